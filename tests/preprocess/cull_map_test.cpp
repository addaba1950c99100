// What upright walls hide from a cell, as a map of the plan.

#include "preprocess/visibility/cull_map.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "preprocess/visibility/plan_segments.h"
#include "tests/numbers.h"

namespace promenade {
namespace {

constexpr float kFloor = -5;  // nobody looks lower

struct Wall {
  glm::vec2 a, b;
  float top_m;
};

/// Whether a line between two points meets the wall below its top.
bool meets_wall(const Wall& wall, const glm::dvec3& from, const glm::dvec3& to) {
  const glm::dvec2 a(wall.a), along = glm::dvec2(wall.b) - a, start(from), way = glm::dvec2(to) - start;
  const double turn = cross(way, along);
  if (turn == 0) return false;
  const double t = cross(a - start, along) / turn, place = cross(a - start, way) / turn;
  if (t < 0 || t > 1 || place < 0 || place > 1) return false;
  return from.z + (to.z - from.z) * t <= double(wall.top_m);
}

glm::dvec3 random_in(test::Numbers& numbers, const Box& box) {
  return glm::dvec3(box.center()) + glm::dvec3(numbers.in_cube(1)) * glm::dvec3(box.size()) * 0.5;
}

TEST(CullMap, hides_only_what_every_line_meets_a_wall_before) {
  test::Numbers numbers(21);
  CullMap map;
  uint32_t hidden = 0;
  for (int round = 0; round < 120; ++round) {
    const Box cell{{-2, -2, 0}, {2, 2, numbers.between(1, 25)}};
    std::vector<Wall> walls;
    for (int i = 0; i < 25; ++i) {
      const glm::vec2 a(numbers.in_cube(30));
      walls.push_back({a, a + glm::vec2(numbers.in_cube(20)), numbers.between(2, 30)});
    }
    map.reset(cell, {-60, -60}, {60, 60});
    for (const Wall& wall : walls) map.add_wall(wall.a, wall.b, wall.top_m, cell);
    for (int i = 0; i < 150; ++i) {
      const glm::vec2 at(numbers.in_cube(59));
      const Box asked{glm::vec3(at - 0.5F, kFloor), glm::vec3(at + 0.5F, numbers.between(kFloor, 20))};
      if (asked.overlaps(cell) || !map.hides(asked)) continue;
      ++hidden;
      for (int k = 0; k < 40; ++k) {
        glm::dvec3 eye = random_in(numbers, cell);
        if (k % 2 == 0)  // a corner
          for (int axis = 0; axis < 3; ++axis)
            eye[axis] = double(eye[axis] > double(cell.center()[axis]) ? cell.max[axis] : cell.min[axis]);
        const glm::dvec3 to = random_in(numbers, asked);
        EXPECT_TRUE(std::any_of(walls.begin(), walls.end(), [&](const Wall& w) { return meets_wall(w, eye, to); }))
            << round;
      }
    }
  }
  EXPECT_GT(hidden, 300U) << "a map that hides nothing proves nothing";
}

TEST(CullMap, joins_the_shadows_of_walls) {
  const Box cell{{-2, -2, 0}, {2, 2, 2}}, thing{{30, -8, 0}, {32, 8, 3}};
  CullMap map;
  map.reset(cell, {-60, -60}, {60, 60});
  map.add_wall({10, -20}, {10, 4}, 9, cell);
  EXPECT_FALSE(map.hides(thing));
  map.add_wall({10, -4}, {10, 20}, 9, cell);
  EXPECT_TRUE(map.hides(thing));
  EXPECT_FALSE(map.hides({{30, -8, 0}, {32, 8, 40}})) << "above the plane through the walls' top";
  EXPECT_FALSE(map.hides({{5, -1, 0}, {6, 1, 1}})) << "before the walls";
  EXPECT_FALSE(map.hides({{58, -8, 0}, {62, 8, 3}})) << "beyond the map";
}

TEST(CullMap, takes_a_solid_as_wide_as_the_cell_sees_it) {
  const Box cell{{-2, -2, 0}, {2, 2, 2}}, thing{{24, 24, 0}, {26, 26, 3}};
  const std::array<glm::vec2, 4> house = {glm::vec2(8, 8), {16, 8}, {16, 16}, {8, 16}};
  CullMap map;
  map.reset(cell, {-60, -60}, {60, 60});
  for (size_t i = 0; i < 4; ++i) map.add_wall(house[i], house[(i + 1) % 4], 12, cell);
  const Box corner{{20, 20, 0}, {20.5F, 20.5F, 3}};
  EXPECT_FALSE(map.hides(corner)) << "between the shadows of two sides that meet in the near corner";
  map.add_solid(house, 12, cell);
  EXPECT_TRUE(map.hides(corner));
  EXPECT_TRUE(map.hides(thing));
}

TEST(CullMap, takes_no_way_across_a_yard_for_a_wall) {
  const Box cell{{-2, -2, 0}, {2, 2, 2}}, behind{{30, -1, 0}, {31, 1, 1}};
  // Open towards the cell: its arms hide nothing in the middle, its back is low.
  const std::array<glm::vec2, 8> yard = {glm::vec2(10, -12), {20, -12}, {20, 12},  {10, 12},
                                         {10, 11},           {19, 11},  {19, -11}, {10, -11}};
  CullMap map;
  map.reset(cell, {-60, -60}, {60, 60});
  map.add_solid(yard, 12, cell);
  EXPECT_TRUE(map.hides(behind)) << "by its back";
  EXPECT_FALSE(map.hides({{15, -1, 0}, {16, 1, 1}})) << "in the yard";
}

TEST(CullMap, leaves_out_walls_that_the_cell_is_on_both_sides_of_or_that_are_near) {
  const Box cell{{-2, -2, 0}, {2, 2, 2}}, behind{{10, -1, 0}, {11, 1, 1}};
  CullMap map;
  map.reset(cell, {-60, -60}, {60, 60});
  map.add_wall({5, 0}, {50, 0}, 9, cell);
  map.add_wall({3, -20}, {3, 20}, 9, cell.grown(2));
  map.add_wall({3, 1}, {3, 1}, 9, cell);
  EXPECT_FALSE(map.hides(behind));
  map.add_wall({3, -20}, {3, 20}, 9, cell);
  EXPECT_TRUE(map.hides(behind));
}

}  // namespace
}  // namespace promenade
