#pragma once
// Normals, texture coordinates and colours of a grown mesh, by the vertices that each was met with. FORMAT.md says how.

#include <array>
#include <cstdint>
#include <vector>

#include "codec/quantized_mesh.h"
#include "codec/told_number.h"
#include "codec/vertex_guesses.h"

namespace promenade {

/// What a vertex was met with.
struct VertexKin {
  Guess guess;            ///< a: the one that it is likely to look like
  uint32_t twin = kNone;  ///< another in the same place; kNone: it was the first there
  static constexpr uint32_t kNone = 0xffffffffU;
};

/// Of all vertices, in order. A PutSide tells what is in the mesh, a GetSide fills it. Positions and indices are there
/// already. False: what is told cannot be.
template <class Side>
bool tell_normals(Side& side, const std::vector<VertexKin>& kin, QuantizedMesh& mesh);
template <class Side>
bool tell_texcoords(Side& side, const std::vector<VertexKin>& kin, QuantizedMesh& mesh);
template <class Side>
bool tell_colors(Side& side, const std::vector<VertexKin>& kin, QuantizedMesh& mesh);

}  // namespace promenade
