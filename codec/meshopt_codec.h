#pragma once
// Connectivity by meshoptimizer's index codec, vertices by vertex_streams.h; meant to be compressed further.

#include <cstddef>
#include <span>
#include <vector>

#include "codec/quantized_mesh.h"
#include "geometry/result.h"

namespace promenade {

/// Reorders triangles within their runs, and vertices, for small code, then encodes them. Deterministic.
std::vector<std::byte> encode_meshopt(QuantizedMesh mesh);

/// `mesh` comes with every field but the arrays of vertices and indices, which are filled: `vertices` and `triangles`
/// of them, with the attributes asked for. Safe on any bytes.
Status decode_meshopt(std::span<const std::byte> bytes, size_t vertices, size_t triangles, bool normals, bool texcoords,
                      bool colors, QuantizedMesh& mesh);

}  // namespace promenade
