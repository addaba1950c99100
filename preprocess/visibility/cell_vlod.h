#pragma once
// What can be seen from one cell: its front, less what the hiders prove hidden.

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "layout/cell_front.h"
#include "preprocess/visibility/hider.h"

namespace promenade {

using HiderChain = std::span<const std::unique_ptr<Hider>>;

struct CellVlod {
  std::vector<NodeId> nodes;  ///< to be drawn from anywhere in the cell; ascending
  uint64_t triangles = 0;     ///< of these
  uint32_t front_nodes = 0;   ///< before hiding
  uint64_t front_triangles = 0;
};

/// Asks the hiders in their order. Any thread. Errors: those of a hider.
/// Source: [chhugani2003] section 2.3.
Result<CellVlod> cell_vlod(const Model& model, HiderChain hiders, const Box& cell, const FrontBound& bound);

}  // namespace promenade
