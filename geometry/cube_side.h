#pragma once
// The sides of a cube around an eye, as pictures: 0 to 5 look along +x, -x, +y, -y, +z, -z.

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

namespace promenade {

struct CubeSide {
  glm::dvec3 forward{0}, right{0}, up{0};  ///< unit, along axes
};

/// The sides have z up; +z has -x up, -z has +x up.
inline CubeSide cube_side(uint32_t side) {
  CubeSide s;
  s.forward[static_cast<int>(side / 2)] = side % 2 == 0 ? 1 : -1;
  s.up = side == 4 ? glm::dvec3(-1, 0, 0) : side == 5 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 0, 1);
  s.right = glm::cross(s.forward, s.up);
  return s;
}

}  // namespace promenade
