#pragma once
// A chunk's triangles divided into the leaves of the HLOD tree.

#include <cstdint>
#include <vector>

#include "geometry/mesh.h"

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
/// and most of them hold nearly as many; inner nodes have 2 to level_factor children. Triangles with an edge longer
/// than half a leaf are cut by the planes (new ones are added to the mesh), all others stay whole, on their
/// centroid's side. Ends for any triangles, also when all lie in one place. Deterministic. One thread.
SplitTree split_chunk(Mesh& mesh, const Box& cell, uint32_t node_triangles, uint32_t level_factor);

}  // namespace promenade
