#pragma once
// Normal cones: bounds on the directions that a set of triangles faces.

#include <glm/vec3.hpp>

#include "geometry/mesh.h"

namespace promenade {

/// Every triangle normal n of the set has dot(n, axis) >= cos_angle. cos_angle -1: any direction (or two-sided).
struct NormalCone {
  glm::vec3 axis{0, 0, 1};  ///< unit
  float cos_angle = -1;
  bool operator==(const NormalCone&) const = default;
};

/// A small cone over the mesh's triangle normals (the area-weighted mean as axis). Degenerate triangles do not count.
NormalCone normal_cone(const Mesh& mesh);

/// A cone that contains both.
NormalCone merged(const NormalCone& a, const NormalCone& b);

/// True only if every triangle of the set, anywhere in the box, shows its back to the eye. Conservative.
bool faces_away(const NormalCone& cone, const Box& box, const glm::vec3& eye);

}  // namespace promenade
