#include "runtime/popping.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <optional>

namespace promenade {
namespace {

constexpr int kTolerance = 24;       // of 255
constexpr int kAreaTolerance = 6;    // of 255
constexpr uint32_t kAreaPx = 8;      // as the pattern of fades (DrawItem)
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

/// The mean of the area around each pixel, cut off at the picture's edges: sums along rows, then along columns.
Image area_means(const Image& image) {
  const uint32_t w = image.width, h = image.height;
  using Sums = std::array<uint32_t, 3>;
  const auto begin = [](uint32_t at) { return at > kAreaPx / 2 ? at - kAreaPx / 2 : 0U; };
  const auto end = [](uint32_t at, uint32_t size) { return std::min(at + kAreaPx / 2, size); };
  std::vector<Sums> rows(size_t(w) * h);
  for (uint32_t y = 0; y < h; ++y)
    for (uint32_t x = 0; x < w; ++x)
      for (uint32_t k = begin(x); k < end(x, w); ++k)
        for (int c = 0; c < 3; ++c) rows[size_t(y) * w + x][static_cast<size_t>(c)] += image.at(k, y)[c];
  Image means{w, h, std::vector<glm::u8vec4>(size_t(w) * h, glm::u8vec4(255))};
  for (uint32_t y = 0; y < h; ++y)
    for (uint32_t x = 0; x < w; ++x) {
      Sums sum{};
      for (uint32_t k = begin(y); k < end(y, h); ++k)
        for (size_t c = 0; c < 3; ++c) sum[c] += rows[size_t(k) * w + x][c];
      const uint32_t pixels = (end(x, w) - begin(x)) * (end(y, h) - begin(y));
      for (int c = 0; c < 3; ++c)
        means.at(x, y)[c] = static_cast<uint8_t>((sum[static_cast<size_t>(c)] + pixels / 2) / pixels);
    }
  return means;
}

/// How far a colour lies outside the range of those `step` pixels around a pixel.
int beyond_neighbours(const Image& image, uint32_t x, uint32_t y, const Channels& color, uint32_t step) {
  Channels least = {255, 255, 255}, most = {0, 0, 0};
  for (uint32_t row = y > step ? y - step : 0; row <= std::min(y + step, image.height - 1); row += step)
    for (uint32_t column = x > step ? x - step : 0; column <= std::min(x + step, image.width - 1); column += step) {
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
  const Image areas_then = area_means(before.color), areas_now = area_means(now.color);
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
      const Channels color = channels_at(now.color, x, y), area = channels_at(areas_now, x, y);
      if (beyond_neighbours(before.color, was_x, was_y, color, 1) > kTolerance) ++popping.popped;
      if (beyond_neighbours(areas_then, was_x, was_y, area, kAreaPx / 2) > kAreaTolerance) ++popping.popped_areas;
    }
  return popping;
}

}  // namespace promenade
