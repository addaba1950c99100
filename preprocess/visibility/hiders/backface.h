#pragma once
#include <memory>

#include "preprocess/visibility/hider.h"
#include "preprocess/visibility/node_parts.h"

namespace promenade {

/// Hides nodes that show only backs to the whole cell: first by the cone of a node and all that is below it (a subtree
/// at once), then part by part. The parts must outlive it.
std::unique_ptr<Hider> make_backface_hider(const Model& model, const NodeParts& parts);

}  // namespace promenade
