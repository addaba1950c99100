#include "runtime/session.h"

#include <fmt/format.h>
#include <time.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <glm/geometric.hpp>
#include <optional>

#include "runtime/fades.h"
#include "runtime/far_follower.h"
#include "runtime/far_store.h"
#include "runtime/posed_model.h"

namespace promenade {
namespace {

using Clock = std::chrono::steady_clock;

double ms_since(Clock::time_point begin) {
  return std::chrono::duration<double, std::milli>(Clock::now() - begin).count();
}

/// Of all threads of the process, in milliseconds.
double process_cpu_ms() {
  timespec now{};
  if (clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now) != 0) return 0;
  return double(now.tv_sec) * 1e3 + double(now.tv_nsec) * 1e-6;
}

/// Heap of the model's tables.
uint64_t table_bytes(const ModelTables& tables) {
  const auto bytes = [](const auto& v) { return uint64_t(v.capacity()) * sizeof(v[0]); };
  return bytes(tables.nodes) + bytes(tables.children) + bytes(tables.roots) + bytes(tables.materials) +
         bytes(tables.textures) + bytes(tables.node_textures) + bytes(tables.segments);
}

/// What selection takes a node, its lists at their longest included.
constexpr uint64_t kSelectBytesPerNode = sizeof(SelectState::Node) + sizeof(SelectState::Visit) +
                                         sizeof(PriorityUpdate) + sizeof(NodeId) +
                                         2 * sizeof(uint32_t);  // and what fades remember

/// Marks of the next cells share most nodes: what their list takes at most, in vLODs.
constexpr uint64_t kMostSoonSets = 8;

/// What cells take: their tables, the vLODs in memory, and marks on the tree for one of them.
uint64_t cell_bytes(const ModelSource& source, const VlodStore& vlods) {
  const CellTables* cells = source.cells();
  if (cells == nullptr) return 0;
  uint64_t largest = 0;
  for (uint32_t i = 0; i < cells->cells.size(); ++i)
    largest = std::max<uint64_t>(largest, source.vlod_nodes(CellId{i}));
  return cells->byte_size() + source.vlod_reader_bytes() + vlods.bound_bytes() +
         source.model().tables.nodes.size() * (sizeof(uint32_t) + sizeof(uint8_t)) +
         largest * sizeof(NodeId) * (1 + kMostSoonSets);
}

constexpr int kWarmUpFrames = 3;
constexpr int kOverheadFrames = 8;
/// Frames in a row without change after which a picture stands still. Time slices may take as many as a counter needs
/// from one end of its range to the other.
uint32_t still_frames(const SelectOptions& options) {
  constexpr uint32_t kStillFrames = 3;
  if (!uses_time(options.policy) && options.policy != Policy::cost_benefit && options.policy != Policy::feedback)
    return kStillFrames;
  return kStillFrames + static_cast<uint32_t>(2 * options.time.hysteresis_limit);
}

}  // namespace

std::string_view name_of(FarStyle style) {
  return style == FarStyle::full ? "full" : style == FarStyle::near_only ? "near" : "far";
}

std::optional<FarStyle> far_style_named(std::string_view name) {
  for (const FarStyle style : {FarStyle::full, FarStyle::near_only, FarStyle::far_only})
    if (name_of(style) == name) return style;
  return std::nullopt;
}

struct Session::State {
  State(const ModelSource& from, Renderer& draws_with, const SessionOptions& with)
      : source(from),
        renderer(draws_with),
        options(with),
        cursor(from.cells()),
        vlods(from),
        posed(from.model()),
        importance(importance_of(from.model(), with.class_weights)),
        fades(posed.now()) {
    if (with.draw_costs) select_state.costs.emplace(*with.draw_costs), cpu_costs.emplace(*with.draw_costs);
  }
  ~State() {
    thread.reset();
    if (set) set->clear(renderer);
    if (far_store) far_store->clear(renderer);
  }
  State(const State&) = delete;
  State& operator=(const State&) = delete;

