#include "runtime/policy.h"

#include <algorithm>
#include <array>

#include "runtime/selecting.h"

namespace promenade {
namespace {

/// Frames that the estimate without feedback is taken from: one alone may hold a page fault or a shader's compilation.
constexpr uint32_t kFirstFrames = 10;
/// While detail streams in, a frame's time is mostly its pixels', which the few triangles there would be charged with.
/// Frames with everything in place are waited for; where memory never holds everything, no longer than this.
constexpr uint32_t kStreamingFrames = 90;

/// What a front comes to: order, sums, toggles, estimates.
void finish(Selecting& s) {
  const TimeSliceOptions& time = s.options.time;
  std::vector<std::pair<float, NodeId>> by_distance;
  by_distance.reserve(s.out.front.size());
  for (const NodeId id : s.out.front) {
    const NodeRecord& n = s.node(id);
    by_distance.emplace_back(n.box.distance(s.sight.eye), id);
    s.out.triangles += n.triangles;
    s.out.cost += node_cost(n, time);
    if (n.level >= s.out.nodes_by_level.size()) s.out.nodes_by_level.resize(n.level + 1);
    ++s.out.nodes_by_level[n.level];
    SelectState::Node& kept = s.state.nodes[index_of(id)];
    if (kept.refined != 0 && kept.refined + 1 == s.state.frame) ++s.out.toggles_down;
    kept.drawn = s.state.frame;
    for (NodeId up = n.parent; up != kNoNode; up = s.node(up).parent) {
      SelectState::Node& ancestor = s.state.nodes[index_of(up)];
      if (ancestor.refined == s.state.frame) break;
      if (ancestor.drawn != 0 && ancestor.drawn + 1 == s.state.frame) ++s.out.toggles_up;
      ancestor.refined = s.state.frame;
    }
  }
  std::sort(by_distance.begin(), by_distance.end());
  for (size_t i = 0; i < by_distance.size(); ++i) s.out.front[i] = by_distance[i].second;
  const double ms_per_cost = s.state.ms_per_cost > 0 ? s.state.ms_per_cost : kFirstMsPerCost;
  const double first = s.state.first_ms_per_cost > 0 ? s.state.first_ms_per_cost : kFirstMsPerCost;
  s.out.estimated_ms = s.state.overhead_ms + ms_per_cost * s.out.cost;
  s.out.estimated_without_feedback_ms = s.state.overhead_ms + first * s.out.cost;
}

struct PolicyName {
  Policy policy;
  std::string_view name;
};
constexpr std::array<PolicyName, 7> kPolicyNames = {{{Policy::none, "none"},
                                                     {Policy::static_error, "static"},
                                                     {Policy::time_slices, "time-slices"},
                                                     {Policy::lakhia, "lakhia"},
                                                     {Policy::front, "front"},
                                                     {Policy::vlod, "vlod"},
                                                     {Policy::vlod_time_slices, "vlod-time-slices"}}};

}  // namespace

std::string_view name_of(Policy policy) {
  for (const PolicyName& known : kPolicyNames)
    if (known.policy == policy) return known.name;
  return "";
}

std::optional<Policy> policy_named(std::string_view name) {
  for (const PolicyName& known : kPolicyNames)
    if (known.name == name) return known.policy;
  return std::nullopt;
}

std::string policy_names() {
  std::string names;
  for (const PolicyName& known : kPolicyNames) names += (names.empty() ? "" : ", ") + std::string(known.name);
  return names;
}

double node_cost(const NodeRecord& node, const TimeSliceOptions& options) {
  const double textured = node.textured_triangles, untextured = double(node.triangles) - textured;
  return textured * options.textured_weight + untextured * (1 - options.textured_weight);
}

float node_priority(const Model& model, NodeId node, const SelectView& view, const SelectOptions& options) {
  return priority_of(model, node, Sight(model, view, options), options);
}

NodePricer::NodePricer(const Model& model, const SelectView& view, const SelectOptions& options)
    : model_(model), options_(options), sight_(std::make_shared<const Sight>(model, view, options)) {}

float NodePricer::operator()(NodeId node) const {
  return priority_of(model_, node, *static_cast<const Sight*>(sight_.get()), options_);
}

void select(const Model& model, const SelectView& view, std::span<const uint8_t> resident, const SelectOptions& options,
            SelectState& state, Selection& selection) {
  if (state.nodes.size() != model.tables.nodes.size()) {
    state.nodes.assign(model.tables.nodes.size(), {});
    state.frame = 0;
  }
  if (state.share_ms <= 0) state.share_ms = options.time.target_ms;
  ++state.frame;
  selection.front.clear();
  selection.updates.clear();
  selection.nodes_by_level.clear();
  selection.triangles = selection.nodes_missing = selection.toggles_up = selection.toggles_down = 0;
  selection.loaded_rejected = 0;
  selection.cost = 0;
  Selecting selecting(model, view, resident, options, state, selection);
  if (uses_time(options.policy))
    select_by_time(selecting);
  else
    select_by_error(selecting);
  finish(selecting);
}

void feed_back(const Selection& selection, double draw_ms, double frame_ms, const TimeSliceOptions& options,
               SelectState& state) {
  const bool is_whole = selection.nodes_missing == 0;
  if (selection.cost > 0 && (is_whole || state.frame > kStreamingFrames)) {
    const double measured = std::max(draw_ms - state.overhead_ms, 0.0) / selection.cost;
    if (state.measured_frames < kFirstFrames) {
      ++state.measured_frames;
      state.first_ms_per_cost += (measured - state.first_ms_per_cost) / double(state.measured_frames);
    }
    if (state.ms_per_cost <= 0 || !options.time_feedback)
      state.ms_per_cost = state.first_ms_per_cost;
    else
      state.ms_per_cost += options.time_gain * (measured - state.ms_per_cost);
  }
  if (!options.share_feedback) {
    state.share_ms = options.target_ms;
    return;
  }
  if (frame_ms < options.target_ms * (1 - options.share_tolerance)) {
    if (selection.loaded_rejected > 0) state.share_ms *= 1 + options.share_gain;
  } else if (frame_ms > options.target_ms * (1 + options.share_tolerance)) {
    state.share_ms *= 1 - options.share_gain;
  }
  state.share_ms = std::clamp(state.share_ms, options.target_ms / options.share_factor_max,
                              options.target_ms * options.share_factor_max);
}

}  // namespace promenade
