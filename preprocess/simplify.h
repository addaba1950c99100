#pragma once
// One step up the HLOD tree: the children's surface with fewer triangles.

#include <cstdint>
#include <vector>

#include "geometry/mesh.h"
#include "preprocess/surface_distance.h"

namespace promenade {

struct SimplifyOptions {
  uint32_t target_triangles = 2000;
  /// Vertices that lie on these boxes' faces are borders to a neighbouring node: moved only as `free_borders` allows.
  Box cell;                  ///< the node's cell of the partition; empty: no borders
  bool lock_borders = true;  ///< keep border vertices where they are while that leaves room under the target
};

/// Simplifies an arbitrary soup: disjoint parts, non-manifold edges, attribute seams, thin walls. The result is sound
/// and has at most max(target, what cannot be removed) triangles: the target is always reached for a mesh with more, by
/// removing whole small parts and by clustering if need be. Normals, colours, texture coordinates and materials of what
/// remains are taken from the given mesh. Deterministic. Pure; any thread.
Mesh simplify(const Mesh& mesh, const SimplifyOptions& options);

}  // namespace promenade
