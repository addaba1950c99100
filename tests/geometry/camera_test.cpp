#include "geometry/camera.h"

#include <gtest/gtest.h>

#include <glm/geometric.hpp>
#include <random>

namespace promenade {
namespace {

TEST(Basis, yaw_zero_looks_along_x_and_yaw_90_along_y) {
  EXPECT_NEAR(glm::distance(basis_of({}).forward, glm::dvec3(1, 0, 0)), 0, 1e-12);
  EXPECT_NEAR(glm::distance(basis_of({{}, 90, 0, 0}).forward, glm::dvec3(0, 1, 0)), 0, 1e-12);
  EXPECT_NEAR(glm::distance(basis_of({{}, 0, 90, 0}).forward, glm::dvec3(0, 0, 1)), 0, 1e-12);
}

TEST(Basis, is_right_handed_and_unit) {
  const Basis b = basis_of({{}, 37, 21, 13});
  EXPECT_NEAR(glm::distance(glm::cross(b.right, b.up), -b.forward), 0, 1e-12);
  EXPECT_NEAR(glm::length(b.right), 1, 1e-12);
}

TEST(ViewFromModel, keeps_small_distances_at_large_coordinates) {
  const glm::dvec3 origin(448251.5, 5411932.25, 113.0);
  const Pose pose{origin + glm::dvec3(3, 4, 5), 0, 0, 0};
  const glm::vec4 v = view_from_model(pose, origin) * glm::vec4(13, 4, 5, 1);
  EXPECT_FLOAT_EQ(v.z, -10);
  EXPECT_FLOAT_EQ(v.x, 0);
}

TEST(Frustum, agrees_with_the_projection_on_random_points) {
  Camera camera;
  camera.pose = {{1, 2, 3}, 30, -20, 10};
  const glm::mat4 clip = clip_from_view(camera, 1000) * view_from_model(camera.pose, {});
  const Frustum frustum = frustum_of(camera, {});
  std::mt19937 random(7);
  std::uniform_real_distribution<float> coordinate(-20, 20);
  int inside_count = 0;
  for (int i = 0; i < 5000; ++i) {
    const glm::vec3 p(coordinate(random), coordinate(random), coordinate(random));
    const glm::vec4 c = clip * glm::vec4(p, 1);
    const bool inside = c.w > 0 && std::abs(c.x) < c.w && std::abs(c.y) < c.w && c.z > -c.w;
    const float margin =
        std::min({c.w - std::abs(c.x), c.w - std::abs(c.y), c.z + c.w}, [](float a, float b) { return a < b; });
    if (std::abs(margin) < 1e-3F) continue;
    EXPECT_EQ(inside, classify(frustum, Box{p, p}) != Overlap::outside);
    EXPECT_EQ(inside, distance_outside(frustum, Box{p, p}) <= 0);
    inside_count += inside ? 1 : 0;
  }
  EXPECT_GT(inside_count, 200);
}

TEST(ScreenError, is_one_pixel_at_the_distance_where_a_pixel_is_as_large_as_the_error) {
  Camera camera;
  const double ppr = pixels_per_radian(camera);
  EXPECT_NEAR(screen_error_px(0.1, 0.1 * ppr, ppr), 1.0, 1e-9);
  EXPECT_EQ(screen_error_px(0, 0, ppr), 0);
  EXPECT_TRUE(std::isinf(screen_error_px(0.1, 0, ppr)));
}

}  // namespace
}  // namespace promenade
