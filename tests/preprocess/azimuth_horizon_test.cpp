#include "preprocess/visibility/azimuth_horizon.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "geometry/random.h"
#include "preprocess/visibility/open_parts.h"

namespace promenade {
namespace {

using Polygon = std::vector<glm::vec2>;

const Box nothing;  // clears no wall

double cross(const glm::dvec2& a, const glm::dvec2& b) { return a.x * b.y - a.y * b.x; }

/// Whether the segment from the eye to a point runs below the top where it crosses a side of the polygon.
bool blocked(const glm::dvec3& eye, const glm::dvec3& to, const Polygon& polygon, double top_m) {
  const glm::dvec2 way = glm::dvec2(to) - glm::dvec2(eye);
  for (size_t i = 0; i < polygon.size(); ++i) {
    const glm::dvec2 a = glm::dvec2(polygon[i]) - glm::dvec2(eye);
    const glm::dvec2 along = glm::dvec2(polygon[(i + 1) % polygon.size()]) - glm::dvec2(polygon[i]);
    const double d = cross(way, along);
    if (d == 0) continue;
    const double t = cross(a, along) / d, u = cross(a, way) / d;
    if (t >= 0 && t <= 1 + 1e-9 && u >= -1e-9 && u <= 1 + 1e-9 && eye.z + (to.z - eye.z) * t <= top_m + 1e-6)
      return true;
  }
  return false;
}

bool inside(const Polygon& polygon, const glm::dvec2& p) {
  bool in = false;
  for (size_t i = 0, last = polygon.size() - 1; i < polygon.size(); last = i++) {
    const glm::dvec2 a(polygon[last]), b(polygon[i]);
    if ((a.y > p.y) != (b.y > p.y) && p.x < a.x + (b.x - a.x) * (p.y - a.y) / (b.y - a.y)) in = !in;
  }
  return in;
}

/// A closed outline around a place, its radius jumping from corner to corner: full of teeth.
Polygon jagged(const glm::vec2& middle, double radius_m, uint32_t corners, Random& random) {
  Polygon polygon;
  polygon.reserve(corners);
  for (uint32_t i = 0; i < corners; ++i) {
    const double angle = 2 * std::numbers::pi * i / corners, r = radius_m * (0.6 + 0.4 * random.unit());
    polygon.emplace_back(middle + glm::vec2(glm::dvec2(std::cos(angle), std::sin(angle)) * r));
  }
  return polygon;
}

TEST(AzimuthHorizon, a_wall_with_overhanging_teeth_hides_as_a_straight_one) {
  // Teeth that lean along the wall: seen from the eye the outline runs to and fro.
  Polygon wall = {{40, -40}, {60, -40}, {60, 40}, {40, 40}};
  for (float y = 40; y > -39; y -= 0.5F) {
    wall.emplace_back(40.0F, y - 0.1F);
    wall.emplace_back(39.6F, y + 0.3F);
  }
  AzimuthHorizon horizon;
  horizon.reset({0, 0, 2});
  horizon.add(wall, 10, nothing);
  EXPECT_TRUE(horizon.hides(horizon.view_of({{80, -20, 0}, {90, 20, 12}})));
  EXPECT_FALSE(horizon.hides(horizon.view_of({{80, -20, 0}, {90, 20, 30}}))) << "rises above";
  EXPECT_FALSE(horizon.hides(horizon.view_of({{80, 60, 0}, {90, 100, 12}}))) << "beside";
}

TEST(AzimuthHorizon, hides_only_what_outlines_block) {
  Random random(7);
  const auto in = [&](double low, double high) { return low + (high - low) * random.unit(); };
  uint32_t hidden = 0;
  for (uint32_t round = 0; round < 300; ++round) {
    const glm::vec2 middle(glm::dvec2(in(-30, 30), in(-30, 30)));
    const Polygon polygon = jagged(middle, in(2, 25), 3 + random.below(60), random);
    const double top_m = in(0, 12);
    const glm::dvec3 eye(in(-20, 20), in(-20, 20), in(0, 15));
    AzimuthHorizon horizon;
    horizon.reset(eye);
    horizon.add(polygon, static_cast<float>(top_m), nothing);
    for (uint32_t k = 0; k < 40; ++k) {
      const glm::vec3 low(glm::dvec3(in(-90, 90), in(-90, 90), in(-5, 10)));
      const Box box{low, low + glm::vec3(glm::dvec3(in(0, 8), in(0, 8), in(0, 6)))};
      if (!horizon.hides(horizon.view_of(box))) continue;
      ++hidden;
      for (uint32_t i = 0; i < 20; ++i) {
        const glm::dvec3 to =
            glm::dvec3(box.min) + glm::dvec3(random.unit(), random.unit(), 1) * glm::dvec3(box.size());
        EXPECT_TRUE(blocked(eye, to, polygon, top_m)) << "round " << round << " box " << k;
      }
    }
  }
  EXPECT_GT(hidden, 1000U) << "else the test says little";
}

TEST(AzimuthHorizon, hides_what_is_asked_for_as_if_everything_were) {
  Random random(11);
  const auto in = [&](double low, double high) { return low + (high - low) * random.unit(); };
  uint32_t hidden = 0, seen = 0;
  for (uint32_t round = 0; round < 400; ++round) {
    const glm::dvec3 eye(in(-5, 5), in(-5, 5), in(0, 12));
    AzimuthHorizon all, some;
    all.reset(eye), some.reset(eye);
    some.want_none();
    std::vector<Box> boxes;
    for (uint32_t k = 0, count = 1 + random.below(6); k < count; ++k) {  // few: a narrow sector; more: all around
      const glm::vec3 low(glm::dvec3(in(-90, 90), in(-90, 90), in(-5, 6)));
      boxes.push_back({low, low + glm::vec3(glm::dvec3(in(0, 8), in(0, 8), in(0, 6)))});
      some.want(some.view_of(boxes.back()));
    }
    some.wants_complete();
    for (uint32_t k = 0; k < 3; ++k) {  // so few that no wall is ever forgotten
      const glm::vec2 middle(glm::dvec2(in(-30, 30), in(-30, 30)));
      const Polygon polygon = jagged(middle, in(5, 25), 3 + random.below(6), random);
      const auto top_m = static_cast<float>(in(0, 12));
      all.add(polygon, top_m, nothing), some.add(polygon, top_m, nothing);
    }
    for (const Box& box : boxes) {
      const bool hides = all.hides(all.view_of(box));
      EXPECT_EQ(some.hides(some.view_of(box)), hides) << "round " << round;
      ++(hides ? hidden : seen);
    }
  }
  EXPECT_GT(std::min(hidden, seen), 200U) << "else the test says little";
}

/// One occluder with one loop, which serves at every erosion up to half a metre.
OccluderSet set_of(const Polygon& polygon, float base_m, float top_m) {
  OccluderSet set;
  Occluder occluder;
  OccluderLoop loop{top_m, base_m, 0, static_cast<uint32_t>(polygon.size()), false, {}, {}};
  Box bounds;
  for (const glm::vec2& p : polygon) bounds.add({p, top_m});
  loop.low = glm::vec2(bounds.min), loop.high = glm::vec2(bounds.max);
  occluder.box = bounds, occluder.base_m = base_m;
  set.loops.push_back(loop), set.points.append(polygon);
  occluder.loops_end.fill(1);
  set.occluders = {occluder};
  return set;
}

TEST(OpenParts, of_a_cell_between_houses_are_the_street) {
  const float ground_m = -1;
  const OccluderSet set = set_of({{-5, 3}, {15, 3}, {15, 20}, {-5, 20}}, ground_m, 12);
  const Box cell{{0, 0, 0}, {10, 10, 8}};
  const std::vector<UsableOccluder> usable = {{&set.occluders[0], 0, 0}};
  const std::vector<Box> parts = open_parts(cell, set, usable);
  ASSERT_EQ(parts.size(), 1U);
  EXPECT_EQ(parts[0].min, cell.min);
  EXPECT_EQ(parts[0].max.x, cell.max.x);
  EXPECT_EQ(parts[0].max.z, cell.max.z);
  EXPECT_GE(parts[0].max.y, 3);
  EXPECT_LT(parts[0].max.y, 3.01F) << "a cell that reaches into a wall cannot be hidden from by it";
  EXPECT_EQ(open_parts({cell.min, {10, 10, 13}}, set, usable).front().max.y, 10) << "one looks out over the roof";
  EXPECT_EQ(open_parts({{0, 0, -2}, cell.max}, set, usable).front().max.y, 10) << "one looks out below";
  EXPECT_EQ(open_parts({cell.min, {10, 10, 11}}, set, {{&set.occluders[0], 1.5F, 0}}).front().max.y, 10)
      << "what is drawn for it may be lower";
}

TEST(OpenParts, leave_out_only_what_lies_in_an_occluder) {
  Random random(3);
  const Box cell{{-8, -6, 0}, {8, 6, 5}};
  uint32_t left_out = 0;
  for (uint32_t round = 0; round < 200; ++round) {
    const Polygon polygon = jagged(glm::vec2(glm::dvec2(random.unit(), random.unit()) * 20.0 - 10.0),
                                   2 + 12 * random.unit(), 3 + random.below(40), random);
    const OccluderSet set = set_of(polygon, -1, 9);
    const std::vector<Box> parts = open_parts(cell, set, {{&set.occluders[0], 0, 0}});
    ASSERT_FALSE(parts.empty());
    for (uint32_t i = 0; i < 500; ++i) {
      const glm::dvec3 p =
          glm::dvec3(cell.min) + glm::dvec3(random.unit(), random.unit(), random.unit()) * glm::dvec3(cell.size());
      const bool open =
          std::any_of(parts.begin(), parts.end(), [&](const Box& box) { return box.contains(glm::vec3(p)); });
      left_out += open ? 0U : 1U;
      EXPECT_TRUE(open || inside(polygon, glm::dvec2(p))) << "round " << round;
    }
  }
  EXPECT_GT(left_out, 5000U) << "else the test says little";
}

}  // namespace
}  // namespace promenade
