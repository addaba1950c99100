// The distance to a convex set is a convex function, so a piece of A whose corners are all within d of one triangle of
// B is within d of it everywhere. And distance grows no faster than one walks: a piece within R of a point that is d
// from B is within d + R. Pieces that neither settles are cut: along the borders of the triangle of B below them, so
// that differently triangulated parts of one plane are compared exactly, else in the middle.

#include "preprocess/surface_distance.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <functional>
#include <glm/geometric.hpp>
#include <numbers>

#include "preprocess/key_set.h"
#include "preprocess/weld.h"

namespace promenade {

namespace {

constexpr size_t kMaxCorners = 16;  // of a piece; from kCrowded on only halving is allowed, which takes corners away
constexpr size_t kCrowded = 10;
constexpr uint32_t kMaxDepth = 40;         // halvings of one triangle below each other
constexpr size_t kPiecesPerTriangle = 64;  // of both meshes; bounds the time on hostile input
constexpr uint32_t kCutsAtOnce = 512;      // of one triangle: neighbours in turn ask for what is in the cache
constexpr uint32_t kMostLooks = 64;        // at triangles around a corner for a neighbour: bounds the time at hubs
constexpr size_t kMostOpen = 1U << 17U;    // pieces waiting at a time: bounds the memory, about 30 MB
constexpr uint32_t kSamples = 512;         // of each direction: five of them above the 99th percentile
constexpr float kWellInside = 1e-4F;       // barycentric: cuts nearer to a border would gain nothing, for ever
constexpr float kFloorShare = 1e-5F;       // of the diagonal: differences below it are not pursued
constexpr float kQueryRounding = 2e-6F;    // see ClosestPointTree
constexpr float kCoordinateRounding = 0x1p-23F;
constexpr float kNearEnough = 0.5F;  // of what a triangle is settled by: measured, see bench_simplify

/// A convex polygon on a triangle of A.
struct Piece {
  std::array<glm::vec3, kMaxCorners> corners;
  uint32_t count;
  uint32_t depth;
  std::array<uint32_t, 3> near;  // triangles of B nearby, the last found first
  uint32_t beside;               // the triangle of B beyond the border that it was cut along; kNoTriangle: unknown
  float bound;                   // on the distance anywhere on it, known from what it was cut from
};

/// What waits for its cuts: the largest bound first, ties by age, the same order everywhere.
class OpenPieces {
 public:
  /// side: 0 or 1, whose piece it is. False where there are too many.
  bool add(uint32_t side, const Piece& piece) {
    if (entries_.size() == kMostOpen) return false;
    uint32_t at = static_cast<uint32_t>(pieces_.size());
    if (free_.empty()) {
      pieces_.push_back(piece);
    } else {
      at = free_.back();
      free_.pop_back();
      pieces_[at] = piece;
    }
    entries_.push_back({piece.bound, sequence_++, side, at});
    std::push_heap(entries_.begin(), entries_.end());
    return true;
  }

  bool empty() const { return entries_.empty(); }
  /// Whether one more cut may leave more than there is room for.
  bool full() const { return entries_.size() + kMostLeft > kMostOpen; }
  float largest_bound() const { return entries_.front().bound; }

  /// The first, and its side.
  std::pair<Piece, uint32_t> take() {
    std::pop_heap(entries_.begin(), entries_.end());
    const Entry entry = entries_.back();
    entries_.pop_back();
    free_.push_back(entry.at);
    return {pieces_[entry.at], entry.side};
  }

 private:
  static constexpr size_t kMostLeft = 4;  // by cuts along three borders

