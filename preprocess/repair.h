#pragma once
// What import mends: numbers that are none, vertices out of range, faces that are nothing or there twice, orientation.

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "geometry/mesh.h"
#include "preprocess/scene.h"

namespace promenade {

using Counts = std::map<std::string, uint64_t>;

/// Removes the faces that use a vertex marked `broken` (one flag a vertex), and then the vertices that no face uses
/// when any went. Returns the faces removed.
uint64_t drop_vertices(Mesh& mesh, const std::vector<bool>& broken);

/// Vertices whose position is not finite, marked; normals, texture coordinates that are not finite are replaced in
/// place (normals by a face's own, the others by 0). Normals are made unit. Adds to vertices_non_finite,
/// attributes_non_finite.
std::vector<bool> mark_non_finite(Mesh& mesh, Counts& counts);

/// Takes instances with transforms that are not finite, or that lie out of range, out of the scene; then vertices out
/// of range and their faces. Range: max_extent_m from the source's middle, the median of its instances' middles, which
/// a few broken numbers cannot move. The scene is in metres. Adds to instances_dropped, vertices_out_of_range,
/// faces_dropped.
void drop_out_of_range(Scene& scene, double max_extent_m);

/// Removes degenerate faces (no area) and duplicates (the same three places with the same winding; two faces back to
/// back both stay), and turns the minority of faces in each connected component so that neighbours agree, where the
/// component says what agrees: edges of more than two faces join nothing, and a component that contradicts itself
/// (a Moebius strip) is left alone. Vertices at the same place count as one for this; vertices that only removed faces
/// used go. Adds to faces_degenerate, faces_duplicate, faces_reoriented.
void repair_mesh(Mesh& mesh, Counts& counts);

/// For each triangle, whether the connected component that it is in is solid: closed (every edge has one face on each
/// side), consistently oriented, its fronts outwards. Vertices at the same place count as one.
std::vector<bool> solid_triangles(const Mesh& mesh);

/// Removes vertices that no face uses.
void drop_unused_vertices(Mesh& mesh);

}  // namespace promenade
