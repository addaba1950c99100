#pragma once
// A chunk's triangles divided into the leaves of the HLOD tree.

#include <cstdint>
#include <vector>

#include "geometry/mesh.h"
#include "preprocess/level_factors.h"

namespace promenade {

/// Nodes of a chunk, the root first, parents before their children.
struct SplitTree {
  struct Node {
    std::vector<uint32_t> children;   ///< empty: a leaf
    std::vector<uint32_t> triangles;  ///< of a leaf: indices into the mesh, ascending
    Box cell;                         ///< between the planes around it; what was not cut reaches beyond
  };
  std::vector<Node> nodes;
};

/// Divides by planes across the longest extent of the triangles' centroids, so that leaves hold at most node_triangles
/// and most of them hold nearly as many; inner nodes have 2 to one and a half times their level's factor children.
/// Triangles stay whole, on their centroid's side of a plane; planes lie on the lattice of cut_step_m (lattice_cut.h)
/// where they can. Ends for any triangles, also when all lie in one place. Deterministic. The halves of a cut are
/// divided at once, by tasks of TBB.
SplitTree split_chunk(const Mesh& mesh, const Box& cell, uint32_t node_triangles, const LevelFactors& factors,
                      float cut_step_m = 0);

}  // namespace promenade
