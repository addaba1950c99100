#include "geometry/shells.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/trigonometric.hpp>

namespace promenade {
namespace {

/// The campus of [xiong1996] section 4.2.
ShellSetup campus() { return {glm::radians(10.0), 56, {1000, 1000, 10}, ParallaxRule::published}; }

struct PublishedShell {
  double cell_m, box_m;
  uint64_t cells;
};

/// The tables leave out the outermost shell, of 49 cells, which their totals count.
void expect_table(const std::vector<Shell>& shells, const std::vector<PublishedShell>& table, uint64_t total) {
  ASSERT_EQ(shells.size(), table.size() + 1);
  for (size_t i = 0; i < table.size(); ++i) {
    EXPECT_NEAR(shells[i].cell_m, table[i].cell_m, 0.006 * table[i].cell_m) << "shell " << i;
    EXPECT_NEAR(shells[i].box_m, table[i].box_m, 0.002 * table[i].box_m) << "shell " << i;
    EXPECT_EQ(shells[i].cells, table[i].cells) << "shell " << i;
  }
  EXPECT_EQ(shells.back().cells, 49U);
  EXPECT_EQ(cells_of(shells), total);
}

// The factors are published with two decimals; their boxes give them with four.
TEST(Shells, with_linear_spacing_are_table_4_1_and_no_factor_is_much_better) {
  const Result<std::vector<Shell>> shells = shells_of(campus(), ShellSpacing::linear, 1.7222);
  ASSERT_TRUE(shells.ok());
  expect_table(*shells,
               {{10.0, 56.0, 10000}, {17.2, 96.4, 3481}, {29.6, 166.2, 1156}, {51.1, 286.3, 400}, {88.0, 493.3, 144}},
               15230);
  const Result<ShellOptimum> best = best_shells(campus(), ShellSpacing::linear, 1.3, 3, 1701);
  ASSERT_TRUE(best.ok());
  EXPECT_LE(cells_of(best->shells), 15230U);
  EXPECT_GE(cells_of(best->shells), 15000U);
}

TEST(Shells, with_exponential_spacing_are_table_4_2_and_no_factor_is_much_better) {
  const Result<std::vector<Shell>> shells = shells_of(campus(), ShellSpacing::exponential, 1.1365);
  ASSERT_TRUE(shells.ok());
  expect_table(*shells, {{10.0, 56.0, 10000}, {16.6, 97.0, 3600}, {30.0, 181.1, 1156}, {58.1, 368.4, 324}}, 15129);
  const Result<ShellOptimum> best = best_shells(campus(), ShellSpacing::exponential, 1.05, 1.4, 1751);
  ASSERT_TRUE(best.ok());
  EXPECT_LE(cells_of(best->shells), 15129U);
  EXPECT_GE(cells_of(best->shells), 15000U);
}

TEST(Shells, single_one_has_the_published_number_of_cells) {
  const Result<Shell> single = single_shell(campus());
  ASSERT_TRUE(single.ok());
  EXPECT_NEAR(double(single->cells), 50000, 200);
}

TEST(Shells, keep_the_bound_by_the_rule_that_looks_everywhere) {
  ShellSetup setup = campus();
  setup.rule = ParallaxRule::everywhere;
  const Result<std::vector<Shell>> shells = shells_of(setup, ShellSpacing::linear, 1.7);
  ASSERT_TRUE(shells.ok());
  for (size_t i = 0; i < shells->size(); ++i) {
    const Shell& shell = (*shells)[i];
    const double reach_m = i + 1 < shells->size() ? ((*shells)[i + 1].cell_m + (*shells)[i + 1].box_m) / 2
                                                  : setup.model_m.x - shell.cell_m / 2;
    EXPECT_LE(largest_parallax_rad({shell.cell_m, shell.box_m, reach_m}), setup.bound_rad * (1 + 1e-9));
  }
}

TEST(Shells, of_hostile_numbers_are_refused) {
  EXPECT_FALSE(shells_of(campus(), ShellSpacing::linear, 1).ok());
  EXPECT_FALSE(shells_of(campus(), ShellSpacing::linear, std::nan("")).ok());
  EXPECT_FALSE(shells_of(campus(), ShellSpacing::linear, 1 + 1e-9).ok()) << "millions of shells";
  ShellSetup setup = campus();
  setup.model_m.x = std::nan("");
  EXPECT_FALSE(shells_of(setup, ShellSpacing::linear, 2).ok());
  EXPECT_FALSE(single_shell(setup).ok());
  setup = campus();
  setup.inner_box_m = 1;
  EXPECT_FALSE(shells_of(setup, ShellSpacing::exponential, 1.2).ok());
  EXPECT_FALSE(best_shells(campus(), ShellSpacing::linear, 1.5, 2, 0).ok());
}

}  // namespace
}  // namespace promenade