  Status open_far(uint64_t& bytes);
  Status draw(const Camera& camera);
  void put_items(const Camera& camera);
  /// Draws `items`; how long that took.
  Result<Redraw> timed_draw();
  /// Of drawing: what the loader does beside it is not part of it.
  double cpu_ms() const { return process_cpu_ms() - (thread ? thread->cpu_ms() : 0); }
  void choose(const Camera& camera, const SelectView& seen, FrameRow& row);
  void look_back(const Camera& camera, double dt_s, SelectView& seen, FrameRow& row);
  void move_to(const Camera& camera, SelectView& seen, FrameRow& row);
  void use_vlod(CellId cell, FrameRow& row);
  void foresee(CellId cell, SelectView& seen, FrameRow& row);
  void follow_far(const Camera& camera, SelectView& seen, FrameRow& row);

  const ModelSource& source;
  Renderer& renderer;
  SessionOptions options;
  Cursor cursor;
  VlodStore vlods;
  std::unique_ptr<VlodMarks> marks;  ///< null: the model has no cells
  std::unique_ptr<SoonMarks> soon;   ///< null: the model has no cells
  std::optional<CellId> marked;      ///< the cell whose vLOD `marks` has
  std::unique_ptr<ResidentSet> set;
  std::unique_ptr<FarStore> far_store;  ///< null: no far pictures
  std::unique_ptr<FarFollower> far;     ///< null: no far pictures
  std::optional<FarCellId> last_far;
  std::vector<DrawItem> far_items;
  std::unique_ptr<Loader> loader;
  std::unique_ptr<LoaderThread> thread;
  SelectState select_state;
  std::optional<CostModel> cpu_costs;  ///< the same in processor time; nothing is decided by it
  Selection selection;
  FrameView view;
  std::vector<DrawItem> items;
  PosedModel posed;
  std::vector<float> importance;  ///< by node; empty: all matter alike
  Fades fades;
  std::vector<FadedNode> faded;
  DrawLoad load;       ///< of the frame, fades included
  double fade_ms = 0;  ///< what the fades are foretold to take
  std::optional<Pose> last_pose;
  uint64_t last_bytes_read = 0;
  double inline_credit_ms = 0;
  uint32_t frames = 0;
};

Session::Session(std::unique_ptr<State> state) : state_(std::move(state)) {}
Session::Session(Session&&) noexcept = default;
Session& Session::operator=(Session&&) noexcept = default;
Session::~Session() = default;

Result<Session> Session::open(const ModelSource& source, Renderer& renderer, const SessionOptions& options) {
  const Model& model = source.model();
  if (model.tables.roots.empty()) return Error{"the model has no nodes; build it again"};
  auto state = std::make_unique<State>(source, renderer, options);
  uint64_t far_bytes = 0;
  PROMENADE_TRY(state->open_far(far_bytes));
  const uint64_t fixed = far_bytes + table_bytes(model.tables) + model.tables.nodes.size() * kSelectBytesPerNode +
                         options.frame_bytes + cell_bytes(source, state->vlods) + model.objects.byte_size() +
                         PosedModel::byte_size(model) +
                         (model.objects.class_shares.empty() ? 0 : model.tables.nodes.size() * sizeof(float));
  const LoaderOptions& loading = options.loader;
  state->set = std::make_unique<ResidentSet>(source, renderer, loading.memory_bytes, fixed, loading.eviction_margin,
                                             loading.along_share);
  PROMENADE_TRY(state->set->load_roots(renderer));
  if (source.cells() != nullptr) {
    state->marks = std::make_unique<VlodMarks>(model);
    state->soon = std::make_unique<SoonMarks>(model);
  }
  state->loader =
      std::make_unique<Loader>(source, renderer, *state->set, &state->vlods, loading, state->far_store.get());
  state->view.model_origin = model.manifest.origin;
  state->view.lighting = options.lighting;
  state->view.background = options.background;
  state->view.textures = options.textures;
  if (options.loader_thread) state->thread = std::make_unique<LoaderThread>(*state->loader);
  return Session(std::move(state));
}

