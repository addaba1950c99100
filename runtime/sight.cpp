#include "runtime/sight.h"

#include <algorithm>
#include <cmath>

namespace promenade {

Sight::Sight(const Model& model, const SelectView& view, const SelectOptions& options)
    : eye(view.camera.pose.eye - model.manifest.origin),
      later_eye(glm::dvec3(eye) + view.velocity_m_per_s * options.look_ahead_s),
      towards_eye(-basis_of(view.camera.pose).forward),
      frustum(frustum_of(view.camera, model.manifest.origin)),
      pixels_per_radian(promenade::pixels_per_radian(view.camera)),
      importance(view.importance),
      importance_weight(options.benefit.importance_weight) {}

double error_px(const NodeRecord& node, const Sight& sight, ErrorKind kind) {
  return screen_error_px(error_m(node, kind), node.box.distance(sight.eye), sight.pixels_per_radian);
}

double priority_distance(const NodeRecord& node, const Sight& sight, const SelectOptions& options) {
  return std::max({double(node.box.distance(sight.later_eye)), options.distance_min_m,
                   options.distance_min_diagonals * double(node.box.diagonal())});
}

double frustum_visibility(const NodeRecord& node, const Sight& sight, const SelectOptions& options, double distance_m) {
  const double outside_m = distance_outside(sight.frustum, node.box);
  if (outside_m <= 0) return 1;
  return std::max(0.0, 1 - outside_m / (options.visibility_falloff * distance_m));
}

float priority_of(const Model& model, NodeId id, const Sight& sight, const SelectOptions& options) {
  const NodeRecord& node = model.tables.nodes[index_of(id)];
  const TimeSliceOptions& time = options.time;
  const double distance_m = priority_distance(node, sight, options);
  const double vis = 1 + time.visibility_weight * frustum_visibility(node, sight, options, distance_m);
  double priority = 0;
  if (uses_time(options.policy)) {
    const double static_benefit = std::sqrt(double(node.triangles) * double(node.surface_m2));
    const double foreshorten =
        1 + double(glm::dot(sight.towards_eye, node.average_normal)) * time.foreshortening_weight;
    const double benefit = static_benefit * vis * foreshorten / (distance_m * distance_m);
    priority = benefit / std::max(node_cost(node, time), 1e-3);
  } else {
    const double coarser_m = node.parent == kNoNode
                                 ? double(node.box.diagonal())
                                 : double(error_m(model.tables.nodes[index_of(node.parent)], options.error_kind));
    priority = coarser_m / distance_m * sight.pixels_per_radian * vis;
  }
  return static_cast<float>(std::min(priority * sight.importance_of(id), 1e30));
}

}  // namespace promenade