  struct Entry {
    float bound;
    uint32_t sequence;
    uint32_t side;
    uint32_t at;
    bool operator<(const Entry& other) const {
      return bound != other.bound ? bound < other.bound : sequence > other.sequence;
    }
  };
  std::vector<Entry> entries_;
  std::vector<Piece> pieces_;
  std::vector<uint32_t> free_;
  uint32_t sequence_ = 0;
};

/// What both directions share.
struct Measure {
  float reached = 0;   // a distance that is really there: the largest found
  float accepted = 0;  // the largest bound of anything settled so far
  float slack = 0;
  float floor = 0;
  OpenPieces open;
  /// Whatever is bounded by this need not be looked at more closely.
  float good_enough() const { return std::max({floor, accepted, reached * (1 + slack)}); }
  /// A triangle this near to a corner will do, nearest or not: nothing about the largest distance depends on it, and
  /// what it leaves to `good_enough` is enough to settle most triangles by.
  float near_enough() const { return kNearEnough * good_enough(); }
};

/// Cuts by the plane dot(normal, x) = offset: `below` is where the product is less.
void cut(const Piece& piece, const glm::vec3& normal, float offset, Piece& below, Piece& above) {
  std::array<float, kMaxCorners> side;  // NOLINT(cppcoreguidelines-pro-type-member-init)
  for (uint32_t i = 0; i < piece.count; ++i) side[i] = glm::dot(normal, piece.corners[i]) - offset;
  below.count = above.count = 0;
  for (uint32_t i = 0; i < piece.count; ++i) {
    const uint32_t next = i + 1 == piece.count ? 0 : i + 1;
    if (side[i] <= 0) below.corners[below.count++] = piece.corners[i];
    if (side[i] >= 0) above.corners[above.count++] = piece.corners[i];
    if ((side[i] < 0 && side[next] > 0) || (side[i] > 0 && side[next] < 0)) {
      const float t = side[i] / (side[i] - side[next]);
      const glm::vec3 p = piece.corners[i] + t * (piece.corners[next] - piece.corners[i]);
      below.corners[below.count++] = p;
      above.corners[above.count++] = p;
    }
  }
}

/// What two meshes have in common: places, and triangles with the same corners, which are nowhere apart.
class Common {
 public:
  Common(const Mesh& a, const Mesh& b) {
    std::vector<glm::vec3> positions;
    positions.reserve(a.positions.size() + b.positions.size());
    positions = a.positions;
    positions.insert(positions.end(), b.positions.begin(), b.positions.end());
    Places places = find_places(positions);
    of_vertex_ = std::move(places.of_vertex);
    sides_[0].mesh = &a, sides_[1].mesh = &b;
    sides_[1].first_vertex = a.positions.size();
    for (Side& side : sides_) {
      side.first_corner.assign(places.first_vertex.size(), kNone);
      side.next_corner.resize(side.mesh->indices.size());
      side.has_twin.assign(side.mesh->triangle_count(), 0);
      for (size_t i = side.mesh->indices.size(); i-- > 0;) {
        uint32_t& first = side.first_corner[of_vertex_[side.first_vertex + side.mesh->indices[i]]];
        side.next_corner[i] = first;
        first = static_cast<uint32_t>(i);
      }
    }
    const bool a_is_smaller = a.triangle_count() < b.triangle_count();
    find_twins(sides_[a_is_smaller ? 0 : 1], sides_[a_is_smaller ? 1 : 0]);
  }

  size_t places() const { return sides_[0].first_corner.size(); }
  uint32_t place(uint32_t side, uint32_t vertex) const { return of_vertex_[sides_[side].first_vertex + vertex]; }
  /// The side's first triangle with a corner there; kNoTriangle: it has none.
  uint32_t triangle_at(uint32_t side, uint32_t place) const {
    const uint32_t corner = sides_[side].first_corner[place];
    return corner == kNone ? kNoTriangle : corner / 3;
  }
  /// The side's first other triangle on the edge from a corner to its triangle's next one; kNoTriangle: none is found
  /// soon.
  uint32_t across(uint32_t side, uint32_t corner) const {
    const Side& its = sides_[side];
    const auto place_of = [&](uint32_t c) { return place(side, its.mesh->indices[c]); };
    const uint32_t end = place_of(next_in_triangle(corner));
    uint32_t looks = kMostLooks;
    for (uint32_t c = its.first_corner[place_of(corner)]; c != kNone && looks > 0; c = its.next_corner[c], --looks)
      if (c / 3 != corner / 3 && (place_of(next_in_triangle(c)) == end || place_of(previous_in_triangle(c)) == end))
        return c / 3;
    return kNoTriangle;
  }
  /// Whether the other side has it too.
  bool has_twin(uint32_t side, size_t triangle) const { return sides_[side].has_twin[triangle] != 0; }

 private:
  static constexpr uint32_t kNone = 0xffffffffU;
  struct Side {
    const Mesh* mesh = nullptr;
    size_t first_vertex = 0;
    std::vector<uint32_t> first_corner;  // at each place
    std::vector<uint32_t> next_corner;   // at the same place
    std::vector<uint8_t> has_twin;
  };
  using Corners = std::array<uint32_t, 3>;

