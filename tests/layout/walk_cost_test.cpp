#include "layout/walk_cost.h"

#include <gtest/gtest.h>

namespace promenade {
namespace {

/// A seek is worth 10 bytes; no blocks.
constexpr StorageProfile kTape{"tape", 1, 10, 1};

/// Ten nodes of ten bytes.
NodeLayout ten_nodes() { return NodeLayout(std::vector<uint32_t>(10, 10)); }

WalkCost walk(const std::vector<std::vector<uint32_t>>& wanted, uint64_t memory_bytes, double least_useful = 0) {
  return walk_cost(ten_nodes(), wanted, {kTape, least_useful, memory_bytes});
}

TEST(WalkCost, what_stays_in_memory_is_not_read_again) {
  const WalkCost cost = walk({{0, 1}, {4, 5}, {0, 1}}, 100);
  EXPECT_EQ(cost.taken, 2U);
  EXPECT_EQ(cost.start.bytes, 20U);
  EXPECT_EQ(cost.steps.bytes, 20U);
  EXPECT_EQ(cost.steps.reads, 1U);
  EXPECT_EQ(cost.useful_share, 1);
}

TEST(WalkCost, what_was_wanted_longest_ago_goes_first) {
  // There is room for four nodes: 0 and 1 leave for 8, not 4 and 5.
  const WalkCost cost = walk({{0, 1}, {4, 5}, {8}, {4, 5}, {0, 1}}, 40);
  EXPECT_EQ(cost.steps.bytes, 20U + 10U + 0U + 10U) << "one of the first two leaves";
  EXPECT_EQ(walk({{0, 1}, {4, 5}, {8}, {4, 5}, {0, 1}}, 0).steps.bytes, 20U + 10U + 20U + 20U);
}

TEST(WalkCost, what_lies_between_comes_along_and_is_useful_once_it_is_wanted) {
  // 0 and 2 are read as one, with 1 between.
  const WalkCost unused = walk({{0, 2}, {0, 2, 8}}, 100);
  EXPECT_EQ(unused.start.reads, 1U);
  EXPECT_EQ(unused.start.bytes, 30U);
  EXPECT_DOUBLE_EQ(unused.useful_share, 30.0 / 40);
  const WalkCost used = walk({{0, 2}, {0, 1, 2}}, 100);
  EXPECT_EQ(used.steps.bytes, 0U);
  EXPECT_DOUBLE_EQ(used.useful_share, 1);
  EXPECT_EQ(walk({{0, 2}}, 100, 0.9).start.reads, 2U) << "a third of one read would be in vain";
}

TEST(WalkCost, the_same_node_read_twice_counts_twice) {
  const WalkCost cost = walk({{0}, {9}, {0}}, 10);
  EXPECT_EQ(cost.steps.bytes, 20U);
  EXPECT_DOUBLE_EQ(cost.useful_share, 1);
}

TEST(WalkCost, nothing_costs_nothing) {
  EXPECT_EQ(walk({}, 10).taken, 0U);
  EXPECT_EQ(walk({{}}, 10).start.bytes, 0U);
  EXPECT_EQ(walk({{}}, 10).useful_share, 1);
}

}  // namespace
}  // namespace promenade
