#pragma once
// Tiny scenes with known pictures. The camera stands in the origin and looks along +x; z is up, y to the left.

#include <vector>

#include "geometry/camera.h"
#include "geometry/mesh.h"

namespace promenade::scenes {

inline Camera looking_along_x(uint32_t side_px = 64) {
  Camera camera;
  camera.width_px = side_px;
  camera.height_px = side_px;
  camera.vertical_fov_deg = 90;
  camera.near_m = 0.1;
  return camera;
}

/// A square of the given half side across the view at distance x, centred, its front to the camera (unless `away`),
/// texture coordinates from (0, 0) at the picture's top left to (1, 1).
inline Mesh square_at(float x, float half_side, bool away = false) {
  Mesh mesh;
  mesh.positions = {
      {x, half_side, half_side}, {x, half_side, -half_side}, {x, -half_side, -half_side}, {x, -half_side, half_side}};
  mesh.texcoords = {{0, 0}, {0, 1}, {1, 1}, {1, 0}};
  mesh.indices = {0, 1, 2, 0, 2, 3};
  if (away) mesh.indices = {0, 2, 1, 0, 3, 2};
  return mesh;
}

inline Material colored(uint8_t r, uint8_t g, uint8_t b, uint8_t a = 255) {
  Material material;
  material.color = {r, g, b, a};
  if (a < 255) material.alpha = AlphaMode::blend;
  return material;
}

inline Image filled(uint32_t side, glm::u8vec4 color) {
  return {side, side, std::vector<glm::u8vec4>(size_t(side) * side, color)};
}

}  // namespace promenade::scenes
