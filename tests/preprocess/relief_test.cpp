#include "preprocess/relief.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "preprocess/relief_press.h"
#include "preprocess/simplify.h"
#include "tests/preprocess/surfaces.h"

namespace promenade {
namespace {

using namespace test;

constexpr glm::u8vec4 kPaint{200, 190, 170, 255};
constexpr float kWindowM = 0.2F;  // how deep add_wall_with_windows sets its panes

/// In the plane y = 0, seen from -y; panes at y = 0.2.
Mesh wall_with_windows(uint32_t columns = 8, uint32_t rows = 5) {
  Mesh wall;
  add_wall_with_windows(wall, {0, 0, 0}, {24, 0, 0}, {0, 0, 15}, columns, rows, kPaint);
  return wall;
}

/// A press with all that it works on.
struct Pressing {
  explicit Pressing(const Mesh& mesh, const Border& border = {})
      : work(make_work_mesh(mesh)), borders(work, border), collapser(work, mesh, borders, 0.5F) {}
  ReliefPress press() { return {work, collapser, borders, find_reliefs(work, 1), {}}; }
  WorkMesh work;
  BorderLines borders;
  Collapser collapser;
};

TEST(Relief, a_wall_and_its_panes_are_one_relief) {
  const Mesh wall = wall_with_windows();
  const WorkMesh work = make_work_mesh(wall);
  const std::vector<Relief> reliefs = find_reliefs(work, 1);
  ASSERT_EQ(reliefs.size(), 1U);
  EXPECT_NEAR(reliefs[0].depth_m(), kWindowM, 1e-4F);
  EXPECT_NEAR(reliefs[0].normal.y, -1, 1e-4F);
  EXPECT_EQ(reliefs[0].places.size(), work.place_count());
  EXPECT_TRUE(find_reliefs(work, 0.1F).empty()) << "deeper than asked for";
}

TEST(Relief, what_looks_the_other_way_or_is_not_joined_is_none) {
  EXPECT_TRUE(find_reliefs(make_work_mesh(flat_grid(10, 10)), 1).empty());
  Mesh box;  // two sides 0.1 m apart
  add_box(box, {0, 0, 0}, {5, 0.1F, 5}, kPaint);
  EXPECT_TRUE(find_reliefs(make_work_mesh(box), 1).empty());
  Mesh apart = flat_grid(4, 10, 0);
  append(apart, flat_grid(4, 10, 0.1F));
  EXPECT_TRUE(find_reliefs(make_work_mesh(apart), 1).empty());
  EXPECT_TRUE(find_reliefs(make_work_mesh(Mesh()), 1).empty());
}

TEST(Relief, deeper_steps_come_later_with_what_is_joined_already) {
  Mesh stairs;
  float z = 0, x = 0;
  for (const float step_m : {0.1F, 0.3F, 0.9F}) {
    add_quad(stairs, {x, 0, z}, {x + 2, 0, z}, {x + 2, 8, z}, {x, 8, z}, kPaint);
    add_quad(stairs, {x + 2, 0, z}, {x + 2, 0, z + step_m}, {x + 2, 8, z + step_m}, {x + 2, 8, z}, kPaint);
    z += step_m, x += 2;
  }
  add_quad(stairs, {x, 0, z}, {x + 2, 0, z}, {x + 2, 8, z}, {x, 8, z}, kPaint);
  const std::vector<Relief> reliefs = find_reliefs(make_work_mesh(stairs), 2);
  ASSERT_EQ(reliefs.size(), 3U);
  EXPECT_NEAR(reliefs[0].depth_m(), 0.1F, 1e-4F);
  EXPECT_NEAR(reliefs[1].depth_m(), 0.4F, 1e-4F);
  EXPECT_NEAR(reliefs[2].depth_m(), 1.3F, 1e-4F);
  EXPECT_EQ(reliefs[0].places.size(), 8U);
  EXPECT_EQ(reliefs[2].places.size(), 16U);
}

TEST(Relief, pressed_it_is_flat_and_what_led_into_it_has_gone) {
  const Mesh wall = wall_with_windows(2, 2);
  Pressing pressing(wall);
  ReliefPress press = pressing.press();
  const uint32_t before = pressing.work.alive_count;
  EXPECT_NEAR(press.first_cost(0), kWindowM / 2, 1e-4F);
  EXPECT_NEAR(press.press(0, 0.2F), kWindowM / 2, 1e-3F);
  EXPECT_EQ(pressing.work.alive_count, before - 4 * 8) << "two triangles on each side of a window";
  const Mesh flat = finish(pressing.work, wall);
  EXPECT_EQ(find_defect(flat), "");
  for (const glm::vec3& p : flat.positions) EXPECT_NEAR(p.y, kWindowM / 2, 1e-4F);
  EXPECT_GT(press.press(0, 0.2F), 1e9F) << "nothing is left of it";
}

TEST(Relief, over_the_limit_nothing_moves) {
  const Mesh wall = wall_with_windows(2, 2);
  Pressing pressing(wall);
  ReliefPress press = pressing.press();
  EXPECT_GT(press.press(0, 0.05F), 0.05F);
  EXPECT_EQ(finish(pressing.work, wall).positions, finish(make_work_mesh(wall), wall).positions);
}

TEST(Relief, places_on_the_border_stay) {
  const Mesh wall = wall_with_windows(3, 2);
  Border border;  // all open edges of the wall's outline on the ground
  for (uint32_t corner = 0; corner < wall.indices.size(); ++corner) {
    const glm::vec3 a = wall.positions[wall.indices[corner]],
                    b = wall.positions[wall.indices[next_in_triangle(corner)]];
    if (a.z == 0 && b.z == 0) border.edges.push_back({corner, 0});
  }
  ASSERT_FALSE(border.edges.empty());
  Pressing pressing(wall, border);
  ReliefPress press = pressing.press();
  EXPECT_LE(press.press(0, 0.2F), 0.2F);
  for (const glm::vec3& p : finish(pressing.work, wall).positions) {
    if (p.z == 0)
      EXPECT_EQ(p.y, 0);
    else
      EXPECT_NEAR(p.y, kWindowM / 2, 1e-4F);
  }
}

TEST(Relief, a_wall_and_its_windows_meet_halfway) {
  const Mesh wall = wall_with_windows();
  const Mesh result = simplify(wall, {.target_triangles = 2 * 40 + 70});
  EXPECT_EQ(find_defect(result), "");
  EXPECT_LT(surface_distance(wall, result, 0.04).bound_m, 0.75F * kWindowM) << "one would have to go to the other";
}

}  // namespace
}  // namespace promenade
