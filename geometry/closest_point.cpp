#include "geometry/closest_point.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <glm/geometric.hpp>
#include <numeric>

#include "geometry/triangle_frame.h"

namespace promenade {

namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr size_t kBins = 16;
constexpr uint32_t kMaxUnbalancedDepth = 24;  // bounds the query's stack: deeper nodes are cut at the median
constexpr size_t kStackSize = 512;            // 7 left behind at each of at most 24 + log8(2^32) levels, and 8

float half_area(const Box& box) {
  const glm::vec3 s = box.size();
  return s.x * s.y + s.y * s.z + s.z * s.x;
}

/// Unit vector perpendicular to unit x.
glm::dvec3 any_perpendicular(const glm::dvec3& x) {
  const glm::dvec3 a = glm::abs(x);
  const glm::dvec3 axis = a.x <= a.y && a.x <= a.z ? glm::dvec3(1, 0, 0)
                          : a.y <= a.z             ? glm::dvec3(0, 1, 0)
                                                   : glm::dvec3(0, 0, 1);
  return glm::normalize(glm::cross(x, axis));
}

/// What the tree knows of a triangle while it is built.
struct Item {
  Box box;
  glm::vec3 center;
  uint32_t triangle;
};

struct Range {
  uint32_t begin, end;
  Box box;
  uint32_t size() const { return end - begin; }
};

}  // namespace

/// Cuts ranges of items by a binned surface-area heuristic along the longest axis of their centres.
struct ClosestPointTree::Builder {
  ClosestPointTree& tree;
  std::span<const glm::vec3> positions;
  std::span<const uint32_t> indices;
  std::vector<Item> items;

  Builder(ClosestPointTree& to, std::span<const glm::vec3> p, std::span<const uint32_t> i)
      : tree(to), positions(p), indices(i) {
    const auto count = static_cast<uint32_t>(indices.size() / 3);
    items.resize(count);
    for (uint32_t t = 0; t < count; ++t) {
      Box box;
      for (size_t c = 0; c < 3; ++c) box.add(positions[indices[size_t(t) * 3 + c]]);
      items[t] = {box, box.min + (box.max - box.min) * 0.5F, t};
      tree.bounds_.add(box);
    }
    tree.slot_of_triangle_.resize(count);
    tree.blocks_.reserve(count / 5 + 1);
    tree.nodes_.reserve(count / 32 + 1);
    if (count > 0) build_node({0, count, tree.bounds_}, 0);
  }

  Box box_of(uint32_t begin, uint32_t end) const {
    Box box;
    for (uint32_t i = begin; i < end; ++i) box.add(items[i].box);
    return box;
  }

  /// Middle of the range along `axis`; ties by triangle, so that the tree is the same with every library.
  uint32_t cut_at_median(const Range& range, int axis) {
    const uint32_t middle = range.begin + range.size() / 2;
    const auto first = items.begin();
    std::nth_element(first + range.begin, first + middle, first + range.end, [axis](const Item& a, const Item& b) {
      return a.center[axis] != b.center[axis] ? a.center[axis] < b.center[axis] : a.triangle < b.triangle;
    });
    return middle;
  }

  /// Two non-empty halves of a range of at least two.
  std::array<Range, 2> cut(const Range& range, bool balanced) {
    Box centers;
    for (uint32_t i = range.begin; i < range.end; ++i) centers.add(items[i].center);
    const int axis = centers.longest_axis();
    const float low = centers.min[axis];
    const float extent = centers.max[axis] - low;
    const float scale = float(kBins) * 0.9999F / extent;
    uint32_t middle = range.begin;
    if (!balanced && extent > 0 && std::isfinite(scale)) {
      const auto bin_of = [&](const Item& item) {
        return std::min(static_cast<size_t>((item.center[axis] - low) * scale), kBins - 1);
      };
      const size_t bin = best_bin(range, bin_of);
      const auto first = items.begin();
      middle = static_cast<uint32_t>(
          std::partition(first + range.begin, first + range.end, [&](const Item& item) { return bin_of(item) < bin; }) -
          first);
    }
    if (middle == range.begin || middle == range.end) middle = cut_at_median(range, axis);
    return {Range{range.begin, middle, box_of(range.begin, middle)},
            Range{middle, range.end, box_of(middle, range.end)}};
  }

