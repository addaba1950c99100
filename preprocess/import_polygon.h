#pragma once
// Polygons with holes to triangles.

#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

namespace promenade {

/// What came of a polygon.
struct Triangulation {
  std::vector<uint32_t> corners;  ///< three a triangle: places in the points given, fronts as the outer ring's
  bool non_planar = false;        ///< a point is off the plane by more than a thousandth of the polygon's size
  bool unclean = false;           ///< it crosses itself, or a hole lies outside: covered as well as can be
};

/// Triangulates a polygon in space. points: all rings one after the other, the outer one first; ring_sizes: how many
/// points each has. The outer ring is counter-clockwise seen from the front; holes may turn either way. Ear clipping
/// in the plane of the outer ring's Newell normal, holes joined by bridges [eberly2002]; a polygon without area gives
/// no triangle. Every point that lies on a straight edge stays a corner, so that neighbours meet without gaps. Work is
/// bounded whatever the input. Deterministic. Pure; any thread.
Triangulation triangulate(std::span<const glm::dvec3> points, std::span<const uint32_t> ring_sizes);

}  // namespace promenade
