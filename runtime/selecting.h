#pragma once
// One selection under way: what the policies, a file each, have in common.

#include <algorithm>
#include <vector>

#include "runtime/sight.h"

namespace promenade {

/// v_time before anything has been drawn: a million triangles in 100 ms, at weight 1/2.
constexpr double kFirstMsPerCost = 2e-4;

/// Lives as long as one select(). A policy fills out.front in any order, out.updates and the counts of what it did not
/// take; select() does the rest.
class Selecting {
 public:
  Selecting(const Model& on_model, const SelectView& on_view, std::span<const uint8_t> on_resident,
            const SelectOptions& with, SelectState& remembered, Selection& into)
      : model(on_model),
        sight(on_model, on_view, with),
        view(on_view),
        vlod(uses_vlod(with.policy) ? on_view.vlod : nullptr),
        options(with),
        state(remembered),
        out(into),
        resident_(on_resident) {}

  const NodeRecord& node(NodeId id) const { return model.tables.nodes[index_of(id)]; }
  bool resident(NodeId id) const { return resident_[index_of(id)] != 0; }
  bool visible(NodeId id) const { return classify(sight.frustum, node(id).box) != Overlap::outside; }
  /// Within the bound in pixels, or only just beyond the line where it was drawn finer in the frame before.
  bool fine_enough(NodeId id) const {
    return error_px(node(id), sight, options.error_kind) <= bound_px() * tolerance(id);
  }
  double tolerance(NodeId id) const {
    const SelectState::Node& kept = state.nodes[index_of(id)];
    const bool was_finer = kept.refined != 0 && kept.refined + 1 == state.frame;
    return was_finer ? 1 - options.error_hysteresis : 1;
  }
  /// With what memory asks for.
  double bound_px() const { return wished_px() * out.coarser; }
  double wished_px() const {
    return options.policy == Policy::feedback ? state.feedback_pixel_error : options.pixel_error;
  }
  std::span<const NodeId> still_roots() const { return roots(false); }
  std::span<const NodeId> moving_roots() const { return roots(true); }
  /// What the node's box may cover of the picture.
  double pixels_of(NodeId id) const {
    const NodeRecord& n = node(id);
    return covered_pixels(n.box, double(n.box.distance(sight.eye)), sight.pixels_per_radian,
                          double(view.camera.width_px) * view.camera.height_px);
  }
  DrawLoad load_of(NodeId id) const { return load_of_node(node(id), pixels_of(id)); }
  /// What drawing the node is foretold to take.
  double ms_of_node(NodeId id) const {
    if (state.costs) return state.costs->estimate_ms(load_of(id));
    const double ms_per_cost = state.ms_per_cost > 0 ? state.ms_per_cost : kFirstMsPerCost;
    return ms_per_cost * node_cost(node(id), options.time);
  }
  /// Whether the vLOD, if there is one, has something of the node.
  bool may_be_seen(NodeId id) const { return is_near(id) && (vlod == nullptr || vlod->leads_to_some(id)); }
  /// Whether some of it is drawn as geometry. What moves always is: no picture has it.
  bool is_near(NodeId id) const {
    return view.near.empty() || model.is_moving(id) ||
           std::any_of(view.near.begin(), view.near.end(),
                       [this, id](const Box& box) { return box.overlaps(node(id).box); });
  }
  /// Tells the loader about the node: once a selection.
  float price(NodeId id) {
    const float priority = priority_of(model, id, sight, options);
    out.updates.push_back({id, priority});
    state.nodes[index_of(id)].priced = state.frame;
    return priority;
  }
  /// The same for what no policy has priced; false: one has.
  bool foresee(NodeId id) {
    if (state.nodes[index_of(id)].priced == state.frame) return false;
    price(id);
    out.updates.back().priority *= kForeseenPriority;
    return true;
  }

  const Model& model;
  const Sight sight;
  const SelectView& view;
  const VlodMarks* const vlod;  ///< null: everything may be seen
  const SelectOptions& options;
  SelectState& state;
  Selection& out;

 private:
  /// Moving objects have the last nodes, and the last roots.
  std::span<const NodeId> roots(bool moving) const {
    const std::span<const NodeId> all = model.tables.roots;
    const size_t still = all.size() - model.objects.moving.size();
    return moving ? all.subspan(still) : all.first(still);
  }

  std::span<const uint8_t> resident_;
};

/// Policies none, static, feedback, front and vlod.
void select_by_error(Selecting& selecting);
/// For the policies that share out time: objects that move take the levels that the bound in pixels asks for. Returns
/// what drawing them is foretold to take, milliseconds.
double select_moving(Selecting& selecting);
/// Policies time_slices, lakhia and vlod_time_slices.
void select_by_time(Selecting& selecting);
/// Finds what is wanted here and what may soon be, into SelectState::ahead.
void look_ahead(Selecting& selecting);
/// How much coarser the bound in pixels must be for that to fit into memory, into out.coarser. After look_ahead().
void fit_into_memory(Selecting& selecting);
/// Prices what was found ahead and no policy has priced, after one has chosen.
void foresee(Selecting& selecting);
/// Policy cost_benefit.
void select_by_benefit(Selecting& selecting);

}  // namespace promenade
