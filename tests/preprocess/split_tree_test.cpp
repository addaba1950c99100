#include "preprocess/split_tree.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "preprocess/chunk_tree.h"
#include "preprocess/lattice_cut.h"
#include "preprocess/mesh_piece.h"
#include "tests/preprocess/surfaces.h"

namespace promenade {
namespace {

/// Every triangle of the mesh in exactly one leaf; leaves within their limit.
void expect_partition(const Mesh& mesh, const SplitTree& tree, uint32_t node_triangles, const LevelFactors& factors) {
  std::vector<int> seen(mesh.triangle_count());
  for (const SplitTree::Node& node : tree.nodes) {
    EXPECT_LE(node.children.size(), factors.largest() * 3 / 2);
    EXPECT_NE(node.children.size(), 1);
    EXPECT_LE(node.triangles.size(), node_triangles);
    EXPECT_EQ(node.children.empty(), !node.triangles.empty());
    for (const uint32_t t : node.triangles) ++seen[t];
  }
  EXPECT_TRUE(std::all_of(seen.begin(), seen.end(), [](int times) { return times == 1; }));
}

class SplitChunk : public testing::TestWithParam<LevelFactors> {};

TEST_P(SplitChunk, shares_all_triangles_out_to_full_leaves) {
  Mesh mesh = test::hills(100);
  const double area_m2 = surface_area_m2(mesh);
  const SplitTree tree = split_chunk(mesh, unbounded_cell(), 300, GetParam());
  expect_partition(mesh, tree, 300, GetParam());
  EXPECT_NEAR(surface_area_m2(mesh), area_m2, 1e-4 * area_m2);
  const auto leaves =
      std::count_if(tree.nodes.begin(), tree.nodes.end(), [](const auto& n) { return n.children.empty(); });
  EXPECT_LE(leaves, 20'000 / 150) << "leaves are half empty";
}

INSTANTIATE_TEST_SUITE_P(LevelFactors, SplitChunk,
                         testing::Values(LevelFactors{2}, LevelFactors{3}, LevelFactors{4}, LevelFactors{7},
                                         LevelFactors{16}, LevelFactors{3, 2, 2, 3}, LevelFactors{2, 9, 2}));

TEST(SplitChunk, gives_nodes_above_leaves_the_children_that_their_level_asks_for) {
  Mesh mesh = test::hills(100);
  for (const uint32_t node_triangles : {230U, 270U, 300U}) {
    const SplitTree tree = split_chunk(mesh, unbounded_cell(), node_triangles, {3, 2, 2, 4});
    expect_partition(mesh, tree, node_triangles, {3, 2, 2, 4});
    std::vector<uint32_t> level(tree.nodes.size(), 0);
    for (size_t n = tree.nodes.size(); n-- > 0;) {
      const SplitTree::Node& node = tree.nodes[n];
      if (node.children.empty()) continue;
      level[n] = level[node.children.front()] + 1;
      for (const uint32_t child : node.children) EXPECT_EQ(level[child] + 1, level[n]) << "a branch is shorter";
      const size_t wanted = level[n] == 1 ? 3 : level[n] <= 3 ? 2 : node.children.size();
      EXPECT_EQ(node.children.size(), wanted) << level[n];
    }
    EXPECT_GE(level[0], 4);
  }
}

TEST(LevelFactors, are_read_as_numbers_with_commas_between) {
  EXPECT_THAT(LevelFactors::named("3,2,2,4")->list(), testing::ElementsAre(3, 2, 2, 4));
  EXPECT_EQ(LevelFactors::named("16")->name(), "16");
  EXPECT_EQ(LevelFactors({3, 2}).name(), "3,2");
  for (const char* wrong : {"", ",", "3,", ",3", "3,,2", "3;2", "-3", "three", "3.5", "99999999999"})
    EXPECT_FALSE(LevelFactors::named(wrong).has_value()) << wrong;
}

TEST(LevelFactors, the_last_holds_for_all_levels_above) {
  const LevelFactors factors{3, 2, 5};
  EXPECT_EQ(factors.at(0), 3);
  EXPECT_EQ(factors.at(9), 5);
  EXPECT_EQ(factors.largest(), 5);
  EXPECT_THAT(factors.above(2).list(), testing::ElementsAre(3, 2, 5));
  EXPECT_THAT(factors.above(5).list(), testing::ElementsAre(2, 5));
  EXPECT_THAT(factors.above(6).list(), testing::ElementsAre(5));
  EXPECT_THAT(factors.above(1e9).list(), testing::ElementsAre(5));
}

TEST(SplitChunk, makes_one_leaf_of_few_triangles) {
  Mesh mesh = test::hills(5);
  const SplitTree tree = split_chunk(mesh, unbounded_cell(), 50, {4});
  ASSERT_EQ(tree.nodes.size(), 1);
  EXPECT_EQ(tree.nodes[0].triangles.size(), 50);
}

TEST(SplitChunk, ends_when_all_triangles_lie_in_one_place) {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {10, 0, 0}, {0, 10, 0}};
  for (int i = 0; i < 5000; ++i) mesh.indices.insert(mesh.indices.end(), {0, 1, 2});
  const SplitTree tree = split_chunk(mesh, unbounded_cell(), 100, {4});
  expect_partition(mesh, tree, 100, {4});
  EXPECT_EQ(mesh.triangle_count(), 5000) << "stacked triangles must not be cut";
}

TEST(SplitChunk, ends_for_stacked_sheets) {
  Mesh mesh;
  for (int i = 0; i < 1000; ++i) append(mesh, test::flat_grid(1, 100, float(i) * 0.001F));
  const SplitTree tree = split_chunk(mesh, unbounded_cell(), 100, {4});
  expect_partition(mesh, tree, 100, {4});
  EXPECT_LT(mesh.triangle_count(), 20'000);
}

TEST(SplitChunk, leaves_are_compact_once_large_triangles_are_cut) {
  Mesh mesh = test::hills(40);
  Mesh ground = test::flat_grid(1, 100, -20);
  append(mesh, ground);
  cut_along_lattice(mesh, 8);
  const SplitTree tree = split_chunk(mesh, unbounded_cell(), 100, {4}, 8);
  expect_partition(mesh, tree, 100, {4});
  for (const SplitTree::Node& node : tree.nodes) {
    if (!node.children.empty()) continue;
    EXPECT_LT(bounds(piece_of(mesh, node.triangles)).diagonal(), 60);
  }
}

TEST(SplitChunk, cuts_lie_on_the_cells_faces) {
  Mesh mesh = test::flat_grid(2, 100);
  for (int i = 0; i < 7; ++i) append(mesh, test::hills(10));
  const SplitTree tree = split_chunk(mesh, unbounded_cell(), 100, {4});
  const Box& cell = tree.nodes[1].cell;
  const Box whole = tree.nodes[0].cell;
  EXPECT_TRUE(whole.contains(cell));
  EXPECT_NE(whole, cell);
}

}  // namespace
}  // namespace promenade
