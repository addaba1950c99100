// Measured in units in which the form is the distance from the origin, half-space after half-space is taken in: one
// that the best point so far violates has the new best point on its plane, where the same question has one unknown
// less. Few do when their order is random: the time is linear. Source: [Seidel 1991], for the distance in place of a
// linear form.

#include "preprocess/visibility/closest_in_half_spaces.h"

#include <algorithm>
#include <cmath>
#include <glm/ext/vector_double1.hpp>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <random>
#include <vector>

namespace promenade {
namespace {

/// All x with dot(normal, x) <= offset; normals have length 1.
template <int D>
struct Bound {
  glm::vec<D, double> normal;
  double offset;
};

constexpr double kSlack = 1e-12;
constexpr double kParallel = 1e-12;

/// Of a line's points between its bounds the one next to 0. Bounds that leave nothing, by a rounding, leave their
/// middle.
double closest(std::span<const Bound<1>> bounds) {
  double low = -INFINITY, high = INFINITY;
  for (const Bound<1>& bound : bounds)
    if (bound.normal.x > 0)
      high = std::min(high, bound.offset);
    else
      low = std::max(low, -bound.offset);
  return low <= high ? std::clamp(0.0, low, high) : (low + high) / 2;
}

/// The two-dimensional question on the plane of a bound: a frame in it, and what other bounds are there.
struct OnPlane {
  glm::dvec3 origin, u, v;
  explicit OnPlane(const Bound<3>& plane) : origin(plane.normal * plane.offset) {
    const glm::dvec3 n = plane.normal;
    const glm::dvec3 other = std::abs(n.x) < 0.6 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
    u = glm::normalize(glm::cross(n, other)), v = glm::cross(n, u);
  }
  glm::dvec3 at(const glm::dvec2& p) const { return origin + u * p.x + v * p.y; }
};
struct OnLine {
  glm::dvec2 origin, u;
  explicit OnLine(const Bound<2>& line) : origin(line.normal * line.offset), u(-line.normal.y, line.normal.x) {}
};

glm::dvec2 closest(std::span<const Bound<2>> bounds, std::vector<Bound<1>>& on_line) {
  glm::dvec2 best(0);
  for (size_t i = 0; i < bounds.size(); ++i) {
    if (glm::dot(bounds[i].normal, best) <= bounds[i].offset + kSlack) continue;
    const OnLine line(bounds[i]);
    on_line.clear();
    for (const Bound<2>& other : bounds.first(i)) {
      const double slope = glm::dot(other.normal, line.u);
      if (std::abs(slope) < kParallel) continue;
      const double left = other.offset - glm::dot(other.normal, line.origin);
      on_line.push_back({glm::dvec1(slope > 0 ? 1 : -1), left / std::abs(slope)});
    }
    best = line.origin + line.u * closest(on_line);
  }
  return best;
}

glm::dvec3 closest(std::span<const Bound<3>> bounds) {
  std::vector<Bound<2>> on_plane;
  std::vector<Bound<1>> on_line;
  glm::dvec3 best(0);
  for (size_t i = 0; i < bounds.size(); ++i) {
    if (glm::dot(bounds[i].normal, best) <= bounds[i].offset + kSlack) continue;
    const OnPlane plane(bounds[i]);
    on_plane.clear();
    for (const Bound<3>& other : bounds.first(i)) {
      const glm::dvec2 normal(glm::dot(other.normal, plane.u), glm::dot(other.normal, plane.v));
      const double slope = glm::length(normal);
      if (slope < kParallel) continue;
      on_plane.push_back({normal / slope, (other.offset - glm::dot(other.normal, plane.origin)) / slope});
    }
    best = plane.at(closest(on_plane, on_line));
  }
  return best;
}

}  // namespace

glm::dvec3 closest_in_half_spaces(std::span<const HalfSpace> half_spaces, const glm::dvec3& wanted,
                                  const glm::dvec3& stiffness, const glm::dvec3& inside) {
  const glm::dvec3 unit = 1.0 / glm::sqrt(stiffness);  // x = wanted + unit * y
  std::vector<Bound<3>> bounds;
  bounds.reserve(half_spaces.size());
  for (const HalfSpace& half_space : half_spaces) {
    const glm::dvec3 normal = half_space.normal * unit;
    const double length = glm::length(normal);
    if (!(length > 0)) continue;
    bounds.push_back({normal / length, (half_space.offset - glm::dot(half_space.normal, wanted)) / length});
  }
  std::shuffle(bounds.begin(), bounds.end(), std::minstd_rand(1));
  const glm::dvec3 best = wanted + unit * closest(bounds), way = best - inside;
  double share = 1;
  for (const HalfSpace& half_space : half_spaces) {
    const double step = glm::dot(half_space.normal, way),
                 left = half_space.offset - glm::dot(half_space.normal, inside);
    if (step > 0) share = std::min(share, std::max(0.0, left / step));
  }
  for (const double less : {0.0, 1e-12, 1e-9, 1e-6, 0.5}) {  // roundings
    const glm::dvec3 at = inside + way * (share * (1 - less));
    if (std::all_of(half_spaces.begin(), half_spaces.end(), [&](const HalfSpace& h) { return h.holds(at); })) return at;
  }
  return inside;
}

}  // namespace promenade
