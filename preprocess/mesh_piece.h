#pragma once
// Triangles of a mesh on their way to nodes.

#include <cstdint>
#include <span>
#include <vector>

#include "geometry/mesh.h"

namespace promenade {

/// Coordinate of a triangle's centroid.
glm::vec3 centroid(const Mesh& mesh, uint32_t triangle);

/// Like submesh, in time that depends on the piece only. Vertices come in the order of their first use.
Mesh piece_of(const Mesh& mesh, std::span<const uint32_t> triangles);

}  // namespace promenade
