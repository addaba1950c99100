#pragma once
#include <memory>

#include "preprocess/visibility/hider.h"
#include "preprocess/visibility/node_parts.h"
#include "preprocess/visibility/occluders.h"

namespace promenade {

/// Hides what upright solids hide, as far as the world stands on the ground: rays that might go below a solid are not
/// hidden by it. All references must outlive it.
std::unique_ptr<Hider> make_horizon_hider(const Model& model, const NodeParts& parts, const OccluderSet& occluders);

}  // namespace promenade
