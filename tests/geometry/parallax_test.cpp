#include "geometry/parallax.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <limits>

#include "geometry/random.h"

namespace promenade {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

glm::dvec3 in_cube(Random& random, double half) {
  const double x = random.range(-half, half), y = random.range(-half, half), z = random.range(-half, half);
  return {x, y, z};
}

double angle(const glm::dvec3& a, const glm::dvec3& b) {
  return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
}

/// The largest parallax over random eyes in the cell and random points between the box and the reach, each drawn on
/// the box.
double brute_force_rad(const FarCubes& cubes, int tries) {
  Random random(7);
  double largest = 0;
  for (int i = 0; i < tries; ++i) {
    glm::dvec3 eye = in_cube(random, cubes.cell_m / 2);
    if (i % 2 == 0)  // corners see most: half of the eyes are there
      for (int k = 0; k < 3; ++k) eye[k] = random.chance(0.5) ? cubes.cell_m / 2 : -cubes.cell_m / 2;
    const glm::dvec3 direction = in_cube(random, 1);
    const double along = std::max({std::abs(direction.x), std::abs(direction.y), std::abs(direction.z)});
    if (along < 1e-6) continue;
    const glm::dvec3 drawn = direction * (cubes.box_m / 2 / along), farthest = direction * (cubes.reach_m / along);
    const glm::dvec3 point = i % 3 == 0 ? farthest : drawn + (farthest - drawn) * random.unit();
    largest = std::max(largest, angle(drawn - eye, point - eye));
  }
  return largest;
}

TEST(Parallax, of_cubes_is_reached_and_never_exceeded_by_random_points) {
  for (const FarCubes& cubes : {FarCubes{5, 330, 1000}, FarCubes{33, 330, 1000}, FarCubes{60, 100, 5000},
                                FarCubes{6.35, 56, 1000}, FarCubes{1, 3, 2}}) {
    const double bound = largest_parallax_rad(cubes), found = brute_force_rad(cubes, 400000);
    EXPECT_LE(found, bound * (1 + 1e-9)) << cubes.cell_m << " m in " << cubes.box_m << " m";
    EXPECT_GE(found, bound * 0.97) << cubes.cell_m << " m in " << cubes.box_m << " m";
  }
}

TEST(Parallax, straight_ahead_as_published_misses_up_to_a_ninth) {
  // In the limit of small cells and a far model: the greatest value of (1 + e) / sqrt(1 + 2 e^2), squared distances of
  // the box's side counted.
  const double exact = largest_parallax_rad({1e-3, 100, 1e7}), published = published_parallax_rad(1e-3, 100, 1e7);
  double limit = 0;
  for (double e = 0; e < 1; e += 1e-4) limit = std::max(limit, (1 + e) / (1 + 2 * e * e));
  EXPECT_NEAR(exact / published, limit, 1e-3);
}

TEST(Parallax, of_a_ray_is_that_of_the_worst_corner) {
  const glm::dvec3 half(1, 2, 0.5), direction(10, 3, -4);
  Random random(3);
  const double bound = parallax_rad(half, direction, 1, 4);
  double found = 0;
  for (int i = 0; i < 200000; ++i) {
    const glm::dvec3 eye = in_cube(random, 1) * half;
    found = std::max(found, angle(direction - eye, direction * 4.0 - eye));
  }
  EXPECT_LE(found, bound * (1 + 1e-12));
  EXPECT_GE(found, bound * 0.95);
  EXPECT_EQ(parallax_rad(half, direction, 4, 1), bound) << "a point drawn too far is as wrong as one too near";
  EXPECT_EQ(parallax_rad(half, direction, 2, 2), 0);
  EXPECT_GT(parallax_rad(half, direction, 1, kInfinity), bound);
}

TEST(Parallax, is_never_above_the_bound_by_inverse_distances) {
  Random random(11);
  double tightest = 0;
  for (int i = 0; i < 20000; ++i) {
    const glm::dvec3 half(random.range(0.1, 3.0), random.range(0.1, 3.0), random.range(0.1, 3.0));
    const glm::dvec3 unit = glm::normalize(in_cube(random, 1) + glm::dvec3(1e-9));
    const EyeReach reach = eye_reach(half, unit);
    const double drawn = random.range(6.0, 60.0), true_one = random.range(6.0, 600.0);
    const double exact = parallax_rad(half, unit, drawn, true_one), bound = parallax_bound_rad(reach, drawn, true_one);
    EXPECT_LE(exact, bound * (1 + 1e-12));
    tightest = std::max(tightest, exact / std::max(bound, 1e-12));
    const DistanceRange range = drawable_range(reach, true_one, 0.05);
    EXPECT_NEAR(parallax_bound_rad(reach, range.from_m, true_one), 0.05, 1e-9);
    if (std::isfinite(range.to_m)) {
      EXPECT_NEAR(parallax_bound_rad(reach, range.to_m, true_one), 0.05, 1e-9);
    }
  }
  EXPECT_GT(tightest, 0.9) << "a bound that is never near says little";
  EXPECT_GT(parallax_bound_rad({2, 1}, 1, 5), 1.5) << "drawn within the cell";
  EXPECT_GT(drawable_range({2, 1}, 1, 0.1).from_m, drawable_range({2, 1}, 1, 0.1).to_m);
}

TEST(Parallax, of_what_is_no_number_is_the_most_there_is) {
  const double nan = std::nan("");
  EXPECT_GT(parallax_rad(glm::dvec3(1), {1, nan, 0}, 1, 2), 3);
  EXPECT_GT(parallax_rad(glm::dvec3(1), {1, 0, 0}, nan, 2), 3);
  EXPECT_GT(largest_parallax_rad({nan, 10, 20}), 3);
  EXPECT_GT(largest_parallax_rad({10, 10, 20}), 3);
  EXPECT_GT(largest_parallax_rad({1, 10, nan}), 3);
  EXPECT_GT(published_parallax_rad(1, nan, 20), 3);
}

TEST(ViewCell, of_the_published_examples_has_their_length) {
  const auto length = [](double degrees, double box_m, double model_m) {
    return *view_cell_length_m({glm::radians(degrees), box_m, model_m, false, ParallaxRule::published});
  };
  EXPECT_NEAR(length(10, 56, 1000), 6.35, 0.01);   // the campus, section 2.4.3
  EXPECT_NEAR(length(10, 56, 10000), 6.22, 0.01);  // the city, section 2.4.4
  EXPECT_NEAR(length(7.5, 330, 1000), 33, 0.5);    // table 6.1
  EXPECT_NEAR(length(1, 330, 1000), 5, 0.25);
}

TEST(ViewCell, is_the_largest_that_keeps_the_bound) {
  for (const ParallaxRule rule : {ParallaxRule::everywhere, ParallaxRule::published})
    for (const double degrees : {1e-6, 0.1, 1.0, 7.5, 30.0, 80.0})
      for (const double model_m : {330.0, 331.0, 1000.0, 1e9}) {
        const CellBound bound{glm::radians(degrees), 330, model_m, false, rule};
        const Result<double> cell_m = view_cell_length_m(bound);
        ASSERT_TRUE(cell_m.ok());
        const auto parallax = [&](double cell) {
          return rule == ParallaxRule::published
                     ? published_parallax_rad(cell, 330, model_m)
                     : largest_parallax_rad({cell, 330, std::max(model_m - cell / 2, 165.0)});
        };
        if (*cell_m < 330) {
          EXPECT_LE(parallax(*cell_m), bound.bound_rad * (1 + 1e-9)) << degrees << " " << model_m;
          EXPECT_GT(parallax(*cell_m * (1 + 1e-6)), bound.bound_rad * (1 - 1e-6)) << degrees << " " << model_m;
        }
      }
}

TEST(ViewCell, shrinks_with_the_bound_and_the_model) {
  const auto length = [](double degrees, double model_m) {
    return *view_cell_length_m({glm::radians(degrees), 100, model_m});
  };
  EXPECT_LT(length(1, 1000), length(2, 1000));
  EXPECT_LT(length(1, 2000), length(1, 1000));
}

TEST(ViewCell, of_hostile_numbers_is_refused_or_sound) {
  const double nan = std::nan("");
  for (const CellBound& bound :
       {CellBound{nan, 1, 2}, CellBound{0, 1, 2}, CellBound{-1, 1, 2}, CellBound{2, 1, 2}, CellBound{0.1, nan, 2},
        CellBound{0.1, 0, 2}, CellBound{0.1, kInfinity, kInfinity}, CellBound{0.1, 3, 2}, CellBound{0.1, 3, nan}})
    EXPECT_FALSE(view_cell_length_m(bound).ok()) << bound.bound_rad << " " << bound.box_m << " " << bound.model_m;
  for (const CellBound& bound :
       {CellBound{1e-12, 1, kInfinity}, CellBound{0.1, 1e-6, 1e12}, CellBound{1.57, 1e6, 1e6}}) {
    const Result<double> cell_m = view_cell_length_m(bound);
    ASSERT_TRUE(cell_m.ok());
    EXPECT_GT(*cell_m, 0);
    EXPECT_LE(*cell_m, bound.box_m);
  }
}

}  // namespace
}  // namespace promenade
