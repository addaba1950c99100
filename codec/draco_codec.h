#pragma once
// A quantised mesh by Draco's edgebreaker and its predictors: the smallest code, the slowest to decode.

#include <cstddef>
#include <span>
#include <vector>

#include "codec/quantized_mesh.h"
#include "geometry/result.h"

namespace promenade {

/// Deterministic. Errors: what Draco reports.
Result<std::vector<std::byte>> encode_draco(const QuantizedMesh& mesh);

/// `mesh` comes with every field but the runs and the arrays of vertices and indices, which are filled and tidied.
/// Checks what Draco's header claims (at most `triangles`, and vertices for them) before Draco allocates. Draco was not
/// made for hostile bytes: its known faults are caught as far as its interface allows.
Status decode_draco(std::span<const std::byte> bytes, size_t triangles, bool normals, bool texcoords, bool colors,
                    QuantizedMesh& mesh);

}  // namespace promenade
