#pragma once
// How far two surfaces are apart, measured.

#include "geometry/closest_point.h"
#include "geometry/mesh.h"

namespace promenade {

struct SurfaceDistance {
  float bound_m = 0;  ///< upper bound of the two-sided Hausdorff distance, rounding included
  float p99_m = 0;    ///< 99th percentile of area-weighted samples, of the worse direction; <= bound_m
};

/// Upper bound (within `slack` of the exact value, or of tolerance_m absolutely, whichever is larger) of the two-sided
/// Hausdorff distance between two meshes: vertices queried, then triangles cut up until convexity bounds them. What
/// rounding may hide is added: about 1e-5 of the meshes' diagonal. Input that would take too many cuts gets a looser
/// bound, never a wrong one. Both must have triangles. Deterministic. Pure; any thread.
SurfaceDistance surface_distance(const Mesh& a, const Mesh& b, double slack = 0.25, double tolerance_m = 0);

/// The same for callers that have the trees already.
SurfaceDistance surface_distance(const Mesh& a, const ClosestPointTree& tree_a, const Mesh& b,
                                 const ClosestPointTree& tree_b, double slack = 0.25, double tolerance_m = 0);

}  // namespace promenade
