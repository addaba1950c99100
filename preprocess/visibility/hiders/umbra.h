#pragma once
#include <memory>
#include <vector>

#include "preprocess/visibility/hider.h"
#include "preprocess/visibility/node_parts.h"

namespace promenade {

struct UmbraOptions {
  /// Pictures of boxes for one cell. More: tighter, slower; beyond, what is undecided stays.
  uint32_t most_views = 64;
  /// Boxes in such a picture: those that cover most of the sphere about the cell.
  size_t most_boxes = 1500;
};

/// Hides what lies in the umbra of solid boxes, wherever they are: for worlds that are no ground with houses on it. All
/// references must outlive it.
std::unique_ptr<Hider> make_umbra_hider(const Model& model, const NodeParts& parts, const std::vector<Box>& boxes,
                                        const UmbraOptions& options = {});

}  // namespace promenade
