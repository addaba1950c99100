#include "runtime/walk.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <limits>

namespace promenade {
namespace {

constexpr double kGravity = 9.81, kFastestFall = 30;
constexpr double kRise = 2;  // m/s, and more of what is left: how the eye follows the feet up a step
constexpr double kLongestLagM = 0.6;
constexpr double kTouchM = 0.002;
constexpr int kTraceSteps = 96, kPushes = 6;

/// Heights of the body's spheres above the feet: what a step can rise to stays free.
std::array<double, 3> sphere_heights(const WalkOptions& o) {
  const double low = o.step_m + o.radius_m, high = std::max(low, o.eye_height_m);
  return {low, (low + high) / 2, high};
}

/// Moves the feet sideways until no sphere of the body touches the surface; false: there is no room.
bool make_room(const ClosestPointTree& surface, const WalkOptions& options, glm::dvec3& feet) {
  for (int push = 0; push < kPushes; ++push) {
    bool touched = false;
    for (const double height_m : sphere_heights(options)) {
      const glm::dvec3 center = feet + glm::dvec3(0, 0, height_m);
      ClosestPointTree::Limits limits;
      limits.max_distance2_m2 = float(options.radius_m * options.radius_m);
      const ClosestPoint closest = surface.closest(glm::vec3(center), limits);
      if (closest.triangle == kNoTriangle) continue;
      const glm::dvec3 away = center - glm::dvec3(closest.point);
      const double sideways_m = std::hypot(away.x, away.y);
      if (sideways_m < options.radius_m / 50) continue;  // a ceiling, or a floor: neither can be walked around
      const double wanted_m = std::sqrt(std::max(0.0, options.radius_m * options.radius_m - away.z * away.z));
      if (wanted_m <= sideways_m + kTouchM / 2) continue;
      feet += glm::dvec3(away.x, away.y, 0) * ((wanted_m - sideways_m) / sideways_m);
      touched = true;
    }
    if (!touched) return true;
  }
  return false;
}

}  // namespace

double free_way_m(const ClosestPointTree& surface, const glm::dvec3& from, const glm::dvec3& way, double length_m) {
  double gone_m = 0;
  for (int i = 0; i < kTraceSteps && gone_m < length_m; ++i) {
    const double distance_m = std::sqrt(double(surface.nearest(glm::vec3(from + way * gone_m)).distance2_m2));
    if (distance_m < kTouchM) return gone_m;
    gone_m += distance_m;
  }
  return gone_m < length_m ? gone_m : std::numeric_limits<double>::infinity();
}

Pose walked(const Pose& pose, const Motion& motion, double speed_m_per_s, double dt_s, const ClosestPointTree& surface,
            const glm::dvec3& model_origin, const WalkOptions& options, WalkState& state) {
  Motion look = motion;
  look.forward = look.right = look.up = 0;
  Pose next = moved(pose, look, speed_m_per_s, dt_s);
  const double yaw = glm::radians(next.yaw_deg);
  const glm::dvec3 ahead(std::cos(yaw), std::sin(yaw), 0), right(ahead.y, -ahead.x, 0);
  const glm::dvec3 way =
      (ahead * motion.forward + right * motion.right) * (std::min(speed_m_per_s, options.fastest_m_per_s) * dt_s);
  glm::dvec3 feet = pose.eye - model_origin - glm::dvec3(0, 0, options.eye_height_m - state.eye_below_m);
  if (surface.triangle_count() == 0) {
    state.fall_m_per_s = 0;
    next.eye += way;
    return next;
  }
  // In pieces that are shorter than the body is wide: nobody leaps through a wall.
  const auto pieces = static_cast<int>(std::ceil(glm::length(way) / (options.radius_m / 2))) + 1;
  for (int i = 0; i < pieces; ++i) {
    const glm::dvec3 before = feet;
    feet += way / double(pieces);
    if (!make_room(surface, options, feet)) feet = before;
    // Onto whatever a step reaches, piece by piece: a flight of stairs taken at a run is many steps.
    const double ground_m = free_way_m(surface, feet + glm::dvec3(0, 0, options.step_m), {0, 0, -1}, options.step_m);
    if (!std::isfinite(ground_m)) continue;
    feet.z += options.step_m - ground_m, state.eye_below_m += options.step_m - ground_m;
  }
  const double below_m =
      free_way_m(surface, feet + glm::dvec3(0, 0, options.step_m), {0, 0, -1}, options.step_m + options.reach_m);
  const double drop_m = below_m - options.step_m;
  state.on_ground = drop_m <= options.step_m / 2;
  if (!std::isfinite(drop_m) || state.on_ground) {
    state.fall_m_per_s = 0;
    if (state.on_ground) feet.z -= drop_m;
  } else {
    state.fall_m_per_s = std::min(kFastestFall, state.fall_m_per_s + kGravity * dt_s);
    feet.z -= std::min(drop_m, state.fall_m_per_s * dt_s);
  }
  state.eye_below_m = std::min(kLongestLagM, state.eye_below_m);
  state.eye_below_m = std::max(0.0, state.eye_below_m * (1 - std::min(1.0, 4 * dt_s)) - kRise * dt_s / 4);
  next.eye = feet + model_origin + glm::dvec3(0, 0, options.eye_height_m - state.eye_below_m);
  return next;
}

}  // namespace promenade
