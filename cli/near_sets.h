#pragma once
// Near geometry of far cells as lists that are told from cell to cell ([xiong1996] section 3.2), beside finding it in
// the tree when it is wanted, as the runtime does.

#include <cstdint>
#include <vector>

#include "layout/model.h"

namespace promenade {

/// Leaves that meet a box, ascending; metres, model space. Pure; any thread.
std::vector<uint32_t> leaves_near(const Model& model, const Box& box);

/// Sums over steps between cells.
struct NearSets {
  uint64_t steps = 0;
  uint64_t leaves = 0;       ///< near the cells
  uint64_t changed = 0;      ///< near one cell of a step and not the other
  uint64_t delta_bytes = 0;  ///< of the differences, stored
  double find_s = 0;         ///< in the tree, of as many cells

  /// The near boxes of a cell and of the one beside it.
  void add(const Model& model, const Box& near, const Box& near_beside);
};

}  // namespace promenade
