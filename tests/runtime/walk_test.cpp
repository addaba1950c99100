#include "runtime/walk.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>

namespace promenade {
namespace {

constexpr double kFrameS = 1.0 / 30;

/// Boxes and a floor; seen from anywhere.
struct World {
  std::vector<glm::vec3> positions;
  std::vector<uint32_t> indices;

  void quad(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c, const glm::vec3& d) {
    const auto first = static_cast<uint32_t>(positions.size());
    positions.insert(positions.end(), {a, b, c, d});
    for (const uint32_t i : {0U, 1U, 2U, 0U, 2U, 3U}) indices.push_back(first + i);
  }
  void box(const glm::vec3& a, const glm::vec3& b) {
    quad({a.x, a.y, a.z}, {b.x, a.y, a.z}, {b.x, b.y, a.z}, {a.x, b.y, a.z});
    quad({a.x, a.y, b.z}, {b.x, a.y, b.z}, {b.x, b.y, b.z}, {a.x, b.y, b.z});
    quad({a.x, a.y, a.z}, {a.x, b.y, a.z}, {a.x, b.y, b.z}, {a.x, a.y, b.z});
    quad({b.x, a.y, a.z}, {b.x, b.y, a.z}, {b.x, b.y, b.z}, {b.x, a.y, b.z});
    quad({a.x, a.y, a.z}, {b.x, a.y, a.z}, {b.x, a.y, b.z}, {a.x, a.y, b.z});
    quad({a.x, b.y, a.z}, {b.x, b.y, a.z}, {b.x, b.y, b.z}, {a.x, b.y, b.z});
  }
  World() { box({-100, -100, -1}, {100, 100, 0}); }
  ClosestPointTree surface() const { return ClosestPointTree(positions, indices); }
};

/// Seconds straight ahead, along +x.
Pose walk(const World& world, Pose pose, double seconds, double speed = 1.4, double yaw_deg = 0) {
  const ClosestPointTree surface = world.surface();
  WalkState state;
  Motion motion;
  motion.forward = 1;
  pose.yaw_deg = yaw_deg;
  for (int i = 0; i < int(seconds / kFrameS); ++i)
    pose = walked(pose, motion, speed, kFrameS, surface, glm::dvec3(0), {}, state);
  return pose;
}

Pose standing(double x = 0, double y = 0, double floor = 0) {
  Pose pose;
  pose.eye = {x, y, floor + WalkOptions().eye_height_m};
  return pose;
}

TEST(Walk, goes_along_the_ground_however_far_down_one_looks) {
  Pose pose = standing();
  pose.pitch_deg = -80;
  const Pose end = walk(World(), pose, 2);
  EXPECT_NEAR(end.eye.x, 2.8, 0.1);
  EXPECT_NEAR(end.eye.z, pose.eye.z, 0.01);
}

TEST(Walk, stops_before_a_wall_at_any_speed_and_slides_along_it) {
  World world;
  world.box({3, -50, 0}, {3.1F, 50, 3});
  for (const double speed : {1.4, 12.0, 1000.0}) {
    const Pose end = walk(world, standing(), 4, speed);
    EXPECT_NEAR(end.eye.x, 3 - WalkOptions().radius_m, 0.03) << speed;
  }
  const Pose slid = walk(world, standing(), 6, 1.4, 45);
  EXPECT_LT(slid.eye.x, 3 - WalkOptions().radius_m + 0.03);
  EXPECT_GT(slid.eye.y, 4);
}

TEST(Walk, passes_a_door_and_not_a_slit) {
  World door, slit;
  for (const auto& [world, half] : {std::pair(&door, 0.45F), {&slit, 0.2F}}) {
    world->box({3, -50, 0}, {3.2F, -half, 3});
    world->box({3, half, 0}, {3.2F, 50, 3});
  }
  EXPECT_GT(walk(door, standing(), 5).eye.x, 5);
  EXPECT_LT(walk(slit, standing(), 5).eye.x, 3);
}

TEST(Walk, climbs_stairs_and_comes_down_again) {
  World world;
  for (int step = 0; step < 10; ++step) world.box({2 + 0.3F * float(step), -2, 0}, {20, 2, 0.17F * float(step + 1)});
  const Pose up = walk(world, standing(), 6);
  EXPECT_GT(up.eye.x, 6);
  EXPECT_NEAR(up.eye.z, 1.7 + WalkOptions().eye_height_m, 0.02);
  const Pose down = walk(world, up, 8, 1.4, 180);
  EXPECT_NEAR(down.eye.z, WalkOptions().eye_height_m, 0.02);
}

TEST(Walk, lets_the_eye_rise_smoothly_onto_a_step) {
  World world;
  world.box({0.5F, -5, 0}, {20, 5, 0.4F});
  const ClosestPointTree surface = world.surface();
  WalkState state;
  Motion motion;
  motion.forward = 1;
  Pose pose = standing();
  double steepest = 0;
  for (int i = 0; i < 90; ++i) {
    const double before = pose.eye.z;
    pose = walked(pose, motion, 1.4, kFrameS, surface, glm::dvec3(0), {}, state);
    steepest = std::max(steepest, pose.eye.z - before);
  }
  EXPECT_NEAR(pose.eye.z, 0.4 + WalkOptions().eye_height_m, 0.01);
  EXPECT_LT(steepest, 0.15);
}

TEST(Walk, does_not_climb_what_is_higher_than_a_step) {
  World world;
  world.box({3, -50, 0}, {10, 50, 0.9F});
  const Pose end = walk(world, standing(), 5);
  EXPECT_LT(end.eye.x, 3);
  EXPECT_NEAR(end.eye.z, WalkOptions().eye_height_m, 0.02);
}

TEST(Walk, falls_to_the_ground_and_no_further) {
  const World world;
  Pose pose = standing(0, 0, 20);
  const ClosestPointTree surface = world.surface();
  WalkState state;
  double seconds = 0, lowest = pose.eye.z;
  for (; !state.on_ground && seconds < 10; seconds += kFrameS) {
    pose = walked(pose, {}, 1.4, kFrameS, surface, glm::dvec3(0), {}, state);
    lowest = std::min(lowest, pose.eye.z);
  }
  EXPECT_NEAR(seconds, std::sqrt(2 * 20 / 9.81), 0.15);
  for (int i = 0; i < 10; ++i) pose = walked(pose, {}, 1.4, kFrameS, surface, glm::dvec3(0), {}, state);
  EXPECT_NEAR(pose.eye.z, WalkOptions().eye_height_m, 0.02);
  EXPECT_GT(lowest, WalkOptions().eye_height_m - 0.02);
}

TEST(Walk, where_nothing_is_nobody_falls_and_nothing_stops_them) {
  const ClosestPointTree nothing({}, {});
  WalkState state;
  Motion motion;
  motion.forward = 1;
  const Pose end = walked(standing(), motion, 2, 0.5, nothing, glm::dvec3(0), {}, state);
  EXPECT_NEAR(end.eye.x, 1, 1e-9);
  EXPECT_EQ(end.eye.z, standing().eye.z);
  // Above the edge of the world: no ground within reach.
  const World world;
  const Pose beyond = walked(standing(300, 0, 5), {}, 2, 0.5, world.surface(), glm::dvec3(0), {}, state);
  EXPECT_EQ(beyond.eye.z, standing(300, 0, 5).eye.z);
}

TEST(Walk, keeps_its_place_in_a_world_far_from_zero) {
  const World world;
  const glm::dvec3 origin(500000, 5e6, 300);
  WalkState state;
  Pose pose = standing();
  pose.eye += origin;
  Motion motion;
  motion.forward = 1;
  const ClosestPointTree surface = world.surface();
  for (int i = 0; i < 30; ++i) pose = walked(pose, motion, 1.4, kFrameS, surface, origin, {}, state);
  EXPECT_NEAR(pose.eye.x - origin.x, 1.4, 0.05);
  EXPECT_NEAR(pose.eye.z - origin.z, WalkOptions().eye_height_m, 0.02);
}

}  // namespace
}  // namespace promenade
