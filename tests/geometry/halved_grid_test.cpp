#include "geometry/halved_grid.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <set>
#include <vector>

#include "geometry/random.h"

namespace promenade {
namespace {

struct Triangle {
  uint32_t a, b, c;
};

std::vector<Triangle> triangles_of(const HalvedGrid& grid, const std::vector<uint8_t>& kept) {
  std::vector<Triangle> triangles;
  for_each_triangle(grid, kept, [&](uint32_t a, uint32_t b, uint32_t c) { triangles.push_back({a, b, c}); });
  return triangles;
}

/// Twice the area, in squares of the grid; positive: clockwise with rows going down.
int64_t doubled_area(const HalvedGrid& grid, const Triangle& t) {
  const auto x = [&](uint32_t i) { return int64_t(i % grid.side()); };
  const auto y = [&](uint32_t i) { return int64_t(i / grid.side()); };
  return (x(t.b) - x(t.a)) * (y(t.c) - y(t.a)) - (y(t.b) - y(t.a)) * (x(t.c) - x(t.a));
}

/// Triangles cover the grid once, all turned alike, and no corner lies within another's edge.
void expect_tiling(const HalvedGrid& grid, const std::vector<uint8_t>& kept) {
  const std::vector<Triangle> triangles = triangles_of(grid, kept);
  int64_t area = 0;
  std::map<std::pair<uint32_t, uint32_t>, int> edges;
  for (const Triangle& t : triangles) {
    EXPECT_GT(doubled_area(grid, t), 0);
    area += doubled_area(grid, t);
    for (const auto& [from, to] : {std::pair(t.a, t.b), std::pair(t.b, t.c), std::pair(t.c, t.a)}) ++edges[{from, to}];
  }
  EXPECT_EQ(area, 2 * int64_t(grid.cells()) * grid.cells());
  const auto on_border = [&](uint32_t a, uint32_t b) {
    const uint32_t n = grid.cells(), ax = a % grid.side(), ay = a / grid.side(), bx = b % grid.side(),
                   by = b / grid.side();
    return (ax == bx && (ax == 0 || ax == n)) || (ay == by && (ay == 0 || ay == n));
  };
  for (const auto& [edge, count] : edges) {
    EXPECT_EQ(count, 1);
    if (!on_border(edge.first, edge.second)) {
      EXPECT_TRUE(edges.contains({edge.second, edge.first}));
    }
  }
}

TEST(HalvedGrid, points_are_each_vertex_but_the_corners_once_after_those_that_need_them) {
  for (const bool coarsest_first : {false, true}) {
    const HalvedGrid grid{4};
    std::set<uint32_t> seen;
    for_each_halving_point(grid, coarsest_first, [&](const HalvingPoint& p) {
      EXPECT_TRUE(seen.insert(p.at).second);
      for (const uint32_t apex : p.apexes)
        EXPECT_EQ(seen.contains(apex),
                  coarsest_first && !((apex % grid.side() == 0 || apex % grid.side() == grid.cells()) &&
                                      (apex / grid.side() == 0 || apex / grid.side() == grid.cells())));
      EXPECT_EQ(p.ends[0] + p.ends[1], 2 * p.at);
    });
    EXPECT_EQ(seen.size(), grid.vertices() - 4);
  }
}

TEST(HalvedGrid, of_random_vertices_tiles_without_cracks_once_closed) {
  Random random(5);
  for (int round = 0; round < 20; ++round) {
    const HalvedGrid grid{5};
    std::vector<uint8_t> kept(grid.vertices(), 0);
    for (int i = 0; i < round * 3; ++i) kept[random.below(static_cast<uint32_t>(grid.vertices()))] = 1;
    close_halvings(grid, kept);
    EXPECT_FALSE(close_halvings(grid, kept)) << "closed means closed";
    expect_tiling(grid, kept);
  }
}

TEST(HalvedGrid, of_one_square_is_two_triangles) {
  const HalvedGrid grid{0};
  const std::vector<uint8_t> kept(4, 1);
  EXPECT_EQ(triangles_of(grid, kept).size(), 2U);
  expect_tiling(grid, kept);
}

/// Values of the triangles at all vertices.
std::vector<float> drawn(const HalvedGrid& grid, const std::vector<uint8_t>& kept, const std::vector<float>& value) {
  std::vector<float> out(grid.vertices());
  const auto x = [&](uint32_t i) { return float(i % grid.side()); };
  const auto y = [&](uint32_t i) { return float(i / grid.side()); };
  for (const Triangle& t : triangles_of(grid, kept)) {
    const auto area = float(doubled_area(grid, t));
    for (uint32_t i = 0; i < grid.vertices(); ++i) {
      const auto part = [&](uint32_t p, uint32_t q) {
        return ((x(q) - x(p)) * (y(i) - y(p)) - (y(q) - y(p)) * (x(i) - x(p))) / area;
      };
      const float a = part(t.b, t.c), b = part(t.c, t.a), c = part(t.a, t.b);
      if (a >= 0 && b >= 0 && c >= 0) out[i] = a * value[t.a] + b * value[t.b] + c * value[t.c];
    }
  }
  return out;
}

TEST(HalvedGrid, refined_keeps_the_bounds_everywhere_and_planes_whole) {
  const HalvedGrid grid{5};
  std::vector<float> plane(grid.vertices()), step(grid.vertices()), low(grid.vertices()), high(grid.vertices());
  for (uint32_t i = 0; i < grid.vertices(); ++i) {
    const auto x = float(i % grid.side()), y = float(i / grid.side());
    plane[i] = 3 + 0.25F * x - 0.5F * y;
    step[i] = 0.7F * x + 0.4F * y > 13 ? 5.0F : std::sin(x * 0.3F);
  }
  const float tolerance = 0.1F;
  for (const std::vector<float>* value : {&plane, &step}) {
    for (uint32_t i = 0; i < grid.vertices(); ++i) low[i] = (*value)[i] - tolerance, high[i] = (*value)[i] + tolerance;
    std::vector<uint8_t> kept(grid.vertices(), 0);
    refine_halvings(grid, *value, low, high, kept);
    expect_tiling(grid, kept);
    const std::vector<float> got = drawn(grid, kept, *value);
    for (uint32_t i = 0; i < grid.vertices(); ++i) EXPECT_NEAR(got[i], (*value)[i], tolerance * 1.001F);
    const size_t count = triangles_of(grid, kept).size();
    if (value == &plane)
      EXPECT_EQ(count, 2U);
    else
      EXPECT_LT(count, 2 * size_t(grid.cells()) * grid.cells()) << "not everything is halved";
  }
}

}  // namespace
}  // namespace promenade
