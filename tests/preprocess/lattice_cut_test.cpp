#include "preprocess/lattice_cut.h"

#include <gtest/gtest.h>

#include <array>

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

TEST(LatticeCut, cuts_a_triangle_into_pieces_of_the_lattices_cells) {
  Mesh mesh = large_triangle();
  cut_along_lattice(mesh, 1);
  EXPECT_EQ(find_defect(mesh), "");
  EXPECT_NEAR(surface_area_m2(mesh), 8, 1e-6);
  EXPECT_EQ(mesh.triangle_count(), 16) << "six squares of two and four halves";
  for (size_t t = 0; t < mesh.triangle_count(); ++t) {
    EXPECT_EQ(mesh.material_of(t), 7);
    EXPECT_GT(triangle_cross(mesh, t).z, 0.5F) << "winding and shape of piece " << t;
    Box box;
    for (size_t c = 0; c < 3; ++c) box.add(mesh.positions[mesh.indices[3 * t + c]]);
    EXPECT_LE(box.size().x, 1);
    EXPECT_LE(box.size().y, 1);
  }
  for (size_t v = 0; v < mesh.vertex_count(); ++v) {
    EXPECT_FLOAT_EQ(mesh.texcoords[v].x, mesh.positions[v].x / 4);
    EXPECT_EQ(mesh.colors[v].g, mesh.positions[v].y * 50);
  }
}

TEST(LatticeCut, leaves_triangles_of_short_edges_whole) {
  Mesh mesh = large_triangle();
  cut_along_lattice(mesh, 8);
  EXPECT_EQ(mesh.triangle_count(), 1);
  cut_along_lattice(mesh, 0);
  EXPECT_EQ(mesh.triangle_count(), 1);
}

TEST(LatticeCut, keeps_a_closed_surface_closed_even_when_each_triangle_is_cut_alone) {
  test::Numbers numbers(3);
  for (int round = 0; round < 20; ++round) {
    // A tetrahedron of long and short edges; its faces in meshes of their own, begun at any corner.
    std::array<glm::vec3, 4> corner;
    for (glm::vec3& p : corner) p = numbers.in_cube(round % 2 == 0 ? 40.0F : 6.0F);
    constexpr std::array<std::array<size_t, 3>, 4> kFaces = {{{0, 1, 2}, {3, 1, 0}, {2, 1, 3}, {0, 2, 3}}};
    std::vector<Mesh> faces;
    for (const auto& face : kFaces) {
      Mesh mesh;
      for (size_t c = 0; c < 3; ++c) mesh.positions.push_back(corner[face[(c + size_t(round)) % 3]]);
      mesh.indices = {0, 1, 2};
      const double area_m2 = surface_area_m2(mesh);
      cut_along_lattice(mesh, 4);
      EXPECT_EQ(find_defect(mesh), "");
      EXPECT_NEAR(surface_area_m2(mesh), area_m2, 1e-3 * area_m2) << "round " << round;
      faces.push_back(std::move(mesh));
    }
    EXPECT_TRUE(test::open_edges(faces).empty()) << "round " << round;
  }
}

TEST(LatticeCut, keeps_a_smooth_closed_surface_closed) {
  Mesh ball = test::ball(12);
  ASSERT_TRUE(test::open_edges({ball}).empty());
  for (const float step : {8.0F, 2.0F, 0.5F}) {
    Mesh cut = ball;
    cut_along_lattice(cut, step);
    EXPECT_TRUE(test::open_edges({cut}).empty()) << "step " << step;
  }
}

TEST(LatticeCut, makes_a_bounded_number_of_pieces_of_a_huge_triangle) {
  Mesh mesh;
  mesh.positions = {{-3e7F, 1, 5}, {3e7F, 2, 7}, {1e6F, 4e7F, -1e7F}};
  mesh.indices = {0, 1, 2};
  cut_along_lattice(mesh, 0.25F);
  EXPECT_GT(mesh.triangle_count(), 100);
  EXPECT_LT(mesh.triangle_count(), 50'000);
  EXPECT_EQ(find_defect(mesh), "");
}

}  // namespace
}  // namespace promenade
