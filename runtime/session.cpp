#include "runtime/session.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <chrono>
#include <deque>

#include "runtime/choosing_thread.h"
#include "runtime/posed_model.h"
#include "runtime/thread_time.h"

namespace promenade {
namespace {

using Clock = std::chrono::steady_clock;

double ms_between(Clock::time_point begin, Clock::time_point end) {
  return std::chrono::duration<double, std::milli>(end - begin).count();
}
double ms_since(Clock::time_point begin) { return ms_between(begin, Clock::now()); }

/// Heap of the model's tables.
uint64_t table_bytes(const ModelTables& tables) {
  const auto bytes = [](const auto& v) { return uint64_t(v.capacity()) * sizeof(v[0]); };
  return bytes(tables.nodes) + bytes(tables.children) + bytes(tables.roots) + bytes(tables.materials) +
         bytes(tables.textures) + bytes(tables.node_textures) + bytes(tables.segments);
}

/// What selection takes a node.
constexpr uint64_t kSelectBytesPerNode =
    sizeof(SelectState::Node) + sizeof(SelectState::Visit) + sizeof(AheadNode) + 2 * sizeof(uint32_t);  // and fades'
/// What a frame on its way takes a node: its lists at their longest.
constexpr uint64_t kFrameBytesPerNode = sizeof(PriorityUpdate) + sizeof(NodeId);

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

/// Part of what the bound leaves for nodes that is not for pictures that nodes share.
constexpr uint64_t kMeshesPart = 8;
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

struct Session::State {
  State(const ModelSource& from, Renderer& draws_with, const SessionOptions& with)
      : source(from),
        renderer(draws_with),
        options(with),
        vlods(from),
        importance(std::make_shared<const std::vector<float>>(importance_of(from.model(), with.class_weights))) {
    view.model_origin = from.model().manifest.origin;
    view.lighting = with.lighting, view.background = with.background, view.textures = with.textures;
  }
  ~State() {
    // Who works beside first. What was chosen and not drawn may have handles that are to be destroyed.
    for (; asked > 0 && choosing; --asked) let_go(*choosing->next());
    choosing.reset();
    thread.reset();
    if (set) set->clear(renderer);
    if (far_store) far_store->clear(renderer);
  }
  State(const State&) = delete;
  State& operator=(const State&) = delete;

  Status open_far(uint64_t& bytes);
  uint64_t fixed_bytes() const;
  /// taken_bytes: of the bound, by other things than nodes.
  TextureLimit texture_limit(uint64_t taken_bytes) const;
  void let_go(const ChosenFrame& frame);
  double upload();
  void choose_now();
  void await_chosen(Clock::time_point begin);
  /// Draws `shown`; how long that took.
  Result<Redraw> timed_draw();
  void finish(double frame_ms, double before_ms);
  /// Of drawing: what the loader does beside it is not part of it, nor is choosing.
  double cpu_ms() const {
    return process_cpu_ms() - (thread ? thread->cpu_ms() : 0) - (choosing ? choosing->cpu_ms() : 0);
  }

  const ModelSource& source;
  Renderer& renderer;
  SessionOptions options;
  VlodStore vlods;
  std::unique_ptr<EyeCuller> eye;  ///< null: the model does not say what is open in its walls
  std::unique_ptr<ResidentSet> set;
  std::unique_ptr<FarStore> far_store;  ///< null: no far pictures
  std::unique_ptr<Loader> loader;
  std::unique_ptr<LoaderThread> thread;
  std::unique_ptr<FrameChooser> chooser;     ///< `choosing`'s own while that lives
  std::unique_ptr<ChoosingThread> choosing;  ///< null: no frames ahead
  std::unique_ptr<PosedModel> shown_model;   ///< null: the chooser's

  // What the next frame is asked for with.
  FrameView view;
  double time_s = 0;
  std::shared_ptr<const std::vector<float>> importance;  ///< by node; empty: all matter alike

