#pragma once
// One step up the HLOD tree: the children's surface with fewer triangles.

#include <cstdint>
#include <vector>

#include "geometry/mesh.h"
#include "preprocess/surface_distance.h"

namespace promenade {

struct SimplifyOptions {
  uint32_t target_triangles = 2000;
  /// Vertices that lie on this box's faces are borders to a neighbouring node: moved only as `lock_borders` allows, and
  /// along the faces rather than off them.
  Box cell;                  ///< the node's cell of the partition; empty: no borders
  bool lock_borders = true;  ///< keep border vertices where they are while they are at most a quarter of the target
};

/// Simplifies an arbitrary soup: disjoint parts, non-manifold edges, attribute seams, thin walls. A queue of edge
/// collapses and removals of whole disjoint parts is worked off, cheapest first; both cost metres, measured by the
/// points that they leave behind, so the largest distance grows as slowly as the queue can tell. How far the result is
/// in the end, surface_distance says.
///
/// The target is always reached for a mesh with more: when nothing else is left borders are freed, then triangles may
/// flip, then the smallest go. Flat patches of another colour, such as panes in a wall, are lifted off and become
/// sheets of their own, so that the wall can close beneath them; sheets lie above what they are painted on in the end,
/// by `sheet_height_m` (0: there are none), which a grid should not exceed. All other positions are the mesh's own, bit
/// by bit; normals, colours, texture coordinates and materials of what remains are taken from it, but a normal that
/// would light the wrong side becomes its triangle's own. A mesh that is at the target already comes back as it is;
/// else degenerate and repeated triangles go first, so that nothing remains of a mesh that has only degenerate ones.
/// find_defect(mesh) empty. Deterministic. Pure; any thread.
Mesh simplify(const Mesh& mesh, const SimplifyOptions& options, float* sheet_height_m = nullptr);

}  // namespace promenade
