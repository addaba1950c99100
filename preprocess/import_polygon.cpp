// Ear clipping with holes. Source: [eberly2002] D. Eberly, Triangulation by Ear Clipping, Geometric Tools. Debian has
// no small library for this: CGAL is the only one with headers, and brings a minute of compilation and three libraries
// for one function.

#include "preprocess/import_polygon.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <limits>
#include <numeric>

namespace promenade {

namespace {

using Vec2 = glm::dvec2;

constexpr double kPlanarTolerance = 1e-3;  // of the polygon's size
// Point-in-ear tests allowed for one polygon, plus so many a corner: bounds quadratic work on hostile input. Past it
// ears are clipped unchecked.
constexpr uint64_t kFreeTests = 20'000'000;
constexpr uint64_t kTestsPerCorner = 2000;

double cross(const Vec2& a, const Vec2& b, const Vec2& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// A corner in the one loop that is left to be cut; bridges make two corners of one point.
struct Corner {
  uint32_t point;
  uint32_t previous, next;
};

/// How much a cut may disregard, when nothing better is left.
enum class Care : uint8_t { strict, touching, flat, convex, any };

class EarClipper {
 public:
  EarClipper(const std::vector<Vec2>& points, std::vector<uint32_t>& out)
      : points_(points), out_(out), tests_left_(kFreeTests + kTestsPerCorner * points.size()) {}

  /// false: the polygon is not clean.
  bool run(std::span<const uint32_t> ring_sizes) {
    uint32_t first = 0;
    std::vector<uint32_t> holes;
    for (size_t r = 0; r < ring_sizes.size(); ++r) {
      if (ring_sizes[r] >= 3) {
        const uint32_t start = add_ring(first, ring_sizes[r], r == 0);
        if (r == 0)
          loop_ = start;
        else
          holes.push_back(rightmost(start));
      } else if (r == 0) {
        return false;
      }
      first += ring_sizes[r];
    }
    // From the right, so that each bridge ends at a hole that is joined already, or at the outer ring.
    std::stable_sort(holes.begin(), holes.end(), [this](uint32_t a, uint32_t b) { return at(a).x > at(b).x; });
    for (const uint32_t hole : holes) join(hole);
    make_grid();
    clip();
    return clean_;
  }

 private:
  const Vec2& at(uint32_t corner) const { return points_[corners_[corner].point]; }

  /// Outer rings counter-clockwise, holes clockwise.
  uint32_t add_ring(uint32_t first, uint32_t size, bool outer) {
    double area = 0;
    for (uint32_t i = 0; i < size; ++i) {
      const Vec2& a = points_[first + i];
      const Vec2& b = points_[first + (i + 1) % size];
      area += a.x * b.y - a.y * b.x;
    }
    const auto start = static_cast<uint32_t>(corners_.size());
    const bool forwards = (area > 0) == outer;
    for (uint32_t i = 0; i < size; ++i)
      corners_.push_back(
          {first + (forwards ? i : size - 1 - i), start + (i + size - 1) % size, start + (i + 1) % size});
    return start;
  }

  uint32_t rightmost(uint32_t start) const {
    uint32_t best = start;
    for (uint32_t c = corners_[start].next; c != start; c = corners_[c].next)
      if (at(c).x > at(best).x) best = c;
    return best;
  }

  /// Joins a hole to the loop by a bridge from its rightmost corner.
  void join(uint32_t hole) {
    const uint32_t other = find_bridge(at(hole));
    if (other == kNone) {
      clean_ = false;  // the hole lies outside: forget it
      return;
    }
    const auto hole_again = static_cast<uint32_t>(corners_.size());
    const uint32_t other_again = hole_again + 1;
    const uint32_t hole_previous = corners_[hole].previous;
    const uint32_t other_next = corners_[other].next;
    corners_.push_back({corners_[hole].point, hole_previous, other_again});
    corners_.push_back({corners_[other].point, hole_again, other_next});
    corners_[hole_previous].next = hole_again;
    corners_[other_next].previous = other_again;
    corners_[other].next = hole;
    corners_[hole].previous = other;
  }

  /// The corner of the loop that `from` sees to its right.
  uint32_t find_bridge(const Vec2& from) {
    uint32_t best = kNone;
    double best_x = std::numeric_limits<double>::infinity();
    uint32_t c = loop_;
    do {
      const uint32_t n = corners_[c].next;
      const Vec2& a = at(c);
      const Vec2& b = at(n);
      // Edges of the loop that have its inside on their left go up where the ray leaves the inside.
      if (a.y <= from.y && b.y >= from.y && a.y != b.y) {
        const double x = a.x + (from.y - a.y) * (b.x - a.x) / (b.y - a.y);
        if (x >= from.x && x < best_x) {
          best_x = x;
          best = a.x > b.x ? c : n;
          if (a.y == from.y && a.x == x) best = c;
          if (b.y == from.y && b.x == x) best = n;
        }
      }
      c = n;
    } while (c != loop_);
    if (best == kNone || at(best) == Vec2(best_x, from.y)) return best;
    return nearest_in_sight(from, Vec2(best_x, from.y), best);
  }

  /// Corners inside the triangle (from, hit, candidate) may hide the candidate: the one at the smallest angle to the
  /// ray is in sight.
  uint32_t nearest_in_sight(const Vec2& from, const Vec2& hit, uint32_t candidate) const {
    const Vec2 p = at(candidate);
    const bool above = p.y > from.y;
    const Vec2& b = above ? hit : p;
    const Vec2& d = above ? p : hit;
    uint32_t best = candidate;
    double best_slope = std::abs(p.y - from.y) / std::max(p.x - from.x, std::numeric_limits<double>::min());
    double best_x = p.x;
    for (uint32_t c = corners_[loop_].next, start = loop_;; c = corners_[c].next) {
      const Vec2& q = at(c);
      const bool inside = q.x > from.x && cross(from, b, q) >= 0 && cross(b, d, q) >= 0 && cross(d, from, q) >= 0;
      if (inside && q != p && sees(c, from)) {
        const double slope = std::abs(q.y - from.y) / (q.x - from.x);
        if (slope < best_slope || (slope == best_slope && q.x < best_x)) best = c, best_slope = slope, best_x = q.x;
      }
      if (c == start) break;
    }
    return best;
  }

  /// Whether `target` lies in the corner's inner angle: of corners at one point, only one takes the bridge.
  bool sees(uint32_t corner, const Vec2& target) const {
    const Vec2& a = at(corners_[corner].previous);
    const Vec2& b = at(corner);
    const Vec2& c = at(corners_[corner].next);
    if (cross(a, b, c) >= 0) return cross(a, b, target) >= 0 && cross(b, c, target) >= 0;
    return cross(a, b, target) > 0 || cross(b, c, target) > 0;
  }

  /// The corners in a grid, so that an ear meets only those near it.
  void make_grid() {
    low_ = high_ = at(loop_);
    uint32_t count = 0;
    uint32_t c = loop_;
    do {
      low_ = glm::min(low_, at(c)), high_ = glm::max(high_, at(c));
      ++count;
      c = corners_[c].next;
    } while (c != loop_);
    remaining_ = count;
    side_ = count < 64 ? 1 : static_cast<uint32_t>(std::sqrt(double(count)));
    cells_.assign(size_t(side_) * side_, {});
    do {
      cells_[size_t(row(at(c).y)) * side_ + column(at(c).x)].push_back(c);
      c = corners_[c].next;
    } while (c != loop_);
    gone_.assign(corners_.size(), false);
  }

  uint32_t column(double x) const { return cell_of(x, low_.x, high_.x); }
  uint32_t row(double y) const { return cell_of(y, low_.y, high_.y); }
  uint32_t cell_of(double v, double low, double high) const {
    const double place = high > low ? (v - low) / (high - low) * side_ : 0;
    return static_cast<uint32_t>(std::clamp(place, 0.0, double(side_ - 1)));
  }

  /// Whether a corner other than the ear's own points lies in it.
  bool blocked(const Vec2& a, const Vec2& b, const Vec2& c, bool touching_blocks) {
    const Vec2 low = glm::min(a, glm::min(b, c));
    const Vec2 high = glm::max(a, glm::max(b, c));
    for (uint32_t y = row(low.y); y <= row(high.y); ++y)
      for (uint32_t x = column(low.x); x <= column(high.x); ++x) {
        if (tests_left_ == 0) return false;
        --tests_left_;
        for (const uint32_t corner : cells_[size_t(y) * side_ + x]) {
          if (gone_[corner]) continue;
          if (tests_left_ == 0) return false;
          --tests_left_;
          const Vec2& p = at(corner);
          if (p == a || p == b || p == c) continue;
          const double u = cross(a, b, p);
          const double v = cross(b, c, p);
          const double w = cross(c, a, p);
          if (touching_blocks ? (u >= 0 && v >= 0 && w >= 0) : (u > 0 && v > 0 && w > 0)) return true;
        }
      }
    return false;
  }

  bool may_cut(uint32_t corner, Care care) {
    if (care == Care::any) return true;
    const Vec2& a = at(corners_[corner].previous);
    const Vec2& b = at(corner);
    const Vec2& c = at(corners_[corner].next);
    const double turn = cross(a, b, c);
    if (care == Care::flat) return turn == 0;
    if (!(turn > 0)) return false;
    return care == Care::convex || !blocked(a, b, c, care == Care::strict);
  }

  void clip() {
    uint32_t corner = loop_;
    uint32_t tried = 0;
    auto care = Care::strict;
    while (remaining_ >= 3) {
      const uint32_t next = corners_[corner].next;
      if (may_cut(corner, care)) {
        if (care >= Care::convex) clean_ = false;
        cut(corner);
        // Skipping one makes fans less likely.
        corner = corners_[next].next;
        tried = 0;
        care = Care::strict;
        continue;
      }
      corner = next;
      if (++tried < remaining_) continue;
      tried = 0;
      care = static_cast<Care>(static_cast<uint8_t>(care) + 1);
    }
  }

  void cut(uint32_t corner) {
    const Corner& gone = corners_[corner];
    const bool flat = cross(at(gone.previous), at(corner), at(gone.next)) == 0;
    if (!flat) out_.insert(out_.end(), {corners_[gone.previous].point, gone.point, corners_[gone.next].point});
    corners_[gone.previous].next = gone.next;
    corners_[gone.next].previous = gone.previous;
    gone_[corner] = true;
    --remaining_;
  }

  static constexpr uint32_t kNone = 0xffffffffU;
  const std::vector<Vec2>& points_;
  std::vector<uint32_t>& out_;
  std::vector<Corner> corners_;
  std::vector<bool> gone_;
  std::vector<std::vector<uint32_t>> cells_;
  Vec2 low_{0}, high_{0};
  uint32_t side_ = 1;
  uint32_t loop_ = kNone;
  uint32_t remaining_ = 0;
  uint64_t tests_left_;
  bool clean_ = true;
};

/// Twice the outer ring's vector area.
glm::dvec3 newell_normal(std::span<const glm::dvec3> ring, const glm::dvec3& origin) {
  glm::dvec3 normal(0);
  for (size_t i = 0; i < ring.size(); ++i) normal += glm::cross(ring[i] - origin, ring[(i + 1) % ring.size()] - origin);
  return normal;
}

/// Two axes that make a right-handed frame with the (unit) normal.
void plane_axes(const glm::dvec3& normal, glm::dvec3& u, glm::dvec3& v) {
  const glm::dvec3 a = glm::abs(normal);
  const glm::dvec3 helper = a.x <= a.y && a.x <= a.z ? glm::dvec3(1, 0, 0)
                            : a.y <= a.z             ? glm::dvec3(0, 1, 0)
                                                     : glm::dvec3(0, 0, 1);
  u = glm::normalize(glm::cross(helper, normal));
  v = glm::cross(normal, u);
}

}  // namespace

Triangulation triangulate(std::span<const glm::dvec3> points, std::span<const uint32_t> ring_sizes) {
  Triangulation out;
  if (ring_sizes.empty() || ring_sizes[0] < 3) return out;
  const glm::dvec3 origin = points[0];
  const glm::dvec3 area = newell_normal(points.first(ring_sizes[0]), origin);
  const double length = glm::length(area);
  if (!(length > 0) || !std::isfinite(length)) return out;
  const glm::dvec3 normal = area / length;
  double size = 0;
  double off = 0;
  for (const glm::dvec3& p : points) {
    size = std::max(size, glm::distance(p, origin));
    off = std::max(off, std::abs(glm::dot(p - origin, normal)));
  }
  if (!std::isfinite(size)) return out;
  out.non_planar = off > kPlanarTolerance * size;
  if (points.size() == 3) {
    out.corners = {0, 1, 2};
    return out;
  }
  glm::dvec3 u;
  glm::dvec3 v;
  plane_axes(normal, u, v);
  std::vector<Vec2> flat;
  flat.reserve(points.size());
  for (const glm::dvec3& p : points) flat.emplace_back(glm::dot(p - origin, u), glm::dot(p - origin, v));
  out.unclean = !EarClipper(flat, out.corners).run(ring_sizes);
  return out;
}

}  // namespace promenade
