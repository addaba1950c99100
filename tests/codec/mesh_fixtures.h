#pragma once
// Meshes with known answers.

#include <cmath>
#include <glm/geometric.hpp>
#include <map>
#include <string>

#include "geometry/mesh.h"

namespace promenade {

inline Mesh one_triangle() {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 2, 0.5F}};
  mesh.indices = {0, 1, 2};
  return mesh;
}

/// Every attribute; flat sides; a material a side.
inline Mesh textured_cube() {
  Mesh mesh;
  for (int side = 0; side < 6; ++side) {
    const int axis = side / 2;
    const float sign = side % 2 == 0 ? 1.0F : -1.0F;
    glm::vec3 normal(0), u(0), v(0);
    normal[axis] = sign;
    u[(axis + 1) % 3] = sign;
    v[(axis + 2) % 3] = 1;
    const auto base = static_cast<uint32_t>(mesh.positions.size());
    for (int corner = 0; corner < 4; ++corner) {
      const float s = corner == 1 || corner == 2 ? 1.0F : -1.0F, t = corner >= 2 ? 1.0F : -1.0F;
      mesh.positions.push_back(3.3F * (normal + s * u + t * v));
      mesh.normals.push_back(normal);
      mesh.texcoords.emplace_back(s * 0.5F + 0.5F, t * 0.7F);
      mesh.colors.emplace_back(side * 40, corner * 60, 7, 255 - side);
    }
    for (const uint32_t i : {0U, 1U, 2U, 0U, 2U, 3U}) mesh.indices.push_back(base + i);
    mesh.materials.insert(mesh.materials.end(), 2, 5U - static_cast<uint32_t>(side));
  }
  return mesh;
}

/// A hilly square of 2 * side * side triangles with shared vertices, smooth normals and texture coordinates.
inline Mesh hills(uint32_t side, float size_m = 50) {
  Mesh mesh;
  const auto height = [](float x, float y) { return 3 * std::sin(x * 0.31F) * std::cos(y * 0.23F); };
  for (uint32_t j = 0; j <= side; ++j)
    for (uint32_t i = 0; i <= side; ++i) {
      const float x = size_m * float(i) / float(side), y = size_m * float(j) / float(side);
      mesh.positions.emplace_back(x, y, height(x, y));
      const float dx = (height(x + 0.01F, y) - height(x - 0.01F, y)) / 0.02F;
      const float dy = (height(x, y + 0.01F) - height(x, y - 0.01F)) / 0.02F;
      mesh.normals.push_back(glm::normalize(glm::vec3(-dx, -dy, 1)));
      mesh.texcoords.emplace_back(float(i) / float(side), float(j) / float(side));
    }
  for (uint32_t j = 0; j < side; ++j)
    for (uint32_t i = 0; i < side; ++i) {
      const uint32_t a = j * (side + 1) + i, b = a + side + 1;
      for (const uint32_t v : {a, a + 1, b, b, a + 1, b + 1}) mesh.indices.push_back(v);
    }
  return mesh;
}

/// Neighbouring triangles never share a material.
inline Mesh hills_of_many_materials() {
  Mesh mesh = hills(12);
  for (uint32_t t = 0; t < mesh.triangle_count(); ++t) mesh.materials.push_back((t * 7919) % 61 * 1000003);
  return mesh;
}

/// Far from the origin, where floats are coarse.
inline Mesh hills_far_away() {
  Mesh mesh = hills(8);
  for (glm::vec3& p : mesh.positions) p += glm::vec3(400000, -123456, 900);
  return mesh;
}

/// Three triangles at one edge, one of them twice, and two that only share a corner.
inline Mesh non_manifold_fan() {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {5, 0, 0}, {5, 1, 0}};
  mesh.indices = {0, 1, 2, 0, 1, 3, 0, 1, 4, 0, 1, 4, 0, 5, 6};
  return mesh;
}

inline std::map<std::string, Mesh> mesh_fixtures() {
  return {{"empty", Mesh{}},
          {"one_triangle", one_triangle()},
          {"textured_cube", textured_cube()},
          {"hills", hills(24)},
          {"hills_of_many_materials", hills_of_many_materials()},
          {"hills_far_away", hills_far_away()},
          {"non_manifold_fan", non_manifold_fan()}};
}

}  // namespace promenade