/// Far pictures, if the model has some: where the policy asks for them, or memory is plenty and it may come to that.
Status Session::State::open_far(uint64_t& bytes) {
  const bool asked = uses_far(options.select.policy);
  if (source.far() == nullptr) {
    if (!asked) return Done{};
    return Error{
        fmt::format("policy {}: the model has no far pictures; build it with --far-pictures, or take another policy",
                    name_of(options.select.policy))};
  }
  const uint64_t memory_bytes = options.loader.memory_bytes;
  auto store = std::make_unique<FarStore>(source, renderer, memory_bytes);
  constexpr uint64_t kPart = 2;  // of the memory, at most: near geometry needs some
  if (store->bound_bytes() > memory_bytes / kPart) {
    if (!asked) return Done{};
    return Error{fmt::format(
        "policy {}: two cells' far pictures take {} MiB, half of the memory bound must hold them: "
        "{} MiB or more",
        name_of(options.select.policy), store->bound_bytes() >> 20, (kPart * store->bound_bytes() >> 20) + 1)};
  }
  bytes = store->bound_bytes() + source.far()->byte_size();
  far_store = std::move(store);
  far = std::make_unique<FarFollower>(*source.far());
  return Done{};
}

/// Chooses far pictures, and what is near besides.
void Session::State::follow_far(const Camera& camera, SelectView& seen, FrameRow& row) {
  far_items.clear();
  if (far == nullptr || !uses_far(options.select.policy)) return;
  const glm::dvec3 eye = camera.pose.eye - source.model().manifest.origin;
  far_store->want(far->wanted(eye, seen.velocity_m_per_s));
  far->follow(eye, options.fade_frames, [this](FarCellId cell) { return far_store->find(cell).has_value(); });
  row.far_crossed = last_far && far->cell() && *last_far != *far->cell();
  last_far = far->cell();
  row.far_late = far->is_late(), row.far_missing = far->is_missing();
  seen.near = far->near();
  if (options.far_style == FarStyle::near_only) return;
  for (const FarLayer& layer : far->layers()) {
    const std::optional<FarStore::Picture> picture = far_store->find(layer.cell);
    for (const MeshHandle mesh : picture->meshes)
      far_items.push_back({mesh, kNoNode, glm::mat4(1), layer.from, layer.to});
    row.far_triangles += picture->triangles;
    ++row.far_layers;
  }
}

Status Session::State::draw(const Camera& camera) {
  put_items(camera);
  return renderer.draw(view, items);
}

void Session::State::put_items(const Camera& camera) {
  view.camera = camera;
  items.clear();
  // What is near hides most of what is far.
  if (options.far_style != FarStyle::far_only || far_items.empty())
    for (const FadedNode& f : faded)
      items.push_back({set->mesh_of(f.node), f.node, posed.matrix_of(f.node), f.from, f.to});
  items.insert(items.end(), far_items.begin(), far_items.end());
}

Result<Session::Redraw> Session::State::timed_draw() {
  const Clock::time_point drawing = Clock::now();
  const double cpu_begin_ms = cpu_ms();
  PROMENADE_TRY(renderer.draw(view, items));
  return Redraw{ms_since(drawing), cpu_ms() - cpu_begin_ms};
}

/// How the eye has moved since the last frame.
void Session::State::look_back(const Camera& camera, double dt_s, SelectView& seen, FrameRow& row) {
  if (last_pose) row.moved_m = glm::distance(camera.pose.eye, last_pose->eye);
  if (dt_s > 0 && last_pose && row.moved_m <= kFastestFlightMPerS * dt_s) {
    seen.velocity_m_per_s = (camera.pose.eye - last_pose->eye) / dt_s;
    const double cosine = glm::dot(basis_of(camera.pose).forward, basis_of(*last_pose).forward);
    seen.turn_rad_per_s = std::acos(std::clamp(cosine, -1.0, 1.0)) / dt_s;
  }
  last_pose = camera.pose;
}

