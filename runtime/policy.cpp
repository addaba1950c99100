#include "runtime/policy.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace promenade {
namespace {

/// v_time before anything has been drawn: a million triangles in 100 ms, at weight 1/2.
constexpr double kFirstMsPerCost = 2e-4;
/// Frames that the estimate without feedback is taken from: one alone may hold a page fault or a shader's compilation.
constexpr uint32_t kFirstFrames = 10;
/// While detail streams in, a frame's time is mostly its pixels', which the few triangles there would be charged with.
/// Frames with everything in place are waited for; where memory never holds everything, no longer than this.
constexpr uint32_t kStreamingFrames = 90;
constexpr uint32_t kNoVisit = 0xffffffffU;

/// What of the view does not depend on the node.
struct Sight {
  Sight(const Model& model, const SelectView& view, const SelectOptions& options)
      : eye(view.camera.pose.eye - model.manifest.origin),
        later_eye(glm::dvec3(eye) + view.velocity_m_per_s * options.look_ahead_s),
        towards_eye(-basis_of(view.camera.pose).forward),
        frustum(frustum_of(view.camera, model.manifest.origin)),
        pixels_per_radian(promenade::pixels_per_radian(view.camera)) {}

  glm::vec3 eye, later_eye, towards_eye;
  Frustum frustum;
  double pixels_per_radian;
};

double error_px(const NodeRecord& node, const Sight& sight) {
  return screen_error_px(node.error_m, node.box.distance(sight.eye), sight.pixels_per_radian);
}

double priority_distance(const NodeRecord& node, const Sight& sight, const SelectOptions& options) {
  return std::max({double(node.box.distance(sight.later_eye)), options.distance_min_m,
                   options.distance_min_diagonals * double(node.box.diagonal())});
}

/// 1 in the frustum, falling to 0 with the distance outside it.
double frustum_visibility(const NodeRecord& node, const Sight& sight, const SelectOptions& options, double distance_m) {
  const double outside_m = distance_outside(sight.frustum, node.box);
  if (outside_m <= 0) return 1;
  return std::max(0.0, 1 - outside_m / (options.visibility_falloff * distance_m));
}

/// priority_n of [lakhia2004] section 4.2, for the policies that are its; else the pixels of error that the node takes
/// away, weighted by visibility alike.
float priority_of(const Model& model, NodeId id, const Sight& sight, const SelectOptions& options) {
  const NodeRecord& node = model.tables.nodes[index_of(id)];
  const TimeSliceOptions& time = options.time;
  const double distance_m = priority_distance(node, sight, options);
  const double vis = 1 + time.visibility_weight * frustum_visibility(node, sight, options, distance_m);
  double priority = 0;
  if (options.policy == Policy::time_slices || options.policy == Policy::lakhia) {
    const double static_benefit = std::sqrt(double(node.triangles) * double(node.surface_m2));
    const double foreshorten =
        1 + double(glm::dot(sight.towards_eye, node.average_normal)) * time.foreshortening_weight;
    const double benefit = static_benefit * vis * foreshorten / (distance_m * distance_m);
    priority = benefit / std::max(node_cost(node, time), 1e-3);
  } else {
    const double coarser_m = node.parent == kNoNode ? double(node.box.diagonal())
                                                    : double(model.tables.nodes[index_of(node.parent)].error_m);
    priority = coarser_m / distance_m * sight.pixels_per_radian * vis;
  }
  return static_cast<float>(std::min(priority, 1e30));
}

/// One selection under way.
class Selecting {
 public:
  Selecting(const Model& model, const SelectView& view, std::span<const uint8_t> resident, const SelectOptions& options,
            SelectState& state, Selection& out)
      : model_(model), sight_(model, view, options), resident_(resident), options_(options), state_(state), out_(out) {}

  void by_error();
  void by_time();
  void finish();

 private:
  struct Slice {
    NodeId node;
    double ms;
  };
  /// A sibling set priced and counted: what [lakhia2004] decides on.
  struct Siblings {
    std::vector<Slice> visible;
    uint32_t visible_missing = 0, missing = 0;
    double needed_ms = 0;
    int64_t cumulative_hysteresis = 0;
  };

  const NodeRecord& node(NodeId id) const { return model_.tables.nodes[index_of(id)]; }
  bool resident(NodeId id) const { return resident_[index_of(id)] != 0; }
  bool visible(NodeId id) const { return classify(sight_.frustum, node(id).box) != Overlap::outside; }
  bool fine_enough(const NodeRecord& n) const { return error_px(n, sight_) <= options_.pixel_error; }
  float price(NodeId id);
  void price_siblings(std::span<const NodeId> ids, double share_ms, Siblings& siblings);
  void update_hysteresis(NodeId id, double slice_ms, double needed_ms);
  bool time_allows(const Siblings& siblings, double share_ms) const;

