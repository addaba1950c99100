#pragma once
// Somebody on foot: on the ground, up stairs, not through walls. Pure, so that it can be tested without a window.

#include "geometry/closest_point.h"
#include "runtime/motion.h"

namespace promenade {

struct WalkOptions {
  double eye_height_m = 1.65;
  double radius_m = 0.25;  ///< of the body
  double step_m = 0.45;    ///< what is lower is stepped on, what is higher stops the body
  double fastest_m_per_s = 12;
  double reach_m = 50;  ///< no ground within this below: the walker stays up
};

/// What a walk remembers between frames.
struct WalkState {
  double fall_m_per_s = 0;
  double eye_below_m = 0;  ///< how much lower the eye is than where it belongs: after a step up it rises smoothly
  bool on_ground = false;
};

/// The pose after dt_s on foot: forward and right along the ground, whatever the pitch; `up` does nothing. surface:
/// what is around, model space (world less model_origin); both sides of a triangle are solid; an empty one stops nobody
/// and lets nobody fall.
Pose walked(const Pose& pose, const Motion& motion, double speed_m_per_s, double dt_s, const ClosestPointTree& surface,
            const glm::dvec3& model_origin, const WalkOptions& options, WalkState& state);

/// How far a ray from `from` (model space) along the unit vector `way` gets before it comes within two millimetres of
/// the surface; infinity: beyond `length_m`.
double free_way_m(const ClosestPointTree& surface, const glm::dvec3& from, const glm::dvec3& way, double length_m);

}  // namespace promenade
