#pragma once
#include <memory>

#include "layout/model_io.h"
#include "preprocess/visibility/hider.h"
#include "preprocess/visibility/node_parts.h"
#include "preprocess/visibility/occluders.h"

namespace promenade {

/// Hides what lies in the shadows of upright solids, joined in a map of the plan. All references must outlive it.
/// Source: [chhugani2003] section 5.1.
std::unique_ptr<Hider> make_cullmap_hider(const Model& model, const NodeParts& parts, const OccluderSet& occluders);

}  // namespace promenade
