#pragma once
// What happens to a node's mesh besides simplification: attributes that say nothing go, plain colours move into the
// vertices, texels are measured.

#include <cstdint>
#include <functional>
#include <vector>

#include "geometry/mesh.h"

namespace promenade {

/// Drops attributes that say nothing: texture coordinates where no triangle is textured, colours that are all white,
/// normals that are everywhere the triangle's own (within half a degree). Triangles whose normals are their own get
/// normals of 0, so that flat things need no vertex for each side.
void drop_idle_attributes(Mesh& mesh, const std::function<bool(uint32_t material)>& is_textured);

/// Moves untextured triangles' material colours into their vertices and gives them the material `plain_of` theirs, so
/// that triangles of any colours can be simplified together. Vertices split where colours meet. Textured triangles
/// (`plain_of` returns their own material) stay as they are.
void fold_colors(Mesh& mesh, const std::vector<Material>& materials,
                 const std::function<uint32_t(uint32_t material)>& plain_of);

/// Side of a texel on the surface, in metres, for the triangles of one material with a picture of width x height: from
/// their total areas. 0 when they have no area on the picture.
double texel_size_m(const Mesh& mesh, uint32_t material, uint32_t width, uint32_t height);

/// The same, but of the triangles with the largest texels, a hundredth of the area aside: where a picture is a palette,
/// triangles see a point of it each, and a smaller picture would show them what lies beside it. 0 where they see no
/// area.
double largest_texel_m(const Mesh& mesh, uint32_t material, uint32_t width, uint32_t height);

/// Whether rounding to the grid would take away surface that nothing else stands for: a triangle without thickness on
/// the grid, such as a side of a thin post, that is no edge and no corner of any triangle that remains.
bool loses_surface_on_grid(const Mesh& mesh, float step_m);

/// Materials that occur, ascending.
std::vector<uint32_t> materials_of(const Mesh& mesh);

/// Area-weighted mean of the triangles' normals, unit, or 0. Source: [lakhia2004] section 3.3.
glm::vec3 average_normal(const Mesh& mesh);

/// Rounds red, green and blue to 64 values, the first 0 and the last 255: at most 2 off. For meshes that are drawn
/// where their own shape is a pixel off.
void round_colors(Mesh& mesh);

}  // namespace promenade
