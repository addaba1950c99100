#include "runtime/eye_culler.h"

#include <algorithm>
#include <cmath>

namespace promenade {
namespace {

constexpr size_t kMostRegions = 512;  // of a node: one that reaches into more is always seen
constexpr double kHair = 1e-9;        // beyond rounding, as a part of a side
constexpr uint32_t kNoParent = 0xffffffffU;

/// Slopes from the eye to x within [low, high] at distances within [near, far] ahead of it, 0 <= near <= far, far > 0.
void slopes(double low, double high, double near, double far, double& least, double& most) {
  least = low >= 0 ? low / far : near > 0 ? low / near : -2;
  most = high <= 0 ? high / far : near > 0 ? high / near : 2;
}

}  // namespace

EyeCuller::EyeCuller(const Model& model, const Openings& openings) : model_(model), openings_(openings) {
  const CellTables& space = openings.regions;
  parent_.assign(space.tree.size(), kNoParent);
  leaf_.resize(space.cells.size());
  for (uint32_t i = 0; i < space.tree.size(); ++i) {
    const CellTreeNode& node = space.tree[i];
    if (node.axis == CellTreeNode::kLeaf)
      leaf_[node.below] = i;
    else
      parent_[node.below] = parent_[node.above] = i;
  }
  waiting_.assign(space.tree.size(), 0);
  arrived_.resize(space.cells.size());
  counted_.assign(space.cells.size(), 0);
  list_regions_of_nodes();
}

void EyeCuller::list_regions_of_nodes() {
  const CellTables& space = openings_.regions;
  const std::vector<NodeRecord>& nodes = model_.tables.nodes;
  first_of_node_.reserve(nodes.size() + 1);
  std::vector<uint32_t> open;
  for (uint32_t i = 0; i < nodes.size(); ++i) {
    const size_t first = node_regions_.size();
    first_of_node_.push_back(static_cast<uint32_t>(first));
    const Box box = nodes[i].box.grown(kOpeningSlackM);
    if (model_.is_moving(NodeId{i}) || !space.box.contains(box)) continue;
    open.assign(1, 0);
    while (!open.empty() && node_regions_.size() - first <= kMostRegions) {
      const CellTreeNode& at = space.tree[open.back()];
      open.pop_back();
      const int axis = static_cast<int>(at.axis);
      if (at.axis == CellTreeNode::kLeaf) {
        node_regions_.push_back(at.below);
        continue;
      }
      if (box.min[axis] <= at.split_m) open.push_back(at.below);
      if (box.max[axis] >= at.split_m) open.push_back(at.above);
    }
    if (node_regions_.size() - first > kMostRegions) node_regions_.resize(first);
  }
  first_of_node_.push_back(static_cast<uint32_t>(node_regions_.size()));
}

uint64_t EyeCuller::byte_size() const {
  return (parent_.capacity() + leaf_.capacity() + waiting_.capacity() + touched_.capacity() + start_.capacity() +
          open_.capacity() + counted_.capacity() + node_regions_.capacity() + first_of_node_.capacity() +
          seen_.capacity()) *
             sizeof(uint32_t) +
         arrived_.capacity() * sizeof(Arrived) + is_seen_.capacity();
}

/// The box's directions on the side in work; false: it has none there. box: from the eye.
bool EyeCuller::project(const DBox& box, Rectangle& into) const {
  const int u = (axis_ + 1) % 3, v = (axis_ + 2) % 3;
  double near = box.min[axis_] * sign_, far = box.max[axis_] * sign_;
  if (near > far) std::swap(near, far);
  if (far <= 0) return false;
  near = std::max(near, 0.0);
  slopes(box.min[u], box.max[u], near, far, into.low_u, into.high_u);
  slopes(box.min[v], box.max[v], near, far, into.low_v, into.high_v);
  into.low_u = std::max(into.low_u - kHair, -1.0), into.high_u = std::min(into.high_u + kHair, 1.0);
  into.low_v = std::max(into.low_v - kHair, -1.0), into.high_v = std::min(into.high_v + kHair, 1.0);
  return into.low_u <= into.high_u && into.low_v <= into.high_v;
}

/// By how much what is drawn of the walls in a face may be off: a node of the front is within the bound from everywhere
/// in the cell, the eye too, and some of it is in the face.
double EyeCuller::growth_m(const Box& face) const {
  const FrontBound& bound = openings_.regions.bound;
  const glm::dvec3 farthest = glm::max(glm::abs(glm::dvec3(face.min) - eye_), glm::abs(glm::dvec3(face.max) - eye_));
  return bound.pixel_error * glm::length(farthest) / bound.scale.focal_px;
}

void EyeCuller::arrive(uint32_t region, const Rectangle& rectangle) {
  Arrived& into = arrived_[region];
  if (into.count == 0) {
    touched_.push_back(region);
    for (uint32_t at = leaf_[region]; at != kNoParent; at = parent_[at]) ++waiting_[at];
  }
  const auto united = [](const Rectangle& a, const Rectangle& b) {
    return Rectangle{std::min(a.low_u, b.low_u), std::max(a.high_u, b.high_u), std::min(a.low_v, b.low_v),
                     std::max(a.high_v, b.high_v)};
  };
  const auto area = [](const Rectangle& r) { return (r.high_u - r.low_u) * (r.high_v - r.low_v); };
  if (into.count < Arrived::kMost) {
    into.parts[into.count++] = rectangle;
    return;
  }
  uint32_t best = 0;
  for (uint32_t i = 1; i < into.count; ++i)
    if (area(united(into.parts[i], rectangle)) - area(into.parts[i]) <
        area(united(into.parts[best], rectangle)) - area(into.parts[best]))
      best = i;
  into.parts[best] = united(into.parts[best], rectangle);
}

/// Through what is open of a region's faces, away from the eye.
void EyeCuller::leave(uint32_t region) {
  const CellTables& space = openings_.regions;
  const Arrived from = arrived_[region];
  for (const uint32_t number : space.faces_of(CellId{region})) {
    const CellFace& face = space.faces[number];
    const bool up = index_of(face.below) == region;
    const int axis = static_cast<int>(face.axis);
    const double at = double(space.cells[index_of(face.above)].box.min[axis]);
    if (up ? at <= eye_[axis] : at > eye_[axis]) continue;
    const std::span<const Box> open = openings_.of(number, up);
    if (open.empty()) continue;
    const double growth = growth_m(rectangle_of(space, face));
    for (const Box& box : open) {
      Rectangle seen;
      if (!project({glm::dvec3(box.min) - eye_ - growth, glm::dvec3(box.max) - eye_ + growth}, seen)) continue;
      for (uint32_t i = 0; i < from.count; ++i) {
        const Rectangle& part = from.parts[i];
        if (!part.meets(seen)) continue;
        arrive(index_of(face.other(CellId{region})),
               {std::max(part.low_u, seen.low_u), std::min(part.high_u, seen.high_u), std::max(part.low_v, seen.low_v),
                std::min(part.high_v, seen.high_v)});
      }
    }
  }
}

/// Front to back: what is on the eye's side of a plane cannot be reached from behind it.
void EyeCuller::pass() {
  open_.assign(1, 0);
  while (!open_.empty()) {
    const uint32_t at = open_.back();
    open_.pop_back();
    if (waiting_[at] == 0) continue;  // nothing in it is reached, nor will be: all that lead there have had their turn
    const CellTreeNode& node = openings_.regions.tree[at];
    if (node.axis == CellTreeNode::kLeaf) {
      leave(node.below);
      continue;
    }
    const bool above = eye_[static_cast<int>(node.axis)] >= double(node.split_m);
    open_.push_back(above ? node.below : node.above);
    open_.push_back(above ? node.above : node.below);
  }
}

void EyeCuller::look(int axis, double sign) {
  axis_ = axis, sign_ = sign;
  for (const uint32_t region : start_) arrive(region, {});
  pass();
}

bool EyeCuller::reaches(NodeId node) const {
  const NodeRecord& record = model_.tables.nodes[index_of(node)];
  const Box grown = record.box.grown(kOpeningSlackM);
  for (uint32_t i = first_of_node_[index_of(node)]; i < first_of_node_[index_of(node) + 1]; ++i) {
    const uint32_t region = node_regions_[i];
    const Arrived& arrived = arrived_[region];
    if (arrived.count == 0) continue;
    const Box room = openings_.regions.cells[region].box.grown(kOpeningSlackM);
    Rectangle there;
    if (!project({glm::dvec3(glm::max(grown.min, room.min)) - eye_, glm::dvec3(glm::min(grown.max, room.max)) - eye_},
                 there))
      continue;
    for (uint32_t k = 0; k < arrived.count; ++k)
      if (arrived.parts[k].meets(there)) return true;
  }
  return false;
}

/// The regions that the eye is in, or as good as in.
void EyeCuller::find_start() {
  const CellTables& space = openings_.regions;
  const Box around = Box{glm::vec3(eye_), glm::vec3(eye_)}.grown(kOpeningSlackM);
  start_.clear();
  if (!space.box.contains(around)) return;
  open_.assign(1, 0);
  while (!open_.empty()) {
    const CellTreeNode& at = space.tree[open_.back()];
    open_.pop_back();
    const int axis = static_cast<int>(at.axis);
    if (at.axis == CellTreeNode::kLeaf) {
      start_.push_back(at.below);
      continue;
    }
    if (around.min[axis] <= at.split_m) open_.push_back(at.below);
    if (around.max[axis] >= at.split_m) open_.push_back(at.above);
  }
}

void EyeCuller::forget_side() {
  for (const uint32_t region : touched_) {
    reached_ += counted_[region] != call_ ? 1U : 0U;
    counted_[region] = call_;
    for (uint32_t at = leaf_[region]; at != kNoParent && waiting_[at] != 0; at = parent_[at]) waiting_[at] = 0;
    arrived_[region].count = 0;
  }
  touched_.clear();
}

std::span<const NodeId> EyeCuller::seen(const glm::dvec3& eye, std::span<const NodeId> nodes) {
  eye_ = eye;
  reached_ = 0;
  ++call_;
  find_start();
  seen_.assign(nodes.begin(), nodes.end());
  if (start_.empty()) return seen_;
  is_seen_.resize(nodes.size());
  const auto is_free = [&](NodeId id) { return first_of_node_[index_of(id)] == first_of_node_[index_of(id) + 1]; };
  for (size_t i = 0; i < nodes.size(); ++i) is_seen_[i] = is_free(nodes[i]) ? 1 : 0;
  for (int axis = 0; axis < 3; ++axis)
    for (const double sign : {-1.0, 1.0}) {
      look(axis, sign);
      for (size_t i = 0; i < nodes.size(); ++i)
        if (is_seen_[i] == 0 && reaches(nodes[i])) is_seen_[i] = 1;
      forget_side();
    }
  size_t kept = 0;
  for (size_t i = 0; i < nodes.size(); ++i)
    if (is_seen_[i] != 0) seen_[kept++] = nodes[i];
  seen_.resize(kept);
  return seen_;
}

}  // namespace promenade
