#pragma once
// A pinhole camera in the world: metres, z up, yaw counter-clockwise from +x, pitch up.

#include <array>
#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "geometry/box.h"

namespace promenade {

/// Where the eye is and where it looks.
struct Pose {
  glm::dvec3 eye{0};     ///< metres, world
  double yaw_deg = 0;    ///< counter-clockwise from +x, seen from above
  double pitch_deg = 0;  ///< up is positive; [-90, 90]
  double roll_deg = 0;   ///< clockwise as the viewer tilts the head to the right
};

/// A pose with a picture: the perspective that turns it into pixels. Square pixels.
struct Camera {
  Pose pose;
  uint32_t width_px = 1280;
  uint32_t height_px = 720;
  double vertical_fov_deg = 60;  ///< (0, 180)
  double near_m = 0.1;
};

/// Unit vectors of a pose.
struct Basis {
  glm::dvec3 forward, right, up;
};
Basis basis_of(const Pose& pose);

/// Rigid transform from model space (world minus origin) to view space (x right, y up, z backwards). In double until
/// the end, so that a far eye loses nothing.
glm::mat4 view_from_model(const Pose& pose, const glm::dvec3& model_origin);

/// OpenGL's perspective (depth -1 at near_m, 1 at far_m).
glm::mat4 clip_from_view(const Camera& camera, double far_m);

/// Pixels that one radian (small angle) covers at the picture's centre: height / (2 tan(fov / 2)). The conversion from
/// an object-space error e at distance d: e / d * pixels_per_radian.
double pixels_per_radian(const Camera& camera);

/// Projected error of a node, in pixels: the most that a displacement of error_m anywhere in a box may move a point's
/// picture, for a box whose nearest point is distance_m away. Infinite at distance 0 (unless the error is 0). Pure; any
/// thread. Source: [chhugani2003] section 2.2, for a point eye.
double screen_error_px(double error_m, double distance_m, double pixels_per_radian);

/// A half-space: dot(normal, p) + offset >= 0 is inside. normal is unit.
struct Plane {
  glm::vec3 normal{0};
  float offset = 0;
};

/// The five planes of a view pyramid in model space: near, left, right, bottom, top. No far plane: nothing is cut off
/// far away.
struct Frustum {
  std::array<Plane, 5> planes;
};
Frustum frustum_of(const Camera& camera, const glm::dvec3& model_origin);

enum class Overlap : uint8_t { outside, partly, inside };

/// Conservative: `outside` is certain, `partly` may be outside near the corners of the pyramid.
Overlap classify(const Frustum& frustum, const Box& box);

/// How far outside the frustum the box lies, in metres along the worst plane's normal; 0 when they may overlap.
float distance_outside(const Frustum& frustum, const Box& box);

}  // namespace promenade
