#include "preprocess/twins.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <map>
#include <set>
#include <vector>

#include "preprocess/simplify.h"
#include "tests/preprocess/surfaces.h"

namespace promenade {
namespace {

using namespace test;

constexpr glm::u8vec4 kGrey{128, 128, 128, 255}, kRed{200, 30, 30, 255};

bool nowhere(uint32_t /*place*/) { return false; }

Mesh moved(Mesh mesh, const glm::vec3& by) {
  for (glm::vec3& p : mesh.positions) p += by;
  return mesh;
}

/// A hilly tile of 200 triangles, 2 m wide.
Mesh tile() {
  Mesh mesh = grid(10, 2, [](float x, float y) { return 0.1F * std::sin(4 * x) * std::cos(5 * y) + 0.02F * x; });
  mesh.colors.assign(mesh.vertex_count(), kGrey);
  mesh.normals.assign(mesh.vertex_count(), glm::vec3(0, 0, 1));
  mesh.texcoords.assign(mesh.vertex_count(), glm::vec2(0));
  mesh.materials.assign(mesh.triangle_count(), 0);
  return mesh;
}

/// Two tiles, the second moved and changed.
Mesh two_tiles(const std::function<void(Mesh& second)>& change) {
  Mesh second = moved(tile(), {7, 11, 3});
  change(second);
  Mesh mesh = tile();
  append(mesh, second);
  return mesh;
}

/// Triangles that remain when twins have been taken out of it.
uint32_t triangles_without_twins(const Mesh& mesh) {
  WorkMesh work = make_work_mesh(mesh);
  take_twins(work, mesh, nowhere);
  return work.alive_count;
}

/// The parts of a mesh: their triangles' corners from the least corner of the part's box, sorted.
using Shape = std::multiset<std::vector<Point>>;
std::map<Point, Shape> shapes_of(const Mesh& mesh, const std::function<glm::vec3(const glm::vec3&)>& cell_of) {
  std::map<Point, Shape> shapes;
  for (size_t t = 0; t < mesh.triangle_count(); ++t) {
    const glm::vec3 cell = cell_of(mesh.positions[mesh.indices[t * 3]]);
    std::vector<Point> corners;
    for (size_t c = 0; c < 3; ++c) {
      const glm::vec3 p = mesh.positions[mesh.indices[t * 3 + c]] - cell;
      corners.emplace_back(p.x, p.y, p.z);
    }
    std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
    shapes[{cell.x, cell.y, cell.z}].insert(corners);
  }
  return shapes;
}

TEST(Twins, are_parts_that_are_one_another_moved) {
  const Mesh mesh = two_tiles([](Mesh&) {});
  WorkMesh work = make_work_mesh(mesh);
  const Twins twins = take_twins(work, mesh, nowhere);
  EXPECT_EQ(work.alive_count, 200U);
  EXPECT_EQ(work.shown_count, 400U);
  EXPECT_EQ(work.place_count(), 121U);
  ASSERT_EQ(twins.copies.size(), 1U);
  EXPECT_EQ(twins.copies[0].offset, glm::vec3(7, 11, 3));
  for (uint32_t v = 0; v < 121; ++v) EXPECT_EQ(twins.vertex_of(0, v), v + 121);
}

TEST(Twins, may_differ_by_what_rounding_does_and_no_more) {
  const auto shaken_by = [](float by) { return two_tiles([by](Mesh& second) { second.positions[60].z += by; }); };
  EXPECT_EQ(triangles_without_twins(shaken_by(0x1p-19F)), 200U);
  EXPECT_EQ(triangles_without_twins(shaken_by(0x1p-15F)), 400U);
}

TEST(Twins, are_found_far_from_the_origin) {
  Mesh mesh = two_tiles([](Mesh&) {});
  mesh = moved(mesh, {0, 0, 0.3F});
  for (glm::vec3& p : mesh.positions) p = glm::vec3(glm::dvec3(p) + glm::dvec3(1234.567, -2345.678, 12.34));
  EXPECT_EQ(triangles_without_twins(mesh), 200U);
}

TEST(Twins, have_the_same_looks) {
  EXPECT_EQ(triangles_without_twins(two_tiles([](Mesh& second) { second.colors[60] = kRed; })), 400U);
  EXPECT_EQ(triangles_without_twins(two_tiles([](Mesh& second) { second.materials[60] = 1; })), 400U);
  EXPECT_EQ(triangles_without_twins(two_tiles([](Mesh& second) { second.normals[60] = {0, 1, 0}; })), 400U);
  EXPECT_EQ(triangles_without_twins(two_tiles([](Mesh& second) { second.texcoords[60] = {0, 1}; })), 400U);
}

TEST(Twins, have_the_same_triangles) {
  const auto turned = [](Mesh& second) { std::swap(second.indices[300], second.indices[301]); };
  EXPECT_EQ(triangles_without_twins(two_tiles(turned)), 400U);
  // Two vertices in one place, or a hair's breadth apart.
  const auto with_slit = [](float slit_m) {
    const Mesh whole = tile();
    Mesh mesh;
    for (const float by : {0.0F, slit_m}) {
      Mesh part = whole;
      part.positions.push_back(whole.positions[whole.indices[300]]);
      part.positions.back().z += by;
      part.colors.push_back(kGrey), part.normals.emplace_back(0, 0, 1), part.texcoords.emplace_back(0);
      part.indices[300] = 121;
      append(mesh, moved(part, {by == 0 ? 0.0F : 8.0F, 0, 0}));
    }
    return mesh;
  };
  EXPECT_EQ(triangles_without_twins(with_slit(0x1p-20F)), 400U);
}

TEST(Twins, do_not_touch_what_stays_alone) {
  const Mesh mesh = two_tiles([](Mesh&) {});
  for (const uint32_t lone : {0U, 130U}) {  // on the first, on the second
    WorkMesh work = make_work_mesh(mesh);
    EXPECT_TRUE(take_twins(work, mesh, [lone](uint32_t place) { return place == lone; }).copies.empty());
    EXPECT_EQ(work.alive_count, 400U);
  }
}

TEST(Twins, of_one_kind_are_the_same_moved_when_simplified) {
  Mesh mesh = hills(30);
  mesh = moved(mesh, {0, 0, -50});
  mesh.colors.assign(mesh.vertex_count(), kGrey);
  Mesh part = tile();
  part.normals.clear(), part.texcoords.clear(), part.materials.clear();
  for (int i = 0; i < 50; ++i) append(mesh, moved(part, {8 * float(i % 10), 8 * float(i / 10), 0}));
  const Mesh result = simplify(mesh, {.target_triangles = 3000});
  EXPECT_LE(result.triangle_count(), 3000U);
  EXPECT_GT(result.triangle_count(), 2800U) << "kinds of 16 at most go down together";
  EXPECT_EQ(find_defect(result), "");
  const std::set<Point> own = [&] {
    std::set<Point> positions;
    for (const glm::vec3& p : mesh.positions) positions.insert({p.x, p.y, p.z});
    return positions;
  }();
  for (const glm::vec3& p : result.positions)
    EXPECT_TRUE(p.z < -20 || own.contains({p.x, p.y, p.z})) << "as the source has them";
  Mesh tiles = result;
  tiles.indices.clear();
  for (size_t i = 0; i < result.indices.size(); ++i)
    if (result.positions[result.indices[i / 3 * 3]].z > -20) tiles.indices.push_back(result.indices[i]);
  const std::map<Point, Shape> shapes = shapes_of(
      tiles, [](const glm::vec3& p) { return glm::vec3(8 * std::floor(p.x / 8), 8 * std::floor(p.y / 8), 0); });
  ASSERT_EQ(shapes.size(), 50U);
  std::set<size_t> sizes;
  for (const auto& [cell, shape] : shapes) sizes.insert(shape.size());
  EXPECT_LE(sizes.size(), 4U) << "four kinds of at most 16";
  EXPECT_LT(*sizes.rbegin(), 200U);
  EXPECT_LT(surface_distance(mesh, result).bound_m, 3.0F);
}

TEST(Twins, vanish_each_by_itself_where_something_is_beside_them) {
  Mesh mesh = moved(hills(20), {0, 0, -100});
  mesh.normals.assign(mesh.vertex_count(), glm::vec3(0));
  mesh.colors.assign(mesh.vertex_count(), kGrey);
  // Boards a hand's breadth before a wall, and the same boards in the open.
  for (int i = 0; i < 5; ++i) add_box(mesh, {float(i), 0, 0}, {float(i) + 0.5F, 0.03F, 0.5F}, kGrey);
  for (int i = 0; i < 5; ++i) add_box(mesh, {float(i), 40, 0}, {float(i) + 0.5F, 40.03F, 0.5F}, kGrey);
  add_box(mesh, {-2, 0.05F, -2}, {8, 0.5F, 3}, kGrey);
  ASSERT_EQ(find_defect(mesh), "");
  const Mesh result = simplify(mesh, {.target_triangles = 600});
  size_t before_wall = 0, in_the_open = 0;
  for (size_t t = 0; t < result.triangle_count(); ++t) {
    const glm::vec3& p = result.positions[result.indices[t * 3]];
    if (p.z < -20) continue;
    if (p.y > 39) ++in_the_open;
    if (p.y < 0.04F) ++before_wall;
  }
  EXPECT_GE(in_the_open, 5U) << "nothing else is near any of them";
  EXPECT_EQ(before_wall, 0U);
}

TEST(Twins, lift_their_panes_wherever_their_walls_are) {
  Mesh house;
  add_wall_with_windows(house, {0, 0, 0}, {12, 0, 0}, {0, 0, 9}, 4, 3, kGrey);
  for (glm::vec3& p : house.positions) p.y = 0;  // panes flush with the wall
  Mesh mesh;
  for (int i = 0; i < 8; ++i) append(mesh, moved(house, {0, 20 * float(i), 0}));
  const Mesh result = simplify(mesh, {.target_triangles = 8 * 40});
  std::map<float, int> panes;
  for (size_t t = 0; t < result.triangle_count(); ++t)
    if (result.colors[result.indices[t * 3]] != kGrey) ++panes[std::round(result.positions[result.indices[t * 3]].y)];
  ASSERT_EQ(panes.size(), 8U);
  for (const auto& [y, count] : panes) EXPECT_EQ(count, panes.begin()->second);
  EXPECT_GE(panes.begin()->second, 12) << "a window has one triangle at least";
}

TEST(Twins, leave_a_bound_that_holds) {
  Mesh mesh = box_city_block();
  const Mesh result = simplify(mesh, {.target_triangles = static_cast<uint32_t>(mesh.triangle_count() / 4)});
  const float bound_m = surface_distance(mesh, result).bound_m;
  const ClosestPointTree to_mesh(mesh), to_result(result);
  Numbers numbers(5);
  const auto farthest_m = [&](const Mesh& from, const ClosestPointTree& to) {
    float farthest2 = 0;
    for (size_t i = 0; i < 50000; ++i) {
      const size_t t = numbers.next() % from.triangle_count();
      const float r = std::sqrt(numbers.unit()), w = numbers.unit();
      const glm::vec3 a = from.positions[from.indices[3 * t]], b = from.positions[from.indices[3 * t + 1]],
                      c = from.positions[from.indices[3 * t + 2]];
      farthest2 = std::max(farthest2, to.nearest(a + (b - a) * (r * (1 - w)) + (c - a) * (r * w)).distance2_m2);
    }
    return std::sqrt(farthest2);
  };
  EXPECT_LE(farthest_m(mesh, to_result), bound_m);
  EXPECT_LE(farthest_m(result, to_mesh), bound_m);
}

}  // namespace
}  // namespace promenade