/// Selects, and lets switches between levels fade.
void Session::State::choose(const Camera& camera, const SelectView& seen, FrameRow& row) {
  select(posed.now(), seen, set->resident(), options.select, select_state, selection);
  const VlodMarks* hides = uses_vlod(options.select.policy) ? seen.vlod : nullptr;
  fades.follow(selection.front, set->resident(), frustum_of(camera, source.model().manifest.origin), hides,
               options.fade_frames, faded);
  load = selection.load;
  row.triangles_drawn = selection.triangles + row.far_triangles;
  const glm::vec3 eye(camera.pose.eye - source.model().manifest.origin);
  DrawLoad fading;
  for (const FadedNode& f : faded) {
    if (!f.extra) continue;
    const NodeRecord& node = posed.now().tables.nodes[index_of(f.node)];
    const double pixels = covered_pixels(node.box, double(node.box.distance(eye)), pixels_per_radian(camera),
                                         double(camera.width_px) * camera.height_px);
    fading += load_of_node(node, pixels);
    row.triangles_drawn += node.triangles;
    ++row.nodes_fading;
  }
  load += fading;
  fade_ms = select_state.costs ? select_state.costs->estimate_ms(fading)
                               : select_state.ms_per_cost * fading.amount[DrawLoad::triangles] / 2;
}

/// Changes to the vLOD of the eye's cell if it is there.
void Session::State::use_vlod(CellId cell, FrameRow& row) {
  if (marked == cell) return;
  const std::shared_ptr<const Vlod> vlod = vlods.find(cell);
  if (vlod == nullptr) return;
  const VlodMarks::Change change = marks->change_to(vlod->nodes);
  marked = cell;
  row.delta_nodes = change.entered + change.left;
  row.delta_bytes = vlod->bytes_read;
}

/// Asks for the vLODs of the cell, of those that the eye may soon be in, and of the other neighbours; marks what the
/// next cells see.
void Session::State::foresee(CellId cell, SelectView& seen, FrameRow& row) {
  const glm::dvec3 eye = seen.camera.pose.eye - source.model().manifest.origin;
  const std::vector<RangeCell> range = range_cells(*source.cells(), cell, eye, seen.velocity_m_per_s, options.range);
  row.range_cells = range.size();
  std::vector<CellId> wanted = {cell};
  std::map<CellId, std::shared_ptr<const Vlod>> there;
  for (const RangeCell& next : range) {
    wanted.push_back(next.cell);
    if (std::shared_ptr<const Vlod> vlod = vlods.find(next.cell)) there.emplace(next.cell, std::move(vlod));
  }
  for (const CellId next : cursor.neighbours())
    if (std::find(wanted.begin(), wanted.end(), next) == wanted.end()) wanted.push_back(next);
  vlods.want(wanted);
  soon->change_to(there);
  seen.soon = soon.get();
}

/// Follows the eye through the cells, and asks for the vLODs of the cell that it is in and of those beside it.
void Session::State::move_to(const Camera& camera, SelectView& seen, FrameRow& row) {
  const Cursor::Move move = cursor.move_to(camera.pose.eye - source.model().manifest.origin);
  row.cell = cursor.cell();
  row.cell_crossed = move == Cursor::Move::stepped || move == Cursor::Move::jumped;
  if (!row.cell) return;
  const CellTables& tables = *source.cells();
  seen.cell = &tables.cells[index_of(*row.cell)].box;
  seen.bound = &tables.bound;
  if (!uses_vlod(options.select.policy)) return;
  foresee(*row.cell, seen, row);
  use_vlod(*row.cell, row);
  row.vlod_missing = marked != row.cell;
  if (!row.vlod_missing) seen.vlod = marks.get();
}

