#include "layout/read_cost.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace promenade {
namespace {

using testing::ElementsAre;

/// A seek is worth 100 bytes.
constexpr StorageProfile kTape{"tape", 1, 100, 10};

TEST(ReadCost, a_read_is_aligned) {
  const ReadPlan plan = plan_reads(std::vector<Extent>{{15, 6}}, kTape);
  EXPECT_EQ(plan.reads, 1U);
  EXPECT_EQ(plan.bytes, 20U) << "10 to 30";
  EXPECT_EQ(plan.useful_bytes, 6U);
  EXPECT_DOUBLE_EQ(plan.seconds, 1 + 0.2);
}

TEST(ReadCost, near_extents_are_one_read_and_far_ones_two) {
  EXPECT_EQ(plan_reads(std::vector<Extent>{{0, 10}, {110, 10}}, kTape).reads, 1U);
  EXPECT_EQ(plan_reads(std::vector<Extent>{{0, 10}, {110, 10}}, kTape).bytes, 120U);
  EXPECT_EQ(plan_reads(std::vector<Extent>{{0, 10}, {120, 10}}, kTape).reads, 2U);
  EXPECT_EQ(plan_reads(std::vector<Extent>{{0, 10}, {120, 10}}, kTape).bytes, 20U);
}

TEST(ReadCost, extents_in_one_block_read_it_once) {
  EXPECT_EQ(plan_reads(std::vector<Extent>{{1, 2}, {5, 2}, {8, 4}}, kTape).bytes, 20U);
}

TEST(ReadCost, nothing_costs_nothing) {
  EXPECT_EQ(plan_reads({}, kTape).reads, 0U);
  EXPECT_EQ(plan_reads(std::vector<Extent>{{50, 0}}, kTape).seconds, 0);
}

TEST(ReadCost, nodes_lie_one_behind_the_other) {
  const NodeLayout layout(std::vector<uint32_t>{10, 500, 20, 30});
  EXPECT_EQ(layout.bytes(), 560U);
  EXPECT_EQ(layout.plan(std::vector<uint32_t>{2, 3}, kTape).useful_bytes, 50U);
  EXPECT_EQ(layout.plan(std::vector<uint32_t>{2, 3}, kTape).reads, 1U);
  EXPECT_EQ(layout.plan(std::vector<uint32_t>{0, 3}, kTape).reads, 2U);
}

TEST(Copies, go_to_the_steps_that_save_most_a_byte) {
  const auto plan = [](double seconds, uint64_t bytes) { return ReadPlan{1, bytes, bytes, seconds}; };
  const std::vector<ReadPlan> cost = {plan(5, 0), plan(9, 0), plan(1, 0), plan(9, 0)};
  const std::vector<ReadPlan> copied = {plan(1, 10), plan(1, 100), plan(2, 1), plan(1, 50)};
  EXPECT_THAT(choose_copies(cost, copied, 70), ElementsAre(1, 0, 0, 1));
  EXPECT_THAT(choose_copies(cost, copied, 1000), ElementsAre(1, 1, 0, 1)) << "a copy that saves nothing is not made";
  EXPECT_THAT(choose_copies(cost, copied, 0), ElementsAre(0, 0, 0, 0));
}

TEST(StorageProfiles, are_found_by_name) {
  for (const StorageProfile& profile : storage_profiles()) EXPECT_EQ(find_storage_profile(profile.name), &profile);
  EXPECT_EQ(find_storage_profile("drum"), nullptr);
}

}  // namespace
}  // namespace promenade