  /// The places of a triangle, sorted.
  Corners corners(const Side& side, size_t t) const {
    Corners at{};
    for (size_t c = 0; c < 3; ++c) at[c] = of_vertex_[side.first_vertex + side.mesh->indices[3 * t + c]];
    if (at[0] > at[1]) std::swap(at[0], at[1]);
    if (at[1] > at[2]) std::swap(at[1], at[2]);
    if (at[0] > at[1]) std::swap(at[0], at[1]);
    return at;
  }

  void find_twins(Side& small, Side& large) {
    const size_t slots = std::bit_ceil(small.has_twin.size() * 2 + 1);
    std::vector<uint32_t> table(slots, kNoTriangle);  // open addressing: the small side's triangles
    const auto first_slot = [&](const Corners& at) {
      return ((at[0] * 0x9e3779b97f4a7c15ULL ^ at[1] * 0xbf58476d1ce4e5b9ULL ^ at[2] * 0x94d049bb133111ebULL) >> 20U) &
             (slots - 1);
    };
    for (uint32_t t = 0; t < small.has_twin.size(); ++t) {
      size_t slot = first_slot(corners(small, t));
      while (table[slot] != kNoTriangle) slot = (slot + 1) & (slots - 1);
      table[slot] = t;
    }
    for (size_t t = 0; t < large.has_twin.size(); ++t) {
      const Corners at = corners(large, t);
      if (small.first_corner[at[0]] == kNone || small.first_corner[at[1]] == kNone ||
          small.first_corner[at[2]] == kNone)
        continue;
      for (size_t slot = first_slot(at); table[slot] != kNoTriangle; slot = (slot + 1) & (slots - 1))
        if (corners(small, table[slot]) == at) small.has_twin[table[slot]] = large.has_twin[t] = 1;
    }
  }

  std::vector<uint32_t> of_vertex_;  // places: a's vertices, then b's
  std::array<Side, 2> sides_;
};

/// Distances from one mesh to another.
class Direction {
 public:
  /// side: what the pieces that are cut from `from` are known by.
  Direction(const Mesh& from, const Mesh& to, const ClosestPointTree& tree, const Common& common, uint32_t side,
            Measure& measure)
      : from_(from), to_(to), tree_(tree), common_(common), side_(side), measure_(measure) {
    const Box box = bounds(from);
    const glm::vec3 largest = glm::max(glm::abs(box.min), glm::abs(box.max));
    cut_rounding_ = kCoordinateRounding * 4 * std::max({largest.x, largest.y, largest.z});
  }

  void measure_vertices() {
    nearest_.resize(common_.places());
    std::vector<uint8_t> done(common_.places(), 0);
    uint32_t hint = kNoTriangle;
    for (size_t i = 0; i < from_.indices.size(); ++i) {
      if (common_.has_twin(side_, i / 3)) continue;
      const uint32_t place = common_.place(side_, from_.indices[i]);
      if (done[place] == 0) {
        done[place] = 1;
        const uint32_t at = common_.triangle_at(1 - side_, place);
        nearest_[place] =
            at != kNoTriangle ? Found{0, at} : query(from_.positions[from_.indices[i]], hint, measure_.near_enough());
      }
      hint = nearest_[place].triangle;
    }
  }

  /// 99th percentile of the distances at evenly spread points; `least_m` where it is less.
  float measure_samples(float least_m) {
    std::vector<double> area_until(from_.triangle_count());
    double area = 0;
    for (size_t t = 0; t < area_until.size(); ++t)
      area_until[t] = area += double(glm::length(triangle_cross(from_, t)));
    // The largest, the least of them first: that is the percentile in the end, and nothing nearer need be known
    // exactly.
    std::array<float, kSamples - kSamples * 99 / 100> largest;  // NOLINT(cppcoreguidelines-pro-type-member-init)
    largest.fill(least_m);
    uint32_t hint = kNoTriangle;
    for (uint32_t s = 0; s < kSamples; ++s) {
      const uint64_t random = scramble(s);
      const double at = area * (s + 0.5) / kSamples;
      const auto t =
          std::min(static_cast<size_t>(std::lower_bound(area_until.begin(), area_until.end(), at) - area_until.begin()),
                   area_until.size() - 1);
      if (common_.has_twin(side_, t)) continue;
      const float r = std::sqrt(float(random >> 40U) * 0x1p-24F);
      const float w = float((random >> 8U) & 0xffffffU) * 0x1p-24F;
      const std::array<glm::vec3, 3> c = corners(t);
      const Found found = query(c[0] + (r * (1 - w)) * (c[1] - c[0]) + (r * w) * (c[2] - c[0]), hint, largest.front());
      hint = found.triangle;
      if (found.distance <= largest.front()) continue;
      std::pop_heap(largest.begin(), largest.end(), std::greater<>());
      largest.back() = found.distance;
      std::push_heap(largest.begin(), largest.end(), std::greater<>());
    }
    return largest.front();
  }

