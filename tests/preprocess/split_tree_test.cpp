#include "preprocess/split_tree.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "preprocess/chunk_tree.h"
#include "preprocess/lattice_cut.h"
#include "preprocess/mesh_piece.h"
#include "tests/preprocess/surfaces.h"

namespace promenade {
namespace {

/// Every triangle of the mesh in exactly one leaf; leaves within their limit.
void expect_partition(const Mesh& mesh, const SplitTree& tree, uint32_t node_triangles, uint32_t level_factor) {
  std::vector<int> seen(mesh.triangle_count());
  for (const SplitTree::Node& node : tree.nodes) {
    EXPECT_LE(node.children.size(), level_factor * 3 / 2);
    EXPECT_NE(node.children.size(), 1);
    EXPECT_LE(node.triangles.size(), node_triangles);
    EXPECT_EQ(node.children.empty(), !node.triangles.empty());
    for (const uint32_t t : node.triangles) ++seen[t];
  }
  EXPECT_TRUE(std::all_of(seen.begin(), seen.end(), [](int times) { return times == 1; }));
}

class SplitChunk : public testing::TestWithParam<uint32_t> {};

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

INSTANTIATE_TEST_SUITE_P(LevelFactors, SplitChunk, testing::Values(2, 3, 4, 7, 16));

TEST(SplitChunk, makes_one_leaf_of_few_triangles) {
  Mesh mesh = test::hills(5);
  const SplitTree tree = split_chunk(mesh, unbounded_cell(), 50, 4);
  ASSERT_EQ(tree.nodes.size(), 1);
  EXPECT_EQ(tree.nodes[0].triangles.size(), 50);
}

TEST(SplitChunk, ends_when_all_triangles_lie_in_one_place) {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {10, 0, 0}, {0, 10, 0}};
  for (int i = 0; i < 5000; ++i) mesh.indices.insert(mesh.indices.end(), {0, 1, 2});
  const SplitTree tree = split_chunk(mesh, unbounded_cell(), 100, 4);
  expect_partition(mesh, tree, 100, 4);
  EXPECT_EQ(mesh.triangle_count(), 5000) << "stacked triangles must not be cut";
}

TEST(SplitChunk, ends_for_stacked_sheets) {
  Mesh mesh;
  for (int i = 0; i < 1000; ++i) append(mesh, test::flat_grid(1, 100, float(i) * 0.001F));
  const SplitTree tree = split_chunk(mesh, unbounded_cell(), 100, 4);
  expect_partition(mesh, tree, 100, 4);
  EXPECT_LT(mesh.triangle_count(), 20'000);
}

TEST(SplitChunk, leaves_are_compact_once_large_triangles_are_cut) {
  Mesh mesh = test::hills(40);
  Mesh ground = test::flat_grid(1, 100, -20);
  append(mesh, ground);
  cut_along_lattice(mesh, 8);
  const SplitTree tree = split_chunk(mesh, unbounded_cell(), 100, 4, 8);
  expect_partition(mesh, tree, 100, 4);
  for (const SplitTree::Node& node : tree.nodes) {
    if (!node.children.empty()) continue;
    EXPECT_LT(bounds(piece_of(mesh, node.triangles)).diagonal(), 60);
  }
}

TEST(SplitChunk, cuts_lie_on_the_cells_faces) {
  Mesh mesh = test::flat_grid(2, 100);
  for (int i = 0; i < 7; ++i) append(mesh, test::hills(10));
  const SplitTree tree = split_chunk(mesh, unbounded_cell(), 100, 4);
  const Box& cell = tree.nodes[1].cell;
  const Box whole = tree.nodes[0].cell;
  EXPECT_TRUE(whole.contains(cell));
  EXPECT_NE(whole, cell);
}

}  // namespace
}  // namespace promenade
