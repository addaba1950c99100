// What solid boxes hide: from an eye, from a cell, and from where a picture of them is best taken.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <vector>

#include "preprocess/visibility/box_view.h"
#include "preprocess/visibility/closest_in_half_spaces.h"
#include "preprocess/visibility/projection_point.h"
#include "tests/numbers.h"

namespace promenade {
namespace {

/// Whether a line between two points goes through a box.
bool meets(const Box& box, const glm::dvec3& from, const glm::dvec3& to) {
  double first = 0, last = 1;
  for (int axis = 0; axis < 3; ++axis) {
    const double way = to[axis] - from[axis];
    const double a = (double(box.min[axis]) - from[axis]) / way, b = (double(box.max[axis]) - from[axis]) / way;
    first = std::max(first, std::min(a, b)), last = std::min(last, std::max(a, b));
  }
  return first <= last;
}

TEST(BoxView, hides_only_what_every_line_meets_a_box_before) {
  test::Numbers numbers(5);
  const auto box_at = [&](float far, float size) {
    const glm::vec3 a = numbers.in_cube(far), half = glm::abs(numbers.in_cube(size)) + 0.1F;
    return Box{a - half, a + half};
  };
  BoxView view;
  uint32_t hidden = 0;
  for (int round = 0; round < 300; ++round) {
    const glm::dvec3 eye(numbers.in_cube(1));
    std::vector<Box> solids;
    for (int i = 0; i < 12; ++i)
      if (const Box box = box_at(6, 3); !box.contains(glm::vec3(eye))) solids.push_back(box);
    std::vector<Box> asked;
    asked.reserve(20);
    for (int i = 0; i < 20; ++i) asked.push_back(box_at(20, 2));
    view.reset(eye);
    for (const Box& box : asked) view.want(box);
    for (const Box& box : solids) view.add(box);
    for (const Box& box : asked) {
      if (!view.hides(box)) continue;
      ++hidden;
      for (int i = 0; i < 60; ++i) {
        const glm::dvec3 at = glm::dvec3(box.center()) + glm::dvec3(numbers.in_cube(1)) * glm::dvec3(box.size()) * 0.5;
        EXPECT_TRUE(std::any_of(solids.begin(), solids.end(), [&](const Box& solid) { return meets(solid, eye, at); }))
            << round;
      }
    }
  }
  EXPECT_GT(hidden, 300U) << "a view that hides nothing proves nothing";
}

TEST(BoxView, hides_what_is_behind_a_box_and_not_what_is_before_it) {
  BoxView view;
  const Box behind{{9, -1, -1}, {10, 1, 1}}, before{{2, -1, -1}, {3, 1, 1}}, around{{-1, -1, -1}, {1, 1, 1}};
  view.reset(glm::dvec3(0));
  for (const Box& box : {behind, before, around}) view.want(box);
  EXPECT_FALSE(view.hides(behind)) << "nothing drawn";
  view.add({{5, -3, -3}, {6, 3, 3}});
  EXPECT_TRUE(view.hides(behind));
  EXPECT_FALSE(view.hides(before));
  EXPECT_FALSE(view.hides(around)) << "the eye is in it";
}

Box random_box(test::Numbers& numbers, float far, float size) {
  const glm::vec3 a = numbers.in_cube(far), half = glm::abs(numbers.in_cube(size)) + 0.1F;
  return {a - half, a + half};
}
/// Flat every third time: a face of a cell.
Box random_cell(test::Numbers& numbers, int round) {
  const glm::vec3 half = glm::abs(numbers.in_cube(2)) + 0.05F;
  Box cell{-half, half};
  if (round % 3 == 0) cell.min.x = cell.max.x = 0.25F;
  return cell;
}
std::array<glm::dvec3, 8> corners_of(const Box& box) {
  std::array<glm::dvec3, 8> corners;
  for (size_t i = 0; i < 8; ++i)
    corners[i] = {(i & 1U) != 0 ? box.max.x : box.min.x, (i & 2U) != 0 ? box.max.y : box.min.y,
                  (i & 4U) != 0 ? box.max.z : box.min.z};
  return corners;
}
glm::dvec3 random_in(test::Numbers& numbers, const Box& box) {
  return glm::dvec3(box.center()) + glm::dvec3(numbers.in_cube(1)) * glm::dvec3(box.size()) * 0.5;
}

TEST(BoxShadow, is_the_umbra_no_more_and_no_less) {
  test::Numbers numbers(11);
  uint32_t within = 0, outside = 0;
  for (int round = 0; round < 3000; ++round) {
    const Box cell = random_cell(numbers, round), solid = random_box(numbers, 12, 8);
    if (solid.overlaps(cell)) continue;
    const BoxShadow shadow(cell, solid);
    for (int i = 0; i < 30; ++i) {
      const glm::dvec3 x = glm::dvec3(solid.center()) * double(1 + numbers.unit() * 3) + glm::dvec3(numbers.in_cube(9));
      if (solid.grown(1e-3F).contains(glm::vec3(x)) || cell.grown(1e-3F).contains(glm::vec3(x))) continue;
      double beyond = -INFINITY;  // the least that x lies outside of any half-space
      for (const HalfSpace& side : shadow.sides()) beyond = std::max(beyond, glm::dot(side.normal, x) - side.offset);
      for (const HalfSpace& front : shadow.fronts())
        beyond = std::max(beyond, glm::dot(front.normal, x) - front.offset);
      if (std::abs(beyond) < 1e-6) continue;  // on its border
      // What a corner of the cell does not see, in a convex cell, nobody does.
      const auto corners = corners_of(cell);
      const bool hidden =
          std::all_of(corners.begin(), corners.end(), [&](const auto& e) { return meets(solid, e, x); });
      EXPECT_EQ(beyond < 0, hidden) << round << ": " << beyond;
      (hidden ? within : outside) += 1U;
    }
  }
  EXPECT_GT(within, 3000U);
  EXPECT_GT(outside, 3000U);
}

TEST(BoxShadow, drawn_from_its_point_hides_only_what_nobody_in_the_cell_sees) {
  test::Numbers numbers(12);
  BoxView view;
  const Box world{{-60, -60, -60}, {60, 60, 60}};
  uint32_t hidden = 0, from_outside = 0;
  for (int round = 0; round < 400; ++round) {
    const Box cell = random_cell(numbers, round);
    std::vector<Box> solids, asked;
    for (int i = 0; i < 10; ++i)
      if (const Box box = random_box(numbers, 10, 7); !box.overlaps(cell)) solids.push_back(box);
    for (int i = 0; i < 20; ++i)
      if (const Box box = random_box(numbers, 40, 2); !box.overlaps(cell)) asked.push_back(box);
    const std::vector<ShrunkOccluder> occluders = shrunk_occluders(cell, solids);
    std::vector<const ShrunkOccluder*> all;
    all.reserve(occluders.size());
    for (const ShrunkOccluder& occluder : occluders) all.push_back(&occluder);
    view.reset(projection_point(cell, world, all));
    from_outside += cell.contains(glm::vec3(view.eye())) ? 0U : 1U;
    for (const Box& box : asked) view.want(box);
    for (const ShrunkOccluder& occluder : occluders) {
      EXPECT_TRUE(occluder.shadow.may_be_seen_from(view.eye()));
      view.add(occluder.shadow);
    }
    for (const Box& box : asked) {
      if (!view.hides(box)) continue;
      ++hidden;
      for (int i = 0; i < 60; ++i) {
        const glm::dvec3 at = random_in(numbers, box);
        const glm::dvec3 eye = i % 2 == 0 ? random_in(numbers, cell) : corners_of(cell)[static_cast<size_t>(i / 2) % 8];
        EXPECT_TRUE(std::any_of(solids.begin(), solids.end(), [&](const Box& solid) { return meets(solid, eye, at); }))
            << round;
      }
    }
  }
  EXPECT_GT(hidden, 300U);
  EXPECT_GT(from_outside, 40U) << "the best point lies behind the cell, often";
}

TEST(BoxShadow, hides_more_from_the_best_point_than_from_the_middle) {
  const Box cell{{-2, -2, -2}, {2, 2, 2}}, wall{{10, -4, -4}, {11, 4, 4}}, world{{-50, -50, -50}, {50, 50, 50}};
  const std::vector<ShrunkOccluder> occluders = shrunk_occluders(cell, std::vector{wall});
  ASSERT_EQ(occluders.size(), 1U);
  const std::vector<const ShrunkOccluder*> all{&occluders[0]};
  const Box behind{{30, -6.5F, -6.5F}, {31, 6.5F, 6.5F}};
  const auto hides_from = [&](const glm::dvec3& eye) {
    BoxView view;
    view.reset(eye);
    view.want(behind);
    view.add(occluders[0].shadow);
    return view.hides(behind);
  };
  EXPECT_FALSE(hides_from(glm::dvec3(0)));
  const glm::dvec3 best = projection_point(cell, world, all);
  EXPECT_NEAR(best.x, -14, 1e-3) << "where its planes meet, behind the cell";
  EXPECT_TRUE(hides_from(best));
}

TEST(BoxShadow, hides_nothing_where_there_is_none) {
  const Box cell{{-2, -2, -2}, {2, 2, 2}}, world{{-50, -50, -50}, {50, 50, 50}}, asked{{9, -1, -1}, {10, 1, 1}};
  EXPECT_EQ(projection_point(cell, world, {}), glm::dvec3(0));
  for (const double x : {0.0, std::numeric_limits<double>::quiet_NaN()}) {
    BoxView view;
    view.reset(glm::dvec3(x));
    view.want(asked);
    EXPECT_FALSE(view.hides(asked)) << x;
  }
}

TEST(ShrunkOccluders, leave_out_what_is_smaller_than_the_cell_or_in_it) {
  const Box cell{{-2, -2, -2}, {2, 2, 2}};
  const std::vector<Box> solids{{{10, -1, -1}, {11, 1, 1}}, {{1, -9, -9}, {3, 9, 9}}, {{10, -9, -9}, {11, 9, 9}}};
  const std::vector<ShrunkOccluder> occluders = shrunk_occluders(cell, solids);
  ASSERT_EQ(occluders.size(), 1U);
  EXPECT_EQ(occluders[0].front, 10);
  EXPECT_EQ(occluders[0].face, 0U);
}

TEST(ClosestInHalfSpaces, is_the_least_that_conditions_allow) {
  test::Numbers numbers(13);
  const auto random = [&](float half) { return glm::dvec3(numbers.in_cube(half)); };
  uint32_t bound = 0;
  for (int round = 0; round < 600; ++round) {
    std::vector<HalfSpace> half_spaces(static_cast<size_t>(round) % 40);
    const glm::dvec3 inside = random(3), wanted = random(30);
    const glm::dvec3 stiffness = glm::abs(random(1)) * glm::dvec3(1, 100, 1e-2) + 1e-3;
    for (HalfSpace& half_space : half_spaces) {
      half_space.normal = random(1) + 1e-3;
      half_space.offset = glm::dot(half_space.normal, inside) + double(numbers.unit()) * 4;
    }
    const auto allowed = [&](const glm::dvec3& x) {
      return std::all_of(half_spaces.begin(), half_spaces.end(), [&](const HalfSpace& h) { return h.holds(x); });
    };
    const auto cost = [&](const glm::dvec3& x) { return glm::dot(stiffness, (x - wanted) * (x - wanted)); };
    const glm::dvec3 best = closest_in_half_spaces(half_spaces, wanted, stiffness, inside);
    EXPECT_TRUE(allowed(best)) << round;
    bound += allowed(wanted) ? 0U : 1U;
    // Nothing near that is allowed is better; then, all being convex, nothing is.
    for (int i = 0; i < 300; ++i) {
      const glm::dvec3 near = best + random(1) * std::pow(10.0, -double(i % 5));
      if (!allowed(near)) continue;
      EXPECT_GE(cost(near), cost(best) * (1 - 1e-6) - 1e-9) << round;
    }
  }
  EXPECT_GT(bound, 400U);
}

TEST(ClosestInHalfSpaces, leaves_no_room_no_slack_and_no_normal_alone) {
  const glm::dvec3 inside(1, 2, 3), wanted(9, 9, 9), one(1);
  EXPECT_EQ(closest_in_half_spaces({}, wanted, one, inside), wanted);
  std::vector<HalfSpace> point;
  for (int axis = 0; axis < 3; ++axis)
    for (const double sign : {-1.0, 1.0}) {
      glm::dvec3 normal(0);
      normal[axis] = sign;
      point.push_back({normal, sign * inside[axis]});
    }
  EXPECT_EQ(closest_in_half_spaces(point, wanted, one, inside), inside);
  const std::vector<HalfSpace> nothing{{glm::dvec3(0), 0}};
  EXPECT_EQ(closest_in_half_spaces(nothing, wanted, one, inside), wanted);
}

}  // namespace
}  // namespace promenade