  /// Bounds the distance over every triangle but for what takes many cuts, which is left open. After measure_vertices
  /// of both directions.
  void bound_triangles() {
    for (size_t t = 0; t < from_.triangle_count(); ++t) {
      if (common_.has_twin(side_, t)) continue;
      bound_triangle(t);
      if (stack_.empty()) continue;
      const Piece whole = stack_.back();
      for (uint32_t cuts = 0; !stack_.empty() && cuts < kCutsAtOnce; ++cuts) {
        Piece top = stack_.back();
        stack_.pop_back();
        bound_piece(top);
      }
      if (stack_.empty()) continue;
      stack_.assign(1, whole);
      leave_open();
    }
  }

  /// One cut of an open piece; what it leaves is open again.
  void cut_open(Piece& piece) {
    bound_piece(piece);
    leave_open();
  }

 private:
  struct Found {
    float distance = 0;
    uint32_t triangle = kNoTriangle;
  };

  void leave_open() {
    for (const Piece& piece : stack_)
      if (!measure_.open.add(side_, piece)) settle(piece.bound);
    stack_.clear();
  }

  /// Settles a piece or cuts it up. Not one of the stack's.
  void bound_piece(Piece& piece) {
    if (piece.bound <= measure_.good_enough() || piece.depth >= kMaxDepth) return settle(piece.bound);
    glm::vec3 center(0);
    for (uint32_t i = 0; i < piece.count; ++i) center += piece.corners[i];
    center /= float(piece.count);
    float radius2 = 0;
    for (uint32_t i = 0; i < piece.count; ++i)
      radius2 = std::max(radius2, glm::dot(piece.corners[i] - center, piece.corners[i] - center));
    const float radius = std::sqrt(radius2);
    Found found;
    if (!is_over(piece.beside, center, found))
      found = query(center, piece.near[0], std::max(measure_.good_enough() - radius - cut_rounding_, 0.0F));
    piece.bound = std::min(piece.bound, found.distance + radius + cut_rounding_);
    if (piece.bound > measure_.good_enough())
      piece.bound = std::min(piece.bound, farthest_from(found.triangle, piece, piece.bound));
    if (piece.bound <= measure_.good_enough()) return settle(piece.bound);
    piece.near[0] = found.triangle;
    if (piece.count < kCrowded && cut_along(piece, center, measure_.good_enough() - found.distance)) return;
    halve(piece);
  }

  std::array<glm::vec3, 3> corners(size_t t) const {
    return {from_.positions[from_.indices[3 * t]], from_.positions[from_.indices[3 * t + 1]],
            from_.positions[from_.indices[3 * t + 2]]};
  }

  /// The nearest triangle, or the first one found within `enough_m`.
  Found query(const glm::vec3& p, uint32_t hint, float enough_m = 0) {
    const ClosestPointTree::Nearest found =
        tree_.nearest(p, {.hint = hint, .enough_distance2_m2 = enough_m * enough_m});
    const float distance = std::sqrt(found.distance2_m2);
    if (distance > enough_m) measure_.reached = std::max(measure_.reached, distance);
    return {distance, found.triangle};
  }

  /// Whether a point lies over the inside of a triangle of B and near it, be others nearer: good enough to cut by.
  bool is_over(uint32_t triangle, const glm::vec3& p, Found& found) const {
    if (triangle == kNoTriangle) return false;
    const ClosestPoint below = tree_.closest_on(triangle, p);
    found = {std::sqrt(below.distance2_m2), triangle};
    return found.distance <= measure_.near_enough() &&
           std::min({below.barycentric.x, below.barycentric.y, below.barycentric.z}) > kWellInside;
  }

