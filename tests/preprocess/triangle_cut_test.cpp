#include "preprocess/triangle_cut.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numeric>

#include "tests/preprocess/surfaces.h"

namespace promenade {
namespace {

/// A right angle at the origin, legs of 4 m along x and y, everything interpolated linearly.
Mesh large_triangle() {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {4, 0, 0}, {0, 4, 0}};
  mesh.normals = {{0, 0, 1}, {0, 0, 1}, {0, 0, 1}};
  mesh.texcoords = {{0, 0}, {1, 0}, {0, 1}};
  mesh.colors = {{0, 0, 0, 255}, {200, 0, 0, 255}, {0, 200, 0, 255}};
  mesh.indices = {0, 1, 2};
  mesh.materials = {7};
  return mesh;
}

TEST(TriangleCutter, cuts_a_triangle_into_pieces_on_either_side_of_the_plane) {
  Mesh mesh = large_triangle();
  TriangleCutter cutter(mesh, {0, 1, 0.5F});
  ASSERT_TRUE(cutter.crosses(0));
  std::vector<uint32_t> below, above;
  cutter.cut(0, below, above);
  EXPECT_EQ(below.size(), 2);
  EXPECT_EQ(above.size(), 1);
  EXPECT_EQ(find_defect(mesh), "");
  EXPECT_NEAR(surface_area_m2(mesh), 8, 1e-6);
  for (const uint32_t t : below)
    for (size_t c = 0; c < 3; ++c) EXPECT_LE(mesh.positions[mesh.indices[3 * t + c]].x, 1);
  for (const uint32_t t : above)
    for (size_t c = 0; c < 3; ++c) EXPECT_GE(mesh.positions[mesh.indices[3 * t + c]].x, 1);
  for (size_t t = 0; t < mesh.triangle_count(); ++t) {
    EXPECT_EQ(mesh.material_of(t), 7);
    EXPECT_GT(triangle_cross(mesh, t).z, 0) << "winding of piece " << t;
  }
  for (size_t v = 0; v < mesh.vertex_count(); ++v) {
    EXPECT_FLOAT_EQ(mesh.texcoords[v].x, mesh.positions[v].x / 4);
    EXPECT_EQ(mesh.colors[v].g, mesh.positions[v].y * 50);
  }
}

TEST(TriangleCutter, leaves_short_edges_whole) {
  Mesh mesh = large_triangle();
  const TriangleCutter cutter(mesh, {0, 1, 6});
  EXPECT_FALSE(cutter.crosses(0));
}

TEST(TriangleCutter, cuts_only_the_long_one_of_two_crossing_edges) {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {4, 0, 0}, {1.5F, 1, 0}};
  mesh.indices = {0, 1, 2};
  TriangleCutter cutter(mesh, {0, 1, 3});
  std::vector<uint32_t> below, above;
  cutter.cut(0, below, above);
  EXPECT_EQ(mesh.triangle_count(), 2);
  EXPECT_NEAR(surface_area_m2(mesh), 2, 1e-6);
}

TEST(TriangleCutter, finds_the_same_point_from_both_sides_of_an_edge) {
  test::Numbers numbers(5);
  for (int i = 0; i < 200; ++i) {
    const glm::vec3 a = numbers.in_cube(100), b = numbers.in_cube(100);
    const float value = numbers.between(-50, 50);
    std::vector<glm::vec3> points;
    for (const bool turned : {false, true}) {
      Mesh mesh;
      mesh.positions = {turned ? b : a, turned ? a : b, numbers.in_cube(100)};
      mesh.indices = {0, 1, 2};
      TriangleCutter cutter(mesh, {1, value, 0});
      std::vector<uint32_t> below, above;
      if ((a.y < value) == (b.y < value)) continue;
      cutter.cut(0, below, above);
      points.insert(points.end(), mesh.positions.begin() + 3, mesh.positions.end());
    }
    if (points.empty()) continue;
    const auto on_edge = [&](const glm::vec3& p) { return std::count(points.begin(), points.end(), p) == 2; };
    EXPECT_TRUE(std::any_of(points.begin(), points.end(), on_edge)) << "edge " << i;
  }
}

TEST(PieceOf, keeps_triangles_with_all_attributes) {
  const Mesh mesh = test::box_city_block();
  const std::vector<uint32_t> triangles{100, 3, 4, 77};
  const Mesh piece = piece_of(mesh, triangles);
  const Mesh expected = submesh(mesh, triangles);
  ASSERT_EQ(piece.triangle_count(), 4);
  EXPECT_EQ(piece.vertex_count(), expected.vertex_count());
  for (size_t i = 0; i < piece.indices.size(); ++i) {
    EXPECT_EQ(piece.positions[piece.indices[i]], expected.positions[expected.indices[i]]);
    EXPECT_EQ(piece.normals[piece.indices[i]], expected.normals[expected.indices[i]]);
    EXPECT_EQ(piece.colors[piece.indices[i]], expected.colors[expected.indices[i]]);
  }
}

}  // namespace
}  // namespace promenade
