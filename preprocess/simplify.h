#pragma once
// One step up the HLOD tree: the children's surface with fewer triangles.

#include <cstdint>
#include <functional>
#include <vector>

#include "geometry/mesh.h"
#include "preprocess/border.h"
#include "preprocess/surface_distance.h"

namespace promenade {

struct SimplifyOptions {
  uint32_t target_triangles = 2000;
  /// How many triangles come to such a mesh with such a border besides, as fins do: the target counts them. May be
  /// asked of a mesh without some of its parts, where these have no border. Unset: none.
  std::function<size_t(const Mesh& mesh, const Border& border)> besides = {};
};

struct SimplifyFigures {
  float sheet_height_m = 0;  ///< how far sheets lie above what they are painted on; 0: there are none
  float reached_m = 0;       ///< the largest distance that simplification knows of
};

/// Simplifies an arbitrary soup: disjoint parts, non-manifold edges, attribute seams, thin walls. A queue of edge
/// collapses and removals of whole disjoint parts is worked off, cheapest first; both cost metres, measured by the
/// points that they leave behind, so the largest distance grows as slowly as the queue can tell. How far the result is
/// in the end, surface_distance says.
///
/// The target is always reached for a mesh with more: when nothing else is left borders are freed, then triangles may
/// flip, then the smallest go. Flat patches of another colour, such as panes in a wall, are lifted off and become
/// sheets of their own, so that the wall can close beneath them; sheets lie above what they are painted on in the end,
/// by `sheet_height_m`, which a grid should not exceed. A wall and its panes, and other reliefs, are pressed onto one
/// plane between them. All other positions, and those on borders, are the mesh's own, bit by bit; normals, colours,
/// texture coordinates and materials of what remains are taken from it, but a normal that would light the wrong side
/// becomes its triangle's own. A mesh that is at the target already, with what comes besides, comes back as it is; else
/// degenerate and repeated triangles go first, so that nothing remains of a mesh that has only degenerate ones.
/// find_defect(mesh) empty. Deterministic. Pure; any thread.
///
/// border: becomes that of the result; the same as before where the mesh comes back as it is.
Mesh simplify(const Mesh& mesh, const SimplifyOptions& options, Border& border, SimplifyFigures* figures = nullptr);
Mesh simplify(const Mesh& mesh, const SimplifyOptions& options, SimplifyFigures* figures = nullptr);

}  // namespace promenade
