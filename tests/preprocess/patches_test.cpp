#include "preprocess/patches.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "preprocess/simplify.h"
#include "tests/preprocess/surfaces.h"

namespace promenade {
namespace {

using namespace test;

constexpr glm::u8vec4 kWall{200, 190, 170, 255}, kGlass{40, 60, 90, 255}, kGrass{60, 120, 50, 255};

/// Area that shows a colour with all corners.
double area_of_color(const Mesh& mesh, const glm::u8vec4& color) {
  double area_m2 = 0;
  for (size_t t = 0; t < mesh.triangle_count(); ++t)
    if (std::all_of(&mesh.indices[3 * t], &mesh.indices[3 * t] + 3,
                    [&](uint32_t v) { return mesh.colors[v] == color; }))
      area_m2 += 0.5 * double(glm::length(triangle_cross(mesh, t)));
  return area_m2;
}

/// The colour that somebody far away at -y sees at a point of a wall; black: a hole.
glm::u8vec4 color_seen(const Mesh& mesh, float x, float z) {
  glm::u8vec4 seen(0);
  float nearest = 1e9F;
  for (size_t t = 0; t < mesh.triangle_count(); ++t) {
    const uint32_t* v = &mesh.indices[3 * t];
    const glm::vec3 a = mesh.positions[v[0]], b = mesh.positions[v[1]], c = mesh.positions[v[2]];
    const auto side = [&](const glm::vec3& p, const glm::vec3& q) {
      return (q.x - p.x) * (z - p.z) - (q.z - p.z) * (x - p.x);
    };
    const float wa = side(b, c), wb = side(c, a), wc = side(a, b), sum = wa + wb + wc;
    if (!(wa >= 0 && wb >= 0 && wc >= 0 && sum > 0)) continue;
    const float y = (wa * a.y + wb * b.y + wc * c.y) / sum;
    if (y < nearest) nearest = y, seen = mesh.colors[v[0]];
  }
  return seen;
}

/// A quadrilateral facing up.
void add_slab(Mesh& mesh, float x0, float x1, float z, const glm::u8vec4& color) {
  add_quad(mesh, {x0, x0, z}, {x1, x0, z}, {x1, x1, z}, {x0, x1, z}, color);
}

std::vector<uint8_t> all_may_rise(const WorkMesh& work) { return std::vector<uint8_t>(work.triangle_count(), 1); }

TEST(Patches, panes_keep_their_place_and_colour_while_the_wall_closes_beneath_them) {
  Mesh wall;  // in the plane y = 0, seen from -y
  add_wall_with_windows(wall, {0, 0, 0}, {24, 0, 0}, {0, 0, 15}, 8, 5, kWall);
  const double glass_m2 = area_of_color(wall, kGlass);
  constexpr uint32_t kPanes = 40, kTarget = 2 * kPanes + 60;  // woven in, each pane would need ten
  SimplifyFigures figures;
  const Mesh result = simplify(wall, {.target_triangles = kTarget}, &figures);
  EXPECT_EQ(find_defect(result), "");
  EXPECT_LE(result.triangle_count(), kTarget);
  EXPECT_NEAR(area_of_color(result, kGlass), glass_m2, 0.02 * glass_m2);
  EXPECT_GT(figures.sheet_height_m, 0);
  EXPECT_LT(surface_distance(wall, result).bound_m, 0.3F) << "windows are 0.2 m deep";
  int points = 0, others = 0;
  for (float x = 0.05F; x < 24; x += 0.1F)
    for (float z = 0.05F; z < 15; z += 0.1F) {
      ++points;
      others += color_seen(wall, x, z) != color_seen(result, x, z) ? 1 : 0;
    }
  EXPECT_LT(others, points / 100) << "the wall hides its windows";
}

TEST(Patches, a_large_patch_or_one_of_nearly_the_same_colour_stays_woven_in) {
  Mesh ground = flat_grid(20, 20);
  const auto color_where = [&](float low, float high, const glm::u8vec4& color) {
    Mesh mesh;
    for (size_t t = 0; t < ground.triangle_count(); ++t) {
      glm::vec3 middle(0);
      for (size_t c = 0; c < 3; ++c) middle += ground.positions[ground.indices[3 * t + c]] / 3.0F;
      const bool inside = middle.x > low && middle.x < high && middle.y > low && middle.y < high;
      for (size_t c = 0; c < 3; ++c) {
        mesh.indices.push_back(static_cast<uint32_t>(mesh.positions.size()));
        mesh.positions.push_back(ground.positions[ground.indices[3 * t + c]]);
        mesh.colors.push_back(inside ? color : kWall);
      }
    }
    return mesh;
  };
  const auto patches_of = [](const Mesh& mesh) {
    WorkMesh work = make_work_mesh(mesh);
    return add_patches(work, mesh).size();
  };
  EXPECT_EQ(patches_of(color_where(8, 10, kGlass)), 1U);
  EXPECT_EQ(patches_of(color_where(4, 14, kGlass)), 0U);
  EXPECT_EQ(patches_of(color_where(8, 10, {203, 190, 170, 255})), 0U);
}

TEST(Patches, a_lifted_patch_leaves_the_colour_around_it_and_nothing_else_changes) {
  Mesh wall;
  add_wall_with_windows(wall, {0, 0, 0}, {3, 0, 0}, {0, 0, 3}, 1, 1, kWall);
  WorkMesh work = make_work_mesh(wall);
  const std::vector<Patch> patches = add_patches(work, wall);
  ASSERT_EQ(patches.size(), 1U);
  EXPECT_EQ(finish(work, wall).indices.size(), wall.indices.size()) << "copies wait";
  lift(patches.front(), work);
  const Mesh lifted = finish(work, wall);
  EXPECT_EQ(lifted.triangle_count(), wall.triangle_count() + 2);
  EXPECT_NEAR(area_of_color(lifted, kGlass), area_of_color(wall, kGlass), 1e-5);
  EXPECT_NEAR(area_of_color(lifted, kWall), area_of_color(wall, kWall) + area_of_color(wall, kGlass), 1e-5);
}

TEST(Patches, what_closes_beneath_a_patch_between_two_grounds_has_the_colour_of_the_longer_border) {
  Mesh mesh;
  add_slab(mesh, 4, 5, 0, kGlass);
  add_quad(mesh, {5, 4, 0}, {9, 4, 0}, {9, 5, 0}, {5, 5, 0}, kGrass);
  add_quad(mesh, {0, 4, 0}, {4, 4, 0}, {4, 5, 0}, {0, 5, 0}, kWall);
  add_quad(mesh, {4, 0, 0}, {5, 0, 0}, {5, 4, 0}, {4, 4, 0}, kGrass);
  add_quad(mesh, {4, 5, 0}, {5, 5, 0}, {5, 9, 0}, {4, 9, 0}, kGrass);
  WorkMesh work = make_work_mesh(mesh);
  const std::vector<Patch> patches = add_patches(work, mesh);
  ASSERT_EQ(patches.size(), 1U);
  lift(patches.front(), work);
  const Mesh lifted = finish(work, mesh);
  EXPECT_NEAR(area_of_color(lifted, kGrass), area_of_color(mesh, kGrass) + 1, 1e-5);
  EXPECT_NEAR(area_of_color(lifted, kWall), area_of_color(mesh, kWall), 1e-5);
}

TEST(Patches, sheets_rise_above_what_has_come_to_cover_them_and_stay_in_order) {
  Mesh mesh = flat_grid(8, 20);
  mesh.colors.assign(mesh.vertex_count(), kWall);
  mesh.normals.assign(mesh.vertex_count(), glm::vec3(0, 0, 1));
  add_slab(mesh, 5, 7, -0.2F, kGlass);
  add_slab(mesh, 5.5F, 6.5F, -0.15F, kGrass);
  add_slab(mesh, 12, 14, 0.5F, kGrass);  // high enough already
  WorkMesh work = make_work_mesh(mesh);
  ASSERT_TRUE(raise_sheets(work, mesh, all_may_rise(work), 0.125F, 0.4F));
  const Mesh result = finish(work, mesh);
  const auto height_of = [&](const glm::u8vec4& color, float x) {
    for (size_t v = 0; v < result.vertex_count(); ++v)
      if (result.colors[v] == color && std::abs(result.positions[v].x - x) < 0.1F) return result.positions[v].z;
    return -1.0F;
  };
  EXPECT_NEAR(height_of(kGlass, 5), 0.125F, 1e-5F);
  EXPECT_NEAR(height_of(kGrass, 5.5F), 0.25F, 1e-5F);
  EXPECT_EQ(height_of(kGrass, 12), 0.5F);
}

TEST(Patches, sheets_that_may_not_rise_or_lie_out_of_reach_stay) {
  Mesh mesh = flat_grid(8, 20);
  mesh.colors.assign(mesh.vertex_count(), kWall);
  mesh.normals.assign(mesh.vertex_count(), glm::vec3(0, 0, 1));
  add_slab(mesh, 5, 7, -0.2F, kGlass);
  WorkMesh work = make_work_mesh(mesh);
  const std::vector<glm::vec3> before = work.positions;
  EXPECT_FALSE(raise_sheets(work, mesh, std::vector<uint8_t>(work.triangle_count(), 0), 0.125F, 0.4F));
  EXPECT_FALSE(raise_sheets(work, mesh, all_may_rise(work), 0.125F, 0.1F));
  EXPECT_EQ(work.positions, before);
}

TEST(Patches, a_cellar_floor_beneath_a_street_never_comes_up) {
  Mesh mesh = flat_grid(40, 20);
  Numbers numbers(3);
  for (glm::vec3& p : mesh.positions) p.z = numbers.between(-0.3F, 0);
  mesh.colors.assign(mesh.vertex_count(), kWall);
  mesh.normals.assign(mesh.vertex_count(), glm::vec3(0, 0, 1));
  add_slab(mesh, 2, 18, -0.5F, kGrass);
  const Mesh result = simplify(mesh, {.target_triangles = 200});
  for (size_t v = 0; v < result.vertex_count(); ++v)
    if (result.colors[v] == kGrass) {
      EXPECT_EQ(result.positions[v].z, -0.5F);
    }
}

}  // namespace
}  // namespace promenade
