#pragma once
// An inner node's texture: its detailed surface's look, baked to an atlas of its own.

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "geometry/mesh.h"
#include "geometry/result.h"

namespace promenade {

/// In texels: a point lies at most half a texel's diagonal from the texel's centre.
constexpr double kTexelReach = 0.7072;

struct BakeOptions {
  /// Wanted side of a texel on the surface, in metres, > 0. Smaller: sharper and larger atlases.
  double texel_m = 0.1;
  /// Longest side of the atlas, 16 to 16384. What does not fit is baked with larger texels.
  uint32_t max_side_px = 1024;
  /// Texels around each chart that repeat its border, so that filters do not see the neighbouring chart. 1 to 16.
  uint32_t padding_px = 2;
};

struct BakedMesh {
  /// The simplified mesh: texture coordinates into the atlas, in [0, 1]; vertices split where charts meet; no materials
  /// (one for the whole mesh: white, the atlas, clamped); no colours, they are in the atlas. Triangles keep their
  /// order.
  Mesh mesh;
  /// At most max_side_px on each side. Clear texels only where the detailed surface is cut out or see-through.
  Image atlas;
  double texel_m = 0;        ///< what the texel's side came to, at least what was wanted
  bool has_opacity = false;  ///< some texel inside a chart has opacity below 255
  /// By triangle: opaque where the middles of all its texels are (its centroid, where it has none), otherwise what lets
  /// them be seen through (blend before mask).
  std::vector<AlphaMode> alpha;
};

/// Bakes materials, vertex colours and textures of `detailed` (the children's meshes together, find_defect empty) onto
/// `simplified` (the same surface with fewer triangles). Each texel takes the colour of the nearest point of `detailed`
/// that faces the same way (the nearest at all where none does, or where it is two-sided), seen through a filter as
/// large as the texel. materials: what detailed.materials index. picture: a material's texture by its index, or null
/// when it is missing (then the material's colour alone); called from this thread only. Errors: no triangles, options
/// out of range, a mesh that cannot be packed. Deterministic. Pure; any thread.
Result<BakedMesh> bake_atlas(const Mesh& simplified, const Mesh& detailed, std::span<const Material> materials,
                             const std::function<const Image*(uint32_t texture)>& picture, const BakeOptions& options);

}  // namespace promenade
