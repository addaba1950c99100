#include "geometry/animation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>

#include "geometry/random.h"

namespace promenade {
namespace {

using Way = AnimationTrack::Way;

uint32_t add_track(Animation& a, Way way, uint32_t components, const std::vector<float>& times,
                   const std::vector<float>& values, float period_s = 0) {
  a.tracks.push_back({way, components, static_cast<uint32_t>(a.times.size()), static_cast<uint32_t>(a.values.size()),
                      static_cast<uint32_t>(times.size()), period_s});
  a.times.insert(a.times.end(), times.begin(), times.end());
  a.values.insert(a.values.end(), values.begin(), values.end());
  return static_cast<uint32_t>(a.tracks.size() - 1);
}

Animation one_joint(AnimationJoint::Slot slot, Way way, const std::vector<float>& times,
                    const std::vector<float>& values, float period_s = 0) {
  Animation a;
  AnimationJoint joint;
  joint.tracks[slot] = add_track(a, way, slot == AnimationJoint::rotation_slot ? 4 : 3, times, values, period_s);
  a.joints = {joint};
  EXPECT_EQ(find_defect(a), "");
  return a;
}

glm::dvec3 moved(const Animation& a, double time_s, const glm::dvec3& p = glm::dvec3(0)) {
  return glm::dvec3(poses_at(a, time_s).back() * glm::dvec4(p, 1));
}

void expect_near(const glm::dvec3& a, const glm::dvec3& b) { EXPECT_NEAR(glm::distance(a, b), 0, 1e-6); }

TEST(Animation, linear_keys_are_joined_by_lines_and_hold_beyond_their_ends) {
  const Animation a = one_joint(AnimationJoint::translation_slot, Way::linear, {1, 3}, {0, 0, 0, 4, 2, 0});
  expect_near(moved(a, 0), {0, 0, 0});
  expect_near(moved(a, 2), {2, 1, 0});
  expect_near(moved(a, 9), {4, 2, 0});
}

TEST(Animation, steps_hold_a_key_until_the_next) {
  const Animation a = one_joint(AnimationJoint::translation_slot, Way::step, {0, 1}, {1, 0, 0, 5, 0, 0});
  expect_near(moved(a, 0.99), {1, 0, 0});
  expect_near(moved(a, 1), {5, 0, 0});
}

TEST(Animation, splines_leave_and_reach_keys_along_their_tangents) {
  // Tangents of 3 a second over two seconds: Hermite's polynomial at the middle is (0 + 4) / 2 + 2 (3 - 3) / 8.
  const Animation a = one_joint(AnimationJoint::translation_slot, Way::cubic, {0, 2},
                                {0, 0, 0, 0, 0, 0, 3, 0, 0, 3, 0, 0, 4, 0, 0, 0, 0, 0});
  expect_near(moved(a, 1), {2, 0, 0});
  expect_near(moved(a, 0.001) * 1000.0, {3 - 0.0015, 0, 0});
}

TEST(Animation, rotations_go_the_shorter_way_at_even_speed) {
  const float h = std::sqrt(0.5F);
  // A quarter turn about z, the second key named by its opposite: the same rotation.
  const Animation a = one_joint(AnimationJoint::rotation_slot, Way::linear, {0, 1}, {0, 0, 0, 1, 0, 0, -h, -h});
  const double third = std::numbers::pi / 6;
  expect_near(moved(a, 1.0 / 3, {1, 0, 0}), {std::cos(third), std::sin(third), 0});
}

TEST(Animation, begins_anew_after_its_period) {
  const Animation a = one_joint(AnimationJoint::translation_slot, Way::linear, {0, 2}, {0, 0, 0, 2, 0, 0}, 2);
  expect_near(moved(a, 7), {1, 0, 0});
  expect_near(moved(a, -0.5), {1.5, 0, 0});
}

TEST(Animation, children_follow_their_parents) {
  Animation a = one_joint(AnimationJoint::translation_slot, Way::linear, {0, 1}, {0, 0, 0, 10, 0, 0});
  AnimationJoint child;
  child.parent = 0;
  child.parent_from_rest[3] = {0, 1, 0, 1};
  child.scale = {2, 2, 2};
  a.joints.push_back(child);
  ASSERT_EQ(find_defect(a), "");
  expect_near(moved(a, 0.5, {1, 0, 0}), {7, 1, 0});
}

/// A chain of joints with tracks of all kinds.
Animation random_chain(Random& random) {
  Animation a;
  const auto number = [&random](double most) { return static_cast<float>(random.range(-most, most)); };
  for (uint32_t j = 0; j < 3; ++j) {
    AnimationJoint joint;
    joint.parent = j == 0 ? kNoJoint : j - 1;
    for (int i = 0; i < 3; ++i) joint.parent_from_rest[3][i] = random.range(-2.0, 2.0);
    joint.parent_from_rest[0][1] = random.range(-0.5, 0.5);  // sheared, too
    for (const AnimationJoint::Slot slot :
         {AnimationJoint::translation_slot, AnimationJoint::rotation_slot, AnimationJoint::scale_slot}) {
      if (random.below(4) == 0) continue;
      const Way way = static_cast<Way>(random.below(3));
      const uint32_t components = slot == AnimationJoint::rotation_slot ? 4 : 3;
      const bool upright = random.below(2) == 0;  // about z only
      std::vector<float> values;
      for (uint32_t i = 0; i < 3 * components * (way == Way::cubic ? 3 : 1); ++i)
        values.push_back(components == 4 && upright && i % 4 < 2 ? 0.0F : number(2));
      joint.tracks[slot] = add_track(a, way, components, {0, 0.7F, 2}, values, random.below(2) == 0 ? 2.0F : 0.0F);
    }
    a.joints.push_back(joint);
  }
  EXPECT_EQ(find_defect(a), "");
  return a;
}

TEST(SweptBox, holds_what_moves_at_any_time) {
  Random random(7);
  const DBox box{{-1, 0.5, -0.25}, {2, 1, 0.5}};
  for (int trial = 0; trial < 100; ++trial) {
    const Animation a = random_chain(random);
    const DBox swept = swept_box(a, 2, box).grown(1e-9);
    for (int i = 0; i <= 300; ++i) {
      const DBox now = transformed_box(box, poses_at(a, i * 0.01)[2]);
      ASSERT_TRUE(swept.contains(now)) << "trial " << trial << ", frame " << i;
    }
  }
}

TEST(SweptBox, of_a_turntable_is_as_high_as_what_stands_on_it) {
  const Animation a = one_joint(AnimationJoint::rotation_slot, Way::linear, {0, 1}, {0, 0, 0, 1, 0, 0, 1, 0});
  const DBox swept = swept_box(a, 0, {{3, -1, 0}, {4, 1, 2}});
  EXPECT_EQ(swept.min.z, 0);
  EXPECT_EQ(swept.max.z, 2);
  EXPECT_NEAR(swept.max.x, std::sqrt(17.0), 1e-9);
}

TEST(LargestScale, bounds_what_any_direction_is_lengthened_by) {
  Random random(3);
  for (int trial = 0; trial < 50; ++trial) {
    const Animation a = random_chain(random);
    const double bound = largest_scale(a, 2);
    for (int i = 0; i <= 100; ++i) {
      const glm::dmat3 linear(poses_at(a, i * 0.03)[2]);
      const glm::dvec3 way = glm::normalize(
          glm::dvec3(random.range(-1.0, 1.0), random.range(-1.0, 1.0), random.range(-1.0, 1.0)) + glm::dvec3(1e-3));
      ASSERT_LE(glm::length(linear * way), bound * (1 + 1e-9)) << "trial " << trial;
    }
  }
}

TEST(LargestScale, of_what_only_turns_and_goes_is_one) {
  const Animation a = one_joint(AnimationJoint::rotation_slot, Way::linear, {0, 1}, {0, 0, 0, 1, 0, 0, 1, 0});
  EXPECT_NEAR(largest_scale(a, 0), 1, 1e-8);
}

TEST(Animation, defects_are_named) {
  const Animation good = one_joint(AnimationJoint::translation_slot, Way::linear, {0, 1}, {0, 0, 0, 1, 0, 0});
  const auto defect = [&good](auto&& spoil) {
    Animation a = good;
    spoil(a);
    return find_defect(a);
  };
  EXPECT_NE(defect([](Animation& a) { a.times[1] = 0; }), "");
  EXPECT_NE(defect([](Animation& a) { a.values[2] = std::numeric_limits<float>::quiet_NaN(); }), "");
  EXPECT_NE(defect([](Animation& a) { a.tracks[0].keys = 3; }), "");
  EXPECT_NE(defect([](Animation& a) { a.tracks[0].keys = 0; }), "");
  EXPECT_NE(defect([](Animation& a) { a.tracks[0].first_value = 0xfffffff0U; }), "");
  EXPECT_NE(defect([](Animation& a) { a.tracks[0].way = Way::cubic; }), "");
  EXPECT_NE(defect([](Animation& a) { a.joints[0].parent = 0; }), "");
  EXPECT_NE(defect([](Animation& a) { a.joints[0].tracks[AnimationJoint::rotation_slot] = 0; }), "");
}

TEST(AppendUsed, takes_what_is_used_and_what_it_hangs_on) {
  Random random(1);
  const Animation chain = random_chain(random);
  Animation both;
  EXPECT_EQ(append_used(both, chain, {false, true, false}), (std::vector<uint32_t>{0, 1, kNoJoint}));
  const std::vector<uint32_t> again = append_used(both, chain, {true, true, true});
  EXPECT_EQ(again, (std::vector<uint32_t>{2, 3, 4}));
  ASSERT_EQ(find_defect(both), "");
  EXPECT_EQ(poses_at(both, 0.9)[4], poses_at(chain, 0.9)[2]);
  EXPECT_EQ(poses_at(both, 0.9)[1], poses_at(chain, 0.9)[1]);
}

}  // namespace
}  // namespace promenade
