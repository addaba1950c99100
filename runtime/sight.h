#pragma once
// What selection measures a node by: its error in pixels, its place beside the frustum, its priority.

#include <algorithm>

#include "runtime/policy.h"

namespace promenade {

/// What of a view does not depend on the node.
struct Sight {
  Sight(const Model& model, const SelectView& view, const SelectOptions& options);

  /// How much a node matters, in [0, 1]: SelectView::importance as far as it weighs.
  double importance_of(NodeId id) const {
    if (index_of(id) >= importance.size()) return 1;
    return 1 - importance_weight * (1 - std::clamp(double(importance[index_of(id)]), 0.0, 1.0));
  }

  glm::vec3 eye, later_eye, towards_eye;
  Frustum frustum;
  double pixels_per_radian;
  std::span<const float> importance;
  double importance_weight;
};

/// Pixels that the node's error may move a point by.
double error_px(const NodeRecord& node, const Sight& sight, ErrorKind kind);

/// Metres to where the node will be seen from a little later, never less than a part of its own size.
double priority_distance(const NodeRecord& node, const Sight& sight, const SelectOptions& options);

/// 1 in the frustum, falling to 0 with the distance outside it.
double frustum_visibility(const NodeRecord& node, const Sight& sight, const SelectOptions& options, double distance_m);

/// priority_n of [lakhia2004] section 4.2, for the policies that are its; else the pixels of error that the node takes
/// away, weighted by visibility alike.
float priority_of(const Model& model, NodeId id, const Sight& sight, const SelectOptions& options);

}  // namespace promenade
