#pragma once
// What triangles in a wall's plane leave open of a rectangle of it.

#include <array>
#include <glm/vec2.hpp>
#include <vector>

namespace promenade {

using FlatTriangle = std::array<glm::vec2, 3>;

struct WallOpening {
  glm::dvec2 low, high;
};

/// Of the triangles that cover a wall: each reaches a millimetre beyond its sides, for neighbours are rounded apart.
/// And what ends this near to the rectangle's border is taken to reach it, for planes are as far off: what is narrower
/// than two millimetres is closed, nothing else.
constexpr double kWallRimM = 0.001;

/// All of the rectangle that no triangle covers lies within these. They are told in squares of at least step_m and a
/// 4096th of the rectangle's side, those that triangles cover but for a slit more exactly. At most so many: beyond,
/// some are united with what lies between them. Triangles: any winding; they come back in order, which the openings do
/// not depend on. Pure; any thread.
std::vector<WallOpening> find_wall_openings(const glm::dvec2& low, const glm::dvec2& high,
                                            std::vector<FlatTriangle>& triangles, double step_m, size_t most);

}  // namespace promenade
