#pragma once
// A side of a far picture as a textured mesh.

#include <cstdint>
#include <glm/vec3.hpp>

#include "codec/far_face.h"

namespace promenade {

/// Faces with depths are drawn this part farther from the centre than measured: where a near node reaches beyond the
/// box, it lies before its picture.
constexpr double kFarPush = 1.0 / 512;

/// Where a face stands.
struct FarPlace {
  glm::dvec3 centre{0};  ///< of the view cell, metres, model space
  double box_m = 0;      ///< length of the box
  uint32_t side = 0;     ///< geometry/cube_side.h
  bool pushed = false;   ///< by kFarPush
};

/// The triangles that show something, fronts towards the centre. Texture coordinates of the face's picture; no normals;
/// material 0: all of the triangle shows something, as far as filters reach; 1: not all, look at its opacity. At most
/// grid vertices and twice its squares. Any thread.
Mesh far_mesh(const FarFace& face, const FarPlace& place);

/// How many triangles that are.
uint32_t far_triangles(const FarFace& face);

}  // namespace promenade
