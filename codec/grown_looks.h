#pragma once
// Normals, texture coordinates and colours of a grown mesh, by the vertices that each was met with. FORMAT.md says how.

#include <vector>

#include "codec/grown_kin.h"
#include "codec/quantized_mesh.h"
#include "codec/told_number.h"

namespace promenade {

/// Of all vertices, in order. A PutSide tells what is in the mesh, a GetSide fills it. Positions and indices are there
/// already. False: what is told cannot be.
template <class Side>
bool tell_normals(Side& side, const std::vector<VertexKin>& kin, QuantizedMesh& mesh);
template <class Side>
bool tell_texcoords(Side& side, const std::vector<VertexKin>& kin, QuantizedMesh& mesh);
template <class Side>
bool tell_colors(Side& side, const std::vector<VertexKin>& kin, QuantizedMesh& mesh);

}  // namespace promenade
