#pragma once
// Meshes grown triangle by triangle, each across an edge of one that is known, with places instead of vertices: corners
// share a place though their looks differ. All by adaptive choices.

#include <cstddef>
#include <span>
#include <vector>

#include "codec/quantized_mesh.h"
#include "geometry/result.h"

namespace promenade {

struct GrownMesh {
  std::vector<std::byte> bytes;
  uint32_t vertices = 0;  ///< that decoding will give
};

/// Triangles of a run, and vertices, in the order in which they grow. Deterministic.
GrownMesh encode_grown(const QuantizedMesh& mesh);

/// `mesh` comes with every field but the arrays of vertices and indices, which are filled: `vertices` and `triangles`
/// of them, with the attributes asked for. Safe on any bytes.
Status decode_grown(std::span<const std::byte> bytes, size_t vertices, size_t triangles, bool normals, bool texcoords,
                    bool colors, QuantizedMesh& mesh);

}  // namespace promenade
