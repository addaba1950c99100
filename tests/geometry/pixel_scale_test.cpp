#include "geometry/pixel_scale.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/gtc/constants.hpp>
#include <random>

#include "geometry/camera.h"

namespace promenade {
namespace {

constexpr uint32_t kWidthPx = 1280, kHeightPx = 720;
constexpr double kFovDeg = 60;

class RandomWorld {
 public:
  double number(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }
  glm::dvec3 unit() {
    const double z = number(-1, 1), turn = number(0, glm::two_pi<double>());
    return {std::sqrt(1 - z * z) * std::cos(turn), std::sqrt(1 - z * z) * std::sin(turn), z};
  }
  /// A point of the box, often on its faces, edges and corners.
  glm::dvec3 point(const Box& box) {
    glm::dvec3 p(0);
    for (int i = 0; i < 3; ++i) p[i] = double(box.min[i]) + double(box.size()[i]) * std::clamp(number(-1, 2), 0.0, 1.0);
    return p;
  }

 private:
  std::mt19937 random_{11};
};

glm::dvec2 picture_of(const glm::dvec3& direction, const glm::dvec3& axis, double focal_px) {
  const glm::dvec3 side =
      glm::normalize(glm::cross(axis, std::abs(axis.z) < 0.9 ? glm::dvec3(0, 0, 1) : glm::dvec3(1, 0, 0)));
  const glm::dvec3 up = glm::cross(side, axis);
  const double depth = glm::dot(direction, axis);
  return focal_px * glm::dvec2(glm::dot(direction, side), glm::dot(direction, up)) / depth;
}

/// The largest movement of a picture, in pixels, over random eyes in the cell, points in the node, displacements of
/// length error_m and cameras that see the point within the scale's angle.
double brute_force_px(const Box& cell, const Box& node, double error_m, const PixelScale& scale, int tries) {
  RandomWorld world;
  const double rim = std::atan(scale.tan_corner);
  double worst = 0;
  for (int i = 0; i < tries; ++i) {
    const glm::dvec3 eye = world.point(cell), point = world.point(node), to = point - eye;
    const glm::dvec3 sight = glm::normalize(to);
    const glm::dvec3 across = glm::normalize(glm::cross(sight, world.unit()));
    const double angle = rim * std::clamp(world.number(0, 2), 0.0, 1.0);
    const glm::dvec3 axis = sight * std::cos(angle) - across * std::sin(angle);
    // Displacements at random and, half of the time, the worst: to where the ball about the point is seen farthest out.
    const double grazing = std::asin(error_m / glm::length(to));
    const glm::dvec3 outermost = -sight * std::sin(grazing) + across * std::cos(grazing);
    const glm::dvec3 moved = to + error_m * (i % 2 == 0 ? world.unit() : outermost);
    if (glm::dot(moved, axis) <= 0) continue;
    worst =
        std::max(worst, glm::distance(picture_of(to, axis, scale.focal_px), picture_of(moved, axis, scale.focal_px)));
  }
  return worst;
}

TEST(AllowedError, bounds_every_movement_in_the_picture_and_is_reached) {
  const Box cell{{0, 0, 0}, {8, 8, 2}};
  const std::vector<Box> nodes = {
      {{20, -3, -1}, {45, 30, 9}}, {{8.25F, 8, 0}, {9, 9, 4}}, {{-300, 2, 40}, {-250, 3, 60}}};
  for (const ErrorAt where : {ErrorAt::center, ErrorAt::corner})
    for (const double pixel_error : {0.5, 1.0, 40.0})
      for (const Box& node : nodes) {
        const PixelScale scale = pixel_scale(kWidthPx, kHeightPx, kFovDeg, where);
        const double error_m = allowed_error_m(cell, node, pixel_error, scale);
        const double worst = brute_force_px(cell, node, error_m, scale, 20000);
        EXPECT_LE(worst, pixel_error * (1 + 1e-9));
        EXPECT_GE(worst, pixel_error * 0.95);
      }
}

TEST(AllowedError, is_zero_where_cell_and_node_touch) {
  const PixelScale scale = pixel_scale(kWidthPx, kHeightPx, kFovDeg);
  const Box cell{{0, 0, 0}, {1, 1, 1}};
  EXPECT_EQ(allowed_error_m(cell, {{1, 0, 0}, {2, 1, 1}}, 1, scale), 0);
  EXPECT_EQ(allowed_error_m(cell, {{0.5F, 0.5F, 0.5F}, {2, 1, 1}}, 1, scale), 0);
  EXPECT_GT(allowed_error_m(cell, {{1.5F, 0, 0}, {2, 1, 1}}, 1, scale), 0);
}

TEST(AllowedError, of_a_point_cell_is_what_screen_error_counts) {
  Camera camera;
  const PixelScale scale = pixel_scale(camera.width_px, camera.height_px, camera.vertical_fov_deg);
  const Box eye{{1, 2, 3}, {1, 2, 3}}, node{{31, 2, 3}, {40, 9, 9}};
  const double error_m = allowed_error_m(eye, node, 1, scale);
  EXPECT_NEAR(screen_error_px(error_m, 30, pixels_per_radian(camera)), 1, 1e-5);
}

TEST(Distance, between_boxes_is_that_of_their_nearest_points) {
  EXPECT_DOUBLE_EQ(distance_m({{0, 0, 0}, {1, 1, 1}}, {{4, 5, 0}, {6, 6, 1}}), 5);
  EXPECT_EQ(distance_m({{0, 0, 0}, {1, 1, 1}}, {{1, 1, 1}, {2, 2, 2}}), 0);
}

}  // namespace
}  // namespace promenade