  void visit_wanted(NodeId root);
  void prefetch_around(NodeId id);

  const Model& model_;
  Sight sight_;
  std::span<const uint8_t> resident_;
  const SelectOptions& options_;
  SelectState& state_;
  Selection& out_;
  std::vector<NodeId> stack_;
};

float Selecting::price(NodeId id) {
  const float priority = priority_of(model_, id, sight_, options_);
  out_.updates.push_back({id, priority});
  return priority;
}

// --- static, none -------------------------------------------------------------------------------------------------

/// Prices nodes beside the frustum that a turn of the head would show, as far as their error wants them.
void Selecting::prefetch_around(NodeId id) {
  stack_.assign(1, id);
  while (!stack_.empty()) {
    const NodeId at = stack_.back();
    stack_.pop_back();
    price(at);
    const NodeRecord& n = node(at);
    const double distance_m = priority_distance(n, sight_, options_);
    if (frustum_visibility(n, sight_, options_, distance_m) <= 0 || fine_enough(n)) continue;
    for (const NodeId child : model_.children_of(at)) stack_.push_back(child);
  }
}

/// Walks down to the front that the error asks for, whatever is resident; visits parents before children.
void Selecting::visit_wanted(NodeId root) {
  const size_t begin = state_.visits.size();
  state_.visits.push_back({root, kNoVisit, 0, false});
  price(root);
  for (size_t i = begin; i < state_.visits.size(); ++i) {
    const NodeId id = state_.visits[i].node;
    const NodeRecord& n = node(id);
    const bool wanted = n.child_count == 0 || (options_.policy == Policy::static_error && fine_enough(n));
    state_.visits[i].wanted = wanted;
    if (wanted) continue;
    for (const NodeId child : model_.children_of(id)) {
      if (!visible(child)) {
        if (options_.policy == Policy::static_error) prefetch_around(child);
        continue;
      }
      price(child);
      state_.visits.push_back({child, static_cast<uint32_t>(i), 0, false});
    }
  }
}

void Selecting::by_error() {
  state_.visits.clear();
  for (const NodeId root : model_.tables.roots) {
    if (visible(root))
      visit_wanted(root);
    else
      price(root);
  }
  // From the leaves up: a node is covered when it, or visible descendants that cover it, can be drawn.
  std::vector<SelectState::Visit>& visits = state_.visits;
  for (size_t i = visits.size(); i-- > 0;) {
    const SelectState::Visit& v = visits[i];
    const bool by_children = !v.wanted && v.uncovered_children == 0;
    if (v.wanted && !resident(v.node)) ++out_.nodes_missing;
    if (!by_children && !resident(v.node) && v.parent != kNoVisit) ++visits[v.parent].uncovered_children;
  }
  // From the roots down: draw a node where its children do not cover it. `wanted` then marks what ends a path.
  for (size_t i = 0; i < visits.size(); ++i) {
    SelectState::Visit& v = visits[i];
    if (v.parent != kNoVisit && visits[v.parent].wanted) {
      v.wanted = true;  // an ancestor is drawn
      continue;
    }
    if (v.wanted || v.uncovered_children > 0) {
      out_.front.push_back(v.node);
      v.wanted = true;
    }
  }
}

// --- time slices --------------------------------------------------------------------------------------------------

void Selecting::update_hysteresis(NodeId id, double slice_ms, double needed_ms) {
  const TimeSliceOptions& time = options_.time;
  SelectState::Node& kept = state_.nodes[index_of(id)];
  const double urgency = (slice_ms - needed_ms) / std::max(needed_ms, 1e-9);
  // The paper does not say where a counter starts. Started at 0, everything resident would be refined until the
  // counters have fallen: start on the side of the first verdict.
  double hysteresis = kept.visited == 0 && urgency < 0 ? -time.hysteresis_switch : double(kept.hysteresis) + urgency;
  hysteresis = std::clamp(hysteresis, -time.hysteresis_limit, time.hysteresis_limit);
  kept.hysteresis = static_cast<float>(hysteresis);
  kept.visited = state_.frame;
}

/// Equation 4.1 for all visible siblings; the others are priced only.
void Selecting::price_siblings(std::span<const NodeId> ids, double share_ms, Siblings& siblings) {
  const TimeSliceOptions& time = options_.time;
  siblings.visible.clear();
  siblings.missing = siblings.visible_missing = 0;
  siblings.needed_ms = 0;
  siblings.cumulative_hysteresis = 0;
  double sum = 0;
  for (const NodeId id : ids) {
    const float priority = price(id);
    const bool is_missing = !resident(id);
    siblings.missing += is_missing ? 1 : 0;
    if (!visible(id)) continue;
    siblings.visible_missing += is_missing ? 1 : 0;
    siblings.visible.push_back({id, double(priority)});
    sum += double(priority);
  }
  const double ms_per_cost = state_.ms_per_cost > 0 ? state_.ms_per_cost : kFirstMsPerCost;
  for (Slice& slice : siblings.visible) {
    const double even = 1.0 / double(siblings.visible.size());
    slice.ms = share_ms * (sum > 0 ? slice.ms / sum : even);
    const double needed_ms = ms_per_cost * node_cost(node(slice.node), time);
    siblings.needed_ms += needed_ms;
    update_hysteresis(slice.node, slice.ms, needed_ms);
    siblings.cumulative_hysteresis += static_cast<int64_t>(
        std::trunc(double(state_.nodes[index_of(slice.node)].hysteresis) / time.hysteresis_switch));
  }
}

bool Selecting::time_allows(const Siblings& siblings, double share_ms) const {
  return options_.time.hysteresis ? siblings.cumulative_hysteresis >= 0 : share_ms > siblings.needed_ms;
}

void Selecting::by_time() {
  const bool bounded = options_.policy == Policy::time_slices;
  Siblings siblings;
  price_siblings(model_.tables.roots, state_.share_ms, siblings);
  std::vector<Slice> queue = siblings.visible;
  for (size_t i = 0; i < queue.size(); ++i) {
    const Slice at = queue[i];
    const NodeRecord& n = node(at.node);
    if (n.child_count == 0 || (bounded && fine_enough(n))) {
      out_.front.push_back(at.node);
      continue;
    }
    price_siblings(model_.children_of(at.node), at.ms, siblings);
    const uint32_t lacking = options_.time.all_children_resident ? siblings.missing : siblings.visible_missing;
    const bool allowed = time_allows(siblings, at.ms);
    if (allowed && lacking == 0) {
      // No child visible: the culling of the parent was the coarser of the two, and nothing is drawn.
      queue.insert(queue.end(), siblings.visible.begin(), siblings.visible.end());
      continue;
    }
    out_.front.push_back(at.node);
    if (allowed)
      out_.nodes_missing += lacking;
    else if (lacking == 0)
      ++out_.loaded_rejected;
  }
}

// --- both ---------------------------------------------------------------------------------------------------------

void Selecting::finish() {
  const TimeSliceOptions& time = options_.time;
  std::vector<std::pair<float, NodeId>> by_distance;
  by_distance.reserve(out_.front.size());
  for (const NodeId id : out_.front) {
    const NodeRecord& n = node(id);
    by_distance.emplace_back(n.box.distance(sight_.eye), id);
    out_.triangles += n.triangles;
    out_.cost += node_cost(n, time);
    if (n.level >= out_.nodes_by_level.size()) out_.nodes_by_level.resize(n.level + 1);
    ++out_.nodes_by_level[n.level];
    SelectState::Node& kept = state_.nodes[index_of(id)];
    if (kept.refined != 0 && kept.refined + 1 == state_.frame) ++out_.toggles_down;
    kept.drawn = state_.frame;
    for (NodeId up = n.parent; up != kNoNode; up = node(up).parent) {
      SelectState::Node& ancestor = state_.nodes[index_of(up)];
      if (ancestor.refined == state_.frame) break;
      if (ancestor.drawn != 0 && ancestor.drawn + 1 == state_.frame) ++out_.toggles_up;
      ancestor.refined = state_.frame;
    }
  }
  std::sort(by_distance.begin(), by_distance.end());
  for (size_t i = 0; i < by_distance.size(); ++i) out_.front[i] = by_distance[i].second;
  const double ms_per_cost = state_.ms_per_cost > 0 ? state_.ms_per_cost : kFirstMsPerCost;
  const double first = state_.first_ms_per_cost > 0 ? state_.first_ms_per_cost : kFirstMsPerCost;
  out_.estimated_ms = state_.overhead_ms + ms_per_cost * out_.cost;
  out_.estimated_without_feedback_ms = state_.overhead_ms + first * out_.cost;
}

struct PolicyName {
  Policy policy;
  std::string_view name;
};
constexpr std::array<PolicyName, 4> kPolicyNames = {{{Policy::none, "none"},
                                                     {Policy::static_error, "static"},
                                                     {Policy::time_slices, "time-slices"},
                                                     {Policy::lakhia, "lakhia"}}};

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

std::string_view policy_names() { return "none, static, time-slices, lakhia"; }

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
  if (options.policy == Policy::time_slices || options.policy == Policy::lakhia)
    selecting.by_time();
  else
    selecting.by_error();
  selecting.finish();
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
