#include "geometry/closest_point.h"

#include <smmintrin.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <glm/geometric.hpp>
#include <numeric>
#include <utility>

namespace promenade {

namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr size_t kBins = 16;
constexpr uint32_t kCurveCells = 1024;  // along each axis
constexpr uint32_t kMostTogether = 8;   // triangles an item
constexpr size_t kWidth = kLanes;       // boxes a node
constexpr uint32_t kLeafBit = BoxTreeNode::kLeafBit;
constexpr uint32_t kMaxUnbalancedDepth = 24;  // bounds the query's stack: deeper nodes are cut at the median

/// Unit vector perpendicular to unit x.
glm::dvec3 any_perpendicular(const glm::dvec3& x) {
  const glm::dvec3 a = glm::abs(x);
  const glm::dvec3 axis = a.x <= a.y && a.x <= a.z ? glm::dvec3(1, 0, 0)
                          : a.y <= a.z             ? glm::dvec3(0, 1, 0)
                                                   : glm::dvec3(0, 0, 1);
  return glm::normalize(glm::cross(x, axis));
}

/// A box in two registers; the fourth lanes mean nothing.
struct WideBox {
  __m128 min = _mm_set1_ps(kInfinity);
  __m128 max = _mm_set1_ps(-kInfinity);
  void add(const WideBox& other) { min = _mm_min_ps(min, other.min), max = _mm_max_ps(max, other.max); }
  Box box() const {
    alignas(16) float low[4], high[4];
    _mm_store_ps(low, min), _mm_store_ps(high, max);
    return {{low[0], low[1], low[2]}, {high[0], high[1], high[2]}};
  }
};

/// Where the register lies in memory it is read from there.
float along(const __m128& v, int axis) {
  float value = 0;
  std::memcpy(&value, reinterpret_cast<const char*>(&v) + sizeof(float) * static_cast<size_t>(axis), sizeof value);
  return value;
}

uint32_t fourth_lane(const __m128& v) { return static_cast<uint32_t>(_mm_extract_epi32(_mm_castps_si128(v), 3)); }
__m128 with_fourth_lane(const __m128& v, uint32_t value) {
  return _mm_castsi128_ps(_mm_insert_epi32(_mm_castps_si128(v), static_cast<int>(value), 3));
}

/// A few triangles beside each other, as the tree knows them while it is built.
struct Item {
  WideBox box;  // with the number of the first of them in the first fourth lane, how many they are in the second
  uint32_t first() const { return fourth_lane(box.min); }
  uint32_t count() const { return fourth_lane(box.max); }
  __m128 doubled_center() const { return _mm_add_ps(box.min, box.max); }
  float doubled_center(int axis) const { return along(box.min, axis) + along(box.max, axis); }
};

struct Range {
  uint32_t begin, end;  // of items
  uint32_t triangles;
  WideBox box;
};

/// Bits of a number of ten, each third one of the result.
uint32_t spread(uint32_t v) {
  v = (v | v << 16U) & 0x030000ffU;
  v = (v | v << 8U) & 0x0300f00fU;
  v = (v | v << 4U) & 0x030c30c3U;
  return (v | v << 2U) & 0x09249249U;
}

}  // namespace

/// Triangles in the order of a curve that fills space make items of a few; ranges of these are cut by a binned
/// surface-area heuristic along the longest axis of their centres.
struct ClosestPointTree::Builder {
  ClosestPointTree& tree;
  std::span<const glm::vec3> positions;
  std::span<const uint32_t> indices;
  std::vector<uint64_t> order;  // of triangles: place on the curve, number
  std::vector<Item> items;
  std::vector<Item> upper_items;  // scratch
  std::vector<uint8_t> bins;      // of items, in the cut at hand

  Builder(ClosestPointTree& to, std::span<const glm::vec3> p, std::span<const uint32_t> i)
      : tree(to), positions(p), indices(i) {
    const auto count = static_cast<uint32_t>(indices.size() / 3);
    if (count == 0) return;
    std::vector<WideBox> boxes(count);
    WideBox all, centers;
    for (uint32_t t = 0; t < count; ++t) {
      WideBox& box = boxes[t];
      for (size_t c = 0; c < 3; ++c) {
        const glm::vec3& corner = positions[indices[size_t(t) * 3 + c]];
        const __m128 at = _mm_setr_ps(corner.x, corner.y, corner.z, 0);
        box.add({at, at});
      }
      all.add(box);
      const __m128 center = _mm_add_ps(box.min, box.max);
      centers.add({center, center});
    }
    tree.bounds_ = all.box();
    order_triangles(boxes, centers);
    make_items(boxes);
    upper_items.resize(items.size()), bins.resize(items.size());
    tree.slot_of_triangle_.resize(count);
    tree.blocks_.reserve(count / 5 + 1);
    tree.nodes_.reserve(count / 32 + 1);
    build_node({0, static_cast<uint32_t>(items.size()), count, all}, 0);
  }

