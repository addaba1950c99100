#include "runtime/front.h"

#include <gtest/gtest.h>

#include "runtime/policy.h"
#include "tests/runtime/forest.h"
#include "tests/runtime/scenes.h"

namespace promenade {
namespace {

using forest::Forest;

/// Two trees, one ahead and one behind a camera that looks along x; errors halve from level to level.
struct AheadAndBehind : Forest {
  AheadAndBehind() {
    grow(root({{10, -8, -1}, {10.5F, 8, 1}}, 4), 2, 4);
    grow(root({{-10.5F, -8, -1}, {-10, 8, 1}}, 4), 2, 4);
  }
};

TEST(CountFront, counts_what_the_static_policy_draws) {
  const AheadAndBehind trees;
  SelectView view;
  view.camera = scenes::looking_along_x();
  const std::vector<uint8_t> resident(trees.model().tables.nodes.size(), 1);
  for (const double pixel_error : {0.0, 10.0, 40.0, 100.0, 1000.0}) {
    SelectOptions options;
    options.policy = Policy::static_error;
    options.pixel_error = pixel_error;
    SelectState state;
    Selection selection;
    select(trees.model(), view, resident, options, state, selection);
    const FrontCount count = count_front(trees.model(), view.camera, pixel_error, ErrorKind::bound);
    EXPECT_EQ(count.front_in_view.nodes, selection.front.size()) << pixel_error;
    EXPECT_EQ(count.front_in_view.triangles, selection.triangles) << pixel_error;
    EXPECT_EQ(count.front.nodes, 2 * count.front_in_view.nodes) << "as much is behind";
    EXPECT_EQ(count.leaves.nodes, 32);
    EXPECT_EQ(count.leaves_in_view.nodes, 16);
  }
}

TEST(CountFront, chooses_by_the_error_that_it_is_told) {
  AheadAndBehind trees;
  const Camera camera = scenes::looking_along_x();
  // The 99th percentile of every node here is 0: the roots will do.
  EXPECT_EQ(count_front(trees.model(), camera, 1, ErrorKind::p99).front.nodes, 2);
  EXPECT_EQ(count_front(trees.model(), camera, 1, ErrorKind::bound).front.nodes, 32);
}

TEST(Select, chooses_by_the_error_that_it_is_told) {
  const AheadAndBehind trees;
  SelectView view;
  view.camera = scenes::looking_along_x();
  const std::vector<uint8_t> resident(trees.model().tables.nodes.size(), 1);
  SelectOptions options;
  options.policy = Policy::static_error;
  SelectState state;
  Selection selection;
  select(trees.model(), view, resident, options, state, selection);
  EXPECT_EQ(selection.front.size(), 16);
  options.error_kind = ErrorKind::p99;
  select(trees.model(), view, resident, options, state, selection);
  EXPECT_EQ(selection.front.size(), 1);
}

}  // namespace
}  // namespace promenade