  /// The first bin of the upper half that costs least.
  template <class BinOf>
  size_t best_bin(const Range& range, const BinOf& bin_of) const {
    std::array<Box, kBins> boxes;
    std::array<uint32_t, kBins> counts{};
    for (uint32_t i = range.begin; i < range.end; ++i) {
      const size_t bin = bin_of(items[i]);
      boxes[bin].add(items[i].box);
      ++counts[bin];
    }
    std::array<float, kBins> above{};
    Box box;
    uint32_t count = 0;
    for (size_t b = kBins; b-- > 1;) {
      if (counts[b] > 0) box.add(boxes[b]);
      count += counts[b];
      above[b] = count == 0 ? 0 : half_area(box) * float(count);
    }
    box = Box{};
    count = 0;
    size_t best = kBins / 2;
    float best_cost = kInfinity;
    for (size_t b = 1; b < kBins; ++b) {
      if (counts[b - 1] > 0) box.add(boxes[b - 1]);
      count += counts[b - 1];
      if (count == 0 || count == range.size()) continue;
      const float cost = half_area(box) * float(count) + above[b];
      if (cost < best_cost) best_cost = cost, best = b;
    }
    return best;
  }

  uint32_t build_node(const Range& range, uint32_t depth) {
    std::array<Range, kWidth> parts;
    size_t count = 1;
    parts[0] = range;
    while (count < kWidth) {
      size_t largest = 0;
      for (size_t i = 1; i < count; ++i)
        if (parts[i].size() > parts[largest].size()) largest = i;
      if (parts[largest].size() <= kLeafSize) break;
      const std::array<Range, 2> halves = cut(parts[largest], depth >= kMaxUnbalancedDepth);
      parts[largest] = halves[0];
      parts[count++] = halves[1];
    }
    const auto index = static_cast<uint32_t>(tree.nodes_.size());
    tree.nodes_.emplace_back();
    for (size_t i = 0; i < kWidth; ++i) {
      uint32_t child = 0;
      uint32_t blocks = 0;
      if (i < count && parts[i].size() <= kLeafSize) {
        child = kLeafBit | static_cast<uint32_t>(tree.blocks_.size());
        blocks = add_blocks(parts[i]);
      } else if (i < count) {
        child = build_node(parts[i], depth + 1);
      }
      Node& node = tree.nodes_[index];
      const Box box = i < count ? parts[i].box : Box{glm::vec3(kInfinity), glm::vec3(kInfinity)};
      node.min_x[i] = box.min.x, node.min_y[i] = box.min.y, node.min_z[i] = box.min.z;
      node.max_x[i] = box.max.x, node.max_y[i] = box.max.y, node.max_z[i] = box.max.z;
      node.child[i] = child;
      node.blocks[i] = blocks;
    }
    return index;
  }

  uint32_t add_blocks(const Range& range) {
    uint32_t blocks = 0;
    for (uint32_t begin = range.begin; begin < range.end; begin += kLanes, ++blocks) {
      tree.blocks_.emplace_back();
      Block& block = tree.blocks_.back();
      for (uint32_t lane = 0; lane < kLanes; ++lane) {
        const uint32_t item = std::min(begin + lane, range.end - 1);  // spare lanes repeat the last triangle
        set_lane(block, lane, items[item].triangle);
        if (begin + lane < range.end)
          tree.slot_of_triangle_[items[item].triangle] =
              static_cast<uint32_t>((tree.blocks_.size() - 1) * kLanes + lane);
      }
    }
    return blocks;
  }

  void set_lane(Block& block, size_t lane, uint32_t triangle) const {
    std::array<glm::dvec3, 3> p;
    for (size_t c = 0; c < 3; ++c) p[c] = glm::dvec3(positions[indices[size_t(triangle) * 3 + c]]);
    const std::array<double, 3> edge2 = {glm::dot(p[1] - p[0], p[1] - p[0]), glm::dot(p[2] - p[1], p[2] - p[1]),
                                         glm::dot(p[0] - p[2], p[0] - p[2])};
    const size_t turn = edge2[0] >= edge2[1] && edge2[0] >= edge2[2] ? 0 : edge2[1] >= edge2[2] ? 1 : 2;
    const glm::dvec3 origin = p[turn];
    const glm::dvec3 base = p[(turn + 1) % 3] - origin;
    const glm::dvec3 apex = p[(turn + 2) % 3] - origin;
    const double length = std::sqrt(edge2[turn]);
    const glm::dvec3 x = length > 0 ? base / length : glm::dvec3(1, 0, 0);
    const double apex_x = glm::dot(apex, x);
    const glm::dvec3 across = apex - apex_x * x;
    const double apex_y = glm::length(across);
    // Below this the double subtraction above leaves noise: a triangle that flat is a segment.
    const bool flat = apex_y <= 1e-12 * length;
    const glm::dvec3 y = flat ? any_perpendicular(x) : across / apex_y;
    const glm::dvec3 z = glm::cross(x, y);
    block.origin_x[lane] = float(origin.x), block.origin_y[lane] = float(origin.y);
    block.origin_z[lane] = float(origin.z);
    block.x_x[lane] = float(x.x), block.x_y[lane] = float(x.y), block.x_z[lane] = float(x.z);
    block.y_x[lane] = float(y.x), block.y_y[lane] = float(y.y), block.y_z[lane] = float(y.z);
    block.z_x[lane] = float(z.x), block.z_y[lane] = float(z.y), block.z_z[lane] = float(z.z);
    block.base[lane] = float(length);
    block.apex_x[lane] = float(apex_x);
    block.apex_y[lane] = flat ? 0 : float(apex_y);
    const auto inverse = [](double squared) {
      const auto value = static_cast<float>(1 / squared);
      return std::isfinite(value) ? value : 0.0F;
    };
    block.inverse_left2[lane] = inverse(edge2[(turn + 2) % 3]);
    block.inverse_right2[lane] = inverse(edge2[(turn + 1) % 3]);
    block.triangle[lane] = triangle;
    block.turn[lane] = static_cast<uint32_t>(turn);
  }
};

