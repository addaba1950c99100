#include "preprocess/visibility/view_cells.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>
#include <set>

#include "layout/cell_faces.h"
#include "tests/layout/cell_fixtures.h"

namespace promenade {
namespace {

using testing::IsEmpty;

/// Random octants of a flat space, some of them dead.
CellPlan random_plan(uint32_t seed, int splits) {
  std::mt19937 random(seed);
  CellPlan plan({{-7, 3, 0}, {90, 60, 20}});
  std::vector<uint32_t> leaves = {CellPlan::kRoot};
  for (int i = 0; i < splits; ++i) {
    const size_t at = random() % leaves.size();
    const std::vector<uint32_t> parts = plan.split_octants(leaves[at]);
    leaves.erase(leaves.begin() + static_cast<std::ptrdiff_t>(at));
    leaves.insert(leaves.end(), parts.begin(), parts.end());
  }
  for (const uint32_t leaf : leaves)
    if (random() % 4U != 0) plan.set_cell(leaf, plan.box_of(leaf));
  return plan;
}

TEST(CellPlan, octants_halve_long_axes_until_parts_are_about_cubes) {
  CellPlan plan({{0, 0, 0}, {100, 80, 20}});
  const std::vector<uint32_t> parts = plan.split_octants(CellPlan::kRoot);
  ASSERT_EQ(parts.size(), 4U) << "20 m high is not worth halving beside 100";
  EXPECT_EQ(plan.box_of(parts[0]), (Box{{0, 0, 0}, {50, 40, 20}}));
  const std::vector<uint32_t> finer = plan.split_octants(parts[3]);
  ASSERT_EQ(finer.size(), 4U);
  EXPECT_EQ(plan.split_octants(finer[0]).size(), 8U) << "20 m high is, beside 25";
}

TEST(CellPlan, what_precision_cannot_halve_stays_whole) {
  CellPlan plan({{1e7F, 0, 0}, {1e7F + 1, 0.1F, 0.1F}});
  EXPECT_THAT(plan.split_octants(CellPlan::kRoot), IsEmpty());
  EXPECT_TRUE(plan.is_leaf(CellPlan::kRoot));
}

TEST(TablesOf, are_sound_and_find_every_neighbour) {
  for (uint32_t seed = 0; seed < 20; ++seed) {
    const CellPlan plan = random_plan(seed, 40);
    std::vector<uint32_t> leaves;
    CellTables tables = tables_of(plan, one_pixel(), leaves);
    ASSERT_TRUE(find_faces(tables));
    ASSERT_TRUE(faces_follow(tables));
    ASSERT_THAT(find_defect(tables), IsEmpty());
    ASSERT_EQ(leaves.size(), tables.cells.size());
    std::set<std::pair<uint32_t, uint32_t>> found, due;
    for (const CellFace& face : tables.faces) {
      const uint32_t below = index_of(face.below), above = index_of(face.above);
      EXPECT_TRUE(found.insert({std::min(below, above), std::max(below, above)}).second) << "a pair twice";
      ASSERT_EQ(face.portal_count, 1U);
      EXPECT_EQ(tables.portals_of(face)[0], rectangle_of(tables, face));
    }
    for (uint32_t a = 0; a < tables.cells.size(); ++a)
      for (uint32_t b = a + 1; b < tables.cells.size(); ++b) {
        const Box &first = tables.cells[a].box, &second = tables.cells[b].box;
        int flat = 0, apart = 0;
        for (int i = 0; i < 3; ++i) {
          const float overlap = std::min(first.max[i], second.max[i]) - std::max(first.min[i], second.min[i]);
          flat += overlap == 0 ? 1 : 0, apart += overlap < 0 ? 1 : 0;
        }
        if (flat == 1 && apart == 0) due.insert({a, b});
      }
    EXPECT_EQ(found, due);
  }
}

TEST(TablesOf, cells_are_the_leaves_that_somebody_may_stand_in) {
  const CellPlan plan = random_plan(5, 30);
  std::vector<uint32_t> leaves;
  const CellTables tables = tables_of(plan, one_pixel(), leaves);
  for (uint32_t i = 0; i < leaves.size(); ++i) {
    EXPECT_EQ(tables.cells[i].box, plan.box_of(leaves[i]));
    EXPECT_EQ(cell_at(tables, tables.cells[i].box.center()), CellId{i});
  }
}

TEST(TablesOf, two_halves_join_when_they_fill_a_box) {
  CellPlan plan({{0, 0, 0}, {4, 2, 2}});
  plan.split(CellPlan::kRoot, 0, 1);
  const uint32_t low = plan.below(CellPlan::kRoot), high = plan.above(CellPlan::kRoot);
  EXPECT_TRUE(plan.is_dead(CellPlan::kRoot));
  plan.set_cell(low, plan.box_of(low));
  EXPECT_FALSE(plan.is_dead(CellPlan::kRoot));
  EXPECT_TRUE(plan.joined_cells(CellPlan::kRoot).empty()) << "the other half is dead";
  plan.set_cell(high, {{1, 0, 1}, {4, 2, 2}});
  EXPECT_TRUE(plan.joined_cells(CellPlan::kRoot).empty()) << "the other cell is lower";
  plan.set_cell(high, plan.box_of(high));
  EXPECT_EQ(plan.joined_cells(CellPlan::kRoot), plan.box_of(CellPlan::kRoot));
  plan.split(low, 1, 1);
  EXPECT_TRUE(plan.joined_cells(CellPlan::kRoot).empty()) << "no leaf";
}

TEST(TablesOf, a_plan_without_cells_has_none) {
  const CellPlan plan({{0, 0, 0}, {1, 1, 1}});
  std::vector<uint32_t> leaves;
  const CellTables tables = tables_of(plan, one_pixel(), leaves);
  EXPECT_THAT(find_defect(tables), IsEmpty());
  EXPECT_THAT(tables.cells, IsEmpty());
}

}  // namespace
}  // namespace promenade
