#pragma once
// Which vertices stand in the same place.

#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

namespace promenade {

/// Places: positions that are equal bit by bit (but 0 and -0 are one), numbered in order of first appearance.
struct Places {
  std::vector<uint32_t> of_vertex;     ///< V
  std::vector<uint32_t> first_vertex;  ///< the first vertex of each place
  size_t count() const { return first_vertex.size(); }
};

/// Positions finite. Linear time.
Places find_places(std::span<const glm::vec3> positions);

}  // namespace promenade
