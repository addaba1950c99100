#pragma once
// Which cells are neighbours: what follows from their boxes and the tree over them, so that no file need hold it.

#include "geometry/result.h"
#include "layout/cells.h"

namespace promenade {

/// Fills faces, faces_of_cells, portals and the cells' ranges of faces: each two cells that share a rectangle are
/// neighbours through one portal, all of it. Ordered by the cell below, then by axis, then by the cell above.
/// tables: with a sound tree and cells; what they hold of faces is replaced. Errors: more neighbours, or a longer way
/// to them, than cells of any use have (against hostile files). Any thread.
Status find_faces(CellTables& tables);

/// Whether the faces are those that find_faces finds.
bool faces_follow(const CellTables& tables);

}  // namespace promenade