  /// Largest distance of a triangle's corners from one triangle of B.
  float farthest_from(uint32_t triangle, const std::array<glm::vec3, 3>& corners) const {
    std::array<float, 3> d2;  // NOLINT(cppcoreguidelines-pro-type-member-init)
    tree_.distances2_to(triangle, corners, d2.data());
    return std::sqrt(std::max({0.0F, d2[0], d2[1], d2[2]}));
  }

  void settle(float bound) { measure_.accepted = std::max(measure_.accepted, bound); }

  void bound_triangle(size_t t) {
    const std::array<glm::vec3, 3> c = corners(t);
    std::array<Found, 3> near;
    for (size_t i = 0; i < 3; ++i) near[i] = nearest_[common_.place(side_, from_.indices[3 * t + i])];
    const float farthest = std::max({near[0].distance, near[1].distance, near[2].distance});
    if (near[0].triangle == near[1].triangle && near[1].triangle == near[2].triangle) return settle(farthest);
    const float edge = std::sqrt(std::max(
        {glm::dot(c[1] - c[0], c[1] - c[0]), glm::dot(c[2] - c[1], c[2] - c[1]), glm::dot(c[0] - c[2], c[0] - c[2])}));
    // Every point of a triangle is within its longest edge / sqrt 3 of a corner.
    float bound = farthest + edge * 0.57735034F;
    if (bound <= measure_.good_enough()) return settle(bound);
    for (size_t i = 0; i < 3; ++i) {
      bound = std::min(bound, farthest_from(near[i].triangle, c));
      if (bound <= measure_.good_enough()) return settle(bound);
    }
    Piece piece;  // NOLINT(cppcoreguidelines-pro-type-member-init)
    std::copy(c.begin(), c.end(), piece.corners.begin());
    piece.count = 3, piece.depth = 0, piece.bound = bound, piece.beside = kNoTriangle;
    for (size_t i = 0; i < 3; ++i) piece.near[i] = near[i].triangle;
    stack_.push_back(piece);
  }

  /// The largest distance of a piece from one triangle of B; more than `limit_m` where it is over that.
  float farthest_from(uint32_t triangle, const Piece& piece, float limit_m) const {
    const float limit2 = limit_m * limit_m;
    std::array<float, kMaxCorners> of_corner;  // NOLINT(cppcoreguidelines-pro-type-member-init)
    tree_.distances2_to(triangle, {piece.corners.data(), piece.count}, of_corner.data());
    float d2 = 0;
    for (uint32_t i = 0; i < piece.count && d2 <= limit2; ++i) d2 = std::max(d2, of_corner[i]);
    return std::sqrt(d2) + cut_rounding_;
  }

  void push(Piece& part, const Piece& whole, uint32_t beside = kNoTriangle) {
    if (part.count < 3) return;
    part.depth = whole.depth, part.near = whole.near, part.bound = whole.bound, part.beside = beside;
    // Beyond the triangle that it was cut along it may lie on one of those that the corners are near.
    for (size_t i = 1; i < part.near.size() && part.bound > measure_.good_enough(); ++i)
      if (const float bound = farthest_from(part.near[i], part, measure_.good_enough());
          bound <= measure_.good_enough())
        part.bound = bound;
    add(part);
  }

  void add(const Piece& piece) {
    if (piece.bound <= measure_.good_enough()) return settle(piece.bound);
    stack_.push_back(piece);
  }

