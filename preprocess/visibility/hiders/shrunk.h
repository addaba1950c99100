#pragma once
#include <memory>
#include <vector>

#include "preprocess/visibility/hider.h"
#include "preprocess/visibility/node_parts.h"

namespace promenade {

struct ShrunkOptions {
  /// Boxes that are looked at for one cell: those that cover most of the sphere about it.
  size_t most_boxes = 1500;
  /// Clusters of directions: the six faces of a cube about the cell, each cut into so many squares a side.
  uint32_t clusters_a_side = 1;
};

/// Hides behind solid boxes that are shrunk about a point, which a quadratic program places. All references must
/// outlive it. Source: [chhugani2003] section 5.2.
std::unique_ptr<Hider> make_shrunk_hider(const Model& model, const NodeParts& parts, const std::vector<Box>& boxes,
                                         const ShrunkOptions& options = {});

}  // namespace promenade
