#include <gtest/gtest.h>

#include "geometry/random.h"

namespace promenade {
namespace {

TEST(RandomStream, gives_the_same_numbers_everywhere) {
  Random random(1, {2, 3});
  EXPECT_EQ(random.next(), Random(1, {2, 3}).next());
  Random first(0);
  // Committed: a change of these changes every generated file.
  EXPECT_EQ(first.next(), 0xa706dd2f4d197e6fU);
  EXPECT_EQ(first.next(), 0xb382a305f4414f5eU);
}

TEST(RandomStream, numbers_stay_in_their_range_and_reach_its_ends) {
  Random random(7);
  int low = 0, high = 0;
  for (int i = 0; i < 2000; ++i) {
    const int value = random.between(-2, 3);
    ASSERT_GE(value, -2);
    ASSERT_LE(value, 3);
    low += value == -2 ? 1 : 0, high += value == 3 ? 1 : 0;
    const double unit = random.unit();
    ASSERT_GE(unit, 0);
    ASSERT_LT(unit, 1);
  }
  EXPECT_GT(low, 200);
  EXPECT_GT(high, 200);
}

TEST(RandomStream, a_fork_does_not_move_its_parent) {
  Random a(5), b(5);
  Random fork = a.fork(1);
  fork.next();
  EXPECT_EQ(a.next(), b.next());
  EXPECT_NE(Random(5).fork(1).next(), Random(5).fork(2).next());
}

}  // namespace
}  // namespace promenade
