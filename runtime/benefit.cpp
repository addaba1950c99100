#include "runtime/benefit.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace promenade {
namespace {

constexpr double kNearestM = 0.1;  // an eye inside a node's box is that far from it

double distance_of(const NodeRecord& node, const Sight& sight) {
  return std::max(double(node.box.distance(sight.eye)), kNearestM);
}

}  // namespace

Benefit::Benefit(const Model& model, const Sight& sight, const SelectView& view, const SelectOptions& options)
    : model_(model),
      sight_(sight),
      view_(view),
      options_(options),
      forward_(basis_of(view.camera.pose).forward),
      picture_px_(double(view.camera.width_px) * view.camera.height_px) {
  const double half_diagonal_px = std::hypot(double(view.camera.width_px), double(view.camera.height_px)) / 2;
  corner_cos_ = std::cos(std::atan(half_diagonal_px / sight.pixels_per_radian));
}

double Benefit::size_px(NodeId id) const {
  const NodeRecord& n = node(id);
  const double px_per_m = sight_.pixels_per_radian / distance_of(n, sight_);
  // A quarter of the surface: what a convex body shows on average (Cauchy).
  return std::min(picture_px_, double(n.surface_m2) / 4 * px_per_m * px_per_m);
}

double Benefit::accuracy(NodeId id) const {
  const NodeRecord& n = node(id);
  const double error = error_m(n, options_.error_kind);
  return 1 / (1 + error / distance_of(n, sight_) * sight_.pixels_per_radian / options_.benefit.half_error_px);
}

double Benefit::importance(NodeId id) const { return sight_.importance_of(id); }

double Benefit::focus(NodeId id) const {
  const Box& box = node(id).box;
  const glm::dvec3 middle = glm::dvec3(box.min + box.max) * 0.5 - glm::dvec3(sight_.eye);
  const double length = glm::length(middle);
  if (length <= double(box.diagonal()) / 2) return 1;  // around the eye
  const double cosine = glm::dot(middle, forward_) / length;
  const double off_middle = std::clamp((1 - cosine) / std::max(1 - corner_cos_, 1e-9), 0.0, 1.0);
  return 1 - options_.benefit.focus_weight * off_middle;
}

double Benefit::motion(NodeId id) const {
  const NodeRecord& n = node(id);
  const double distance_m = distance_of(n, sight_);
  const glm::dvec3 to_node = glm::dvec3(n.box.min + n.box.max) * 0.5 - glm::dvec3(sight_.eye);
  const double length = glm::length(to_node);
  const glm::dvec3 direction = length > 0 ? to_node / length : forward_;
  const glm::dvec3 across = view_.velocity_m_per_s - direction * glm::dot(view_.velocity_m_per_s, direction);
  const double radians_per_s = glm::length(across) / distance_m + view_.turn_rad_per_s;
  const double speed_px = radians_per_s * sight_.pixels_per_radian * options_.benefit.frame_s;
  const double triangle_px = std::sqrt(size_px(id) / std::max(1.0, double(n.triangles)));
  return 1 / (1 + options_.benefit.motion_weight * speed_px / std::max(triangle_px, 1.0));
}

double Benefit::of(NodeId id, bool drawn_before) const {
  const double hysteresis = drawn_before ? 1 : 1 - options_.benefit.hysteresis_weight;
  return size_px(id) * accuracy(id) * importance(id) * focus(id) * motion(id) * hysteresis;
}

}  // namespace promenade
