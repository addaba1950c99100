#include "preprocess/visibility/voxel_grid.h"

#include <cmath>

namespace promenade {

VoxelGrid VoxelGrid::over(const Box& box, uint64_t max_voxels) {
  const glm::dvec3 size = glm::max(glm::dvec3(box.max) - glm::dvec3(box.min), glm::dvec3(1e-6));
  const auto counts = [&size](double step) { return glm::ceil(size / step); };
  const auto fits = [&](double step) {
    const glm::dvec3 n = counts(step);
    return n.x * n.y * n.z <= double(std::max<uint64_t>(max_voxels, 1));
  };
  // Between a step that is too small by its volume alone and one cube.
  double low = std::cbrt(size.x * size.y * size.z / double(std::max<uint64_t>(max_voxels, 1)));
  double high = std::max({size.x, size.y, size.z});
  for (int i = 0; i < 40; ++i) {
    const double middle = (low + high) / 2;
    (fits(middle) ? high : low) = middle;
  }
  VoxelGrid grid;
  grid.box = box;
  grid.step_m = static_cast<float>(high);
  grid.count = glm::max(glm::ivec3(counts(high)), glm::ivec3(1));
  return grid;
}

bool triangle_touches_cube(const Corners& triangle, const glm::vec3& center, float side) {
  const float half = side * 0.5001F;  // rounding must not lose a cube
  const Corners p = {triangle[0] - center, triangle[1] - center, triangle[2] - center};
  const auto separates = [&p, half](const glm::vec3& axis) {
    const float a = glm::dot(p[0], axis), b = glm::dot(p[1], axis), c = glm::dot(p[2], axis);
    const float reach = half * (std::abs(axis.x) + std::abs(axis.y) + std::abs(axis.z));
    return std::min({a, b, c}) > reach || std::max({a, b, c}) < -reach;
  };
  const std::array<glm::vec3, 3> axes = {glm::vec3(1, 0, 0), glm::vec3(0, 1, 0), glm::vec3(0, 0, 1)};
  for (const glm::vec3& axis : axes)
    if (separates(axis)) return false;
  const std::array<glm::vec3, 3> edges = {p[1] - p[0], p[2] - p[1], p[0] - p[2]};
  if (separates(glm::cross(edges[0], edges[1]))) return false;
  for (const glm::vec3& edge : edges)
    for (const glm::vec3& axis : axes)
      if (separates(glm::cross(edge, axis))) return false;
  return true;
}

}  // namespace promenade
