#include "preprocess/surface_distance.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/preprocess/surfaces.h"

namespace promenade {
namespace {

using namespace test;

/// Largest distance of `samples` random points of `from`, and of its corners, to `to`.
float sampled_distance(const Mesh& from, const Mesh& to, uint32_t samples, uint64_t seed) {
  const ClosestPointTree tree(to);
  std::vector<double> area_until;
  double area = 0;
  for (size_t t = 0; t < from.triangle_count(); ++t)
    area_until.push_back(area += double(glm::length(triangle_cross(from, t))));
  Numbers numbers(seed);
  float farthest2 = 0;
  for (const uint32_t v : from.indices) farthest2 = std::max(farthest2, tree.nearest(from.positions[v]).distance2_m2);
  uint32_t hint = kNoTriangle;
  for (uint32_t s = 0; s < samples; ++s) {
    const double at = area * double(numbers.unit());
    size_t t = size_t(std::upper_bound(area_until.begin(), area_until.end(), at) - area_until.begin());
    t = std::min(t, from.triangle_count() - 1);
    const float r = std::sqrt(numbers.unit()), w = numbers.unit();
    const glm::vec3 a = from.positions[from.indices[3 * t]], b = from.positions[from.indices[3 * t + 1]],
                    c = from.positions[from.indices[3 * t + 2]];
    const glm::vec3 p = a + (b - a) * (r * (1 - w)) + (c - a) * (r * w);
    const ClosestPointTree::Nearest found = tree.nearest(p, {.hint = hint});
    hint = found.triangle;
    farthest2 = std::max(farthest2, found.distance2_m2);
  }
  return std::sqrt(farthest2);
}

/// The bound holds at 100,000 points, and is not much looser than what they show.
void expect_bound_holds(const Mesh& a, const Mesh& b, float loosest_ratio) {
  const SurfaceDistance measured = surface_distance(a, b);
  const float sampled = std::max(sampled_distance(a, b, 50000, 3), sampled_distance(b, a, 50000, 4));
  EXPECT_LE(sampled, measured.bound_m);
  EXPECT_LE(measured.bound_m, sampled * loosest_ratio);
  EXPECT_LE(measured.p99_m, measured.bound_m);
}

/// Every second vertex of a mesh moved at random.
Mesh shaken(Mesh mesh, float by) {
  Numbers numbers(77);
  for (size_t v = 0; v < mesh.positions.size(); v += 2) mesh.positions[v] += numbers.in_cube(by);
  return mesh;
}

/// The same triangles in another order, each with corners of its own, which begin elsewhere.
Mesh rearranged(const Mesh& mesh) {
  Mesh out;
  for (size_t t = mesh.triangle_count(); t-- > 0;)
    for (size_t c = 0; c < 3; ++c) {
      out.indices.push_back(static_cast<uint32_t>(out.positions.size()));
      out.positions.push_back(mesh.positions[mesh.indices[3 * t + (c + t) % 3]]);
    }
  return out;
}

TEST(SurfaceDistance, is_nothing_between_the_same_triangles) {
  const Mesh mesh = hills(20);
  const SurfaceDistance distance = surface_distance(mesh, rearranged(mesh));
  EXPECT_EQ(distance.p99_m, 0);
  EXPECT_LE(distance.bound_m, 1e-5F * bounds(mesh).diagonal());
}

TEST(SurfaceDistance, sees_what_differs_among_triangles_that_are_the_same) {
  const Mesh mesh = hills(20);
  Mesh moved = rearranged(mesh);
  for (size_t c = 300; c < 303; ++c) moved.positions[c].z += 0.5F;  // a triangle alone: its neighbours stay
  expect_bound_holds(mesh, moved, 1.3F);
  Mesh fewer = rearranged(mesh);
  fewer.indices.resize(fewer.indices.size() - 3);
  expect_bound_holds(mesh, fewer, 1.3F);
}

TEST(SurfaceDistance, is_exact_between_parallel_squares) {
  const SurfaceDistance one_metre = surface_distance(flat_grid(1, 4, 0), flat_grid(1, 4, 1));
  EXPECT_GE(one_metre.bound_m, 1);
  EXPECT_NEAR(one_metre.bound_m, 1, 1e-4);
  EXPECT_NEAR(one_metre.p99_m, 1, 1e-5);
}

TEST(SurfaceDistance, is_nearly_nothing_between_two_triangulations_of_one_square) {
  for (const uint32_t n : {2U, 7U, 40U}) {
    const SurfaceDistance none = surface_distance(flat_grid(n, 10), flat_grid(1, 10));
    EXPECT_LT(none.bound_m, 1e-3) << n;
    EXPECT_LT(none.p99_m, 1e-5) << n;
    EXPECT_LT(surface_distance(flat_grid(n, 10), flat_grid(13, 10)).bound_m, 1e-3) << n;
  }
}

TEST(SurfaceDistance, counts_what_only_one_of_them_has) {
  Mesh cube, open_cube;
  add_box(cube, glm::vec3(0), glm::vec3(2), {255, 255, 255, 255});
  open_cube = cube;
  open_cube.indices.resize(open_cube.indices.size() - 6);  // without its lid: the lid's middle is 1 m from the rim
  const SurfaceDistance measured = surface_distance(cube, open_cube, 0.01);
  EXPECT_GE(measured.bound_m, 1);
  EXPECT_LE(measured.bound_m, 1.011F);
  EXPECT_EQ(surface_distance(open_cube, cube, 0.01).bound_m, measured.bound_m);

  Mesh with_speck = flat_grid(10, 10);
  append(with_speck, flat_grid(1, 0.01F, 5));
  EXPECT_NEAR(surface_distance(with_speck, flat_grid(10, 10)).bound_m, 5, 0.01);
  EXPECT_LT(surface_distance(with_speck, flat_grid(10, 10)).p99_m, 1e-5);
}

TEST(SurfaceDistance, p99_leaves_out_one_part_in_a_hundred_whichever_mesh_has_it) {
  const Mesh floor = flat_grid(10, 10);
  Mesh with_boards = floor;
  append(with_boards, flat_grid(1, 0.7F, 9));  // half of one part in a hundred
  EXPECT_LT(surface_distance(with_boards, floor).p99_m, 1e-5);
  append(with_boards, flat_grid(1, 1.0F, 5));  // one more
  EXPECT_NEAR(surface_distance(with_boards, floor).p99_m, 5, 1e-4);
  EXPECT_EQ(surface_distance(floor, with_boards).p99_m, surface_distance(with_boards, floor).p99_m);
  append(with_boards, flat_grid(1, 0.7F, 7));
  EXPECT_NEAR(surface_distance(with_boards, floor).p99_m, 5, 1e-4);
  append(with_boards, flat_grid(1, 0.7F, 8));
  EXPECT_NEAR(surface_distance(with_boards, floor).p99_m, 7, 1e-4);
}

TEST(SurfaceDistance, bound_holds_on_a_hundred_thousand_samples) {
  expect_bound_holds(hills(40), hills(9), 1.3F);
  expect_bound_holds(ball(24), ball(7), 1.3F);
  expect_bound_holds(box_city_block(), shaken(box_city_block(), 0.3F), 1.3F);
  expect_bound_holds(disjoint_triangles(300, 2.0F, 1), disjoint_triangles(300, 2.0F, 2), 1.3F);
  expect_bound_holds(tangled_soup(60, 30, 1), tangled_soup(60, 30, 2), 1.3F);
}

TEST(SurfaceDistance, a_tighter_slack_gives_a_tighter_bound) {
  const Mesh fine = hills(60), coarse = hills(11);
  const float tight = surface_distance(fine, coarse, 0.01).bound_m;
  const float loose = surface_distance(fine, coarse, 1).bound_m;
  const float sampled = std::max(sampled_distance(fine, coarse, 50000, 1), sampled_distance(coarse, fine, 50000, 2));
  EXPECT_LE(tight, loose);
  EXPECT_LE(sampled, tight);
  EXPECT_LE(tight, sampled * 1.05F);
}

/// A square, and specks of a millimetre a metre above it: nearly everything is as far as anything, and nothing but ever
/// smaller pieces bounds it.
TEST(SurfaceDistance, spends_what_cuts_it_has_where_the_bound_is_largest) {
  Mesh dust;
  for (uint32_t i = 0; i < 1600; ++i) {
    const glm::vec3 at(float(i % 40) * 0.1F + 0.05F, float(i / 40) * 0.1F + 0.05F, 1);
    for (const glm::vec3 corner : {glm::vec3(0), glm::vec3(0.001F, 0, 0), glm::vec3(0, 0.001F, 0)}) {
      dust.indices.push_back(static_cast<uint32_t>(dust.positions.size()));
      dust.positions.push_back(at + corner);
    }
  }
  const Mesh square = flat_grid(1, 4);
  const float sampled = sampled_distance(square, dust, 50000, 3);
  const float bound = surface_distance(square, dust, 0.0001).bound_m;
  EXPECT_GE(bound, sampled);
  EXPECT_LE(bound, sampled * 1.05F);
}

TEST(SurfaceDistance, stops_at_the_tolerance) {
  const SurfaceDistance measured = surface_distance(hills(30), hills(29), 0.0, 3.0);
  EXPECT_GE(measured.bound_m, sampled_distance(hills(30), hills(29), 20000, 1));
  EXPECT_LE(measured.bound_m, 3.01F);
}

TEST(SurfaceDistance, takes_degenerate_triangles_for_the_segments_and_points_that_they_are) {
  Mesh needle;
  needle.positions = {{0, 0, 3}, {1, 0, 3}, {0.5F, 0, 3}, {0, 0, 3}};
  needle.indices = {0, 1, 2, 0, 3, 0};
  const SurfaceDistance measured = surface_distance(needle, flat_grid(1, 1));
  EXPECT_NEAR(measured.bound_m, std::sqrt(10.0F), 0.9F);
  EXPECT_GE(measured.bound_m, std::sqrt(10.0F));
}

TEST(SurfaceDistance, holds_far_from_zero) {
  Mesh near_a = hills(20), near_b = hills(6);
  for (Mesh* mesh : {&near_a, &near_b})
    for (glm::vec3& p : mesh->positions) p += glm::vec3(5000, -9000, 200);
  expect_bound_holds(near_a, near_b, 1.3F);
}

TEST(SurfaceDistance, is_the_same_every_time) {
  const Mesh a = box_city_block(), b = shaken(a, 0.5F);
  const SurfaceDistance once = surface_distance(a, b), again = surface_distance(a, b);
  EXPECT_EQ(once.bound_m, again.bound_m);
  EXPECT_EQ(once.p99_m, again.p99_m);
}

}  // namespace
}  // namespace promenade
