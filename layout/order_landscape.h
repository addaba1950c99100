#pragma once
// A matrix of any size to measure orders on: what steps across a wide landscape bring, under levels of detail.

#include <cstdint>

#include "layout/incidence.h"

namespace promenade {

/// The first `columns` nodes of a quadtree in preorder, over a square as large as it takes. Cells are squares of two
/// leaves' length; a cell sees a node that is at least its size away times two while the parent is not, so that nodes
/// give way to their children as one comes near; a quarter of what it would see is hidden, from groups of cells. A row
/// a step across a face of two cells, as step_rows has them. Deterministic; about 40 ones a column.
Incidence landscape_steps(uint32_t columns);

}  // namespace promenade
