#include "runtime/self_motion.h"

#include <gtest/gtest.h>

#include <glm/geometric.hpp>

namespace promenade {
namespace {

TEST(SelfMotion, glides_the_shorter_way_and_arrives) {
  SelfMotion motion;
  EXPECT_FALSE(motion.next(1));
  motion.glide({{0, 0, 0}, 350, 0, 0}, {{10, 0, 0}, 10, 20, 0});
  double last_x = 0;
  for (int i = 0; i < 7; ++i) {
    const std::optional<Pose> pose = motion.next(0.1);
    ASSERT_TRUE(pose);
    EXPECT_GT(pose->eye.x, last_x);
    EXPECT_GT(pose->yaw_deg, 349.9);
    EXPECT_LT(pose->yaw_deg, 370.1);
    last_x = pose->eye.x;
  }
  const std::optional<Pose> end = motion.next(0.2);
  ASSERT_TRUE(end);
  EXPECT_EQ(end->eye.x, 10);
  EXPECT_EQ(end->yaw_deg, 10);
  EXPECT_FALSE(motion.moving());
}

TEST(SelfMotion, replays_a_path_from_its_first_key_to_its_last) {
  CameraPath path;
  path.keys = {{5, {{0, 0, 0}, 0, 0, 0}}, {7, {{4, 0, 0}, 0, 0, 0}}};
  SelfMotion motion;
  motion.replay(path);
  EXPECT_NEAR(motion.next(0.5)->eye.x, 1, 1e-9);
  EXPECT_TRUE(motion.replaying());
  EXPECT_NEAR(motion.next(10)->eye.x, 4, 1e-9);
  EXPECT_FALSE(motion.moving());
  motion.replay({});
  EXPECT_FALSE(motion.moving());
}

}  // namespace
}  // namespace promenade
