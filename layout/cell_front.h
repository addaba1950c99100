#pragma once
// The front of a cell: what is drawn from anywhere in it when nothing is hidden.

#include <vector>

#include "geometry/pixel_scale.h"
#include "layout/model.h"

namespace promenade {

/// How exact a front is: a bound in pixels and the camera that it is meant for.
struct FrontBound {
  double pixel_error = 1;  ///< pixels, > 0
  PixelScale scale;
  bool operator==(const FrontBound&) const = default;
};

/// Whether a node of the tree ends its paths in the front of the cell: its error stays within the bound from everywhere
/// in the cell, or it has no children.
bool ends_front(const NodeRecord& node, const Box& cell, const FrontBound& bound);

/// The coarsest front whose projected error stays within the bound from everywhere in the cell. Every path from a root
/// to a leaf meets it exactly once. Sorted by id. cell: closed, metres, model space. Pure; any thread.
/// Source: [chhugani2003] section 2.2.
std::vector<NodeId> cell_front(const Model& model, const Box& cell, const FrontBound& bound);

}  // namespace promenade
