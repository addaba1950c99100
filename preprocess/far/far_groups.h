#pragma once
// Which far cells are made together, so that the pictures of some may be told against one's.

#include <span>
#include <vector>

#include "layout/far.h"

namespace promenade {

/// Cells of one shell within a cube of kFarGroupCells places a side.
struct FarGroup {
  std::vector<uint64_t> places;  ///< the first is the key, nearest to all others: those are told against it alone
};
constexpr uint32_t kFarGroupCells = 3;

/// All places, in groups, in the order of the groups' keys. Deterministic. places: of the grid, each once.
std::vector<FarGroup> far_groups(const FarTables& tables, std::span<const uint64_t> places);

/// A place's coordinates in its shell's grid.
glm::uvec3 coordinates_of(const FarTables& tables, uint64_t place);

}  // namespace promenade
