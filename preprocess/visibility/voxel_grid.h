#pragma once
// A box of space in cubes, and which of them a triangle touches.

#include <algorithm>
#include <array>
#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include "geometry/box.h"

namespace promenade {

/// Cubes of side step_m from box.min on; the last ones may reach beyond box.max.
struct VoxelGrid {
  Box box;
  float step_m = 1;
  glm::ivec3 count{0};

  /// The finest grid over the box with at most max_voxels cubes; max_voxels below 2^32.
  static VoxelGrid over(const Box& box, uint64_t max_voxels);

  size_t size() const { return size_t(count.x) * size_t(count.y) * size_t(count.z); }
  size_t index(const glm::ivec3& at) const {
    return (size_t(at.z) * size_t(count.y) + size_t(at.y)) * size_t(count.x) + size_t(at.x);
  }
  glm::ivec3 at(size_t index) const {
    const size_t row = index / size_t(count.x);
    return {static_cast<int>(index % size_t(count.x)), static_cast<int>(row % size_t(count.y)),
            static_cast<int>(row / size_t(count.y))};
  }
  bool holds(const glm::ivec3& at) const {
    return at.x >= 0 && at.y >= 0 && at.z >= 0 && at.x < count.x && at.y < count.y && at.z < count.z;
  }
  /// The cube that holds a point, which may lie outside the grid.
  glm::ivec3 place(const glm::vec3& p) const { return glm::ivec3(glm::floor((p - box.min) / step_m)); }
  /// The nearest cube of the grid.
  glm::ivec3 clamped(const glm::ivec3& at) const { return glm::clamp(at, glm::ivec3(0), count - 1); }
  glm::vec3 center(const glm::ivec3& at) const { return box.min + (glm::vec3(at) + 0.5F) * step_m; }
};

/// Three corners of a triangle.
using Corners = std::array<glm::vec3, 3>;

/// Whether a triangle and a cube have a point in common; true also when they nearly have. Separating axes: the cube's,
/// the triangle's normal, and the cross products of their edges.
bool triangle_touches_cube(const Corners& triangle, const glm::vec3& center, float side);

/// Calls visit(glm::ivec3) for every cube that the triangle touches.
template <class Visit>
void for_each_touched(const VoxelGrid& grid, const Corners& triangle, Visit visit) {
  const glm::ivec3 low = grid.clamped(grid.place(glm::min(glm::min(triangle[0], triangle[1]), triangle[2])));
  const glm::ivec3 high = grid.clamped(grid.place(glm::max(glm::max(triangle[0], triangle[1]), triangle[2])));
  const bool one = low == high;
  for (int z = low.z; z <= high.z; ++z)
    for (int y = low.y; y <= high.y; ++y)
      for (int x = low.x; x <= high.x; ++x)
        if (const glm::ivec3 at(x, y, z); one || triangle_touches_cube(triangle, grid.center(at), grid.step_m))
          visit(at);
}

}  // namespace promenade