  std::optional<FrameWish> wish;                                         ///< without frames ahead: what was asked for
  std::deque<double> times_s;                                            ///< of the frames asked for, with frames ahead
  uint32_t asked = 0;                                                    ///< frames, not drawn yet
  std::unique_ptr<ChosenFrame> shown = std::make_unique<ChosenFrame>();  ///< drawn last
  Clock::time_point finished;                                            ///< when that was
  double upload_ms = 0;                                                  ///< of that
  uint64_t last_bytes_read = 0;
  double inline_credit_ms = 0;
  uint32_t frames = 0;
};

Session::Session(std::unique_ptr<State> state) : state_(std::move(state)) {}
Session::Session(Session&&) noexcept = default;
Session& Session::operator=(Session&&) noexcept = default;
Session::~Session() = default;

/// What the memory bound counts besides what is loaded.
uint64_t Session::State::fixed_bytes() const {
  const Model& model = source.model();
  const uint64_t nodes = model.tables.nodes.size(),
                 frames_in_memory = 1 + (options.frames_ahead > 0 ? 1 : 0) + uint64_t(options.frames_ahead);
  return table_bytes(model.tables) + nodes * (kSelectBytesPerNode + frames_in_memory * kFrameBytesPerNode) +
         options.frame_bytes + cell_bytes(source, vlods) + model.objects.byte_size() +
         (eye != nullptr ? source.openings()->byte_size() + eye->byte_size() + nodes * sizeof(uint32_t) : 0) +
         PosedModel::byte_size(model) * (options.frames_ahead > 0 ? 2 : 1) +
         (model.objects.class_shares.empty() ? 0 : nodes * sizeof(float));
}

Result<Session> Session::open(const ModelSource& source, Renderer& renderer, const SessionOptions& options) {
  const Model& model = source.model();
  if (model.tables.roots.empty()) return Error{"the model has no nodes; build it again"};
  auto state = std::make_unique<State>(source, renderer, options);
  State& s = *state;
  uint64_t far_bytes = 0;
  PROMENADE_TRY(s.open_far(far_bytes));
  if (source.openings() != nullptr)
    s.eye = std::make_unique<EyeCuller>(model, *source.openings());
  else if (options.select.eye_culling)
    return Error{"the model does not say what is open in its walls: build it with --openings"};
  const LoaderOptions& loading = options.loader;
  const uint64_t fixed_bytes = far_bytes + s.fixed_bytes();
  s.set = std::make_unique<ResidentSet>(source, renderer, loading.memory_bytes, fixed_bytes, loading.eviction_margin,
                                        loading.along_share, s.texture_limit(fixed_bytes));
  PROMENADE_TRY(s.set->load_roots(renderer));
  s.chooser = std::make_unique<FrameChooser>(source, Shared{*s.set, s.vlods, s.far_store.get(), s.eye.get()},
                                             options.draw_costs, options.range);
  s.loader = std::make_unique<Loader>(source, renderer, *s.set, &s.vlods, loading, s.far_store.get());
  if (options.loader_thread) s.thread = std::make_unique<LoaderThread>(*s.loader);
  if (options.frames_ahead == 0) return Session(std::move(state));
  if (s.chooser->posed().moves()) s.shown_model = std::make_unique<PosedModel>(model);
  s.choosing = std::make_unique<ChoosingThread>(*s.chooser, options.frames_ahead + 1, [&s] {
    if (s.thread) s.thread->wake();
  });
  return Session(std::move(state));
}

TextureLimit Session::State::texture_limit(uint64_t taken_bytes) const {
  const LoaderOptions& loading = options.loader;
  if (loading.texture_side) return {*loading.texture_side > 0 ? *loading.texture_side : kAnySide};
  const uint64_t left = loading.memory_bytes - std::min(loading.memory_bytes, taken_bytes);
  return texture_limit_for(source, left - left / kMeshesPart);
}

/// Far pictures, if the model has some: where the policy asks for them, or memory is plenty and it may come to that.
Status Session::State::open_far(uint64_t& bytes) {
  const bool needed = uses_far(options.select.policy);
  if (source.far() == nullptr) {
    if (!needed) return Done{};
    return Error{
        fmt::format("policy {}: the model has no far pictures; build it with --far-pictures, or take another policy",
                    name_of(options.select.policy))};
  }
  const uint64_t memory_bytes = options.loader.memory_bytes;
  auto store = std::make_unique<FarStore>(source, renderer, memory_bytes);
  constexpr uint64_t kPart = 2;  // of the memory, at most: near geometry needs some
  if (store->bound_bytes() > memory_bytes / kPart) {
    if (!needed) return Done{};
    return Error{fmt::format(
        "policy {}: far pictures of the least number of cells take {} MiB, half of the memory bound must hold them: "
        "{} MiB or more",
        name_of(options.select.policy), store->bound_bytes() >> 20, (kPart * store->bound_bytes() >> 20) + 1)};
  }
  bytes = store->bound_bytes() + source.far()->byte_size();
  far_store = std::move(store);
  return Done{};
}

void Session::State::let_go(const ChosenFrame& frame) {
  set->let_go(frame.leaving, renderer);
  if (far_store) far_store->let_go(frame.far_leaving, renderer);
}

/// Hands what was loaded to the renderer; how long that took.
double Session::State::upload() {
  const Clock::time_point begin = Clock::now();
  set->upload(renderer, options.upload_budget_ms);
  if (far_store) far_store->upload(renderer, options.upload_budget_ms);
  return ms_since(begin);
}

Result<Session::Redraw> Session::State::timed_draw() {
  const Clock::time_point drawing = Clock::now();
  const double cpu_begin_ms = cpu_ms();
  PROMENADE_TRY(renderer.draw(shown->view, shown->items));
  return Redraw{ms_since(drawing), cpu_ms() - cpu_begin_ms};
}

void Session::ask(const Camera& camera, double dt_s, std::optional<Clock::time_point> read) {
  State& s = *state_;
  assert(s.asked <= s.options.frames_ahead);
  FrameWish wish{camera,
                 dt_s,
                 s.time_s,
                 s.options.select,
                 s.view,
                 s.options.fade_frames,
                 s.options.far_style,
                 s.importance,
                 s.upload_ms,
                 read.value_or(Clock::now())};
  ++s.asked;
  if (!s.choosing) {
    s.wish = std::move(wish);
    return;
  }
  s.times_s.push_back(s.time_s);
  s.choosing->ask(std::move(wish));
}

uint32_t Session::frames_asked() const { return state_->asked; }
uint32_t Session::frames_ahead() const { return state_->options.frames_ahead; }

/// One stage after the other: what has just come can be shown at once.
void Session::State::choose_now() {
  upload_ms = wish->upload_ms = upload();
  chooser->choose(*wish, *shown);
  wish.reset();
  if (thread) thread->wake();
  const Clock::time_point leaving = Clock::now();
  let_go(*shown);
  upload_ms += ms_since(leaving);
}

/// What was chosen beside the last frame. Uploads are for the frames after it.
void Session::State::await_chosen(Clock::time_point begin) {
  std::unique_ptr<ChosenFrame> next = choosing->next();
  shown.swap(next);
  choosing->give_back(std::move(next));
  // The time between two pictures; what the caller did in between, a loader's turn or a pause, is not the frame's.
  const Clock::time_point free = std::max(finished, shown->asked);
  shown->row.wait_ms = std::max({0.0, ms_between(free, shown->chosen), ms_since(begin)});
  if (shown_model) shown_model->set_time(times_s.front());
  times_s.pop_front();
  const Clock::time_point uploading = Clock::now();
  let_go(*shown);
  upload();
  upload_ms = ms_since(uploading);
}

/// What is known when the picture is whole.
void Session::State::finish(double frame_ms, double foretold_ms) {
  FrameRow& row = shown->row;
  finished = Clock::now();
  row.frame_ms = frame_ms;
  row.response_ms = ms_between(shown->asked, finished);
  row.frame = frames++;
  row.resident_bytes = set->memory().total();  // with all that far pictures may take
  SelectionSums sums = shown->selection;
  if (chooser->has_costs()) sums.estimated_ms = row.estimated_ms;
  const FrameTook took{sums, shown->time, foretold_ms, row.frame_ms, row.draw_cpu_ms};
  if (choosing)
    choosing->learn(took);
  else
    chooser->learn(took);
}

Result<FrameRow> Session::draw_next() {
  State& s = *state_;
  assert(s.asked > 0);
  --s.asked;
  const Clock::time_point begin = Clock::now();
  if (s.choosing)
    s.await_chosen(begin);
  else
    s.choose_now();
  FrameRow& row = s.shown->row;
  row.upload_ms = s.upload_ms;
  // Of the frame's time, what lies before drawing. With v_time the estimate has selection in it.
  const double choosing_ms = s.choosing ? row.wait_ms : row.select_ms;
  const double before_ms = row.upload_ms + (s.chooser->has_costs() ? choosing_ms : 0);
  row.estimated_ms += before_ms, row.estimated_without_feedback_ms += before_ms;
  const Result<Redraw> drawn = s.timed_draw();
  if (!drawn) return drawn.error();
  row.draw_ms = drawn->ms, row.draw_cpu_ms = drawn->cpu_ms;
  const double frame_ms = s.choosing ? row.wait_ms + row.upload_ms + row.draw_ms : ms_since(begin);
  s.finish(frame_ms, row.draw_ms + (s.chooser->has_costs() ? 0 : choosing_ms));
  const uint64_t bytes_read = loader_counts().bytes_read;
  row.bytes_read = bytes_read - s.last_bytes_read;
  s.last_bytes_read = bytes_read;
  return row;
}

Result<FrameRow> Session::frame(const Camera& camera, double dt_s) {
  while (state_->asked > 0)
    if (const Result<FrameRow> before = draw_next(); !before) return before;
  ask(camera, dt_s);
  return draw_next();
}

Result<Session::Redraw> Session::redraw() { return state_->timed_draw(); }

Status Session::draw_from(const Camera& camera) {
  FrameView view = state_->shown->view;
  view.camera = camera;
  return state_->renderer.draw(view, state_->shown->items);
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
  FrameView view = s.view;
  view.camera = camera;
  // The first frames compile shaders: keep that out of every figure.
  std::vector<DrawItem> items;
  items.reserve(s.source.model().tables.roots.size());
  for (const NodeId root : s.source.model().tables.roots)
    items.push_back({s.set->mesh_of(root), root, s.chooser->posed().matrix_of(root)});
  for (int i = 0; i < kWarmUpFrames; ++i) PROMENADE_TRY(s.renderer.draw(view, items));
  // The roots alone: next to no triangles, but surfaces that fill the picture as any front does. What shading them
  // costs is overhead too; frames without anything would charge it to the first few triangles.
  double least_ms = 1e9;
  for (int i = 0; i < kOverheadFrames; ++i) {
    const Clock::time_point begin = Clock::now();
    PROMENADE_TRY(s.renderer.draw(view, items));
    least_ms = std::min(least_ms, ms_since(begin));
  }
  s.chooser->set_overhead_ms(least_ms);
  return Done{};
}

const Selection& Session::selection() const { return state_->shown->selection; }
const Camera& Session::camera_drawn() const { return state_->shown->view.camera; }
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
std::vector<NodeId> Session::resident_nodes() const { return state_->set->resident_nodes(); }
uint64_t Session::resident_bytes() const { return state_->set->memory().total(); }
uint32_t Session::texture_side_px() const { return state_->set->texture_limit().side_px; }
uint64_t Session::resident_bytes_peak() const { return state_->set->memory_peak_bytes(); }
void Session::set_time(double time_s) { state_->time_s = time_s; }
const Model& Session::model_now() const {
  return (state_->shown_model ? *state_->shown_model : state_->chooser->posed()).now();
}
const ClassWeights& Session::class_weights() const { return state_->options.class_weights; }
void Session::set_class_weight(const std::string& class_name, double weight) {
  state_->options.class_weights[class_name] = weight;
  state_->importance =
      std::make_shared<const std::vector<float>>(importance_of(state_->source.model(), state_->options.class_weights));
}
SelectOptions& Session::select_options() { return state_->options.select; }
FrameView& Session::frame_view() { return state_->view; }
bool Session::has_openings() const { return state_->eye != nullptr; }
uint32_t& Session::fade_frames() { return state_->options.fade_frames; }
FarStyle& Session::far_style() { return state_->options.far_style; }

}  // namespace promenade
