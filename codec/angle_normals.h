#pragma once
// Normals that triangles let expect.

#include <glm/vec2.hpp>
#include <vector>

#include "codec/quantized_mesh.h"

namespace promenade {

/// For vertices that are wanted (not 0) the sum of the normals of the triangles that have them, each weighted by its
/// angle there, as an octahedral code; (0, 0) where that is nothing. Of a mesh on a grid. The same on every machine:
/// doubles, each operation rounded, and no library's functions. FORMAT.md says how. Pure; any thread.
std::vector<glm::i16vec2> normals_by_angle(const QuantizedMesh& mesh, const std::vector<uint8_t>& is_wanted);

}  // namespace promenade