  void order_triangles(const std::vector<WideBox>& boxes, const WideBox& centers) {
    const Box box = centers.box();
    const float extent = box.size()[box.longest_axis()];
    const float scale = extent > 0 ? float(kCurveCells) * 0.9999F / extent : 0;
    const __m128 scales = _mm_set1_ps(std::isfinite(scale) ? scale : 0);
    order.resize(boxes.size());
    for (uint32_t t = 0; t < boxes.size(); ++t) {
      const __m128 at = _mm_mul_ps(_mm_sub_ps(_mm_add_ps(boxes[t].min, boxes[t].max), centers.min), scales);
      alignas(16) std::array<uint32_t, 4> cell;
      _mm_store_si128(reinterpret_cast<__m128i*>(cell.data()), _mm_cvttps_epi32(at));
      for (uint32_t axis = 0; axis < 3; ++axis) cell[axis] = std::min(cell[axis], kCurveCells - 1);
      order[t] = uint64_t(spread(cell[0]) | spread(cell[1]) << 1U | spread(cell[2]) << 2U) << 32U | t;
    }
    // By digits of ten bits, the last first.
    std::vector<uint64_t> sorted(order.size());
    std::array<std::array<uint32_t, kCurveCells>, 3> begin{};
    for (const uint64_t key : order)
      for (uint32_t digit = 0; digit < 3; ++digit) ++begin[digit][key >> (32 + 10 * digit) & (kCurveCells - 1)];
    for (uint32_t digit = 0; digit < 3; ++digit) {
      uint32_t sum = 0;
      for (uint32_t& its : begin[digit]) sum += std::exchange(its, sum);
      for (const uint64_t key : order) sorted[begin[digit][key >> (32 + 10 * digit) & (kCurveCells - 1)]++] = key;
      order.swap(sorted);
    }
  }

  /// Halves the curve where it leaves cells, the largest first, down to pieces of kMostTogether.
  void make_items(const std::vector<WideBox>& boxes) {
    items.reserve(order.size() / 2 + 1);
    std::vector<std::array<uint32_t, 2>> stack = {{0, static_cast<uint32_t>(order.size())}};
    while (!stack.empty()) {
      const auto [begin, end] = stack.back();
      stack.pop_back();
      if (end - begin > kMostTogether) {
        const uint64_t first = order[begin] >> 32U, last = order[end - 1] >> 32U;
        uint32_t middle = begin + (end - begin) / 2;
        if (first != last) {
          const uint64_t bit = std::bit_floor(first ^ last);
          const uint64_t above = (last & ~(bit - 1)) << 32U;
          middle = static_cast<uint32_t>(std::lower_bound(order.begin() + begin, order.begin() + end, above) -
                                         order.begin());
        }
        stack.push_back({middle, end}), stack.push_back({begin, middle});
        continue;
      }
      WideBox box;
      for (uint32_t i = begin; i < end; ++i) box.add(boxes[static_cast<uint32_t>(order[i])]);
      items.push_back({{with_fourth_lane(box.min, begin), with_fourth_lane(box.max, end - begin)}});
    }
  }

  Range range_of(uint32_t begin, uint32_t end) const {
    Range range{begin, end, 0, {}};
    for (uint32_t i = begin; i < end; ++i) range.box.add(items[i].box), range.triangles += items[i].count();
    return range;
  }

  /// Two halves of a range along `axis`; ties by place on the curve, so that the tree is the same with every library.
  std::array<Range, 2> cut_at_median(const Range& range, int axis) {
    const uint32_t middle = range.begin + (range.end - range.begin) / 2;
    const auto first = items.begin();
    std::nth_element(first + range.begin, first + middle, first + range.end, [axis](const Item& a, const Item& b) {
      const float a_at = a.doubled_center(axis), b_at = b.doubled_center(axis);
      return a_at != b_at ? a_at < b_at : a.first() < b.first();
    });
    return {range_of(range.begin, middle), range_of(middle, range.end)};
  }

