#pragma once
// How keys and mouse move the eye: pure, so that it can be tested without a window.

#include "geometry/box.h"
#include "geometry/camera.h"

namespace promenade {

/// What the user does during one frame. Directions in [-1, 1], along the view.
struct Motion {
  double forward = 0, right = 0, up = 0;
  double roll = 0;           ///< clockwise
  double look_right_px = 0;  ///< the mouse, dragged
  double look_down_px = 0;
};

/// The pose after dt_s at speed_m_per_s. Looking: a quarter of a degree a pixel, by the screen's own axes even when the
/// head is rolled; pitch stays within [-90, 90].
Pose moved(const Pose& pose, const Motion& motion, double speed_m_per_s, double dt_s);

/// Each step of the wheel changes the speed by a quarter, within 1 cm/s and 100 km/s.
double changed_speed(double speed_m_per_s, double wheel_steps);

/// A pose outside the box from which all of it is in view, looking at its middle from south-west and above.
Pose overview_of(const DBox& world_box, double vertical_fov_deg);

}  // namespace promenade
