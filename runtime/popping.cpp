#include "runtime/popping.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <optional>

namespace promenade {
namespace {

constexpr int kTolerance = 24;       // of 255
constexpr double kSameDepth = 0.02;  // of the distance
using Channels = std::array<uint8_t, 3>;

/// Pixels of a pinhole camera and points in the world.
struct Pinhole {
  explicit Pinhole(const Camera& camera)
      : eye(camera.pose.eye), basis(basis_of(camera.pose)), focal_px(pixels_per_radian(camera)) {
    middle = {double(camera.width_px) / 2, double(camera.height_px) / 2};
  }
  glm::dvec3 point_at(double x_px, double y_px, double depth_m) const {
    return eye + basis.forward * depth_m + basis.right * ((x_px - middle.x) / focal_px * depth_m) +
           basis.up * ((middle.y - y_px) / focal_px * depth_m);
  }
  /// x, y in pixels, z: depth.
  glm::dvec3 pixel_of(const glm::dvec3& point) const {
    const glm::dvec3 v = point - eye;
    const double depth_m = glm::dot(v, basis.forward);
    return {middle.x + glm::dot(v, basis.right) / depth_m * focal_px,
            middle.y - glm::dot(v, basis.up) / depth_m * focal_px, depth_m};
  }
  glm::dvec3 eye;
  Basis basis;
  double focal_px;
  glm::dvec2 middle{0};
};

Channels channels_at(const Image& image, uint32_t x, uint32_t y) {
  const glm::u8vec4 pixel = image.at(x, y);
  return {pixel.x, pixel.y, pixel.z};
}

/// How far a colour lies outside the range of those around a pixel.
int beyond_neighbours(const Image& image, uint32_t x, uint32_t y, const Channels& color) {
  Channels least = {255, 255, 255}, most = {0, 0, 0};
  for (uint32_t row = y > 0 ? y - 1 : 0; row <= std::min(y + 1, image.height - 1); ++row)
    for (uint32_t column = x > 0 ? x - 1 : 0; column <= std::min(x + 1, image.width - 1); ++column) {
      const Channels there = channels_at(image, column, row);
      for (size_t c = 0; c < 3; ++c) least[c] = std::min(least[c], there[c]), most[c] = std::max(most[c], there[c]);
    }
  int beyond = 0;
  for (size_t c = 0; c < 3; ++c)
    beyond = std::max({beyond, int(color[c]) - int(most[c]), int(least[c]) - int(color[c])});
  return beyond;
}

}  // namespace

Popping popping_between(const SeenFrame& before, const SeenFrame& now) {
  const uint32_t width = now.color.width, height = now.color.height;
  const size_t pixels = size_t(width) * height;
  Popping popping;
  if (before.color.width != width || before.color.height != height || now.depth_m.size() != pixels ||
      before.depth_m.size() != pixels)
    return popping;
  const Pinhole then(before.camera), here(now.camera);
  for (uint32_t y = 0; y < height; ++y)
    for (uint32_t x = 0; x < width; ++x) {
      const double depth_m = double(now.depth_m[size_t(y) * width + x]);
      if (!std::isfinite(depth_m) || depth_m <= 0) continue;
      const glm::dvec3 was = then.pixel_of(here.point_at(double(x) + 0.5, double(y) + 0.5, depth_m));
      if (!(was.z > 0 && was.x >= 0 && was.y >= 0 && was.x < double(width) && was.y < double(height))) continue;
      const auto was_x = static_cast<uint32_t>(was.x), was_y = static_cast<uint32_t>(was.y);
      const double was_m = double(before.depth_m[size_t(was_y) * width + was_x]);
      if (!(std::abs(was_m - was.z) <= kSameDepth * was.z)) continue;
      ++popping.compared;
      if (beyond_neighbours(before.color, was_x, was_y, channels_at(now.color, x, y)) > kTolerance) ++popping.popped;
    }
  return popping;
}

}  // namespace promenade
