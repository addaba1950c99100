// The point. For a box whose planes allow points up to h before its front, the shadow through a point at height x grows
// with x; so the sum over boxes of a(h - x)^2 is made least, where `a` is the cross-section of the shadow's cone times
// the way from the box to the end of the world: a convex quadratic program, with all boxes' planes as its conditions.
// The section's text calls a box's own best point the one nearest to it; its volume, 1/3 a (H2^3 - H1^3) with H2 - H1
// given, grows with the distance, so here it is the farthest.
// Source: [chhugani2003] section 5.2.

#include "preprocess/visibility/projection_point.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "preprocess/visibility/box_view.h"
#include "preprocess/visibility/closest_in_half_spaces.h"

namespace promenade {
namespace {

constexpr double kLoose = 1e-6;  // stiffness along axes that no box asks about, of the greatest

/// What a cone's planes leave of a face of a cube about its point, without those that are across no axis of the face;
/// 0: nothing. Cones wider than the face count as wide as it.
double cross_section(const BoxShadow& shadow, uint32_t face) {
  const int axis = static_cast<int>(face / 2), u = (axis + 1) % 3, v = (axis + 2) % 3;
  const double forward = face % 2 != 0 ? -1 : 1;
  std::array<double, 2> low{-1, -1}, high{1, 1};
  for (const HalfSpace& side : shadow.sides()) {
    const double along = side.normal[axis] * forward;
    for (size_t k = 0; k < 2; ++k) {
      const double a = side.normal[k == 0 ? u : v], other = side.normal[k == 0 ? v : u];
      if (other != 0 || a == 0) continue;
      a > 0 ? high[k] = std::min(high[k], -along / a) : low[k] = std::max(low[k], -along / a);
    }
  }
  return std::max(0.0, high[0] - low[0]) * std::max(0.0, high[1] - low[1]);
}

}  // namespace

std::vector<ShrunkOccluder> shrunk_occluders(const Box& cell, std::span<const Box> solids) {
  std::vector<ShrunkOccluder> occluders;
  for (const Box& solid : solids) {
    if (solid.overlaps(cell)) continue;
    const BoxShadow shadow(cell, solid);
    const glm::dvec3 way = glm::dvec3(solid.center()) - glm::dvec3(cell.center());
    ShrunkOccluder best{shadow, 0, 0, 0, 0, 0};
    for (uint32_t face = 0; face < BoxView::kFaces; ++face) {
      const int axis = static_cast<int>(face / 2);
      const bool down = face % 2 != 0;
      const float front = down ? solid.max[axis] : solid.min[axis];
      if (down ? front >= cell.min[axis] : front <= cell.max[axis]) continue;
      const double cross = cross_section(shadow, face);
      if (!(cross > best.cross)) continue;
      const double far = std::abs(way[axis]);
      best = {shadow, face, way[(axis + 1) % 3] / far, way[(axis + 2) % 3] / far, cross, double(front)};
    }
    if (best.cross > 0) occluders.push_back(best);
  }
  return occluders;
}

glm::dvec3 projection_point(const Box& cell, const Box& world, std::span<const ShrunkOccluder* const> occluders) {
  const glm::dvec3 middle(cell.center());
  if (occluders.empty()) return middle;
  const double far = double(world.diagonal());
  glm::dvec3 stiffness(0), sum(0);
  std::vector<HalfSpace> sides;
  for (const ShrunkOccluder* occluder : occluders) {
    const int axis = static_cast<int>(occluder->face / 2);
    const bool down = occluder->face % 2 != 0;
    glm::dvec3 wanted = middle, along(kLoose);
    wanted[axis] += down ? far : -far, along[axis] = 1;
    const std::span<const HalfSpace> own = occluder->shadow.sides();
    const glm::dvec3 best = closest_in_half_spaces(own, wanted, along, middle);
    const double end = down ? double(world.min[axis]) : double(world.max[axis]);
    const double weight = occluder->cross * std::max(std::abs(end - occluder->front), 1e-3);
    stiffness[axis] += weight, sum[axis] += weight * best[axis];
    sides.insert(sides.end(), own.begin(), own.end());
  }
  const double most = std::max({stiffness.x, stiffness.y, stiffness.z});
  const glm::dvec3 loose(most * kLoose);
  return closest_in_half_spaces(sides, (sum + loose * middle) / (stiffness + loose), stiffness + loose, middle);
}

}  // namespace promenade
