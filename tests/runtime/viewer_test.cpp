#include "runtime/viewer.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <glm/geometric.hpp>

#include "runtime/motion.h"
#include "tests/runtime/forest.h"

namespace promenade {
namespace {

TEST(Motion, keys_move_along_the_view) {
  Pose pose;
  pose.yaw_deg = 90;  // looks along +y
  Motion motion;
  motion.forward = 1;
  EXPECT_LT(glm::distance(moved(pose, motion, 2, 0.5).eye, glm::dvec3(0, 1, 0)), 1e-12);
  motion = {};
  motion.right = 1;
  EXPECT_LT(glm::distance(moved(pose, motion, 2, 0.5).eye, glm::dvec3(1, 0, 0)), 1e-12);
  motion = {};
  motion.up = -1;
  EXPECT_LT(glm::distance(moved(pose, motion, 2, 0.5).eye, glm::dvec3(0, 0, -1)), 1e-12);
}

TEST(Motion, mouse_turns_the_head_by_the_screens_axes) {
  Motion motion;
  motion.look_right_px = 40;
  motion.look_down_px = 20;
  const Pose level = moved(Pose{}, motion, 1, 0.01);
  EXPECT_NEAR(level.yaw_deg, -10, 1e-12);
  EXPECT_NEAR(level.pitch_deg, -5, 1e-12);
  // Head tilted a quarter to the right: the screen's right is down.
  Pose tilted;
  tilted.roll_deg = 90;
  motion.look_down_px = 0;
  const Pose turned = moved(tilted, motion, 1, 0.01);
  EXPECT_GT(glm::dot(basis_of(turned).forward, basis_of(tilted).right), 0.1) << "towards the screen's right";
}

TEST(Motion, looking_up_stops_at_the_zenith) {
  Motion motion;
  motion.look_down_px = -1e6;
  EXPECT_EQ(moved(Pose{}, motion, 1, 0.01).pitch_deg, 90);
}

TEST(Motion, roll_comes_round) {
  Motion motion;
  motion.roll = 1;
  EXPECT_NEAR(moved(Pose{}, motion, 1, 4).roll_deg, -120, 1e-9);
}

TEST(Motion, wheel_changes_speed_within_limits) {
  EXPECT_NEAR(changed_speed(1, 1), 1.25, 1e-12);
  EXPECT_NEAR(changed_speed(changed_speed(3, 5), -5), 3, 1e-12);
  EXPECT_EQ(changed_speed(1, -1000), 0.01);
}

TEST(Motion, overview_has_every_corner_in_view) {
  const DBox box{{500000, 5e6, -20}, {500400, 5000100, 80}};
  Camera camera;
  camera.pose = overview_of(box, camera.vertical_fov_deg);
  const Frustum frustum = frustum_of(camera, box.min);
  EXPECT_EQ(classify(frustum, Box{glm::vec3(0), glm::vec3(box.size())}), Overlap::inside);
}

TEST(Viewer, without_a_display_says_so) {
  if (std::getenv("DISPLAY") != nullptr || std::getenv("WAYLAND_DISPLAY") != nullptr)
    GTEST_SKIP() << "there is a display";
  forest::Forest model;
  model.root({{10, -8, -1}, {10.5F, 8, 1}}, 1);
  const Result<ViewerReport> report = view(model, ViewerOptions{});
  ASSERT_FALSE(report);
  EXPECT_NE(report.error().message.find("no window"), std::string::npos) << report.error().message;
}

TEST(Viewer, draws_in_a_window_where_there_is_a_display) {
  if (std::getenv("DISPLAY") == nullptr) GTEST_SKIP() << "no display: run under xvfb-run";
  forest::Forest model;
  model.grow(model.root({{10, -8, -1}, {10.5F, 8, 1}}, 1), 2, 2);
  ViewerOptions options;
  options.max_frames = 5;
  options.start = Pose{};
  for (const RendererKind kind : {RendererKind::gl, RendererKind::cpu, RendererKind::automatic}) {
    options.renderer = kind;
    const Result<ViewerReport> report = view(model, options);
    ASSERT_TRUE(report) << report.error().message;
    EXPECT_EQ(report->frames, 5U);
  }
}

}  // namespace
}  // namespace promenade
