// Who sees whom: small worlds with known answers, and what no hider may ever do.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <tbb/task_arena.h>

#include "preprocess/visibility/hider_trial.h"
#include "preprocess/visibility/hiders/backface.h"
#include "preprocess/visibility/hiders/horizon.h"
#include "preprocess/visibility/node_parts.h"
#include "preprocess/visibility/occluders.h"
#include "tests/preprocess/who_sees_whom.h"

namespace promenade {
namespace {

using testing::HasSubstr;

const Box middle_cell{{-2, -2, 0.5F}, {2, 2, 2.5F}};  // in the middle, on the ground

/// A wall from ground up that is solid.
Mesh wall(float x0, float y0, float x1, float y1, float top = 10, float bottom = -0.5F) {
  return block({x0, y0, bottom}, {x1, y1, top});
}

/// A shell without a bottom that reaches a little below the ground, as buildings do.
Mesh shell(const glm::vec3& low, const glm::vec3& high) {
  Mesh mesh;
  const glm::vec3 a(low.x, low.y, low.z), b(high.x, low.y, low.z), c(high.x, high.y, low.z), d(low.x, high.y, low.z);
  const auto up = [&](const glm::vec3& p) { return glm::vec3(p.x, p.y, high.z); };
  for (const auto& [p, q] : {std::pair(a, b), {b, c}, {c, d}, {d, a}})
    test::add_quad(mesh, p, q, up(q), up(p), {255, 255, 255, 255});
  test::add_quad(mesh, up(a), up(b), up(c), up(d), {255, 255, 255, 255});
  return of_material(std::move(mesh), kStone);
}

/// So thick on all sides, without a bottom.
Mesh house_around_a_yard(const glm::vec2& low, const glm::vec2& high, float thick_m) {
  constexpr float kBottom = -0.5F, kTop = 10;
  Mesh mesh;
  const auto corners = [](const glm::vec2& a, const glm::vec2& b) {
    return std::array<glm::vec2, 4>{a, glm::vec2(b.x, a.y), b, glm::vec2(a.x, b.y)};
  };
  const auto outer = corners(low, high), inner = corners(low + thick_m, high - thick_m);
  const auto at = [](const glm::vec2& p, float z) { return glm::vec3(p, z); };
  const auto add = [&](const glm::vec3& a, const glm::vec3& b, const glm::vec3& c, const glm::vec3& d) {
    test::add_quad(mesh, a, b, c, d, {255, 255, 255, 255});
  };
  for (size_t i = 0, k = 1; i < 4; ++i, k = (k + 1) % 4) {
    add(at(outer[i], kBottom), at(outer[k], kBottom), at(outer[k], kTop), at(outer[i], kTop));
    add(at(inner[k], kBottom), at(inner[i], kBottom), at(inner[i], kTop), at(inner[k], kTop));
    add(at(outer[i], kTop), at(outer[k], kTop), at(inner[k], kTop), at(inner[i], kTop));
  }
  return of_material(std::move(mesh), kStone);
}

std::vector<Situation> situations() {
  const auto ground = std::pair<std::string, Mesh>("ground", flat_ground());
  std::vector<Situation> all;
  all.push_back({"open_field", {ground, {"thing", thing_at(20, 0)}}, middle_cell, {}, {"ground", "thing"}});
  all.push_back({"thing_behind_house",
                 {ground, {"house", wall(10, -10, 20, 10)}, {"thing", thing_at(30, 0)}},
                 middle_cell,
                 {"thing"},
                 {"ground", "house"}});
  all.push_back({"cell_that_reaches_into_a_house",
                 {ground, {"house", wall(4, -30, 6, 30)}, {"thing", thing_at(20, 0)}, {"before", thing_at(-20, 0)}},
                 {{-2, -2, 0.5F}, {5.5F, 2, 2.5F}},
                 {"thing"},
                 {"ground", "house", "before"}});
  all.push_back({"cell_with_a_house_across_it",
                 {ground, {"house", wall(4, -30, 6, 30)}, {"thing", thing_at(20, 0)}, {"before", thing_at(-20, 0)}},
                 {{-2, -2, 0.5F}, {8, 2, 2.5F}},
                 {},
                 {"ground", "house", "thing", "before"}});
  all.push_back({"cell_that_reaches_through_a_house_into_its_yard",
                 {ground,
                  {"house", house_around_a_yard({10, -20}, {50, 20}, 9)},
                  {"tower", wall(25, -6.4F, 27, -1.2F)},
                  {"in_the_yard", thing_at(38, -6)},
                  {"behind_it_all", thing_at(80, 0)}},
                 {{4, -3, 0.5F}, {24, 3, 2.5F}},
                 {"behind_it_all"},
                 {"house", "in_the_yard"}});
  all.push_back(
      {"tower_behind_wall",
       {ground, {"wall", wall(10, -15, 14, 15, 6)}, {"tower", wall(28, -3, 34, 3, 40)}, {"hut", wall(28, 6, 30, 8, 3)}},
       middle_cell,
       {"hut"},
       {"tower"}});
  all.push_back({"thing_beside_house",
                 {ground, {"house", wall(10, -10, 20, 10)}, {"thing", thing_at(30, 26)}},
                 middle_cell,
                 {},
                 {"thing"}});
  all.push_back({"street_with_side_alley",
                 {ground,
                  {"left", wall(8, -30, 20, -1.5F)},
                  {"right", wall(8, 1.5F, 20, 30)},
                  {"in_sight", thing_at(40, 0)},
                  {"round_the_corner", thing_at(40, -30)}},
                 middle_cell,
                 {"round_the_corner"},
                 {"in_sight"}});
  all.push_back(
      {"window_slit",
       {ground, {"left", wall(8, -30, 20, -0.4F)}, {"right", wall(8, 0.4F, 20, 30)}, {"in_sight", thing_at(40, 0)}},
       middle_cell,
       {},
       {"in_sight"}});
  all.push_back({"two_houses_wall_to_wall_leave_a_slit_in_doubt",
                 {ground, {"left", wall(8, -30, 20, 0)}, {"right", wall(8, 0, 20, 30)}, {"thing", thing_at(40, 0)}},
                 middle_cell,
                 {},
                 {"thing"}});
  all.push_back({"two_houses_together_hide_what_neither_does",
                 {ground, {"near", wall(8, -14, 12, 1)}, {"far", wall(16, -1, 22, 20)}, {"thing", thing_at(45, 0)}},
                 middle_cell,
                 {"thing"},
                 {}});
  all.push_back({"house_on_legs",
                 {ground, {"house", wall(10, -10, 20, 10, 10, 2)}, {"thing", thing_at(30, 0)}},
                 middle_cell,
                 {},
                 {"thing"}});
  all.push_back({"gap_of_ten_centimetres_under_a_wall",
                 {ground, {"house", wall(10, -10, 20, 10, 10, 0.1F)}, {"thing", thing_at(30, 0)}},
                 middle_cell,
                 {},
                 {"thing"}});
  all.push_back({"house_stands_on_the_ground_exactly",
                 {ground, {"house", wall(10, -10, 20, 10, 10, 0)}, {"thing", thing_at(30, 0)}},
                 middle_cell,
                 {"thing"},
                 {}});
  all.push_back({"shell_without_a_bottom",
                 {ground, {"house", shell({10, -10, -0.3F}, {20, 10, 10})}, {"thing", thing_at(30, 0)}},
                 middle_cell,
                 {"thing"},
                 {"house"}});
  all.push_back({"shell_that_hovers",
                 {ground, {"house", shell({10, -10, 0.05F}, {20, 10, 10})}, {"thing", thing_at(30, 0)}},
                 middle_cell,
                 {},
                 {"thing"}});
  all.push_back(
      {"one_sided_sheet",
       {ground, {"sheet", sheet({10, 10, 0}, {10, -10, 0}, {10, -10, 10}, {10, 10, 10})}, {"thing", thing_at(30, 0)}},
       middle_cell,
       {},
       {"thing"}});
  all.push_back({"glass_house",
                 {ground, {"house", block({10, -10, -0.5F}, {20, 10, 10}, kGlassPane)}, {"thing", thing_at(30, 0)}},
                 middle_cell,
                 {},
                 {"thing"}});
  all.push_back({"hedge",
                 {ground, {"hedge", block({10, -10, -0.5F}, {20, 10, 10}, kLeaves)}, {"thing", thing_at(30, 0)}},
                 middle_cell,
                 {},
                 {"thing"}});
  all.push_back({"glass_front_of_a_solid_house",
                 {ground,
                  {"pane", block({9, -12, -0.5F}, {9.2F, 12, 12}, kGlassPane)},
                  {"house", wall(10, -10, 20, 10)},
                  {"thing", thing_at(30, 0)}},
                 middle_cell,
                 {"thing"},
                 {"pane", "house"}});
  all.push_back({"turned_house",
                 {ground, {"house", turned_block({15, 0}, {9, 9}, -0.5F, 10, 0.6F)}, {"thing", thing_at(40, 0)}},
                 middle_cell,
                 {"thing"},
                 {}});
  all.push_back(
      {"canopy_is_no_house",
       {ground, {"roof", sheet({10, -10, 3}, {20, -10, 3}, {20, 10, 3}, {10, 10, 3})}, {"thing", thing_at(30, 0)}},
       middle_cell,
       {},
       {"thing"}});
  all.push_back({"house_with_an_open_side",
                 {ground,
                  {"house", together(sheet({10, -10, 10}, {20, -10, 10}, {20, 10, 10}, {10, 10, 10}),
                                     sheet({20, -10, 0}, {20, 10, 0}, {20, 10, 10}, {20, -10, 10}))},
                  {"thing", thing_at(30, 0)}},
                 middle_cell,
                 {},
                 {"thing"}});
  all.push_back({"over_the_roof_from_the_air",
                 {ground, {"house", wall(10, -10, 20, 10)}, {"thing", thing_at(40, 0)}},
                 {{-2, -2, 30}, {2, 2, 34}},
                 {},
                 {"thing"}});
  all.push_back({"behind_the_house_from_the_air",
                 {ground, {"house", wall(10, -10, 20, 10)}, {"thing", thing_at(21.5F, 0)}},
                 {{-2, -2, 14}, {2, 2, 17}},
                 {"thing"},
                 {}});
  all.push_back({"house_around_the_cell",
                 {ground,
                  {"north", wall(-20, 10, 20, 14)},
                  {"south", wall(-20, -14, 20, -10)},
                  {"east", wall(16, -12, 20, 12)},
                  {"west", wall(-20, -12, -16, 12)},
                  {"thing", thing_at(40, 5)},
                  {"inside", thing_at(5, 5)}},
                 middle_cell,
                 {"thing"},
                 {"inside", "north", "south", "east", "west"}});
  all.push_back({"thing_on_the_roof_near_the_edge",
                 {ground, {"house", wall(10, -10, 30, 10, 5)}, {"thing", thing_at(11, 0, 5)}},
                 middle_cell,
                 {},
                 {"thing"}});
  all.push_back({"thing_on_the_roof_far_back",
                 {ground, {"house", wall(8, -20, 50, 20, 12)}, {"thing", thing_at(45, 0, 12)}},
                 middle_cell,
                 {"thing"},
                 {}});
  all.push_back(
      {"step_in_the_ground",
       {{"ground", together(sheet({-60, -60, 0}, {5, -60, 0}, {5, 60, 0}, {-60, 60, 0}),
                            together(sheet({5, -60, 0.15F}, {60, -60, 0.15F}, {60, 60, 0.15F}, {5, 60, 0.15F}),
                                     sheet({5, 60, 0}, {5, -60, 0}, {5, -60, 0.15F}, {5, 60, 0.15F})))},
        {"house", wall(10, -10, 20, 10, 10, 0.1F)},
        {"thing", thing_at(30, 0, 0.15F)}},
       middle_cell,
       {"thing"},
       {}});
  all.push_back({"no_ground_at_all",
                 {{"house", wall(10, -10, 20, 10, 10, 0)}, {"thing", thing_at(30, 0)}, {"deep", thing_at(30, 0, -9)}},
                 middle_cell,
                 {},
                 {"deep"}});
  all.push_back({"cage_of_bars_finer_than_a_column", {ground, {"thing", thing_at(30, 0)}}, middle_cell, {}, {"thing"}});
  Mesh bars;
  for (float y = -10; y <= 10; y += 0.2F) append(bars, block({10, y, 0}, {10.05F, y + 0.05F, 4}));
  append(bars, block({10, -10, 4}, {14, 10, 4.2F}));
  all.back().objects.emplace_back("cage", bars);
  return all;
}

class WhoSeesWhom : public testing::TestWithParam<Situation> {};

TEST_P(WhoSeesWhom, is_as_the_situation_says) { expect_as_said(GetParam(), hiders_for(CellStyle::octree)); }
TEST_P(WhoSeesWhom, is_as_cull_maps_say) {
  Situation situation = GetParam();
  // From the whole cell the two shadows do not meet; `horizon` asks parts of it.
  if (situation.name == "two_houses_together_hide_what_neither_does") {
    situation.kept.insert(situation.kept.end(), situation.hidden.begin(), situation.hidden.end());
    situation.hidden.clear();
  }
  expect_as_said(situation, {"backface", "cullmap"});
}

INSTANTIATE_TEST_SUITE_P(Hiders, WhoSeesWhom, testing::ValuesIn(situations()),
                         [](const auto& param_info) { return param_info.param.name; });

TEST(Audit, catches_occluders_grown_on_purpose) {
  const SituationModel model({{"ground", flat_ground()}, {"house", wall(10, -4, 20, 4)}, {"thing", thing_at(30, 10)}});
  JobMonitor monitor;
  const Result<NodeParts> parts = NodeParts::make(model.reader(), monitor);
  Result<OccluderSet> occluders = extract_occluders(model.reader(), {}, monitor);
  ASSERT_TRUE(parts.ok() && occluders.ok());
  const std::vector<NodeId> front = model.front();
  const auto asked = [&] {
    std::vector<uint8_t> hidden(front.size(), 0);
    EXPECT_TRUE(
        make_horizon_hider(model.reader().model(), *parts, *occluders)->hide({middle_cell, front}, hidden).ok());
    return hidden;
  };
  EXPECT_EQ(misses(model, middle_cell, asked()), 0U);
  for (glm::vec2& p : occluders->points) p.y *= 4;  // a house four times as wide as it is
  for (OccluderLoop& loop : occluders->loops) loop.low.y *= 4, loop.high.y *= 4;
  for (Occluder& occluder : occluders->occluders) occluder.box.min.y *= 4, occluder.box.max.y *= 4;
  EXPECT_GT(misses(model, middle_cell, asked()), 0U);
}

TEST(Audit, finds_no_place_to_stand_in_a_solid) {
  const SituationModel model({{"house", wall(-10, -10, 10, 10, 10, -10)}});
  const Result<std::unique_ptr<NodeMeshes>> meshes = NodeMeshes::make(model.reader(), 1U << 28U);
  ASSERT_TRUE(meshes.ok());
  const Result<Looks> looks = look_from_cell(**meshes, middle_cell, model.front(), {}, {});
  ASSERT_TRUE(looks.ok());
  EXPECT_EQ(looks->eyes, 0U);
}

uint64_t eyes_in(const SituationModel& model, const Box& cell) {
  const Result<std::unique_ptr<NodeMeshes>> meshes = NodeMeshes::make(model.reader(), 1U << 28U);
  EXPECT_TRUE(meshes.ok());
  LookOptions options;
  options.views = 120;
  const Result<Looks> looks = look_from_cell(**meshes, cell, model.front(), {}, options);
  EXPECT_TRUE(looks.ok());
  return looks.ok() ? looks->eyes : 0;
}

TEST(Audit, tells_slits_of_rounded_vertices_from_what_is_truly_seen) {
  const auto verdict = [](float wide) {
    const SituationModel model({{"left", wall(8, -30, 8.1F, -wide / 2)},
                                {"right", wall(8, wide / 2, 8.1F, 30)},
                                {"thing", block({12, -20, 0}, {13, 20, 9})}});
    const Result<std::unique_ptr<NodeMeshes>> meshes = NodeMeshes::make(model.reader(), 1U << 28U);
    EXPECT_TRUE(meshes.ok());
    const std::vector<NodeId> front = model.front();
    const std::vector<uint8_t> hidden = {0, 0, 1};
    LookOptions options;
    options.aimed_views = 200;
    const Result<Looks> looks = look_from_cell(**meshes, middle_cell, front, hidden, options);
    EXPECT_TRUE(looks.ok());
    EXPECT_EQ(looks->missed.size(), judge(model.reader().model(), front, hidden, *looks).missed_nodes);
    return judge(model.reader().model(), front, hidden, *looks);
  };
  const CellVerdict slit = verdict(0.0017F), hole = verdict(0.0021F);
  EXPECT_GT(slit.slit_pixels, 0U);
  EXPECT_EQ(slit.missed_nodes, 0U);
  EXPECT_GT(hole.false_hidden_pixels, 0U);
  EXPECT_EQ(hole.missed_nodes, 1U);
}

TEST(Audit, refuses_eyes_in_a_tower_on_a_podium) {
  // The podium's roof goes on inside the tower and shows its front there.
  const SituationModel model({{"ground", flat_ground()},
                              {"podium", shell({-10, -10, -0.3F}, {10, 10, 5})},
                              {"tower", shell({-4, -4, 5}, {4, 4, 40})}});
  EXPECT_EQ(eyes_in(model, {{-2, -2, 6}, {2, 2, 8}}), 0U);
  EXPECT_GT(eyes_in(model, {{6, 6, 6}, {8, 8, 8}}), 0U) << "beside the tower, on the podium";
}

TEST(Audit, refuses_eyes_below_the_ground) {
  const SituationModel model({{"ground", flat_ground()}, {"house", wall(10, -10, 20, 10)}});
  EXPECT_EQ(eyes_in(model, {{-2, -2, -3}, {2, 2, -1}}), 0U);
  EXPECT_GT(eyes_in(model, {{-2, -2, 1}, {2, 2, 3}}), 0U);
}

TEST(Audit, refuses_eyes_below_and_within_what_is_two_sided_where_the_source_tells_its_solids) {
  const Objects town = {{"ground", of_material(flat_ground(), kBothSides)},
                        {"house", of_material(block({10, -10, -0.2F}, {20, 10, 9}), kBothSides)}};
  const SituationModel told(town, Tell::footprints), soup(town);
  const Box below{{-2, -2, -3}, {2, 2, -1}}, within{{13, -2, 3}, {17, 2, 5}}, above{{-2, -2, 1}, {2, 2, 3}};
  EXPECT_EQ(eyes_in(told, below), 0U);
  EXPECT_EQ(eyes_in(told, within), 0U);
  EXPECT_GT(eyes_in(told, above), 0U);
  EXPECT_GT(eyes_in(soup, below), 0U) << "who knows which side of it is the outside";
  EXPECT_GT(eyes_in(soup, within), 0U);
}

TEST(Audit, refuses_eyes_beneath_a_floor_that_lies_below_the_ground) {
  const Objects town = {{"ground", of_material(flat_ground(), kBothSides)},
                        {"house", of_material(block({-10, -10, -0.2F}, {10, 10, 9}), kBothSides)},
                        {"balcony", of_material(block({10, -9, 3}, {14, 9, 3.2F}), kBothSides)}};
  const SituationModel told(town, Tell::footprints);
  EXPECT_EQ(eyes_in(told, {{-2, -2, -0.4F}, {2, 2, -0.3F}}), 0U);
  EXPECT_GT(eyes_in(told, {{11, -2, 1}, {13, 2, 2}}), 0U) << "beneath a balcony, on the ground";
}

TEST(Audit, refuses_eyes_in_the_plane_of_a_roof) {
  const SituationModel model({{"ground", flat_ground()}, {"house", wall(-10, -10, 10, 10, 5)}});
  EXPECT_EQ(eyes_in(model, {{-2, -2, 4.996F}, {2, 2, 5.004F}}), 0U);
  EXPECT_GT(eyes_in(model, {{-2, -2, 5.1F}, {2, 2, 5.2F}}), 0U);
}

TEST(Audit, refuses_eyes_right_before_a_wall) {
  const SituationModel model({{"ground", flat_ground()}, {"house", wall(10, -10, 20, 10)}});
  EXPECT_EQ(eyes_in(model, {{9.995F, -2, 1}, {9.9999F, 2, 3}}), 0U);
  EXPECT_GT(eyes_in(model, {{9.8F, -2, 1}, {9.9F, 2, 3}}), 0U);
}

TEST(Hiders, backface_hides_what_shows_its_back_only) {
  const SituationModel model({{"back", sheet({10, -5, 0}, {10, 5, 0}, {10, 5, 5}, {10, -5, 5})},
                              {"front", sheet({10, 5, 0}, {10, -5, 0}, {10, -5, 5}, {10, 5, 5})},
                              {"two_sided", sheet({10, -5, 0}, {10, 5, 0}, {10, 5, 5}, {10, -5, 5}, kBothSides)}});
  EXPECT_THAT(hidden_by(model, {"backface"}, middle_cell), testing::ElementsAre(1, 0, 0));
}

TEST(Hiders, sampled_agrees_with_pictures_and_says_that_it_is_no_proof) {
  const SituationModel model({{"ground", flat_ground()}, {"house", wall(10, -10, 20, 10)}, {"thing", thing_at(30, 0)}});
  EXPECT_THAT(hidden_by(model, {"sampled"}, middle_cell), testing::ElementsAre(0, 0, 1));
  JobMonitor monitor;
  const std::vector<std::string> names = {"sampled", "horizon"};
  const auto hiders = HiderMaker(model.reader(), {}, monitor).make(names);
  ASSERT_TRUE(hiders.ok());
  EXPECT_FALSE((*hiders)[0]->is_conservative());
  EXPECT_TRUE((*hiders)[1]->is_conservative());
}

TEST(Hiders, what_is_hidden_already_stays_hidden) {
  const SituationModel model({{"ground", flat_ground()}, {"thing", thing_at(20, 0)}});
  const Result<NodeParts> parts = NodeParts::make(model.reader(), *std::make_unique<JobMonitor>());
  JobMonitor monitor;
  const Result<OccluderSet> occluders = extract_occluders(model.reader(), {}, monitor);
  ASSERT_TRUE(parts.ok() && occluders.ok());
  const std::vector<NodeId> front = model.front();
  std::vector<uint8_t> hidden = {0, 1};
  ASSERT_TRUE(make_horizon_hider(model.reader().model(), *parts, *occluders)->hide({middle_cell, front}, hidden).ok());
  EXPECT_THAT(hidden, testing::ElementsAre(0, 1));
}

TEST(Hiders, auto_leaves_out_what_finds_next_to_nothing) {
  const auto names_for = [](const SituationModel& model, const std::vector<std::string>& names) {
    JobMonitor monitor;
    CellOptions options;
    options.cells = CellStyle::octree;
    const Result<ViewSpace> space = survey_view_space(model.reader(), options, monitor);
    EXPECT_TRUE(space.ok());
    HiderMaker maker(model.reader(), {}, monitor);
    const auto hiders = make_hiders_for(names, model.reader(), *space, options, maker, monitor);
    EXPECT_TRUE(hiders.ok());
    std::vector<std::string> made;
    for (const auto& hider : *hiders) made.emplace_back(hider->name());
    return made;
  };
  const SituationModel field({{"ground", flat_ground()}, {"thing", thing_at(20, 0)}, {"other", thing_at(-20, 9)}});
  EXPECT_THAT(names_for(field, {"auto"}), testing::ElementsAre("backface"));
  EXPECT_THAT(names_for(field, {"backface", "horizon"}), testing::ElementsAre("backface", "horizon"))
      << "what is asked for by name is done";
  Objects street = {{"ground", flat_ground()}};
  for (int x = -3; x < 4; ++x)
    for (int y = -3; y < 4; ++y) {
      const auto low = glm::vec2(x, y) * 14.0F;
      street.emplace_back(fmt::format("house {} {}", x, y), wall(low.x, low.y, low.x + 10, low.y + 10, 12));
    }
  EXPECT_THAT(names_for(SituationModel(street), {"auto"}), testing::ElementsAre("backface", "horizon"));
}

TEST(Hiders, chains_are_parsed_and_unknown_names_refused) {
  EXPECT_THAT(*parse_hiders("backface,horizon"), testing::ElementsAre("backface", "horizon"));
  EXPECT_TRUE(parse_hiders("none")->empty());
  EXPECT_THAT(resolved_hiders(*parse_hiders("auto"), CellStyle::octree), testing::ElementsAre("backface", "horizon"));
  EXPECT_THAT(resolved_hiders(*parse_hiders("auto"), CellStyle::kd), testing::ElementsAre("backface", "portals"));
  EXPECT_THAT(resolved_hiders(*parse_hiders("portals"), CellStyle::octree), testing::ElementsAre("portals"));
  for (const std::string wrong : {"portals of doom", "horizon,horizon", "horizon,", ",", "Horizon", "auto,horizon"})
    EXPECT_FALSE(parse_hiders(wrong).ok()) << wrong;
  EXPECT_THAT(parse_hiders("shadow").error().message,
              HasSubstr("backface, horizon, cullmap, portals, umbra, shrunk, sampled"));
}

TEST(Occluders, are_the_same_at_any_number_of_threads) {
  Objects objects = {{"ground", flat_ground(200)}};
  for (int i = 0; i < 12; ++i)
    objects.emplace_back("house" + std::to_string(i), turned_block({float(i % 4) * 90 - 140, float(i / 4) * 110 - 120},
                                                                   {14, 9}, -0.5F, 12, float(i)));
  const SituationModel model(objects);
  const auto extracted = [&](int threads) {
    tbb::task_arena arena(threads);
    JobMonitor monitor;
    return arena.execute([&] { return extract_occluders(model.reader(), {}, monitor); });
  };
  const Result<OccluderSet> one = extracted(1), two = extracted(2);
  ASSERT_TRUE(one.ok() && two.ok());
  EXPECT_EQ(one->occluders.size(), 12U);
  EXPECT_EQ(one->points, two->points);
  EXPECT_EQ(one->ground.slips, two->ground.slips);
}

TEST(Occluders, are_found_in_quarters_of_tiles_where_memory_is_short) {
  Objects objects = {{"ground", flat_ground(60)}};
  for (int i = 0; i < 4; ++i)
    objects.emplace_back("house" + std::to_string(i),
                         turned_block({float(i % 2) * 70 - 35, float(i / 2) * 60 - 30}, {14, 9}, -0.5F, 12, float(i)));
  const SituationModel model(objects);
  const auto extracted = [&](int threads, uint64_t bytes) {
    OccluderOptions options;
    options.memory_bytes = bytes;
    tbb::task_arena arena(threads);
    JobMonitor monitor;
    return arena.execute([&] { return extract_occluders(model.reader(), options, monitor); });
  };
  constexpr uint64_t kLittle = uint64_t(24) << 20;
  const Result<OccluderSet> whole = extracted(2, uint64_t(1) << 30), one = extracted(1, kLittle),
                            two = extracted(2, kLittle);
  ASSERT_TRUE(whole.ok() && one.ok() && two.ok());
  EXPECT_EQ(one->points, two->points);
  EXPECT_EQ(one->ground.slips, two->ground.slips);
  EXPECT_FALSE(one->points == whole->points) << "else no tile was too much";
  ASSERT_EQ(whole->occluders.size(), 4U);
  for (const Occluder& occluder : whole->occluders)
    EXPECT_TRUE(std::any_of(one->occluders.begin(), one->occluders.end(), [&](const Occluder& other) {
      return other.box.grown(0.5F).contains(occluder.box) && occluder.box.grown(0.5F).contains(other.box);
    }));
}

TEST(NodeParts, are_the_same_on_the_disk) {
  const SituationModel model({{"ground", flat_ground()}, {"house", wall(10, -10, 20, 10)}, {"thing", thing_at(30, 0)}});
  const TemporaryFolder folder;
  JobMonitor monitor;
  NodePartsOptions options;
  const Result<NodeParts> in_memory = NodeParts::make(model.reader(), monitor, options);
  options.memory_bytes = 1, options.folder = folder.path();
  const Result<NodeParts> on_disk = NodeParts::make(model.reader(), monitor, options);
  ASSERT_TRUE(in_memory.ok() && on_disk.ok());
  EXPECT_FALSE(in_memory->on_disk());
  EXPECT_TRUE(on_disk->on_disk());
  const std::vector<NodeId> front = model.front();
  const std::vector<uint8_t> left_out = {0, 1, 0};
  const Result<HeldParts> a = in_memory->hold(front, left_out), b = on_disk->hold(front, left_out);
  ASSERT_TRUE(a.ok() && b.ok());
  for (size_t i = 0; i < front.size(); ++i) {
    ASSERT_EQ(a->of(i).size(), b->of(i).size());
    EXPECT_EQ(a->of(i).empty(), left_out[i] != 0);
    for (size_t k = 0; k < a->of(i).size(); ++k) {
      EXPECT_EQ(a->of(i)[k].box, b->of(i)[k].box);
      EXPECT_EQ(a->of(i)[k].cone.axis, b->of(i)[k].cone.axis);
      EXPECT_EQ(a->of(i)[k].cone.cos_angle, b->of(i)[k].cone.cos_angle);
    }
  }
  std::vector<uint8_t> hidden_a(front.size(), 0), hidden_b(front.size(), 0);
  const Result<OccluderSet> occluders = extract_occluders(model.reader(), {}, monitor);
  ASSERT_TRUE(occluders.ok());
  for (const auto& [parts, hidden] : {std::pair(&*in_memory, &hidden_a), std::pair(&*on_disk, &hidden_b)})
    ASSERT_TRUE(
        make_horizon_hider(model.reader().model(), *parts, *occluders)->hide({middle_cell, front}, *hidden).ok());
  EXPECT_EQ(hidden_a, hidden_b);
  EXPECT_EQ(hidden_a[2], 1);
}

TEST(NodeParts, that_the_disk_loses_are_an_error) {
  const SituationModel model({{"ground", flat_ground()}, {"thing", thing_at(30, 0)}});
  const TemporaryFolder folder;
  JobMonitor monitor;
  NodePartsOptions options;
  options.memory_bytes = 1, options.folder = folder.path() / "missing";
  EXPECT_FALSE(NodeParts::make(model.reader(), monitor, options).ok());
  options.folder = folder.path();
  const Result<NodeParts> parts = NodeParts::make(model.reader(), monitor, options);
  ASSERT_TRUE(parts.ok());
  std::filesystem::resize_file(folder.path() / "node-parts", 8);
  std::vector<uint8_t> hidden(model.front().size(), 0);
  EXPECT_FALSE(make_backface_hider(model.reader().model(), *parts)->hide({middle_cell, model.front()}, hidden).ok());
}

TEST(Occluders, lie_within_the_solids_by_their_erosion) {
  const SituationModel model({{"ground", flat_ground()}, {"house", turned_block({5, 3}, {12, 8}, -0.5F, 9, 0.4F)}});
  JobMonitor monitor;
  const Result<OccluderSet> set = extract_occluders(model.reader(), {}, monitor);
  ASSERT_TRUE(set.ok());
  ASSERT_EQ(set->occluders.size(), 1U);
  for (size_t k = 0; k < OccluderSet::kErosionsM.size(); ++k)
    for (const OccluderLoop& loop : set->loops_of(set->occluders[0], k)) {
      EXPECT_LE(loop.top_m, 9);
      for (const glm::vec2& p : set->points_of(loop)) {
        const glm::vec2 d = p - glm::vec2(5, 3);
        const glm::vec2 local(d.x * std::cos(0.4F) + d.y * std::sin(0.4F),
                              -d.x * std::sin(0.4F) + d.y * std::cos(0.4F));
        EXPECT_GE(12 - std::abs(local.x), OccluderSet::kErosionsM[k] - 1e-3F);
        EXPECT_GE(8 - std::abs(local.y), OccluderSet::kErosionsM[k] - 1e-3F);
      }
    }
}

TEST(Occluders, of_a_model_without_triangles_or_ground_are_none) {
  const SituationModel model({{"sheet", sheet({0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0})}});
  JobMonitor monitor;
  const Result<OccluderSet> set = extract_occluders(model.reader(), {}, monitor);
  ASSERT_TRUE(set.ok());
  EXPECT_TRUE(set->occluders.empty());
}

}  // namespace
}  // namespace promenade
