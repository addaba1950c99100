#include "runtime/policy.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "runtime/selecting.h"

namespace promenade {
namespace {

/// Frames that the estimate without feedback is taken from: one alone may hold a page fault or a shader's compilation.
constexpr uint32_t kFirstFrames = 10;
/// While detail streams in, a frame's time is mostly its pixels', which the few triangles there would be charged with.
/// Frames with everything in place are waited for; where memory never holds everything, no longer than this.
constexpr uint32_t kStreamingFrames = 90;

/// With a cost model: the roots share no less than the target over this.
constexpr double kLeastShareDivisor = 4;
/// Policy feedback: its bound follows this power of the time over the target, and stays within this factor of
/// pixel_error.
constexpr double kFeedbackPower = 0.2, kFeedbackCoarsest = 1000;

/// A node that was refined is drawn, or the other way round: never twice the same, so each toggle undoes the last.
void count_toggle(Selecting& s, SelectState::Node& node, uint64_t& of_its_way) {
  ++of_its_way;
  if (node.toggled != 0 && s.state.frame - node.toggled <= SelectionSums::kBackFrames) ++s.out.toggles_back;
  node.toggled = s.state.frame;
}

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
    s.out.load += s.load_of(id);
    if (n.level >= s.out.nodes_by_level.size()) s.out.nodes_by_level.resize(n.level + 1);
    ++s.out.nodes_by_level[n.level];
    SelectState::Node& kept = s.state.nodes[index_of(id)];
    if (kept.refined != 0 && kept.refined + 1 == s.state.frame) {
      count_toggle(s, kept, s.out.toggles_down);
      if (kept.lacked == s.state.frame) ++s.out.toggles_loading;
    }
    kept.drawn = s.state.frame;
    for (NodeId up = n.parent; up != kNoNode; up = s.node(up).parent) {
      SelectState::Node& ancestor = s.state.nodes[index_of(up)];
      if (ancestor.refined == s.state.frame) break;
      if (ancestor.drawn != 0 && ancestor.drawn + 1 == s.state.frame) {
        count_toggle(s, ancestor, s.out.toggles_up);
        if (ancestor.lacked != 0 && ancestor.lacked + 1 == s.state.frame) ++s.out.toggles_loading;
      }
      ancestor.refined = s.state.frame;
    }
  }
  std::sort(by_distance.begin(), by_distance.end());
  for (size_t i = 0; i < by_distance.size(); ++i) s.out.front[i] = by_distance[i].second;
  const double ms_per_cost = s.state.ms_per_cost > 0 ? s.state.ms_per_cost : kFirstMsPerCost;
  const double first = s.state.first_ms_per_cost > 0 ? s.state.first_ms_per_cost : kFirstMsPerCost;
  s.out.estimated_ms = s.state.overhead_ms + ms_per_cost * s.out.cost;
  s.out.estimated_without_feedback_ms = s.state.overhead_ms + first * s.out.cost;
  if (!s.state.costs) return;
  s.out.estimated_ms = s.state.costs->estimate_ms(s.out.load);
  s.out.estimated_without_feedback_ms = s.state.costs->unrefined_ms(s.out.load);
}

bool as_published(Policy policy) { return policy == Policy::lakhia || policy == Policy::none; }
/// Whether the bound in pixels gives way to memory: not where there is none, or where it is a cell's.
bool may_give_way(Policy policy) { return !as_published(policy) && policy != Policy::front && !uses_far(policy); }

struct PolicyName {
  Policy policy;
  std::string_view name;
};
constexpr std::array<PolicyName, 11> kPolicyNames = {{{Policy::none, "none"},
                                                      {Policy::static_error, "static"},
                                                      {Policy::feedback, "feedback"},
                                                      {Policy::cost_benefit, "cost-benefit"},
                                                      {Policy::time_slices, "time-slices"},
                                                      {Policy::lakhia, "lakhia"},
                                                      {Policy::front, "front"},
                                                      {Policy::vlod, "vlod"},
                                                      {Policy::vlod_time_slices, "vlod-time-slices"},
                                                      {Policy::stratified, "stratified"},
                                                      {Policy::vlod_stratified, "vlod-stratified"}}};

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

std::span<const Policy> all_policies() {
  static constexpr std::array kAll = {
      Policy::vlod_time_slices, Policy::cost_benefit, Policy::vlod,     Policy::front, Policy::time_slices,
      Policy::lakhia,           Policy::static_error, Policy::feedback, Policy::none,  Policy::stratified,
      Policy::vlod_stratified};
  static_assert(kAll.size() == kPolicyNames.size());
  return kAll;
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
  state.feedback_pixel_error =
      std::clamp(state.feedback_pixel_error, options.pixel_error, options.pixel_error * kFeedbackCoarsest);
  ++state.frame;
  static_cast<SelectionSums&>(selection) = {};
  selection.front.clear();
  selection.updates.clear();
  selection.nodes_by_level.clear();
  selection.load = load_of_picture(view.camera.width_px, view.camera.height_px);
  Selecting selecting(model, view, resident, options, state, selection);
  Selecting ahead(view.swept != nullptr ? *view.swept : model, view, resident, options, state, selection);
  const bool foresees = options.prefetch_s > 0 && !as_published(options.policy);
  const bool fits =
      view.memory != nullptr && options.fit_memory && options.pixel_error > 0 && may_give_way(options.policy);
  if (foresees || fits) look_ahead(ahead);
  if (fits)
    fit_into_memory(ahead);
  else
    state.fit = {};
  if (options.policy == Policy::cost_benefit)
    select_by_benefit(selecting);
  else if (uses_time(options.policy))
    select_by_time(selecting);
  else
    select_by_error(selecting);
  if (foresees) foresee(ahead);
  finish(selecting);
}

namespace {

/// Policy feedback: a coarser bound after a frame that took longer than the target, a finer one after a shorter one.
void follow_target(double frame_ms, const TimeSliceOptions& options, SelectState& state) {
  if (state.feedback_pixel_error <= 0 || frame_ms <= 0) return;
  state.feedback_pixel_error *= std::pow(std::clamp(frame_ms / options.target_ms, 0.5, 2.0), kFeedbackPower);
}

}  // namespace

void feed_back(const SelectionSums& selection, double draw_ms, double frame_ms, const TimeSliceOptions& options,
               SelectState& state) {
  if (state.costs) state.costs->learn(selection.load, draw_ms);
  follow_target(frame_ms, options, state);
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
  // One slow frame tells of other programs, not of the share: with a cost model the estimate must say so, too.
  if (state.costs && frame_ms > options.target_ms && selection.estimated_ms <= options.target_ms) return;
  if (frame_ms < options.target_ms * (1 - options.share_tolerance)) {
    if (selection.loaded_rejected > 0) state.share_ms *= 1 + options.share_gain;
  } else if (frame_ms > options.target_ms * (1 + options.share_tolerance)) {
    state.share_ms *= 1 - options.share_gain;
  }
  // Where the picture alone takes longer than the target, coarser levels save next to nothing: they stop at a share.
  const double least = state.costs ? std::min(options.share_factor_max, kLeastShareDivisor) : options.share_factor_max;
  state.share_ms = std::clamp(state.share_ms, options.target_ms / least, options.target_ms * options.share_factor_max);
}

}  // namespace promenade
