#include "preprocess/simplify.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <set>
#include <span>

#include "preprocess/collapse.h"
#include "tests/preprocess/surfaces.h"

namespace promenade {
namespace {

using namespace test;

Mesh simplified(const Mesh& mesh, uint32_t target) { return simplify(mesh, {.target_triangles = target}); }

/// Sound, at the target, with unit normals and only positions that the source has.
void expect_sound(const Mesh& source, const Mesh& result, uint32_t target) {
  EXPECT_EQ(find_defect(result), "");
  EXPECT_LE(result.triangle_count(), target);
  EXPECT_GE(result.triangle_count(), 1U);
  EXPECT_EQ(result.normals.empty(), source.normals.empty());
  EXPECT_EQ(result.colors.empty(), source.colors.empty());
  EXPECT_EQ(result.materials.empty(), source.materials.empty());
  for (const glm::vec3& n : result.normals)
    EXPECT_TRUE(n == glm::vec3(0) || std::abs(glm::length(n) - 1) < 1e-4F) << glm::length(n);
  for (size_t i = 0; i < result.indices.size(); i += 3) {
    const std::set<uint32_t> corners(result.indices.begin() + std::ptrdiff_t(i),
                                     result.indices.begin() + std::ptrdiff_t(i) + 3);
    EXPECT_EQ(corners.size(), 3U);
  }
}

double area_facing(const Mesh& mesh, const glm::vec3& direction) {
  double area = 0;
  for (size_t t = 0; t < mesh.triangle_count(); ++t) {
    const glm::vec3 cross = triangle_cross(mesh, t);
    if (glm::dot(cross, direction) > 0.99F * glm::length(cross)) area += 0.5 * double(glm::length(cross));
  }
  return area;
}

TEST(Simplify, leaves_alone_what_is_small_enough) {
  const Mesh mesh = hills(5);
  EXPECT_EQ(simplified(mesh, 50).indices, mesh.indices);
}

TEST(Simplify, flat_grid_becomes_two_triangles) {
  const Mesh flat = flat_grid(30, 10);
  const Mesh result = simplified(flat, 2);
  expect_sound(flat, result, 2);
  EXPECT_LT(surface_distance(flat, result).bound_m, 1e-3);
  EXPECT_NEAR(area_facing(result, {0, 0, 1}), 100, 1e-3);
}

TEST(Simplify, tessellated_cube_stays_a_cube) {
  Mesh cube;
  for (int face = 0; face < 6; ++face) {
    Mesh side = flat_grid(12, 1);
    for (glm::vec3& p : side.positions) {
      const glm::vec3 q = p;
      const int axis = face / 2;
      p[axis] = face % 2 == 0 ? 0.0F : 1.0F;
      p[(axis + 1) % 3] = face % 2 == 0 ? q.y : q.x;
      p[(axis + 2) % 3] = face % 2 == 0 ? q.x : q.y;
    }
    append(cube, side);
  }
  const Mesh result = simplified(cube, 12);
  expect_sound(cube, result, 12);
  EXPECT_LT(surface_distance(cube, result).bound_m, 1e-3);
  for (int axis = 0; axis < 3; ++axis)
    for (const float sign : {-1.0F, 1.0F}) {
      glm::vec3 direction(0);
      direction[axis] = sign;
      EXPECT_NEAR(area_facing(result, direction), 1, 1e-4);
    }
}

TEST(Simplify, tiny_parts_vanish_before_the_shape_suffers) {
  Mesh mesh = ball(24);
  const double area = surface_area_m2(mesh);
  mesh.normals.clear();
  Mesh specks = disjoint_triangles(500);
  Numbers numbers(4);
  for (size_t v = 0; v < specks.positions.size(); ++v)
    specks.positions[v] = v % 3 == 0 ? glm::normalize(specks.positions[v]) * 10.02F
                                     : specks.positions[v / 3 * 3] + numbers.in_cube(0.02F);
  append(mesh, specks);
  const Mesh result = simplified(mesh, 2000);
  expect_sound(mesh, result, 2000);
  EXPECT_LT(surface_distance(mesh, result).bound_m, 0.15F);
  EXPECT_NEAR(surface_area_m2(result), area, 0.01 * area);
}

TEST(Simplify, a_zebra_crossing_outlives_pebbles_that_stand_higher_above_the_street) {
  constexpr glm::u8vec4 kAsphalt{70, 70, 74, 255}, kWhite{235, 235, 235, 255};
  Mesh mesh = flat_grid(10, 20);
  mesh.colors.assign(mesh.vertex_count(), kAsphalt);
  for (int i = 0; i < 40; ++i) {
    const glm::vec3 corner(0.3F + 0.47F * float(i), 15, 0);
    Mesh pebble;
    add_box(pebble, corner, corner + glm::vec3(0.06F), kAsphalt);
    append(mesh, pebble);
  }
  for (int i = 0; i < 8; ++i) {
    Mesh stripe = flat_grid(1);
    for (glm::vec3& p : stripe.positions) p = glm::vec3(1 + float(i) + 0.5F * p.x, 5 + 4 * p.y, 0.01F);
    stripe.colors.assign(stripe.vertex_count(), kWhite);
    append(mesh, stripe);
  }
  const Mesh result = simplified(mesh, 40);
  expect_sound(mesh, result, 40);
  double white_m2 = 0;
  for (size_t t = 0; t < result.triangle_count(); ++t)
    if (result.colors[result.indices[t * 3]] == kWhite)
      white_m2 += 0.5 * double(glm::length(triangle_cross(result, t)));
  EXPECT_NEAR(white_m2, 8 * 0.5 * 4, 1e-3);
}

TEST(Simplify, a_rail_on_posts_at_its_ends_middle_and_thirds_outlives_bumps) {
  constexpr glm::u8vec4 kGrey{128, 128, 128, 255};
  Mesh mesh;
  for (int post = 0; post <= 6; ++post) {
    const float x = 2 * float(post);
    add_box(mesh, {x - 0.05F, 2, 0}, {x + 0.05F, 2.1F, 1}, kGrey);
  }
  add_box(mesh, {0, 2, 1}, {12, 2.1F, 1.04F}, kGrey);
  Numbers numbers(7);
  Mesh bumps = grid(40, 12, [&](float, float) { return numbers.between(-0.4F, 0); });
  bumps.colors.assign(bumps.vertex_count(), kGrey);
  append(mesh, bumps);
  const Mesh result = simplified(mesh, 300);
  expect_sound(mesh, result, 300);
  EXPECT_LT(surface_distance(mesh, result).bound_m, 0.5F);
}

TEST(Simplify, a_lone_part_far_away_outlives_larger_ones_that_lie_close) {
  Mesh mesh;
  add_box(mesh, glm::vec3(0), glm::vec3(10), {255, 255, 255, 255});
  for (int i = 0; i < 20; ++i)
    add_box(mesh, glm::vec3(float(i) * 0.45F, 1, 10.01F), glm::vec3(float(i) * 0.45F + 0.4F, 9, 10.05F),
            {200, 0, 0, 255});
  add_box(mesh, glm::vec3(50), glm::vec3(50.3F), {0, 0, 200, 255});
  const Mesh result = simplified(mesh, 40);
  expect_sound(mesh, result, 40);
  EXPECT_LT(surface_distance(mesh, result).bound_m, 0.2F);
}

TEST(Simplify, target_is_reached_whatever_comes) {
  const Mesh meshes[] = {disjoint_triangles(800), tangled_soup(1500, 150), box_city_block(), ball(20), hub(1000)};
  for (const uint32_t target : {1U, 7U, 200U})
    for (const Mesh& mesh : meshes) expect_sound(mesh, simplified(mesh, target), target);
  const Mesh disjoint = disjoint_triangles(5000);
  expect_sound(disjoint, simplified(disjoint, 500), 500);
}

TEST(Simplify, degenerate_and_repeated_faces_go_first) {
  Mesh mesh = flat_grid(4, 4);
  const std::vector<uint32_t> once = mesh.indices;
  for (int i = 0; i < 3; ++i) mesh.indices.insert(mesh.indices.end(), once.begin(), once.end());
  for (uint32_t i = 0; i < 10; ++i) mesh.indices.insert(mesh.indices.end(), {i, i, i + 1});
  const Mesh result = simplified(mesh, 32);
  expect_sound(mesh, result, 32);
  EXPECT_NEAR(surface_area_m2(result), 16, 1e-4);

  Mesh points;
  points.positions.assign(30, glm::vec3(1));
  for (uint32_t i = 0; i < 30; ++i) points.indices.push_back(i);
  EXPECT_EQ(find_defect(simplified(points, 2)), "");
  EXPECT_EQ(find_defect(simplified(Mesh{}, 2)), "");
}

TEST(Simplify, the_border_between_two_colours_of_a_flat_wall_stays) {
  Mesh wall = flat_grid(20, 10);
  Mesh two_coloured;
  for (size_t t = 0; t < wall.triangle_count(); ++t) {
    const bool left = t / 2 % 20 < 9;
    for (size_t c = 0; c < 3; ++c) {
      two_coloured.indices.push_back(static_cast<uint32_t>(two_coloured.positions.size()));
      two_coloured.positions.push_back(wall.positions[wall.indices[3 * t + c]]);
      two_coloured.colors.push_back(left ? glm::u8vec4(200, 40, 40, 255) : glm::u8vec4(240, 240, 230, 255));
    }
  }
  const Mesh result = simplified(two_coloured, 4);
  expect_sound(two_coloured, result, 4);
  double red = 0;
  for (size_t t = 0; t < result.triangle_count(); ++t) {
    EXPECT_EQ(result.colors[result.indices[3 * t]], result.colors[result.indices[3 * t + 1]]);
    EXPECT_EQ(result.colors[result.indices[3 * t]], result.colors[result.indices[3 * t + 2]]);
    if (result.colors[result.indices[3 * t]].y == 40) red += 0.5 * double(glm::length(triangle_cross(result, t)));
  }
  EXPECT_NEAR(red, 45, 1e-3);
}

TEST(Simplify, the_border_between_two_materials_stays) {
  Mesh wall = flat_grid(20, 10);
  for (size_t t = 0; t < wall.triangle_count(); ++t) wall.materials.push_back(t / 40 < 5 ? 3 : 8);
  const Mesh result = simplified(wall, 4);
  expect_sound(wall, result, 4);
  double third = 0;
  for (size_t t = 0; t < result.triangle_count(); ++t)
    if (result.materials[t] == 3) third += 0.5 * double(glm::length(triangle_cross(result, t)));
  EXPECT_NEAR(third, 25, 1e-3);
}

/// All open edges.
Border border_all_around(const Mesh& mesh) {
  std::vector<uint32_t> triangles(mesh.triangle_count());
  std::iota(triangles.begin(), triangles.end(), 0U);
  const std::span<const uint32_t> leaf(triangles);
  return find_borders(mesh, {&leaf, 1}, bounds(mesh), bounds(mesh).diagonal()).front();
}

TEST(Simplify, locked_borders_stay_where_they_are) {
  const Mesh mesh = hills(40);
  Border border = border_all_around(mesh);
  const Mesh result = simplify(mesh, {.target_triangles = 1000}, border);
  expect_sound(mesh, result, 1000);
  const auto on_border = [](const glm::vec3& p) { return p.x == 0 || p.y == 0 || p.x == 100 || p.y == 100; };
  const auto borders = [&](const Mesh& m) {
    std::set<std::array<float, 3>> places;
    for (const glm::vec3& p : m.positions)
      if (on_border(p)) places.insert({p.x, p.y, p.z});
    return places;
  };
  EXPECT_EQ(borders(result), borders(mesh));
}

TEST(Simplify, borders_that_leave_no_room_give_way_but_stay_on_the_cell) {
  const Mesh mesh = hills(40);
  Border border = border_all_around(mesh);
  const Mesh result = simplify(mesh, {.target_triangles = 100}, border);
  expect_sound(mesh, result, 100);
  const Box box = bounds(result);
  EXPECT_EQ(box.min.x, 0);
  EXPECT_EQ(box.min.y, 0);
  EXPECT_EQ(box.max.x, 100);
  EXPECT_EQ(box.max.y, 100);
}

TEST(Simplify, a_place_goes_along_its_border_however_many_neighbours_it_has) {
  constexpr uint32_t kRim = 24;
  Mesh mesh;
  mesh.positions = {{0, 0, 1}, {1, 0, 0}, {-1, 0, 0}, {0, 1, 0}};
  uint32_t last = 1;  // from the right over a rim above the middle to the left
  for (uint32_t i = 0; i <= kRim; ++i) {
    const uint32_t next = i == kRim ? 2 : uint32_t(mesh.positions.size());
    const float x = 0.5F - float(i) / float(kRim - 1);
    if (i < kRim) mesh.positions.emplace_back(x, 0.6F - 0.4F * x * x, 1);
    mesh.indices.insert(mesh.indices.end(), {0, last, next, last, 3, next});
    last = next;
  }
  WorkMesh work = make_work_mesh(mesh);
  const auto place_at = [&](const glm::vec3& p) {
    return static_cast<uint32_t>(std::find(work.model_positions.begin(), work.model_positions.end(), p) -
                                 work.model_positions.begin());
  };
  const uint32_t middle = place_at({0, 0, 1}), right = place_at({1, 0, 0}), left = place_at({-1, 0, 0});
  BorderLines borders(work, border_all_around(mesh));
  Collapser collapser(work, mesh, borders, 1);
  // Onto the rim it would be half a metre.
  collapser.set_border_rule(Collapser::BorderRule::along);
  const uint32_t along = collapser.choose(middle, 100).target;
  EXPECT_TRUE(along == right || along == left) << along;
}

TEST(Simplify, windows_go_before_walls) {
  const Mesh city = box_city_block();
  const Mesh result = simplified(city, uint32_t(city.triangle_count()) / 8);
  expect_sound(city, result, uint32_t(city.triangle_count()) / 8);
  EXPECT_LT(surface_distance(city, result, 0.04).bound_m, 0.5F);
}

TEST(Simplify, a_thin_wall_keeps_both_its_sides) {
  Mesh wall;
  Mesh front = flat_grid(20, 10, 0.1F), back = flat_grid(20, 10, 0);
  for (size_t i = 0; i < back.indices.size(); i += 3) std::swap(back.indices[i + 1], back.indices[i + 2]);
  append(wall, front);
  append(wall, back);
  const Mesh result = simplified(wall, 4);
  EXPECT_NEAR(area_facing(result, {0, 0, 1}), 100, 1e-2);
  EXPECT_NEAR(area_facing(result, {0, 0, -1}), 100, 1e-2);
}

TEST(Simplify, is_the_same_every_time) {
  const Mesh city = box_city_block();
  const Mesh once = simplified(city, 300), again = simplified(city, 300);
  EXPECT_EQ(once.positions, again.positions);
  EXPECT_EQ(once.indices, again.indices);
}

}  // namespace
}  // namespace promenade