Result<FrameRow> Session::frame(const Camera& camera, double dt_s) {
  State& s = *state_;
  const Clock::time_point begin = Clock::now();
  s.set->begin_frame(s.renderer);
  s.set->upload(s.renderer, s.options.upload_budget_ms);
  if (s.far_store) {
    s.far_store->begin_frame(s.renderer);
    s.far_store->upload(s.renderer);
  }
  FrameRow row;
  row.upload_ms = ms_since(begin);

  const Clock::time_point selecting = Clock::now();
  SelectView view;
  view.camera = camera;
  s.look_back(camera, dt_s, view, row);
  s.move_to(camera, view, row);
  s.follow_far(camera, view, row);
  const SelectOptions& select_options = s.options.select;
  view.importance = s.importance;
  if (s.posed.moves()) view.swept = &s.posed.source();
  // What fades go on taking, and what this frame has taken so far. Without a cost model: as published.
  if (s.select_state.costs) view.reserved_ms = s.fade_ms + row.upload_ms;
  s.choose(camera, view, row);
  s.set->update(s.selection.updates, NodePricer(s.source.model(), view, select_options));
  s.set->mark_drawn(s.selection.front);
  if (s.thread) s.thread->wake();
  row.select_ms = ms_since(selecting);

  // With v_time the estimate has selection in it.
  const double before_ms = s.select_state.costs ? row.upload_ms + row.select_ms : row.upload_ms;
  row.estimated_ms = before_ms + s.selection.estimated_ms + s.fade_ms;
  row.estimated_without_feedback_ms = before_ms + s.selection.estimated_without_feedback_ms + s.fade_ms;
  s.put_items(camera);
  const Result<Redraw> drawn = s.timed_draw();
  if (!drawn) return drawn.error();
  row.draw_ms = drawn->ms, row.draw_cpu_ms = drawn->cpu_ms;
  if (s.cpu_costs) {
    row.estimated_cpu_ms = s.cpu_costs->estimate_ms(s.load);
    s.cpu_costs->learn(s.load, row.draw_cpu_ms);
  }

  row.frame_ms = ms_since(begin);
  row.response_ms = row.frame_ms;
  row.frame = s.frames++;
  row.share_ms = s.select_state.share_ms;
  row.nodes_drawn = s.selection.front.size() + row.nodes_fading;
  row.pace = s.select_state.costs ? s.select_state.costs->pace() : 1;
  row.nodes_missing = s.selection.nodes_missing;
  row.nodes_foreseen = s.selection.nodes_foreseen;
  row.toggles_up = s.selection.toggles_up;
  row.toggles_down = s.selection.toggles_down;
  row.toggles_loading = s.selection.toggles_loading;
  row.toggles = row.toggles_up + row.toggles_down;
  row.nodes_by_level = s.selection.nodes_by_level;
  row.resident_bytes = s.set->memory().total();  // with all that far pictures may take
  const uint64_t bytes_read = loader_counts().bytes_read;
  row.bytes_read = bytes_read - s.last_bytes_read;
  s.last_bytes_read = bytes_read;
  if (s.select_state.costs) {
    s.selection.load = s.load;
    s.selection.estimated_ms = row.estimated_ms;
    feed_back(s.selection, row.draw_ms, row.frame_ms, select_options.time, s.select_state);
  } else {
    feed_back(s.selection, row.select_ms + row.draw_ms, row.frame_ms, select_options.time, s.select_state);
  }
  return row;
}

Result<Session::Redraw> Session::redraw() { return state_->timed_draw(); }

Status Session::draw_from(const Camera& camera) {
  const Camera own = state_->view.camera;
  PROMENADE_TRY(state_->draw(camera));
  state_->view.camera = own;
  return Done{};
}

void Session::run_loader(double ms) {
  State& s = *state_;
  if (s.thread) {
    s.thread->grant(ms);
    return;
  }
  s.inline_credit_ms = std::min(s.inline_credit_ms, 0.0) + ms;
  while (s.inline_credit_ms > 0) {
    const Loader::Step step = s.loader->step();
    if (step.outcome != Loader::Outcome::worked) break;
    s.inline_credit_ms -= step.busy_ms;
  }
}

void Session::wait_for_loader() {
  if (state_->thread) state_->thread->wait();
}

