#include "geometry/closest_point.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <initializer_list>

#include "tests/numbers.h"

namespace promenade {
namespace {

using test::Numbers;

/// Small triangles anywhere in a cube of 20 m, some of them long slivers, some flat, some points.
Mesh soup_with_degenerate_triangles(uint32_t triangles, const glm::vec3& center, uint64_t seed) {
  Numbers numbers(seed);
  Mesh mesh;
  for (uint32_t t = 0; t < triangles; ++t) {
    const glm::vec3 a = center + numbers.in_cube(10);
    glm::vec3 b = a + numbers.in_cube(t % 7 == 0 ? 5.0F : 0.5F);
    glm::vec3 c = a + numbers.in_cube(0.5F);
    if (t % 11 == 1) c = a;
    if (t % 11 == 2) c = a + (b - a) * 0.5F;
    if (t % 11 == 3) b = a, c = a;
    if (t % 11 == 4) c = a + (b - a) * 2.0F + glm::vec3(1e-5F, 0, 0);
    mesh.positions.insert(mesh.positions.end(), {a, b, c});
    for (uint32_t i = 0; i < 3; ++i) mesh.indices.push_back(t * 3 + i);
  }
  return mesh;
}

double segment_distance(const glm::dvec3& p, const glm::dvec3& a, const glm::dvec3& b) {
  const double length2 = glm::dot(b - a, b - a);
  const double t = length2 > 0 ? glm::clamp(glm::dot(p - a, b - a) / length2, 0.0, 1.0) : 0.0;
  return glm::length(p - (a + t * (b - a)));
}

/// In double, straight from the definition: the plane's distance over the inside, else the nearest edge's.
double slow_distance(const Mesh& mesh, size_t t, const glm::vec3& point) {
  const glm::dvec3 p(point);
  const glm::dvec3 a(mesh.positions[mesh.indices[3 * t]]), b(mesh.positions[mesh.indices[3 * t + 1]]),
      c(mesh.positions[mesh.indices[3 * t + 2]]);
  const double edges = std::min({segment_distance(p, a, b), segment_distance(p, b, c), segment_distance(p, c, a)});
  const glm::dvec3 n = glm::cross(b - a, c - a);
  const double n2 = glm::dot(n, n);
  if (n2 <= 1e-24) return edges;
  const bool inside = glm::dot(glm::cross(b - a, p - a), n) >= 0 && glm::dot(glm::cross(c - b, p - b), n) >= 0 &&
                      glm::dot(glm::cross(a - c, p - c), n) >= 0;
  return inside ? std::abs(glm::dot(p - a, n)) / std::sqrt(n2) : edges;
}

double slow_distance(const Mesh& mesh, const glm::vec3& p) {
  double least = std::numeric_limits<double>::infinity();
  for (size_t t = 0; t < mesh.triangle_count(); ++t) least = std::min(least, slow_distance(mesh, t, p));
  return least;
}

void expect_exact_distances(const Mesh& mesh, const glm::vec3& center, uint64_t seed) {
  const ClosestPointTree tree(mesh);
  Numbers numbers(seed);
  uint32_t hint = kNoTriangle;
  for (int i = 0; i < 300; ++i) {
    const glm::vec3 p = center + numbers.in_cube(i % 3 == 0 ? 100.0F : 11.0F);
    const double expected = slow_distance(mesh, p);
    const ClosestPoint found = tree.closest(p);
    ASSERT_LT(found.triangle, mesh.triangle_count());
    EXPECT_NEAR(std::sqrt(double(found.distance2_m2)), expected, 2e-6 * (expected + 10));
    EXPECT_NEAR(slow_distance(mesh, found.triangle, p), expected, 2e-6 * (expected + 10));
    const ClosestPointTree::Nearest hinted =
        tree.nearest(p, {.max_distance2_m2 = found.distance2_m2 * 1.01F + 1e-6F, .hint = hint});
    EXPECT_EQ(hinted.distance2_m2, found.distance2_m2);
    hint = found.triangle;

    const glm::vec3 w = found.barycentric;
    EXPECT_GE(std::min({w.x, w.y, w.z}), 0.0F);
    EXPECT_NEAR(w.x + w.y + w.z, 1, 1e-5);
    const glm::vec3 by_weights = w.x * mesh.positions[mesh.indices[size_t(found.triangle) * 3]] +
                                 w.y * mesh.positions[mesh.indices[size_t(found.triangle) * 3 + 1]] +
                                 w.z * mesh.positions[mesh.indices[size_t(found.triangle) * 3 + 2]];
    const float rounding = 1e-6F * (glm::length(p) + 20);
    EXPECT_LT(glm::length(by_weights - found.point), 4 * rounding);
    EXPECT_NEAR(glm::length(found.point - p), std::sqrt(found.distance2_m2), 4 * rounding);
  }
}

TEST(ClosestPointTree, agrees_with_the_definition_on_a_soup_with_degenerate_triangles) {
  for (const uint32_t triangles : {1U, 2U, 15U, 17U, 200U, 1500U})
    expect_exact_distances(soup_with_degenerate_triangles(triangles, glm::vec3(0), triangles), glm::vec3(0), 7);
}

TEST(ClosestPointTree, keeps_its_precision_far_from_zero) {
  const glm::vec3 far(4000, -7000, 300);
  expect_exact_distances(soup_with_degenerate_triangles(300, far, 3), far, 9);
}

TEST(ClosestPointTree, survives_many_triangles_in_one_place) {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  for (int i = 0; i < 5000; ++i) mesh.indices.insert(mesh.indices.end(), {0, 1, 2});
  const ClosestPointTree tree(mesh);
  EXPECT_FLOAT_EQ(tree.nearest({0.2F, 0.2F, 3}).distance2_m2, 9);
  EXPECT_FLOAT_EQ(tree.nearest({-3, -4, 0}).distance2_m2, 25);
}

TEST(ClosestPointTree, finds_nothing_beyond_the_limit) {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.indices = {0, 1, 2};
  const ClosestPointTree tree(mesh);
  const ClosestPointTree::Nearest none = tree.nearest({0.2F, 0.2F, 2}, {.max_distance2_m2 = 3.9F});
  EXPECT_EQ(none.triangle, kNoTriangle);
  EXPECT_EQ(none.distance2_m2, 3.9F);
  EXPECT_EQ(tree.nearest({0.2F, 0.2F, 2}, {.max_distance2_m2 = 4.1F}).triangle, 0U);
  EXPECT_EQ(ClosestPointTree(Mesh{}).closest({1, 2, 3}).triangle, kNoTriangle);
}

TEST(ClosestPointTree, good_enough_is_within_what_was_asked) {
  const Mesh mesh = soup_with_degenerate_triangles(1000, glm::vec3(0), 5);
  const ClosestPointTree tree(mesh);
  Numbers numbers(6);
  for (int i = 0; i < 200; ++i) {
    const glm::vec3 p = numbers.in_cube(10);
    const float nearest = tree.nearest(p).distance2_m2;
    const ClosestPointTree::Nearest enough = tree.nearest(p, {.enough_distance2_m2 = 4});
    EXPECT_LE(enough.distance2_m2, std::max(4.0F, nearest));
    EXPECT_EQ(tree.distance2_to(enough.triangle, p), enough.distance2_m2);
  }
}

TEST(ClosestPointTree, measures_several_points_as_one_by_one) {
  const Mesh mesh = soup_with_degenerate_triangles(100, glm::vec3(0), 4);
  const ClosestPointTree tree(mesh);
  Numbers numbers(8);
  for (const size_t count : std::initializer_list<size_t>{0, 1, 7, 8, 9, 20}) {
    std::vector<glm::vec3> points(count);
    for (glm::vec3& p : points) p = numbers.in_cube(10);
    for (uint32_t t = 0; t < 100; ++t) {
      std::vector<float> distances2_m2(count + 1, -1);
      tree.distances2_to(t, points, distances2_m2.data());
      for (size_t i = 0; i < count; ++i) EXPECT_EQ(distances2_m2[i], tree.distance2_to(t, points[i]));
      EXPECT_EQ(distances2_m2[count], -1);
    }
  }
}

TEST(ClosestPointTree, measures_one_triangle_as_the_search_does) {
  const Mesh mesh = soup_with_degenerate_triangles(100, glm::vec3(0), 2);
  const ClosestPointTree tree(mesh);
  Numbers numbers(1);
  for (uint32_t t = 0; t < 100; ++t) {
    const glm::vec3 p = numbers.in_cube(10);
    EXPECT_NEAR(std::sqrt(double(tree.distance2_to(t, p))), slow_distance(mesh, t, p), 1e-4);
    EXPECT_EQ(tree.closest_on(t, p).triangle, t);
  }
}

}  // namespace
}  // namespace promenade
