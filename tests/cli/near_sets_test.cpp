#include "cli/near_sets.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace promenade {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

/// A root over four leaves of a metre in a row.
Model row_of_leaves() {
  Model model;
  model.tables.nodes.resize(5);
  model.tables.nodes[0].box = {{0, 0, 0}, {4, 1, 1}};
  model.tables.nodes[0].child_count = 4;
  for (uint32_t i = 1; i < 5; ++i) {
    const auto x = static_cast<float>(i);
    model.tables.nodes[i].box = {{x - 1, 0, 0}, {x, 1, 1}};
    model.tables.children.push_back(NodeId{5 - i});
  }
  model.tables.roots = {NodeId{0}};
  return model;
}

TEST(LeavesNear, are_those_that_meet_the_box_in_order) {
  const Model model = row_of_leaves();
  EXPECT_THAT(leaves_near(model, {{1.2F, 0, 0}, {2.5F, 1, 1}}), ElementsAre(2, 3));
  EXPECT_THAT(leaves_near(model, {{0, 0, 0}, {9, 1, 1}}), ElementsAre(1, 2, 3, 4));
  EXPECT_THAT(leaves_near(model, {{0, 0, 2}, {9, 1, 3}}), IsEmpty());
}

TEST(NearSets, count_what_changes_between_cells) {
  const Model model = row_of_leaves();
  NearSets near;
  near.add(model, {{0.2F, 0, 0}, {1.8F, 1, 1}}, {{1.2F, 0, 0}, {2.8F, 1, 1}});
  near.add(model, {{0.2F, 0, 0}, {0.8F, 1, 1}}, {{0.2F, 0, 0}, {0.9F, 1, 1}});
  EXPECT_EQ(near.steps, 2U);
  EXPECT_EQ(near.leaves, 3U);
  EXPECT_EQ(near.changed, 2U);
  EXPECT_GT(near.delta_bytes, 0U);
}

}  // namespace
}  // namespace promenade
