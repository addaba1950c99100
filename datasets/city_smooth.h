#pragma once
// Smooth meshes with normals: what cars, trees and street furniture are made of.

#include <cstdint>
#include <functional>
#include <glm/mat4x4.hpp>
#include <span>
#include <vector>

#include "datasets/city_shape.h"

namespace promenade {

/// A mesh being built, with a normal and a colour per vertex.
class SmoothShape {
 public:
  void color(const Color& color) { color_ = color; }
  /// What comes next is placed so. Rotation and translation only.
  void place(const glm::mat4& to_from_part) { place_ = to_from_part; }

  void box(const glm::vec3& low, const glm::vec3& high);
  /// A profile of (radius, height) points turned around the z axis at a centre; sharp where it bends by more than 40
  /// degrees. The outside is to the right of the way: upwards.
  void lathe(const glm::vec3& center, std::span<const glm::vec2> profile, int sides);
  /// A sphere whose surface `radius_of` moves in and out, darker below.
  void blob(const glm::vec3& center, const glm::vec3& radii, int rings, int sides,
            const std::function<float(const glm::vec3&)>& radius_of);
  /// A grid of points, rows x columns, smooth all over. `color_of` paints the quad between four neighbours. Front: row
  /// direction x column direction.
  void grid(std::span<const glm::vec3> points, size_t columns,
            const std::function<Color(size_t row, size_t column)>& color_of);

  Mesh take() { return std::move(mesh_); }

 private:
  uint32_t vertex(const glm::vec3& p, const glm::vec3& normal, const Color& color);
  void quad(uint32_t a, uint32_t b, uint32_t c, uint32_t d);

  glm::mat4 place_{1};
  Color color_{255, 255, 255, 255};
  Mesh mesh_;
};

}  // namespace promenade