  /// Two non-empty halves of a range of at least two.
  std::array<Range, 2> cut(const Range& range, bool balanced) {
    WideBox centers;
    for (uint32_t i = range.begin; i < range.end; ++i)
      centers.add({items[i].doubled_center(), items[i].doubled_center()});
    const Box box = centers.box();
    const int axis = box.longest_axis();
    const float low = box.min[axis];
    const float extent = box.max[axis] - low;
    const float scale = float(kBins) * 0.9999F / extent;
    if (balanced || !(extent > 0) || !std::isfinite(scale)) return cut_at_median(range, axis);
    for (uint32_t i = range.begin; i < range.end; ++i) {
      const float value = items[i].doubled_center(axis);
      bins[i] = static_cast<uint8_t>(std::min(static_cast<uint32_t>((value - low) * scale), uint32_t(kBins - 1)));
    }
    std::array<Range, 2> halves;
    const uint32_t bin = best_bin(range, halves);
    uint32_t middle = range.begin, above = 0;
    for (uint32_t i = range.begin; i < range.end; ++i) {  // without branches: nothing could foresee them
      const Item item = items[i];
      const uint32_t is_below = bins[i] < bin ? 1 : 0;
      items[middle] = item, upper_items[above] = item;
      middle += is_below, above += 1 - is_below;
    }
    std::copy_n(upper_items.begin(), above, items.begin() + middle);
    if (middle == range.begin || middle == range.end) return cut_at_median(range, axis);
    halves[0].begin = range.begin, halves[0].end = halves[1].begin = middle, halves[1].end = range.end;
    return halves;
  }

  static float half_area(const WideBox& box) {
    const __m128 s = _mm_sub_ps(box.max, box.min);                                        // x y z
    const __m128 product = _mm_mul_ps(s, _mm_shuffle_ps(s, s, _MM_SHUFFLE(3, 0, 2, 1)));  // xy yz zx
    alignas(16) float p[4];
    _mm_store_ps(p, product);
    return p[0] + p[1] + p[2];
  }

  /// The first bin of the upper half that costs least, and the halves' boxes.
  uint32_t best_bin(const Range& range, std::array<Range, 2>& halves) const {
    std::array<WideBox, kBins> boxes;
    std::array<uint32_t, kBins> counts{};
    for (uint32_t i = range.begin; i < range.end; ++i) {
      const uint32_t bin = bins[i];
      boxes[bin].add(items[i].box);
      counts[bin] += items[i].count();
    }
    std::array<WideBox, kBins> above;  // of this bin and those above
    std::array<uint32_t, kBins> counts_above{};
    WideBox box;
    uint32_t count = 0;
    for (size_t b = kBins; b-- > 1;) {
      box.add(boxes[b]);
      count += counts[b];
      above[b] = box, counts_above[b] = count;
    }
    box = WideBox{};
    count = 0;
    uint32_t best = kBins / 2;
    float best_cost = kInfinity;
    for (uint32_t b = 1; b < kBins; ++b) {
      box.add(boxes[b - 1]);
      count += counts[b - 1];
      if (counts[b - 1] == 0 || count == 0 || counts_above[b] == 0) continue;  // the same as before, or all on one side
      const float cost = half_area(box) * float(count) + half_area(above[b]) * float(counts_above[b]);
      if (cost < best_cost) {
        best_cost = cost, best = b;
        halves[0].box = box, halves[0].triangles = count;
        halves[1].box = above[b], halves[1].triangles = counts_above[b];
      }
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
        if (parts[i].triangles > parts[largest].triangles) largest = i;
      if (parts[largest].triangles <= kLeafSize) break;
      const std::array<Range, 2> halves = cut(parts[largest], depth >= kMaxUnbalancedDepth);
      parts[largest] = halves[0];
      parts[count++] = halves[1];
    }
    const auto index = static_cast<uint32_t>(tree.nodes_.size());
    tree.nodes_.emplace_back();
    for (size_t i = 0; i < kWidth; ++i) {
      uint32_t child = 0;
      uint32_t blocks = 0;
      if (i < count && parts[i].triangles <= kLeafSize) {
        child = kLeafBit | static_cast<uint32_t>(tree.blocks_.size());
        blocks = add_blocks(parts[i]);
      } else if (i < count) {
        child = build_node(parts[i], depth + 1);
      }
      BoxTreeNode& node = tree.nodes_[index];
      const Box box = i < count ? parts[i].box.box() : Box{glm::vec3(kInfinity), glm::vec3(kInfinity)};
      node.min_x[i] = box.min.x, node.min_y[i] = box.min.y, node.min_z[i] = box.min.z;
      node.max_x[i] = box.max.x, node.max_y[i] = box.max.y, node.max_z[i] = box.max.z;
      node.child[i] = child;
      node.blocks[i] = blocks;
    }
    return index;
  }

