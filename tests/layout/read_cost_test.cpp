#include "layout/read_cost.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <utility>

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

TEST(ReadCost, reads_are_joined_nearest_first_while_enough_is_wanted) {
  // Gaps of 40, 10 and 20 bytes between blocks of 10, all of them worth less than a seek.
  const std::vector<Extent> extents = {{0, 10}, {50, 10}, {70, 10}, {100, 10}};
  const auto reads_with = [&](double least_useful) {
    std::vector<std::pair<uint64_t, uint64_t>> reads;
    for (const Extent& read : merge_reads(extents, kTape, least_useful)) reads.emplace_back(read.offset, read.bytes);
    return reads;
  };
  using Pair = std::pair<uint64_t, uint64_t>;
  EXPECT_THAT(reads_with(0), ElementsAre(Pair(0, 110)));
  EXPECT_THAT(reads_with(0.5), ElementsAre(Pair(0, 10), Pair(50, 60)));
  EXPECT_THAT(reads_with(0.8), ElementsAre(Pair(0, 10), Pair(50, 30), Pair(100, 10)));
  EXPECT_THAT(reads_with(1), ElementsAre(Pair(0, 10), Pair(50, 10), Pair(70, 10), Pair(100, 10)));
  EXPECT_EQ(plan_reads(extents, kTape, 0.8).bytes, 50U);
  EXPECT_EQ(plan_reads(extents, kTape, 0.8).useful_bytes, 40U);
}

TEST(ReadCost, a_read_brings_the_nodes_that_are_whole_in_it) {
  const NodeLayout layout(std::vector<uint32_t>{10, 10, 30});
  const auto whole = [&](uint64_t offset, uint64_t bytes) {
    const NodeLayout::Places places = layout.whole_in({offset, bytes});
    return std::pair(places.first, places.last);
  };
  EXPECT_EQ(whole(0, 50), std::pair(0U, 3U));
  EXPECT_EQ(whole(10, 10), std::pair(1U, 2U));
  EXPECT_EQ(whole(5, 30), std::pair(1U, 2U));
  EXPECT_EQ(whole(11, 20).first, whole(11, 20).second);
  EXPECT_EQ(whole(0, 60), std::pair(0U, 3U)) << "the last block ends behind the last node";
  EXPECT_EQ(NodeLayout(std::span<const uint32_t>()).whole_in({0, 10}).last, 0U);
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
