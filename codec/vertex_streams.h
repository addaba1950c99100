#pragma once
// Vertices as small differences from what their triangles let expect, in streams that compress well.

#include <cstddef>
#include <span>
#include <vector>

#include "codec/byte_io.h"
#include "codec/quantized_mesh.h"
#include "geometry/result.h"

namespace promenade {

/// Appends the vertices of a mesh whose vertices are numbered in the order of their first use by the triangles (within
/// a triangle in any order). Every vertex must be used.
void put_vertices(const QuantizedMesh& mesh, ByteWriter& writer);

/// Fills the arrays of vertices that are asked for, by mesh.indices, which are there already. Reads to the end. Safe on
/// any bytes.
Status get_vertices(ByteReader& reader, size_t vertices, bool normals, bool texcoords, bool colors,
                    QuantizedMesh& mesh);

}  // namespace promenade