Result<FrameRow> Session::settle(const Camera& camera, uint32_t max_frames) {
  constexpr double kUnlimitedMs = 1e9;
  FrameRow last;
  const uint32_t enough = still_frames(state_->options.select);
  uint32_t still = 0;
  uint64_t loaded_before = ~uint64_t(0);
  for (uint32_t i = 0; i < std::max(1U, max_frames) && still < enough; ++i) {
    Result<FrameRow> row = frame(camera, 0);
    if (!row) return row.error();
    run_loader(kUnlimitedMs);
    wait_for_loader();
    const LoaderCounts counts = loader_counts();
    const uint64_t loaded = counts.nodes_loaded + counts.textures_loaded + counts.pieces + counts.vlods_loaded +
                            counts.far_sides_loaded + counts.far_sides_uploaded;
    const bool same =
        loaded == loaded_before && row->nodes_drawn == last.nodes_drawn && row->triangles_drawn == last.triangles_drawn;
    still = same && row->nodes_fading == 0 && row->far_layers < 2 ? still + 1 : 0;
    loaded_before = loaded;
    last = *row;
  }
  return last;
}

Status Session::measure_overhead(const Camera& camera) {
  State& s = *state_;
  s.view.camera = camera;
  // The first frames compile shaders: keep that out of every figure.
  s.items.clear();
  for (const NodeId root : s.source.model().tables.roots)
    s.items.push_back({s.set->mesh_of(root), root, s.posed.matrix_of(root)});
  for (int i = 0; i < kWarmUpFrames; ++i) PROMENADE_TRY(s.renderer.draw(s.view, s.items));
  // The roots alone: next to no triangles, but surfaces that fill the picture as any front does. What shading them
  // costs is overhead too; frames without anything would charge it to the first few triangles.
  double least_ms = 1e9;
  for (int i = 0; i < kOverheadFrames; ++i) {
    const Clock::time_point begin = Clock::now();
    PROMENADE_TRY(s.renderer.draw(s.view, s.items));
    least_ms = std::min(least_ms, ms_since(begin));
  }
  s.select_state.overhead_ms = least_ms;
  return Done{};
}

const Selection& Session::selection() const { return state_->selection; }
const SelectState& Session::select_state() const { return state_->select_state; }
LoaderCounts Session::loader_counts() const {
  LoaderCounts counts = state_->set->counts();
  counts.vlods_loaded = state_->vlods.loaded();
  counts.vlod_bytes_read = state_->vlods.bytes_read();
  counts.bytes_read += counts.vlod_bytes_read;
  counts.bytes_read_useful += counts.vlod_bytes_read;
  counts.reads += counts.vlods_loaded;
  if (state_->far_store) {
    counts.far_sides_loaded = state_->far_store->sides_loaded();
    counts.far_sides_uploaded = state_->far_store->sides_uploaded();
    counts.far_bytes_read = state_->far_store->bytes_read();
    counts.bytes_read += counts.far_bytes_read;
    counts.bytes_read_useful += counts.far_bytes_read;
    counts.reads += counts.far_sides_loaded;
  }
  return counts;
}
std::vector<std::string> Session::failures() const {
  std::vector<std::string> failures = state_->set->failures();
  for (std::string& failure : state_->vlods.failures()) failures.push_back(std::move(failure));
  if (state_->far_store)
    for (std::string& failure : state_->far_store->failures()) failures.push_back(std::move(failure));
  return failures;
}
std::vector<NodeId> Session::resident_nodes() const {
  std::vector<NodeId> nodes;
  const std::span<const uint8_t> resident = state_->set->resident();
  for (uint32_t i = 0; i < resident.size(); ++i)
    if (resident[i] != 0) nodes.push_back(NodeId{i});
  return nodes;
}
uint64_t Session::resident_bytes() const { return state_->set->memory().total(); }
uint64_t Session::resident_bytes_peak() const { return state_->set->memory_peak_bytes(); }
void Session::set_time(double time_s) { state_->posed.set_time(time_s); }
const Model& Session::model_now() const { return state_->posed.now(); }
const ClassWeights& Session::class_weights() const { return state_->options.class_weights; }
void Session::set_class_weight(const std::string& class_name, double weight) {
  state_->options.class_weights[class_name] = weight;
  state_->importance = importance_of(state_->source.model(), state_->options.class_weights);
}
SelectOptions& Session::select_options() { return state_->options.select; }
FrameView& Session::frame_view() { return state_->view; }
uint32_t& Session::fade_frames() { return state_->options.fade_frames; }
FarStyle& Session::far_style() { return state_->options.far_style; }

}  // namespace promenade
