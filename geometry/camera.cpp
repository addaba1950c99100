#include "geometry/camera.h"

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <limits>

namespace promenade {

Basis basis_of(const Pose& pose) {
  const double yaw = glm::radians(pose.yaw_deg), pitch = glm::radians(pose.pitch_deg),
               roll = glm::radians(pose.roll_deg);
  const glm::dvec3 forward(std::cos(pitch) * std::cos(yaw), std::cos(pitch) * std::sin(yaw), std::sin(pitch));
  const glm::dvec3 level_right(std::sin(yaw), -std::cos(yaw), 0.0);
  const glm::dvec3 level_up = glm::cross(level_right, forward);
  return {forward, std::cos(roll) * level_right - std::sin(roll) * level_up,
          std::cos(roll) * level_up + std::sin(roll) * level_right};
}

glm::mat4 view_from_model(const Pose& pose, const glm::dvec3& model_origin) {
  const auto [f, r, u] = basis_of(pose);
  const glm::dvec3 eye = pose.eye - model_origin;
  glm::dmat4 m(1.0);
  for (int column = 0; column < 3; ++column) m[column] = glm::dvec4(r[column], u[column], -f[column], 0.0);
  m[3] = glm::dvec4(-glm::dot(r, eye), -glm::dot(u, eye), glm::dot(f, eye), 1.0);
  return glm::mat4(m);
}

glm::mat4 clip_from_view(const Camera& camera, double far_m) {
  const double scale = 1.0 / std::tan(glm::radians(camera.vertical_fov_deg) / 2.0);
  const double aspect = double(camera.width_px) / double(camera.height_px);
  const double n = camera.near_m, f = far_m;
  glm::dmat4 m(0.0);
  m[0][0] = scale / aspect;
  m[1][1] = scale;
  m[2][2] = (f + n) / (n - f);
  m[2][3] = -1.0;
  m[3][2] = 2.0 * f * n / (n - f);
  return glm::mat4(m);
}

double pixels_per_radian(const Camera& camera) {
  return double(camera.height_px) / (2.0 * std::tan(glm::radians(camera.vertical_fov_deg) / 2.0));
}

double screen_error_px(double error_m, double distance_m, double pixels_per_radian) {
  if (error_m <= 0) return 0;
  if (distance_m <= error_m) return std::numeric_limits<double>::infinity();
  return error_m / distance_m * pixels_per_radian;
}

Frustum frustum_of(const Camera& camera, const glm::dvec3& model_origin) {
  const auto [f, r, u] = basis_of(camera.pose);
  const glm::dvec3 eye = camera.pose.eye - model_origin;
  const double tan_y = std::tan(glm::radians(camera.vertical_fov_deg) / 2.0);
  const double tan_x = tan_y * double(camera.width_px) / double(camera.height_px);
  const auto plane = [](const glm::dvec3& normal, const glm::dvec3& through) {
    const glm::dvec3 unit = glm::normalize(normal);
    return Plane{glm::vec3(unit), static_cast<float>(-glm::dot(unit, through))};
  };
  return {{plane(f, eye + f * camera.near_m), plane(f * tan_x + r, eye), plane(f * tan_x - r, eye),
           plane(f * tan_y + u, eye), plane(f * tan_y - u, eye)}};
}

namespace {

/// Signed distance of the box's corner that is farthest along the plane's normal (far = true) or against it.
float corner_distance(const Plane& plane, const Box& box, bool far) {
  const glm::vec3 corner(((plane.normal.x > 0) == far) ? box.max.x : box.min.x,
                         ((plane.normal.y > 0) == far) ? box.max.y : box.min.y,
                         ((plane.normal.z > 0) == far) ? box.max.z : box.min.z);
  return glm::dot(plane.normal, corner) + plane.offset;
}

}  // namespace

Overlap classify(const Frustum& frustum, const Box& box) {
  bool inside = true;
  for (const Plane& plane : frustum.planes) {
    if (corner_distance(plane, box, true) < 0) return Overlap::outside;
    inside = inside && corner_distance(plane, box, false) >= 0;
  }
  return inside ? Overlap::inside : Overlap::partly;
}

float distance_outside(const Frustum& frustum, const Box& box) {
  float outside = 0;
  for (const Plane& plane : frustum.planes) outside = std::max(outside, -corner_distance(plane, box, true));
  return outside;
}

}  // namespace promenade
