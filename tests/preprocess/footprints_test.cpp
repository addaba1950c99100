// What the solids of a source fill, and plans of polygons.

#include "preprocess/footprints.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <glm/ext/matrix_transform.hpp>

#include "preprocess/plan_polygons.h"
#include "preprocess/visibility/occluders.h"
#include "tests/preprocess/situations.h"

namespace promenade {
namespace {

using testing::ElementsAre;
using testing::FloatNear;

Footprints footprints_in(const Mesh& mesh) {
  std::vector<Material> materials(2);
  materials[kGlassPane].alpha = AlphaMode::blend;
  return footprints_of(mesh, materials);
}

double area_of(const Footprints& footprints, size_t number) {
  PlanLoops loops;
  for (uint32_t l = footprints.first_loop(number); l < footprints.all[number].loops_end; ++l) {
    const auto points = footprints.loop(l);
    loops.emplace_back(points.begin(), points.end());
  }
  return area_m2(loops);
}

std::vector<float> tops_of(const Footprints& footprints) {
  std::vector<float> tops;
  for (const Footprint& f : footprints.all) tops.push_back(f.top_m);
  return tops;
}

/// An outline drawn up from z0 to z1, closed above and below.
Mesh prism(const std::vector<glm::vec2>& outline, float z0, float z1, uint32_t material = kStone) {
  Mesh mesh;
  const size_t n = outline.size();
  for (size_t i = 0; i < n; ++i) {
    const glm::vec2 a = outline[i], b = outline[(i + 1) % n];
    test::add_quad(mesh, {a, z0}, {b, z0}, {b, z1}, {a, z1}, {255, 255, 255, 255});
    // Fans from the first corner: their triangles may overlap, but their edges cancel all the same.
    if (i == 0 || i + 1 == n) continue;
    const auto v = static_cast<uint32_t>(mesh.positions.size());
    for (const float z : {z0, z1})
      for (const glm::vec2& p : {outline[0], a, b}) mesh.positions.emplace_back(p, z);
    mesh.indices.insert(mesh.indices.end(), {v, v + 2, v + 1, v + 3, v + 4, v + 5});
  }
  return of_material(std::move(mesh), material);
}

/// A tower on a podium, one closed surface.
Mesh stepped_tower() {
  const std::array<glm::vec2, 4> outer = {{{0, 0}, {20, 0}, {20, 20}, {0, 20}}},
                                 inner = {{{5, 5}, {15, 5}, {15, 15}, {5, 15}}};
  Mesh mesh = sheet({outer[3], 0}, {outer[2], 0}, {outer[1], 0}, {outer[0], 0});
  append(mesh, sheet({inner[0], 40}, {inner[1], 40}, {inner[2], 40}, {inner[3], 40}));
  for (size_t i = 0; i < 4; ++i) {
    const size_t next = (i + 1) % 4;
    append(mesh, sheet({outer[i], 0}, {outer[next], 0}, {outer[next], 6}, {outer[i], 6}));
    append(mesh, sheet({outer[i], 6}, {outer[next], 6}, {inner[next], 6}, {inner[i], 6}));
    append(mesh, sheet({inner[i], 6}, {inner[next], 6}, {inner[next], 40}, {inner[i], 40}));
  }
  return mesh;
}

TEST(Footprints, a_box_is_one_two_millimetres_within_its_walls) {
  const Footprints found = footprints_in(block({0, 0, 0}, {10, 8, 7}));
  ASSERT_EQ(found.all.size(), 1U);
  EXPECT_NEAR(area_of(found, 0), 9.996 * 7.996, 0.01);
  EXPECT_NEAR(found.all[0].base_m, 0.002, 0.001);
  EXPECT_NEAR(found.all[0].top_m, 7 - 0.002, 0.001);
  EXPECT_EQ(found.defect(), "");
}

TEST(Footprints, an_l_is_itself_and_a_yard_is_a_hole) {
  const Footprints l = footprints_in(prism({{0, 0}, {20, 0}, {20, 5}, {5, 5}, {5, 20}, {0, 20}}, -1, 9));
  ASSERT_EQ(l.all.size(), 1U);
  EXPECT_NEAR(area_of(l, 0), 175, 0.5);
  Mesh yard = prism({{5, 5}, {15, 5}, {15, 15}, {5, 15}}, 0, 9);
  for (size_t t = 0; t < yard.triangle_count(); ++t) std::swap(yard.indices[3 * t], yard.indices[3 * t + 1]);
  const Footprints around = footprints_in(together(block({0, 0, 0}, {20, 20, 9}), yard));
  ASSERT_EQ(around.all.size(), 1U);
  EXPECT_EQ(around.loop_ends.size(), 2U);
  EXPECT_NEAR(area_of(around, 0), 300, 0.5);
}

TEST(Footprints, a_tower_has_one_for_each_step) {
  const Footprints found = footprints_in(stepped_tower());
  EXPECT_THAT(tops_of(found), ElementsAre(FloatNear(6, 0.01F), FloatNear(40, 0.01F)));
  EXPECT_NEAR(area_of(found, 0), 400, 0.5);
  EXPECT_NEAR(area_of(found, 1), 100, 0.5);
  EXPECT_EQ(found.all[1].base_m, found.all[0].base_m) << "all the way up from the ground";
}

TEST(Footprints, solids_wall_to_wall_are_one) {
  const Footprints found = footprints_in(together(block({0, 0, 0}, {10, 8, 7}), block({10, 0, 0}, {16, 8, 7})));
  ASSERT_EQ(found.all.size(), 1U);
  EXPECT_NEAR(area_of(found, 0), 128, 0.2);
}

TEST(Footprints, a_pitched_roof_counts_up_to_its_eaves_and_an_overhang_from_where_it_stands) {
  Mesh house = block({0, 0, 0}, {10, 10, 6});
  for (glm::vec3& p : house.positions)
    if (p.z > 5 && p.y > 5) p.z = 9;
  EXPECT_THAT(tops_of(footprints_in(house)), ElementsAre(FloatNear(6, 0.01F)));
  const Footprints mushroom = footprints_in(together(block({4, 4, 0}, {6, 6, 3}), block({0, 0, 3}, {10, 10, 8})));
  ASSERT_EQ(mushroom.all.size(), 1U) << "what stands free is not solid from the ground up";
  EXPECT_NEAR(area_of(mushroom, 0), 4, 0.1);
}

TEST(Footprints, what_is_open_transparent_or_inside_out_has_none) {
  const Mesh whole = block({0, 0, 0}, {10, 10, 7});
  ASSERT_FALSE(footprints_in(whole).empty());
  for (size_t without = 0; without < whole.triangle_count(); ++without) {
    std::vector<uint32_t> kept;
    for (uint32_t t = 0; t < whole.triangle_count(); ++t)
      if (t != without) kept.push_back(t);
    EXPECT_TRUE(footprints_in(submesh(whole, kept)).empty()) << without;
    Mesh glazed = whole;
    glazed.materials[without] = kGlassPane;
    EXPECT_TRUE(footprints_in(glazed).empty()) << without;
  }
  Mesh inside_out = whole;
  for (size_t t = 0; t < whole.triangle_count(); ++t)
    std::swap(inside_out.indices[3 * t], inside_out.indices[3 * t + 1]);
  EXPECT_TRUE(footprints_in(inside_out).empty());
  EXPECT_TRUE(footprints_in(block({0, 0, 0}, {10, 10, 1})).empty()) << "too low to hide anything";
  EXPECT_TRUE(footprints_in({}).empty());
}

TEST(Footprints, they_go_where_their_mesh_goes_while_they_stand_upright) {
  const Footprints found = footprints_in(block({0, 0, 0}, {10, 8, 7}));
  const glm::dmat4 turned =
      glm::rotate(glm::translate(glm::dmat4(1), glm::dvec3(100, 50, 3)), 0.5, glm::dvec3(0, 0, 1));
  const auto there = placed(found, turned);
  ASSERT_TRUE(there.has_value());
  EXPECT_NEAR(there->all[0].top_m, 10 - 0.002, 0.001);
  EXPECT_NEAR(area_of(*there, 0), area_of(found, 0), 0.001);
  EXPECT_FALSE(placed(found, glm::rotate(glm::dmat4(1), 0.1, glm::dvec3(1, 0, 0))).has_value());
  EXPECT_FALSE(placed(found, glm::scale(glm::dmat4(1), glm::dvec3(-1, 1, 1))).has_value());
}

TEST(Footprints, defects_of_untrusted_ones_are_told) {
  const Footprints sound = footprints_in(stepped_tower());
  EXPECT_EQ(sound.defect(), "");
  const auto refused = [&](auto&& spoil) {
    Footprints spoilt = sound;
    spoil(spoilt);
    return !spoilt.defect().empty();
  };
  EXPECT_TRUE(refused([](Footprints& f) { f.all[0].top_m = -5; }));
  EXPECT_TRUE(refused([](Footprints& f) { f.all[0].top_m = std::nanf(""); }));
  EXPECT_TRUE(refused([](Footprints& f) { f.all[1].loops_end = 7; }));
  EXPECT_TRUE(refused([](Footprints& f) { f.all[1].loops_end = 1; }));
  EXPECT_TRUE(refused([](Footprints& f) { f.loop_ends[0] = 2; }));
  EXPECT_TRUE(refused([](Footprints& f) { f.loop_ends[1] = 99; }));
  EXPECT_TRUE(refused([](Footprints& f) { f.points.pop_back(); }));
  EXPECT_TRUE(refused([](Footprints& f) { f.points[0].x = std::nanf(""); }));
}

TEST(PlanPolygons, shrunk_ones_keep_away_from_every_border_and_more_of_corners_that_point_in) {
  const PlanLoops l = united({{{0, 0}, {20, 0}, {20, 5}, {5, 5}, {5, 20}, {0, 20}}});
  const PlanLoops less = shrunk(l, 1);
  ASSERT_EQ(less.size(), 1U);
  EXPECT_NEAR(area_m2(less), 18 * 3 + 3 * 15, 0.01);
  EXPECT_TRUE(shrunk(l, 2.6).empty());
  EXPECT_NEAR(area_m2(shrunk(shrunk(l, -0.5), 0.5)), area_m2(l), 0.01);
  const PlanLoops two = united({{{0, 0}, {1, 0}, {1, 1}, {0, 1}}, {{3, 0}, {4, 0}, {4, 1}, {3, 1}}});
  EXPECT_EQ(taken_apart(two).size(), 2U);
  EXPECT_TRUE(contains(two, {3.5, 0.5}));
  EXPECT_FALSE(contains(two, {2, 0.5}));
}

/// The largest occluder's loop at the least erosion that contains a point, as a box.
Box loop_around(const OccluderSet& set, const glm::vec2& point) {
  for (const Occluder& occluder : set.occluders)
    for (const OccluderLoop& loop : set.loops_of(occluder, 0))
      if (!loop.is_hole && loop.low.x < point.x && loop.high.x > point.x && loop.low.y < point.y &&
          loop.high.y > point.y)
        return {glm::vec3(loop.low, loop.base_m), glm::vec3(loop.high, loop.top_m)};
  return {};
}

TEST(Footprints, occluders_of_a_row_of_houses_end_at_their_walls) {
  const Objects row = {{"ground", flat_ground()},
                       {"left", block({-10.05F, -5.07F, -0.2F}, {0, 5.07F, 9})},
                       {"right", block({0, -5.07F, -0.2F}, {10.05F, 5.07F, 9})}};
  const SituationModel guessed(row), told(row, Tell::footprints);
  JobMonitor monitor;
  const auto box_in = [&](const SituationModel& model) {
    const Result<OccluderSet> set = extract_occluders(model.reader(), {}, monitor);
    EXPECT_TRUE(set.ok());
    return loop_around(*set, {0.01F, 0});
  };
  const Box exact = box_in(told), about = box_in(guessed);
  EXPECT_NEAR(exact.min.x, -10.05, 0.012) << "one occluder, wall to wall";
  EXPECT_NEAR(exact.max.x, 10.05, 0.012);
  EXPECT_NEAR(exact.max.y, 5.07, 0.012);
  EXPECT_LE(exact.max.y, 5.07 - 0.005);
  EXPECT_LT(about.max.y, exact.max.y - 0.03F) << "columns know it less well";
  EXPECT_LT(exact.min.z, -1000) << "solid all the way down";
}

TEST(Footprints, one_that_floats_above_the_ground_does_not_stand_for_its_columns) {
  const Objects floating = {{"ground", flat_ground()}, {"house", block({-10, -5, 1}, {10, 5, 9})}};
  JobMonitor monitor;
  const SituationModel told(floating, Tell::footprints);
  const Result<OccluderSet> set = extract_occluders(told.reader(), {}, monitor);
  ASSERT_TRUE(set.ok());
  EXPECT_GT(loop_around(*set, {0.01F, 0}).min.z, 0.9F) << "or there is none";
}

}  // namespace
}  // namespace promenade