  /// Cuts along the borders of the triangle of B that the piece's centre lies over. False, and nothing done, where that
  /// is no use: the triangle is no larger than what halving would reach (`reach`), or has the whole piece over it.
  bool cut_along(const Piece& piece, const glm::vec3& center, float reach) {
    const uint32_t triangle = piece.near[0];
    const ClosestPoint below = tree_.closest_on(triangle, center);
    if (std::min({below.barycentric.x, below.barycentric.y, below.barycentric.z}) <= kWellInside) return false;
    const size_t t = size_t(triangle) * 3;
    const std::array<glm::vec3, 3> b = {to_.positions[to_.indices[t]], to_.positions[to_.indices[t + 1]],
                                        to_.positions[to_.indices[t + 2]]};
    const glm::vec3 normal = glm::cross(b[1] - b[0], b[2] - b[0]);
    if (glm::dot(normal, normal) <= reach * reach * reach * reach) return false;
    Piece inside = piece;
    Piece outside;    // NOLINT(cppcoreguidelines-pro-type-member-init)
    Piece remaining;  // NOLINT(cppcoreguidelines-pro-type-member-init)
    bool any = false;
    for (size_t e = 0; e < 3; ++e) {
      glm::vec3 outward = glm::cross(b[(e + 1) % 3] - b[e], normal);
      const float length = glm::length(outward);
      if (!(length > 0)) continue;
      outward /= length;
      const float offset = glm::dot(outward, b[e]);
      float farthest = std::numeric_limits<float>::lowest();
      for (uint32_t i = 0; i < inside.count; ++i)
        farthest = std::max(farthest, glm::dot(outward, inside.corners[i]) - offset);
      if (farthest <= measure_.floor + cut_rounding_) continue;
      cut(inside, outward, offset, remaining, outside);
      if (remaining.count < 3) break;  // rounding: the centre was inside
      any = true;
      push(outside, piece, common_.across(1 - side_, static_cast<uint32_t>(t + e)));
      remaining.depth = piece.depth;
      inside = remaining;
    }
    if (!any) return false;
    inside.near = piece.near, inside.depth = piece.depth, inside.beside = kNoTriangle;
    inside.bound = std::min(piece.bound, farthest_from(triangle, inside, piece.bound));
    add(inside);
    return true;
  }

  /// Cuts across the piece's longest diagonal.
  void halve(Piece& piece) {
    float longest2 = -1;
    glm::vec3 from(0), to(0);
    for (uint32_t i = 0; i < piece.count; ++i)
      for (uint32_t j = i + 1; j < piece.count; ++j) {
        const glm::vec3 d = piece.corners[j] - piece.corners[i];
        if (const float d2 = glm::dot(d, d); d2 > longest2)
          longest2 = d2, from = piece.corners[i], to = piece.corners[j];
      }
    ++piece.depth;
    const glm::vec3 along = to - from;
    Piece first, second;  // NOLINT(cppcoreguidelines-pro-type-member-init)
    cut(piece, along, glm::dot(along, from + 0.5F * along), first, second);
    if (first.count < 3 || second.count < 3) return settle(piece.bound);  // too small to cut
    push(first, piece);
    push(second, piece);
  }

  const Mesh& from_;
  const Mesh& to_;
  const ClosestPointTree& tree_;
  const Common& common_;
  uint32_t side_;
  Measure& measure_;
  float cut_rounding_ = 0;
  std::vector<Found> nearest_;  // of each place
  std::vector<Piece> stack_;
};

/// Cuts what is open, the worst first, until nothing is left that matters, or it has become too much.
void cut_open(std::array<Direction, 2>& sides, size_t cuts, Measure& measure) {
  OpenPieces& open = measure.open;
  for (; cuts > 0 && !open.empty() && !open.full() && open.largest_bound() > measure.good_enough(); --cuts) {
    auto [piece, side] = open.take();
    sides[side].cut_open(piece);
  }
  if (!open.empty()) measure.accepted = std::max(measure.accepted, open.largest_bound());
}

}  // namespace

SurfaceDistance surface_distance(const Mesh& a, const ClosestPointTree& tree_a, const Mesh& b,
                                 const ClosestPointTree& tree_b, double slack, double tolerance_m) {
  Box box = bounds(a);
  box.add(bounds(b));
  Measure measure;
  measure.slack = static_cast<float>(slack);
  measure.floor = std::max(static_cast<float>(tolerance_m), box.diagonal() * kFloorShare);
  const Common common(a, b);
  std::array<Direction, 2> sides = {Direction(a, b, tree_b, common, 0, measure),
                                    Direction(b, a, tree_a, common, 1, measure)};
  SurfaceDistance result;
  // Samples first: how far the surfaces are apart at most decides how closely the rest is looked at.
  for (Direction& side : sides) result.p99_m = side.measure_samples(result.p99_m);
  for (Direction& side : sides) side.measure_vertices();
  for (Direction& side : sides) side.bound_triangles();
  cut_open(sides, (a.triangle_count() + b.triangle_count()) * kPiecesPerTriangle + 1000, measure);
  const float bound = std::max(measure.accepted, measure.reached);
  result.bound_m = bound + 2 * kQueryRounding * (bound + box.diagonal());
  return result;
}

SurfaceDistance surface_distance(const Mesh& a, const Mesh& b, double slack, double tolerance_m) {
  return surface_distance(a, ClosestPointTree(a), b, ClosestPointTree(b), slack, tolerance_m);
}

}  // namespace promenade
