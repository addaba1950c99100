#include "runtime/frame_chooser.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace promenade {
namespace {

using Clock = std::chrono::steady_clock;

/// An eye that nobody said how long it took on its way (a still picture's) did not take longer.
constexpr double kLongestFrameS = 0.1;

/// Whether the way ends outside the cells or passes through where there are none. eye: model space.
bool leaves_cells(const CellTables& tables, const glm::dvec3& eye, const glm::dvec3& way) {
  constexpr int kSteps = 4;
  for (int i = 1; i <= kSteps; ++i)
    if (!cell_at(tables, eye + way * (double(i) / kSteps))) return true;
  return false;
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

FrameChooser::FrameChooser(const ModelSource& source, const Shared& shared, const std::optional<DrawCosts>& costs,
                           const RangeOptions& range)
    : source_(source),
      shared_(shared),
      range_(range),
      cursor_(source.cells()),
      posed_(source.model()),
      fades_(posed_.now()) {
  if (source.cells() != nullptr) {
    marks_ = std::make_unique<VlodMarks>(source.model());
    soon_ = std::make_unique<SoonMarks>(source.model());
  }
  if (shared.far != nullptr) far_.emplace(*source.far());
  if (costs) select_state_.costs.emplace(*costs), cpu_costs_.emplace(*costs);
}

/// How the eye has moved since the last frame.
void FrameChooser::look_back(const FrameWish& wish, SelectView& seen, FrameRow& row) {
  const Pose& pose = wish.camera.pose;
  if (last_pose_) row.moved_m = glm::distance(pose.eye, last_pose_->eye);
  if (wish.dt_s > 0 && last_pose_ && row.moved_m <= kFastestFlightMPerS * wish.dt_s) {
    seen.velocity_m_per_s = (pose.eye - last_pose_->eye) / wish.dt_s;
    const double cosine = glm::dot(basis_of(pose).forward, basis_of(*last_pose_).forward);
    seen.turn_rad_per_s = std::acos(std::clamp(cosine, -1.0, 1.0)) / wish.dt_s;
  }
  seen.jumped = !last_pose_ || row.moved_m > kFastestFlightMPerS * std::max(wish.dt_s, kLongestFrameS);
  last_pose_ = pose;
}

/// Changes to the vLOD of the eye's cell if it is there.
void FrameChooser::use_vlod(CellId cell, FrameRow& row) {
  if (marked_ == cell) return;
  const std::shared_ptr<const Vlod> vlod = shared_.vlods.find(cell);
  if (vlod == nullptr) return;
  const VlodMarks::Change change = marks_->change_to(vlod->nodes);
  marked_ = cell;
  row.delta_nodes = change.entered + change.left;
  row.delta_bytes = vlod->bytes_read;
}

/// Asks for the vLODs of the cell, of those that the eye may soon be in, and of the other neighbours; marks what the
/// next cells see.
void FrameChooser::foresee(CellId cell, const SelectOptions& select, SelectView& seen, FrameRow& row) {
  const glm::dvec3 eye = seen.camera.pose.eye - source_.model().manifest.origin;
  const std::vector<RangeCell> range = range_cells(*source_.cells(), cell, eye, seen.velocity_m_per_s, range_);
  row.range_cells = range.size();
  std::vector<CellId> wanted = {cell};
  std::map<CellId, std::shared_ptr<const Vlod>> there;
  for (const RangeCell& next : range) {
    wanted.push_back(next.cell);
    if (std::shared_ptr<const Vlod> vlod = shared_.vlods.find(next.cell)) there.emplace(next.cell, std::move(vlod));
  }
  // What this eye alone does not see comes back with its next step.
  if (select.eye_culling && shared_.eye != nullptr)
    if (std::shared_ptr<const Vlod> vlod = shared_.vlods.find(cell)) there.emplace(cell, std::move(vlod));
  for (const CellId next : cursor_.neighbours())
    if (std::find(wanted.begin(), wanted.end(), next) == wanted.end()) wanted.push_back(next);
  shared_.vlods.want(wanted);
  soon_->change_to(there);
  seen.soon = soon_.get();
  seen.leaving = leaves_cells(*source_.cells(), eye, seen.velocity_m_per_s * select.prefetch_s);
}

/// Follows the eye through the cells, and asks for the vLODs of the cell that it is in and of those beside it.
void FrameChooser::move_to(const FrameWish& wish, SelectView& seen, FrameRow& row) {
  const Cursor::Move move = cursor_.move_to(wish.camera.pose.eye - source_.model().manifest.origin);
  row.cell = cursor_.cell();
  row.cell_crossed = move == Cursor::Move::stepped || move == Cursor::Move::jumped;
  if (!row.cell) return;
  const CellTables& tables = *source_.cells();
  seen.cell = &tables.cells[index_of(*row.cell)].box;
  seen.bound = &tables.bound;
  if (!uses_vlod(wish.select.policy)) return;
  foresee(*row.cell, wish.select, seen, row);
  use_vlod(*row.cell, row);
  row.vlod_missing = marked_ != row.cell;
  if (row.vlod_missing) return;
  seen.vlod = marks_.get();
  if (wish.select.eye_culling && shared_.eye != nullptr) look_with_eye(seen, row);
}

/// Leaves out what the cell sees and the eye does not.
void FrameChooser::look_with_eye(SelectView& seen, FrameRow& row) {
  const Clock::time_point begin = Clock::now();
  if (eye_marks_ == nullptr) eye_marks_ = std::make_unique<VlodMarks>(source_.model());
  const glm::dvec3 eye = seen.camera.pose.eye - source_.model().manifest.origin;
  const std::span<const NodeId> kept = shared_.eye->seen(eye, marks_->nodes());
  row.eye_hidden_nodes = marks_->nodes().size() - kept.size();
  eye_marks_->change_to(kept);
  seen.vlod = eye_marks_.get();
  row.eye_ms = std::chrono::duration<double, std::milli>(Clock::now() - begin).count();
}

/// Chooses far pictures, and what is near besides.
void FrameChooser::follow_far(const FrameWish& wish, SelectView& seen, FrameRow& row) {
  far_items_.clear();
  if (!far_ || !uses_far(wish.select.policy)) return;
  const glm::dvec3 eye = wish.camera.pose.eye - source_.model().manifest.origin;
  FarStore& store = *shared_.far;
  store.want(far_->wanted(eye, seen.velocity_m_per_s));
  const FarTables& tables = *source_.far();
  far_->follow(eye, wish.fade_frames, [&](FarCellId cell) {
    const std::vector<FarCellId> chain = chain_of(tables, cell);
    return std::all_of(chain.begin(), chain.end(), [&](FarCellId each) { return store.find(each).has_value(); });
  });
  row.far_crossed = last_far_ && far_->cell() && *last_far_ != *far_->cell();
  last_far_ = far_->cell();
  row.far_late = far_->is_late(), row.far_missing = far_->is_missing();
  row.far_cell = far_->shown();
  seen.near = far_->near();
  if (wish.far_style == FarStyle::near_only) return;
  for (const FarLayer& layer : far_->layers()) {
    ++row.far_layers;
    for (const FarCellId cell : chain_of(tables, layer.cell)) {
      const std::optional<FarStore::Picture> picture = store.find(cell);
      if (!picture) continue;  // the loader has given it up since
      for (const MeshHandle mesh : picture->meshes)
        far_items_.push_back({mesh, kNoNode, glm::mat4(1), layer.from, layer.to});
      row.far_triangles += picture->triangles;
    }
  }
}

/// What fades draw besides the front.
DrawLoad FrameChooser::load_of_fades(const Camera& camera, FrameRow& row) const {
  const glm::vec3 eye(camera.pose.eye - source_.model().manifest.origin);
  DrawLoad fading;
  for (const FadedNode& f : faded_) {
    if (!f.extra) continue;
    const NodeRecord& node = posed_.now().tables.nodes[index_of(f.node)];
    const double pixels = covered_pixels(node.box, double(node.box.distance(eye)), pixels_per_radian(camera),
                                         double(camera.width_px) * camera.height_px);
    fading += load_of_node(node, pixels);
    row.triangles_drawn += node.triangles;
    ++row.nodes_fading;
  }
  return fading;
}

/// Selects, and lets switches between levels fade.
void FrameChooser::show(const FrameWish& wish, const SelectView& seen, ChosenFrame& frame) {
  Selection& selection = frame.selection;
  select(posed_.now(), seen, shared_.set.resident(), wish.select, select_state_, selection);
  const VlodMarks* hides = uses_vlod(wish.select.policy) ? seen.vlod : nullptr;
  fades_.follow(selection.front, shared_.set.resident(), frustum_of(wish.camera, source_.model().manifest.origin),
                hides, wish.fade_frames, faded_);
  frame.row.triangles_drawn = selection.triangles + frame.row.far_triangles;
  const DrawLoad fading = load_of_fades(wish.camera, frame.row);
  fade_ms_ = select_state_.costs ? select_state_.costs->estimate_ms(fading)
                                 : select_state_.ms_per_cost * fading.amount[DrawLoad::triangles] / 2;
  // With v_time a frame is told by its front alone, as published.
  if (select_state_.costs) selection.load += fading;
}

void FrameChooser::put_items(const FrameWish& wish, ChosenFrame& frame) const {
  frame.view = wish.view;
  frame.view.camera = wish.camera;
  frame.items.clear();
  // What is near hides most of what is far.
  if (wish.far_style != FarStyle::far_only || far_items_.empty())
    for (const FadedNode& f : faded_)
      frame.items.push_back({shared_.set.mesh_of(f.node), f.node, posed_.matrix_of(f.node), f.from, f.to,
                             source_.model().tables.nodes[index_of(f.node)].error_m});
  frame.items.insert(frame.items.end(), far_items_.begin(), far_items_.end());
}

void FrameChooser::choose(const FrameWish& wish, ChosenFrame& frame) {
  const Clock::time_point begin = Clock::now();
  frame.row = {};
  frame.asked = wish.asked, frame.time = wish.select.time;
  frame.leaving = shared_.set.refresh();
  frame.far_leaving = shared_.far != nullptr ? shared_.far->take_leaving() : FarStore::Leaving();
  posed_.set_time(wish.time_s);
  SelectView seen;
  seen.camera = wish.camera;
  look_back(wish, seen, frame.row);
  move_to(wish, seen, frame.row);
  follow_far(wish, seen, frame.row);
  seen.importance = *wish.importance;
  seen.memory = &shared_.set.budget();
  if (posed_.moves()) seen.swept = &posed_.source();
  // What fades go on taking, and what this frame has taken so far. Without a cost model: as published.
  if (select_state_.costs) seen.reserved_ms = fade_ms_ + wish.upload_ms;
  show(wish, seen, frame);
  put_items(wish, frame);
  shared_.set.update(frame.selection.updates, [pricer = NodePricer(source_.model(), seen, wish.select)](NodeId id) {
    return pricer(id) * kRememberedPriority;
  });
  shared_.set.mark_drawn(frame.selection.front);

  const Selection& selection = frame.selection;
  FrameRow& row = frame.row;
  row.estimated_ms = selection.estimated_ms + fade_ms_;  // of drawing alone: the rest is not known yet
  row.estimated_without_feedback_ms = selection.estimated_without_feedback_ms + fade_ms_;
  if (cpu_costs_) row.estimated_cpu_ms = cpu_costs_->estimate_ms(selection.load);
  row.share_ms = select_state_.share_ms;
  row.coarsening = selection.coarser;
  row.pace = select_state_.costs ? select_state_.costs->pace() : 1;
  row.nodes_drawn = selection.front.size() + row.nodes_fading;
  row.nodes_missing = selection.nodes_missing;
  row.nodes_foreseen = selection.nodes_foreseen;
  row.toggles_up = selection.toggles_up, row.toggles_down = selection.toggles_down;
  row.toggles_loading = selection.toggles_loading, row.toggles_back = selection.toggles_back;
  row.toggles = row.toggles_up + row.toggles_down;
  row.nodes_by_level = selection.nodes_by_level;
  frame.chosen = Clock::now();
  row.select_ms = std::chrono::duration<double, std::milli>(frame.chosen - begin).count();
}

void FrameChooser::learn(const FrameTook& took) {
  if (cpu_costs_) cpu_costs_->learn(took.sums.load, took.draw_cpu_ms);
  feed_back(took.sums, took.foretold_ms, took.frame_ms, took.time, select_state_);
}

}  // namespace promenade
