#pragma once
// Borders: where a node's surface goes on in other nodes', and what the source had there.

#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "geometry/mesh.h"

namespace promenade {

/// An edge that one triangle of its node alone has.
struct BorderEdge {
  uint32_t corner = 0;      ///< of the mesh: the edge goes from it to its triangle's next one
  uint32_t passed_end = 0;  ///< its points in Border::passed end here, and begin where the edge before it has its end
};

/// The line along which leaves meet is one and the same for both: the source's. Simplification takes points out of it,
/// for either side by itself; what it has taken is remembered, so that the line can be had back.
struct Border {
  std::vector<BorderEdge> edges;
  std::vector<glm::vec3> passed;  ///< points of the source's line between an edge's ends, bit by bit, in its direction
  std::span<const glm::vec3> passed_by(size_t edge) const {
    const uint32_t first = edge == 0 ? 0 : edges[edge - 1].passed_end;
    return std::span(passed).subspan(first, edges[edge].passed_end - first);
  }
};

/// The borders of a chunk's leaves: edges that triangles of two leaves have, and open edges at most reach_m from the
/// sides of the chunk's cell, where another chunk may go on. leaves: the triangles of each; corners are of a mesh that
/// has these triangles alone, in their order. Any thread.
std::vector<Border> find_borders(const Mesh& mesh, std::span<const std::span<const uint32_t>> leaves, const Box& cell,
                                 float reach_m);

/// Joins surfaces that lie one after the other in `mesh`, each from its entry in first_triangle on, along their
/// borders: where an edge passes by a point that another surface's border still has, it is led through that point
/// again, so that edges meet edges. Returns the border of what they have become; edges that two of them had are none
/// of it.
Border join_borders(Mesh& mesh, std::span<const Border* const> borders, std::span<const uint32_t> first_triangle);

}  // namespace promenade
