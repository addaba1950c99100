#include "runtime/overlay.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>

namespace promenade {
namespace {

constexpr double kBirdPitchDeg = -62;

}  // namespace

void draw_line(const RasterView& view, const glm::dvec3& a, const glm::dvec3& b,
               const std::function<void(const Line&)>& draw) {
  const auto in_view = [&](const glm::dvec3& p) {
    const glm::dvec3 d = p - view.eye;
    return glm::dvec3(glm::dot(d, view.right), glm::dot(d, view.up), glm::dot(d, view.forward));
  };
  glm::dvec3 p = in_view(a), q = in_view(b);
  if (p.z < view.near_m && q.z < view.near_m) return;
  if (p.z < view.near_m) p += (q - p) * ((view.near_m - p.z) / (q.z - p.z));
  if (q.z < view.near_m) q += (p - q) * ((view.near_m - q.z) / (p.z - q.z));
  const auto pixel = [&](const glm::dvec3& v) {
    return glm::vec2(view.width_px / 2.0 + v.x / v.z * view.scale_px, view.height_px / 2.0 - v.y / v.z * view.scale_px);
  };
  draw({pixel(p), pixel(q)});
}

void draw_box(const RasterView& view, const Box& box, const std::function<void(const Line&)>& draw) {
  const auto corner = [&](int c) {
    return glm::dvec3((c & 1) != 0 ? box.max.x : box.min.x, (c & 2) != 0 ? box.max.y : box.min.y,
                      (c & 4) != 0 ? box.max.z : box.min.z);
  };
  for (int c = 0; c < 8; ++c)
    for (const int axis : {1, 2, 4})
      if ((c & axis) == 0) draw_line(view, corner(c), corner(c | axis), draw);
}

void draw_pyramid(const RasterView& view, const Camera& camera, const glm::dvec3& model_origin, double length_m,
                  const std::function<void(const Line&)>& draw) {
  const Basis basis = basis_of(camera.pose);
  const double up = std::tan(glm::radians(camera.vertical_fov_deg) / 2);
  const double right = up * camera.width_px / std::max(1U, camera.height_px);
  const glm::dvec3 eye = camera.pose.eye - model_origin;
  std::array<glm::dvec3, 4> corners;
  for (size_t i = 0; i < 4; ++i) {
    const double x = i == 0 || i == 3 ? -1 : 1, y = i < 2 ? -1 : 1;
    corners[i] = eye + (basis.forward + basis.right * (right * x) + basis.up * (up * y)) * length_m;
  }
  for (size_t i = 0; i < 4; ++i) {
    draw_line(view, eye, corners[i], draw);
    draw_line(view, corners[i], corners[(i + 1) % 4], draw);
  }
}

Camera birds_eye(const Camera& camera, double height_m) {
  Camera bird = camera;
  const double yaw = glm::radians(camera.pose.yaw_deg);
  const double behind_m = height_m / std::tan(glm::radians(-kBirdPitchDeg)) * 0.6;
  bird.pose.eye += glm::dvec3(-std::cos(yaw) * behind_m, -std::sin(yaw) * behind_m, height_m);
  bird.pose.pitch_deg = kBirdPitchDeg;
  bird.pose.roll_deg = 0;
  bird.near_m = std::max(camera.near_m, height_m / 100);
  return bird;
}

glm::u8vec4 false_color(double share) {
  const double s = std::clamp(share, 0.0, 1.0);
  const auto channel = [s](double middle) {
    return static_cast<uint8_t>(std::lround(255 * std::clamp(1.5 - std::abs(s - middle) * 4, 0.0, 1.0)));
  };
  return {channel(0.75), channel(0.5), channel(0.25), 255};
}

}  // namespace promenade
