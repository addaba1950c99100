#pragma once
// Flat patches of another colour within a surface, such as panes in a wall: lifted off, they become sheets of their
// own, and the surface below goes on without them.

#include <cstdint>
#include <vector>

#include "preprocess/work_mesh.h"

namespace promenade {

/// Triangles of a patch or a sheet at most: larger ones are surfaces in their own right.
constexpr size_t kMostSheetTriangles = 16;

/// While a patch is woven into the wall around it, every corner of its outline holds a place and some eight triangles
/// of wall. Lifted, it takes two, and the wall closes beneath it.
struct Patch {
  std::vector<uint32_t> triangles;  ///< as the work mesh numbers them
  std::vector<uint32_t> ground;     ///< for each of their corners: the source vertex to show once the patch is lifted
  std::vector<uint32_t> outline;    ///< places on it
  uint32_t first_copy = 0;          ///< of as many triangles at the work mesh's end, with places of their own
};

/// Finds what may be lifted: connected flat triangles of one colour and one material, a few of them, bordered by other
/// colours of the same material along most of their outline; of two such that border on each other, one. Adds a copy of
/// each to the mesh, with places of its own and not alive. Deterministic. Linear time but for places with many
/// triangles.
std::vector<Patch> add_patches(WorkMesh& work, const Mesh& source);

/// The copy comes alive, what was there takes the colour of what is around it. stands_for: as WorkMesh::alive.
void lift(const Patch& patch, WorkMesh& work, uint8_t stands_for = 1);

/// Moves flat sheets (parts of few triangles that share no place with others) along their normals to at least
/// `height_m` above surfaces of another colour that face the same way and cover them, or lie less below them: so that
/// neither simplification nor rounding to a grid as wide as that hides paint beneath what it is painted on. Sheets that
/// lie on each other stay stacked as they were. may_rise: of each triangle. reach_m: covers farther away do not count.
/// Only alive triangles; moves positions and model positions. Returns whether anything moved.
bool raise_sheets(WorkMesh& work, const Mesh& source, const std::vector<uint8_t>& may_rise, float height_m,
                  float reach_m);

}  // namespace promenade
