#pragma once
// What a step from cell to cell brings: the rows that an order of nodes is made for.

#include <cstdint>
#include <span>
#include <vector>

#include "layout/cells.h"

namespace promenade {

/// The ids that are in `to` and not in `from`, ascending, as both are: what is read on a step.
std::vector<uint32_t> entering(std::span<const uint32_t> from, std::span<const uint32_t> to);

/// A row a step: across face i upwards (into the cell above it), row 2 i, and downwards, row 2 i + 1. What leaves is no
/// part of it: a node and the children that take its place would stand together, and one of them be read in vain.
/// vlods: node ids by cell, ascending.
std::vector<std::vector<uint32_t>> step_rows(std::span<const std::vector<uint32_t>> vlods,
                                             std::span<const CellFace> faces);

}  // namespace promenade
