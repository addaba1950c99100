#include "runtime/motion.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>

namespace promenade {
namespace {

constexpr double kDegreesPerPixel = 0.25;
constexpr double kRollDegreesPerSecond = 60;
constexpr double kSpeedStep = 1.25;

}  // namespace

Pose moved(const Pose& pose, const Motion& motion, double speed_m_per_s, double dt_s) {
  Pose next = pose;
  const Basis basis = basis_of(pose);
  next.eye +=
      (basis.forward * motion.forward + basis.right * motion.right + basis.up * motion.up) * speed_m_per_s * dt_s;
  next.roll_deg = std::remainder(pose.roll_deg + motion.roll * kRollDegreesPerSecond * dt_s, 360.0);
  // The mouse moves along the screen; yaw and pitch turn about the level head's axes.
  const double roll = glm::radians(pose.roll_deg);
  const double level_right = motion.look_right_px * std::cos(roll) - motion.look_down_px * std::sin(roll);
  const double level_down = motion.look_right_px * std::sin(roll) + motion.look_down_px * std::cos(roll);
  next.yaw_deg = pose.yaw_deg - level_right * kDegreesPerPixel;
  next.pitch_deg = std::clamp(pose.pitch_deg - level_down * kDegreesPerPixel, -90.0, 90.0);
  return next;
}

double changed_speed(double speed_m_per_s, double wheel_steps) {
  return std::clamp(speed_m_per_s * std::pow(kSpeedStep, wheel_steps), 0.01, 1e5);
}

Pose overview_of(const DBox& world_box, double vertical_fov_deg) {
  Pose pose;
  if (world_box.empty()) return pose;
  const glm::dvec3 look = glm::normalize(glm::dvec3(1, 1, -0.7));
  const double radius = std::max(world_box.diagonal() / 2, 1e-3);
  pose.eye = world_box.center() - look * (radius / std::sin(glm::radians(vertical_fov_deg) / 2));
  pose.yaw_deg = glm::degrees(std::atan2(look.y, look.x));
  pose.pitch_deg = glm::degrees(std::asin(look.z));
  return pose;
}

}  // namespace promenade
