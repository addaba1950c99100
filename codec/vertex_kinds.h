#pragma once
// Positions and normals by kinds: one byte a vertex says what each is like, and only what is like nothing known is told
// as a difference. What people build repeats its coordinates, so that most are.

#include <vector>

#include "codec/byte_io.h"
#include "codec/quantized_mesh.h"
#include "codec/vertex_guesses.h"
#include "geometry/result.h"

namespace promenade {

/// twins: for each vertex how many vertices back one in the same place is, which is not told again; 0: none. wide:
/// numbers take 32 bits, otherwise 16. Pure; any thread.
void put_positions(const std::vector<glm::u32vec3>& positions, const std::vector<Guess>& guesses,
                   const std::vector<uint32_t>& twins, bool wide, ByteWriter& writer);

/// Fills `positions`. Safe on any bytes, as long as twins are no further back than the vertices go.
Status get_positions(ByteReader& reader, const std::vector<Guess>& guesses, const std::vector<uint32_t>& twins,
                     bool wide, std::vector<glm::u32vec3>& positions);

/// mesh: with its positions. Normals are foretold by the triangles around. Pure; any thread.
void put_normals(const QuantizedMesh& mesh, const std::vector<Guess>& guesses, const std::vector<uint32_t>& twins,
                 ByteWriter& writer);

/// Fills mesh.normals, by its positions and indices. Safe on any bytes, as get_positions.
Status get_normals(ByteReader& reader, const std::vector<Guess>& guesses, const std::vector<uint32_t>& twins,
                   QuantizedMesh& mesh);

}  // namespace promenade
