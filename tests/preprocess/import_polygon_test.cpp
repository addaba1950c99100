// Triangulated polygons cover what the polygon covers: areas are compared, for shapes that go wrong easily.

#include "preprocess/import_polygon.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <random>

namespace promenade {
namespace {

using Ring = std::vector<glm::dvec2>;

double ring_area(const Ring& ring) {
  double area = 0;
  for (size_t i = 0; i < ring.size(); ++i) {
    const glm::dvec2& a = ring[i];
    const glm::dvec2& b = ring[(i + 1) % ring.size()];
    area += a.x * b.y - a.y * b.x;
  }
  return area / 2;
}

struct Covered {
  Triangulation result;
  double area = 0;           ///< of the triangles, signed
  double area_unsigned = 0;  ///< the same when none is turned over
};

/// Triangulates rings on a tilted plane far from the origin.
Covered cover(const std::vector<Ring>& rings) {
  const glm::dvec3 u = glm::normalize(glm::dvec3(1, 2, 3));
  const glm::dvec3 v = glm::normalize(glm::cross(glm::dvec3(0.3, -1, 0.2), u));
  const glm::dvec3 normal = glm::cross(u, v);
  std::vector<glm::dvec3> points;
  std::vector<uint32_t> sizes;
  for (const Ring& ring : rings) {
    for (const glm::dvec2& p : ring) points.push_back(glm::dvec3(1000, 2000, 30) + p.x * u + p.y * v);
    sizes.push_back(static_cast<uint32_t>(ring.size()));
  }
  Covered out;
  out.result = triangulate(points, sizes);
  const std::vector<uint32_t>& c = out.result.corners;
  for (size_t i = 0; i + 2 < c.size(); i += 3) {
    const double area =
        glm::dot(glm::cross(points[c[i + 1]] - points[c[i]], points[c[i + 2]] - points[c[i]]), normal) / 2;
    out.area += area;
    out.area_unsigned += std::abs(area);
  }
  return out;
}

void expect_covered(const std::vector<Ring>& rings, const char* what) {
  double wanted = std::abs(ring_area(rings[0]));
  for (size_t r = 1; r < rings.size(); ++r) wanted -= std::abs(ring_area(rings[r]));
  const Covered covered = cover(rings);
  EXPECT_FALSE(covered.result.unclean) << what;
  EXPECT_FALSE(covered.result.non_planar) << what;
  const double sign = ring_area(rings[0]) < 0 ? -1 : 1;
  EXPECT_NEAR(covered.area, sign * wanted, 1e-6 * wanted) << what;
  EXPECT_NEAR(covered.area_unsigned, wanted, 1e-6 * wanted) << what;
}

Ring square(double x, double y, double size) { return {{x, y}, {x + size, y}, {x + size, y + size}, {x, y + size}}; }

Ring reversed(Ring ring) {
  std::reverse(ring.begin(), ring.end());
  return ring;
}

/// A star-shaped ring around a centre, deterministic.
Ring wobbly(double x, double y, double radius, int corners, unsigned seed) {
  std::mt19937 random(seed);
  Ring ring;
  for (int i = 0; i < corners; ++i) {
    const double angle = 2 * std::acos(-1.0) * i / corners;
    const double r = radius * (0.5 + double(random() % 1000) / 2000);
    ring.emplace_back(x + r * std::cos(angle), y + r * std::sin(angle));
  }
  return ring;
}

TEST(ImportPolygon, shapes_that_go_wrong_easily_are_covered_once) {
  expect_covered({square(0, 0, 2)}, "square");
  expect_covered({reversed(square(0, 0, 2))}, "square seen from behind");
  expect_covered({{{0, 0}, {4, 0}, {4, 4}, {2, 1}, {0, 4}}}, "notch");
  expect_covered({{{0, 0}, {1, 0}, {2, 0}, {2, 1}, {2, 2}, {1, 2}, {0, 2}, {0, 1}}}, "corners on straight edges");
  expect_covered({{{0, 0}, {3, 0}, {3, 3}, {2, 3}, {2, 1}, {1, 1}, {1, 3}, {0, 3}}}, "letter U");
  expect_covered({{{0, 0}, {5, 0}, {5, 1}, {1, 1}, {1, 2}, {5, 2}, {5, 3}, {0, 3}}}, "letter E without its middle");
  expect_covered({wobbly(0, 0, 10, 500, 3)}, "five hundred corners");
}

TEST(ImportPolygon, holes_are_left_open) {
  expect_covered({square(0, 0, 10), square(4, 4, 2)}, "courtyard");
  expect_covered({square(0, 0, 10), reversed(square(4, 4, 2))}, "courtyard turned the other way");
  expect_covered({square(0, 0, 10), square(1, 4, 2), square(4, 4, 2), square(7, 4, 2)}, "three in a row");
  expect_covered({square(0, 0, 10), square(1, 1, 2), square(1, 4, 2), square(1, 7, 2)}, "three in a column");
  std::vector<Ring> grid{square(0, 0, 100)};
  for (int y = 0; y < 9; ++y)
    for (int x = 0; x < 9; ++x) grid.push_back(wobbly(10 + 10 * x, 10 + 10 * y, 4, 7, unsigned(9 * y + x)));
  expect_covered(grid, "eighty-one windows");
}

TEST(ImportPolygon, corner_on_a_straight_edge_stays_a_corner) {
  const Covered covered = cover({{{0, 0}, {1, 0}, {2, 0}, {2, 2}, {0, 2}}});
  EXPECT_NE(std::find(covered.result.corners.begin(), covered.result.corners.end(), 1U), covered.result.corners.end());
}

TEST(ImportPolygon, warped_polygon_is_reported_and_covered) {
  const std::vector<glm::dvec3> points{{0, 0, 0}, {1, 0, 0.2}, {1, 1, 0}, {0, 1, 0.2}, {-0.5, 0.5, 0}};
  const std::vector<uint32_t> sizes{5};
  const Triangulation result = triangulate(points, sizes);
  EXPECT_TRUE(result.non_planar);
  EXPECT_EQ(result.corners.size(), 9U);
}

TEST(ImportPolygon, figure_of_eight_and_hole_outside_are_reported) {
  EXPECT_TRUE(cover({{{0, 0}, {2, 2}, {2, 0}, {0, 3}}}).result.unclean);
  EXPECT_TRUE(cover({square(0, 0, 2), square(5, 0, 1)}).result.unclean);
}

TEST(ImportPolygon, polygons_without_area_give_nothing) {
  EXPECT_TRUE(cover({{{0, 0}, {1, 1}, {2, 2}, {3, 3}}}).result.corners.empty());
  EXPECT_TRUE(cover({{{0, 0}, {0, 0}, {0, 0}, {0, 0}}}).result.corners.empty());
  EXPECT_TRUE(triangulate({}, {}).corners.empty());
}

TEST(ImportPolygon, random_rings_end_with_corners_in_range) {
  std::mt19937 random(7);
  for (int round = 0; round < 300; ++round) {
    std::vector<glm::dvec3> points(4 + random() % 40);
    for (glm::dvec3& p : points) p = {double(random() % 6), double(random() % 6), 0};
    const auto first = static_cast<uint32_t>(3 + random() % (points.size() - 3));
    const std::vector<uint32_t> sizes{first, static_cast<uint32_t>(points.size() - first)};
    const Triangulation result = triangulate(points, sizes);
    EXPECT_EQ(result.corners.size() % 3, 0U);
    EXPECT_LE(result.corners.size() / 3, points.size());
    for (const uint32_t c : result.corners) EXPECT_LT(c, points.size());
  }
}

}  // namespace
}  // namespace promenade
