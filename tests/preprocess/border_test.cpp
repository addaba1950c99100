#include "preprocess/border.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <numeric>
#include <set>

#include "preprocess/fins.h"
#include "preprocess/mesh_piece.h"
#include "preprocess/simplify.h"
#include "tests/preprocess/surfaces.h"

namespace promenade {
namespace {

using namespace test;

using Place = std::array<float, 3>;
Place place_of(const glm::vec3& p) { return {p.x, p.y, p.z}; }

/// A border's edges by their ends' places.
std::set<std::pair<Place, Place>> edges_of(const Mesh& mesh, const Border& border) {
  std::set<std::pair<Place, Place>> edges;
  for (const BorderEdge& edge : border.edges)
    edges.emplace(place_of(mesh.positions[mesh.indices[edge.corner]]),
                  place_of(mesh.positions[mesh.indices[next_in_triangle(edge.corner)]]));
  return edges;
}

/// A mesh in two leaves, which meet along x = the middle of its box.
struct Halves {
  std::array<Mesh, 2> mesh;
  std::array<Border, 2> border;
};

Halves halves_of(const Mesh& mesh, const Box& cell, float reach_m) {
  std::array<std::vector<uint32_t>, 2> triangles;
  const float middle = bounds(mesh).center().x;
  for (uint32_t t = 0; t < mesh.triangle_count(); ++t) triangles[centroid(mesh, t).x < middle ? 0 : 1].push_back(t);
  const std::array<std::span<const uint32_t>, 2> leaves{triangles[0], triangles[1]};
  std::vector<Border> borders = find_borders(mesh, leaves, cell, reach_m);
  Halves halves;
  for (size_t i = 0; i < 2; ++i)
    halves.mesh[i] = piece_of(mesh, triangles[i]), halves.border[i] = std::move(borders[i]);
  return halves;
}

constexpr Box kFarAway{{-1e6F, -1e6F, -1e6F}, {1e6F, 1e6F, 1e6F}};

TEST(Borders, are_where_two_leaves_meet_and_along_the_cells_sides) {
  const Mesh mesh = hills(20);
  const Halves inner = halves_of(mesh, kFarAway, 1);
  for (const Border& border : inner.border) EXPECT_EQ(border.edges.size(), 20U);
  std::set<std::pair<Place, Place>> turned;
  for (const auto& [from, to] : edges_of(inner.mesh[1], inner.border[1])) turned.emplace(to, from);
  EXPECT_EQ(edges_of(inner.mesh[0], inner.border[0]), turned);

  Box cell = kFarAway;
  cell.min.y = -0.5F;
  const Halves sides = halves_of(mesh, cell, 1);
  for (const Border& border : sides.border) EXPECT_EQ(border.edges.size(), 30U);
}

TEST(Borders, of_a_simplified_surface_are_the_sources_line_with_points_left_out) {
  const Mesh mesh = hills(40);
  Halves halves = halves_of(mesh, kFarAway, 1);
  std::set<Place> line;
  for (const auto& [from, to] : edges_of(halves.mesh[0], halves.border[0])) line.insert(from), line.insert(to);
  Border border = halves.border[0];
  const Mesh result = simplify(halves.mesh[0], {.target_triangles = 100}, border);
  EXPECT_LT(border.edges.size(), 30U);
  std::set<Place> ends, passed;
  for (const auto& [from, to] : edges_of(result, border)) ends.insert(from), ends.insert(to);
  for (const glm::vec3& p : border.passed) passed.insert(place_of(p));
  EXPECT_FALSE(passed.empty());
  EXPECT_EQ(passed.size(), border.passed.size());
  for (const Place& p : ends) EXPECT_FALSE(passed.contains(p));
  ends.merge(passed);
  EXPECT_EQ(ends, line);
}

// Each side leaves out other points; where they meet each gets back what the other has kept.
TEST(Borders, of_surfaces_simplified_apart_meet_when_they_are_joined) {
  Mesh mesh = ball(40);
  mesh.normals.clear();
  ASSERT_TRUE(open_edges({mesh}).empty());
  Halves halves = halves_of(mesh, kFarAway, 1);
  Mesh joined;
  std::vector<uint32_t> first;
  for (size_t i = 0; i < 2; ++i) {
    halves.mesh[i] = simplify(halves.mesh[i], {.target_triangles = i == 0 ? 60U : 300U}, halves.border[i]);
    first.push_back(static_cast<uint32_t>(joined.triangle_count()));
    append(joined, halves.mesh[i]);
  }
  EXPECT_FALSE(open_edges({joined}).empty());
  const std::array<const Border*, 2> borders{&halves.border[0], &halves.border[1]};
  const Border rest = join_borders(joined, borders, first);
  EXPECT_EQ(find_defect(joined), "");
  EXPECT_TRUE(open_edges({joined}).empty());
  EXPECT_TRUE(rest.edges.empty());
}

/// A square in the plane z = 0, its edge along y = 0 a border that passes by one point.
std::pair<Mesh, Border> square_that_passes_by(const glm::vec3& point) {
  Mesh mesh = flat_grid(1, 4);
  Border border;
  border.edges.push_back({0, 1}), border.passed.push_back(point);
  EXPECT_EQ(mesh.positions[mesh.indices[0]], glm::vec3(0));
  EXPECT_EQ(mesh.positions[mesh.indices[1]], glm::vec3(4, 0, 0));
  return {mesh, border};
}

TEST(Fins, reach_beyond_what_an_edge_passes_by) {
  const auto expect_reach = [](float reach, bool is_passed_by) {
    EXPECT_GE(reach, is_passed_by ? 0.25F : 0);
    EXPECT_LT(reach, is_passed_by ? 0.4F : 0.01F);
  };
  for (const glm::vec3 point :
       {glm::vec3(2, 0, 0.25F), glm::vec3(2, 0, -0.25F), glm::vec3(2, -0.25F, 0), glm::vec3(2, -0.25F, 0.25F)}) {
    auto [mesh, border] = square_that_passes_by(point);
    const std::vector<uint8_t> is_exact = add_fins(mesh, border, {1.0F / 1024, {}});
    EXPECT_EQ(find_defect(mesh), "");
    EXPECT_EQ(mesh.triangle_count(), point.y < 0 && point.z > 0 ? 6U : 4U);
    EXPECT_EQ(is_exact.size(), mesh.vertex_count());
    expect_reach(bounds(mesh).max.z, point.z > 0);
    expect_reach(-bounds(mesh).min.z, point.z < 0);
    expect_reach(-bounds(mesh).min.y, point.y < 0);
  }
}

TEST(Fins, stand_on_no_straight_edge_and_on_none_that_passes_by_nothing) {
  auto [mesh, border] = square_that_passes_by({2, 0, 0});
  EXPECT_EQ(add_fins(mesh, border, {1.0F / 1024, {}}), (std::vector<uint8_t>{1, 1, 0, 0}));
  EXPECT_EQ(mesh.triangle_count(), 2U);
  border.edges[0].passed_end = 0, border.passed.clear();
  add_fins(mesh, border, {1.0F / 1024, {}});
  EXPECT_EQ(mesh.triangle_count(), 2U);
  EXPECT_TRUE(add_fins(mesh, {}, {1.0F / 1024, {}}).empty());
}

TEST(Fins, look_like_the_triangle_that_they_stand_on) {
  auto [mesh, border] = square_that_passes_by({2, -0.25F, 0.25F});
  mesh.colors.assign(mesh.vertex_count(), glm::u8vec4(1, 2, 3, 4));
  mesh.texcoords.assign(mesh.vertex_count(), glm::vec2(0.5F));
  mesh.materials = {7, 8};
  add_fins(mesh, border, {1.0F / 1024, [](uint32_t material) { return material + 10; }});
  EXPECT_EQ(find_defect(mesh), "");
  EXPECT_EQ(mesh.materials, (std::vector<uint32_t>{7, 8, 17, 17, 17, 17}));
  for (const glm::u8vec4& c : mesh.colors) EXPECT_EQ(c, glm::u8vec4(1, 2, 3, 4));
  for (size_t v = 4; v < mesh.vertex_count(); ++v) EXPECT_EQ(mesh.normals[v], glm::vec3(0, 0, 1));
}

}  // namespace
}  // namespace promenade