ClosestPointTree::ClosestPointTree(std::span<const glm::vec3> positions, std::span<const uint32_t> indices) {
  Builder(*this, positions, indices);
}

namespace {

bool is_visible(const ClosestPointTree::Limits& limits, uint32_t triangle) {
  return limits.group_hidden == nullptr || limits.group_hidden[limits.group_of_triangle[triangle]] == 0;
}

}  // namespace

struct ClosestPointTree::Query {
  Lanes x, y, z;
  explicit Query(const glm::vec3& p) : x(_mm_set1_ps(p.x)), y(_mm_set1_ps(p.y)), z(_mm_set1_ps(p.z)) {}

  /// Squared distances to triangles `first` to `first + 3` of a block.
  Lanes to_triangles(const Block& b, size_t first) const {
    const auto at = [first](const float(&values)[kLanes]) { return _mm_load_ps(values + first); };
    const Lanes dx = x - at(b.origin_x), dy = y - at(b.origin_y), dz = z - at(b.origin_z);
    return distance2_in_frame(dx * at(b.x_x) + dy * at(b.x_y) + dz * at(b.x_z),
                              dx * at(b.y_x) + dy * at(b.y_y) + dz * at(b.y_z),
                              dx * at(b.z_x) + dy * at(b.z_y) + dz * at(b.z_z), at(b.base), at(b.apex_x), at(b.apex_y),
                              at(b.inverse_left2), at(b.inverse_right2));
  }

  /// Squared distances to boxes `first` to `first + 3` of a node.
  Lanes to_boxes(const Node& n, size_t first) const {
    const auto outside = [first](Lanes p, const float(&low)[kWidth], const float(&high)[kWidth]) {
      const Lanes d = upper(_mm_load_ps(low + first) - p, p - _mm_load_ps(high + first));
      return upper(d, _mm_setzero_ps());
    };
    const Lanes dx = outside(x, n.min_x, n.max_x), dy = outside(y, n.min_y, n.max_y), dz = outside(z, n.min_z, n.max_z);
    return dx * dx + dy * dy + dz * dz;
  }
};

void ClosestPointTree::search_leaf(uint32_t first, uint32_t blocks, const Query& query, const Limits& limits,
                                   Nearest& best) const {
  for (uint32_t b = first; b < first + blocks; ++b) {
    const Lanes low = query.to_triangles(blocks_[b], 0);
    const Lanes high = query.to_triangles(blocks_[b], 4);
    const Lanes limit = _mm_set1_ps(best.distance2_m2);
    if (_mm_movemask_ps(_mm_cmplt_ps(lower(low, high), limit)) == 0) continue;
    alignas(16) float d2[kLanes];
    _mm_store_ps(d2, low);
    _mm_store_ps(d2 + 4, high);
    for (size_t i = 0; i < kLanes; ++i)
      if (d2[i] < best.distance2_m2 && is_visible(limits, blocks_[b].triangle[i]))
        best = {d2[i], blocks_[b].triangle[i]};
  }
}

