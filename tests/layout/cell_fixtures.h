#pragma once
// View cells with known answers.

#include "layout/cells.h"

namespace promenade {

inline FrontBound one_pixel() { return {1, pixel_scale(1280, 720, 60)}; }

/// Space of 4 x 2 x 2 m: a cell of half of it, 0, and two of a quarter each, 1 and 2, beside each other behind it.
///
///     y ^  +-----+-----+
///       |  |     |  2  |
///       |  |  0  +-----+
///       |  |     |  1  |
///       +  +-----+-----+--> x
inline CellTables three_cells() {
  CellTables tables;
  tables.bound = one_pixel();
  tables.box = {{0, 0, 0}, {4, 2, 2}};
  tables.tree = {{0, 2, 1, 2},
                 {CellTreeNode::kLeaf, 0, 0, 0},
                 {1, 1, 3, 4},
                 {CellTreeNode::kLeaf, 0, 1, 0},
                 {CellTreeNode::kLeaf, 0, 2, 0}};
  tables.cells = {{{{0, 0, 0}, {2, 2, 2}}, 0, 2}, {{{2, 0, 0}, {4, 1, 2}}, 2, 2}, {{{2, 1, 0}, {4, 2, 2}}, 4, 2}};
  tables.faces = {{CellId{0}, CellId{1}, 0, 0, 1}, {CellId{0}, CellId{2}, 0, 1, 1}, {CellId{1}, CellId{2}, 1, 2, 1}};
  tables.faces_of_cells = {0, 1, 0, 2, 1, 2};
  tables.portals = {{{2, 0, 0}, {2, 1, 2}}, {{2, 1, 0}, {2, 2, 2}}, {{2, 1, 0}, {4, 1, 2}}};
  return tables;
}

}  // namespace promenade