  uint32_t add_blocks(const Range& range) {
    uint32_t count = 0;
    for (uint32_t i = range.begin; i < range.end; ++i) {
      const uint32_t first = items[i].first();
      for (uint32_t at = first; at < first + items[i].count(); ++at, ++count) {
        const auto lane = static_cast<uint32_t>(count % kLanes);
        if (lane == 0) tree.blocks_.emplace_back();
        const auto triangle = static_cast<uint32_t>(order[at]);
        set_lane(tree.blocks_.back(), lane, triangle);
        tree.slot_of_triangle_[triangle] = static_cast<uint32_t>((tree.blocks_.size() - 1) * kLanes + lane);
      }
    }
    repeat_lane(tree.blocks_.back(), (count - 1) % kLanes);
    return static_cast<uint32_t>((count + kLanes - 1) / kLanes);
  }

  /// In all lanes after it.
  static void repeat_lane(TriangleBlock& block, size_t lane) {
    static_assert(sizeof(TriangleBlock) % (kLanes * sizeof(uint32_t)) == 0);
    using Row = std::array<uint32_t, kLanes>;
    std::array<Row, sizeof(TriangleBlock) / sizeof(Row)> rows;
    std::memcpy(rows.data(), &block, sizeof block);
    for (Row& row : rows) std::fill(row.begin() + std::ptrdiff_t(lane), row.end(), row[lane]);
    std::memcpy(&block, rows.data(), sizeof block);
  }

  void set_lane(TriangleBlock& block, size_t lane, uint32_t triangle) const {
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

ClosestPointTree::Nearest ClosestPointTree::nearest(const glm::vec3& p, const Limits& limits) const {
  Nearest best{limits.max_distance2_m2, kNoTriangle};
  if (nodes_.empty()) return best;
  if (limits.hint < slot_of_triangle_.size() && is_visible(limits, limits.hint)) {
    const float d2 = distance2_to(limits.hint, p);
    if (d2 < best.distance2_m2) best = {d2, limits.hint};
    if (best.triangle != kNoTriangle && best.distance2_m2 <= limits.enough_distance2_m2) return best;
  }
  TreeSearch search{.nodes = nodes_.data(),
                    .blocks = blocks_.data(),
                    .point = {p.x, p.y, p.z},
                    .enough_distance2 = limits.enough_distance2_m2,
                    .group_of_triangle = limits.group_of_triangle,
                    .group_hidden = limits.group_hidden,
                    .distance2 = best.distance2_m2,
                    .triangle = best.triangle};
  triangle_kernels().search(search);
  return {search.distance2, search.triangle};
}

float ClosestPointTree::distance2_to(uint32_t triangle, const glm::vec3& p) const {
  const uint32_t slot = slot_of_triangle_[triangle];
  alignas(32) float d2[kLanes];
  triangle_kernels().distances(blocks_[slot / kLanes], &p.x, d2);
  return d2[slot % kLanes];
}

void ClosestPointTree::distances2_to(uint32_t triangle, std::span<const glm::vec3> points, float* distances2_m2) const {
  const uint32_t slot = slot_of_triangle_[triangle];
  PointLanes lanes{};  // spare lanes keep what was there, and are not looked at
  alignas(32) float d2[kLanes];
  for (size_t first = 0; first < points.size(); first += kLanes) {
    const size_t count = std::min(points.size() - first, kLanes);
    for (size_t i = 0; i < count; ++i) {
      const glm::vec3& p = points[first + i];
      lanes.x[i] = p.x, lanes.y[i] = p.y, lanes.z[i] = p.z;
    }
    triangle_kernels().distances_of(blocks_[slot / kLanes], slot % kLanes, lanes, d2);
    for (size_t i = 0; i < count; ++i) distances2_m2[first + i] = d2[i];
  }
}

ClosestPoint ClosestPointTree::closest_on(uint32_t triangle, const glm::vec3& p) const {
  const uint32_t slot = slot_of_triangle_[triangle];
  const TriangleBlock& block = blocks_[slot / kLanes];
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