ClosestPointTree::Nearest ClosestPointTree::nearest(const glm::vec3& p, const Limits& limits) const {
  Nearest best{limits.max_distance2_m2, kNoTriangle};
  if (nodes_.empty()) return best;
  if (limits.hint < slot_of_triangle_.size() && is_visible(limits, limits.hint)) {
    const float d2 = distance2_to(limits.hint, p);
    if (d2 < best.distance2_m2) best = {d2, limits.hint};
  }
  const Query query(p);
  struct Entry {
    float distance2;
    uint32_t child;
    uint32_t blocks;
  };
  std::array<Entry, kStackSize> stack;  // NOLINT(cppcoreguidelines-pro-type-member-init): only what is pushed is read
  size_t top = 0;
  stack[top++] = {0, 0, 0};
  while (top > 0) {
    const Entry entry = stack[--top];
    if (entry.distance2 >= best.distance2_m2) continue;
    if (best.distance2_m2 <= limits.enough_distance2_m2 && best.triangle != kNoTriangle) break;
    if ((entry.child & kLeafBit) != 0) {
      search_leaf(entry.child & ~kLeafBit, entry.blocks, query, limits, best);
      continue;
    }
    const Node& node = nodes_[entry.child];
    alignas(16) float d2[kWidth];
    const Lanes limit = _mm_set1_ps(best.distance2_m2);
    const Lanes low = query.to_boxes(node, 0);
    const Lanes high = query.to_boxes(node, 4);
    _mm_store_ps(d2, low);
    _mm_store_ps(d2 + 4, high);
    auto nearer = static_cast<unsigned>(_mm_movemask_ps(_mm_cmplt_ps(low, limit)) |
                                        (_mm_movemask_ps(_mm_cmplt_ps(high, limit)) << 4));
    const size_t base = top;
    for (; nearer != 0; nearer &= nearer - 1) {
      const auto i = static_cast<size_t>(std::countr_zero(nearer));
      size_t at = top++;
      for (; at > base && stack[at - 1].distance2 < d2[i]; --at) stack[at] = stack[at - 1];  // nearest on top
      stack[at] = {d2[i], node.child[i], node.blocks[i]};
    }
  }
  return best;
}

float ClosestPointTree::distance2_to(uint32_t triangle, const glm::vec3& p) const {
  const uint32_t slot = slot_of_triangle_[triangle];
  alignas(16) float d2[4];
  _mm_store_ps(d2, Query(p).to_triangles(blocks_[slot / kLanes], slot % kLanes / 4 * 4));
  return d2[slot % 4];
}

ClosestPoint ClosestPointTree::closest_on(uint32_t triangle, const glm::vec3& p) const {
  const uint32_t slot = slot_of_triangle_[triangle];
  const Block& block = blocks_[slot / kLanes];
  const size_t i = slot % kLanes;
  const glm::vec3 origin(block.origin_x[i], block.origin_y[i], block.origin_z[i]);
  const glm::vec3 x_axis(block.x_x[i], block.x_y[i], block.x_z[i]);
  const glm::vec3 y_axis(block.y_x[i], block.y_y[i], block.y_z[i]);
  const glm::vec2 q(glm::dot(p - origin, x_axis), glm::dot(p - origin, y_axis));
  const glm::vec2 corner[3] = {{0, 0}, {block.base[i], 0}, {block.apex_x[i], block.apex_y[i]}};
  glm::vec3 weights(0);  // of origin, base, apex
  const float doubled_area = block.base[i] * block.apex_y[i];
  if (doubled_area > 0) {
    weights.z = q.y / block.apex_y[i];
    weights.y = (q.x - weights.z * block.apex_x[i]) / block.base[i];
    weights.x = 1 - weights.y - weights.z;
  }
  if (!(doubled_area > 0) || weights.x < 0 || weights.y < 0 || weights.z < 0) {
    float least = kInfinity;
    for (int e = 0; e < 3; ++e) {
      const glm::vec2 from = corner[e], along = corner[(e + 1) % 3] - from;
      const float length2 = glm::dot(along, along);
      const float t = length2 > 0 ? glm::clamp(glm::dot(q - from, along) / length2, 0.0F, 1.0F) : 0;
      const glm::vec2 off = q - from - t * along;
      if (const float d2 = glm::dot(off, off); d2 < least) {
        least = d2;
        weights = glm::vec3(0);
        weights[e] = 1 - t, weights[(e + 1) % 3] = t;
      }
    }
  }
  ClosestPoint result;
  result.distance2_m2 = distance2_to(triangle, p);
  result.triangle = triangle;
  const glm::vec2 at = weights.x * corner[0] + weights.y * corner[1] + weights.z * corner[2];
  result.point = origin + at.x * x_axis + at.y * y_axis;
  const auto turn = static_cast<int>(block.turn[i]);
  for (int c = 0; c < 3; ++c) result.barycentric[(turn + c) % 3] = weights[c];
  return result;
}

ClosestPoint ClosestPointTree::closest(const glm::vec3& p, const Limits& limits) const {
  const Nearest found = nearest(p, limits);
  if (found.triangle == kNoTriangle) {
    ClosestPoint none;
    none.distance2_m2 = found.distance2_m2;
    return none;
  }
  ClosestPoint result = closest_on(found.triangle, p);
  result.distance2_m2 = found.distance2_m2;
  return result;
}

}  // namespace promenade
