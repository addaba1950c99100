// Who sees whom indoors: rooms, doors and windows with known answers, asked of the portals.

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "geometry/random.h"
#include "preprocess/visibility/hider_trial.h"
#include "preprocess/visibility/line_beam.h"
#include "preprocess/visibility/room_parts.h"
#include "preprocess/visibility/wall_openings.h"
#include "tests/preprocess/who_sees_whom.h"

namespace promenade {
namespace {

/// Along a wall and in height.
struct Hole {
  float from, to, low, high;
};

/// A wall of 0.2 m across x (from x on) with holes, which must be in order and apart.
Mesh wall_across_x(float x, const std::vector<Hole>& holes, float y0 = 0, float y1 = 4, float top = 3) {
  Mesh mesh;
  const auto piece = [&](float a, float b, float low, float high) {
    if (a < b && low < high) append(mesh, block({x, a, low}, {x + 0.2F, b, high}));
  };
  float done = y0;
  for (const Hole& hole : holes) {
    piece(done, hole.from, 0, top);
    piece(hole.from, hole.to, 0, hole.low);
    piece(hole.from, hole.to, hole.high, top);
    done = hole.to;
  }
  piece(done, y1, 0, top);
  return mesh;
}

Mesh swapped_xy(Mesh mesh) {
  for (glm::vec3& p : mesh.positions) std::swap(p.x, p.y);
  for (size_t i = 0; i < mesh.indices.size(); i += 3) std::swap(mesh.indices[i], mesh.indices[i + 1]);
  return mesh;
}

/// Walls, floor and ceiling of 0.2 m around a space.
Mesh case_around(const glm::vec3& low, const glm::vec3& high, bool open_left = false) {
  const glm::vec3 a = low - 0.2F, b = high + 0.2F;
  Mesh mesh = block({a.x, a.y, a.z}, {b.x, b.y, low.z});
  append(mesh, block({a.x, a.y, high.z}, {b.x, b.y, b.z}));
  append(mesh, block({a.x, a.y, low.z}, {b.x, low.y, high.z}));
  append(mesh, block({a.x, high.y, low.z}, {b.x, b.y, high.z}));
  append(mesh, block({high.x, low.y, low.z}, {b.x, high.y, high.z}));
  if (!open_left) append(mesh, block({a.x, low.y, low.z}, {low.x, high.y, high.z}));
  return mesh;
}

const Hole door{1.5F, 2.5F, 0, 2};
const Box left_cell{{1, 1.5F, 0.5F}, {2, 2.5F, 1.8F}};

/// Two rooms of 4 x 4 x 3 m side by side, and what is between them and in them.
Objects two_rooms(const Mesh& between, Objects things) {
  things.insert(things.begin(), {"walls", together(case_around({0, 0, 0}, {8.2F, 4, 3}), between)});
  return things;
}

const std::pair<std::string, Mesh> opposite("opposite", block({5.5F, 1.5F, 0.2F}, {6.5F, 2.5F, 1.2F}));
const std::pair<std::string, Mesh> beside("beside", block({4.3F, 0.1F, 0.1F}, {4.9F, 0.7F, 1}));

std::vector<Situation> doors() {
  std::vector<Situation> all;
  const auto leaf = [](uint32_t material) { return block({4.08F, 1.5F, 0}, {4.12F, 2.5F, 2}, material); };
  const auto rooms = [&](const std::string& name, const Mesh& between, Objects things, std::vector<std::string> hidden,
                         std::vector<std::string> kept) {
    all.push_back({name, two_rooms(between, std::move(things)), left_cell, std::move(hidden), std::move(kept)});
  };
  rooms("two_rooms_without_a_door", wall_across_x(4, {}), {opposite, beside}, {"opposite", "beside"}, {"walls"});
  rooms("two_rooms_one_door", wall_across_x(4, {door}), {opposite, beside}, {"beside"}, {"opposite"});
  rooms("door_closed", together(wall_across_x(4, {door}), leaf(kStone)), {opposite}, {"opposite"}, {});
  rooms("door_of_glass", together(wall_across_x(4, {door}), leaf(kGlassPane)), {opposite}, {}, {"opposite"});
  rooms("curtain_of_leaves", together(wall_across_x(4, {door}), leaf(kLeaves)), {opposite}, {}, {"opposite"});
  rooms("door_ajar", together(wall_across_x(4, {door}), turned_block({4.6F, 1.7F}, {0.45F, 0.02F}, 0, 2, 0.5F)),
        {opposite, beside}, {"beside"}, {"opposite"});
  rooms("two_doors_in_a_wall", wall_across_x(4, {{0.2F, 1, 0, 2}, {3, 3.8F, 0, 2}}), {opposite, beside}, {"opposite"},
        {"beside"});
  rooms("gap_under_the_door", together(wall_across_x(4, {door}), block({4.08F, 1.5F, 0.05F}, {4.12F, 2.5F, 2})),
        {opposite}, {"opposite"}, {});
  all.push_back({"gap_under_the_door_from_the_floor",
                 two_rooms(together(wall_across_x(4, {door}), block({4.08F, 1.5F, 0.05F}, {4.12F, 2.5F, 2})),
                           {{"on_the_floor", block({5, 1.5F, 0.01F}, {6, 2.5F, 0.3F})}}),
                 {{1, 1.5F, 0.005F}, {2, 2.5F, 0.3F}},
                 {},
                 {"on_the_floor"}});
  // As a lift's door ends half a centimetre above the floor.
  all.push_back({"slit_of_half_a_centimetre_under_the_door",
                 two_rooms(together(wall_across_x(4, {door}), block({4.08F, 1.5F, 0.005F}, {4.12F, 2.5F, 2})),
                           {{"on_the_floor", block({5, 1.5F, 0.001F}, {6, 2.5F, 0.3F})}}),
                 {{1, 1.5F, 0.001F}, {2, 2.5F, 0.3F}},
                 {},
                 {"on_the_floor"}});
  // Only its back is in the line of sight, and its front where no line gets to.
  const auto plate = [](float away, float towards) {
    Mesh mesh = sheet({away, 1.7F, 1}, {away, 2.3F, 1}, {away, 2.3F, 1.6F}, {away, 1.7F, 1.6F});
    append(mesh, sheet({towards, 0.6F, 1}, {towards, 0.1F, 1}, {towards, 0.1F, 1.6F}, {towards, 0.6F, 1.6F}));
    return std::pair<std::string, Mesh>("plate", mesh);
  };
  rooms("back_of_a_plate_behind_the_door", wall_across_x(4, {door}), {plate(5, 4.3F)}, {"plate"}, {});
  rooms("front_of_a_plate_behind_the_door", wall_across_x(4, {door}),
        {{"plate", sheet({5, 2.3F, 1}, {5, 1.7F, 1}, {5, 1.7F, 1.6F}, {5, 2.3F, 1.6F})}}, {}, {"plate"});
  all.push_back({"cell_touches_the_wall",
                 two_rooms(wall_across_x(4, {}), {opposite, beside}),
                 {{3, 1, 0.5F}, {4, 3, 2}},
                 {"opposite", "beside"},
                 {"walls"}});
  all.push_back({"cell_in_the_doorway",
                 two_rooms(wall_across_x(4, {door}), {opposite, {"behind", block({1, 1.5F, 0}, {2, 2.5F, 1})}}),
                 {{4, 1.5F, 0.2F}, {4.2F, 2.5F, 1.8F}},
                 {},
                 {"opposite", "behind"}});
  all.push_back({"cell_across_a_wall",
                 two_rooms(wall_across_x(4, {}), {opposite, {"behind", block({1, 1.5F, 0}, {2, 2.5F, 1})}}),
                 {{3, 1, 0.5F}, {5, 3, 2}},
                 {},
                 {"opposite", "behind"}});
  all.push_back({"two_rooms_one_door_along_y",
                 {{"walls", swapped_xy(together(case_around({0, 0, 0}, {8.2F, 4, 3}), wall_across_x(4, {door})))},
                  {"opposite", swapped_xy(opposite.second)},
                  {"beside", swapped_xy(beside.second)}},
                 {{1.5F, 1, 0.5F}, {2.5F, 2, 1.8F}},
                 {"beside"},
                 {"opposite"}});
  const auto three = [](const std::vector<Hole>& first, const std::vector<Hole>& second) {
    return together(case_around({0, 0, 0}, {12.4F, 4, 3}),
                    together(wall_across_x(4, first), wall_across_x(8.2F, second)));
  };
  const auto third = std::pair<std::string, Mesh>("third", block({10, 1.5F, 0.2F}, {11, 2.5F, 1.2F}));
  all.push_back({"doors_in_line", {{"walls", three({door}, {door})}, third}, left_cell, {}, {"third"}});
  all.push_back({"corner_behind_doors_in_line",
                 {{"walls", three({door}, {door})}, {"corner", block({8.5F, 0.1F, 0.1F}, {9, 0.6F, 1})}},
                 left_cell,
                 {"corner"},
                 {}});
  all.push_back(
      {"doors_out_of_line", {{"walls", three({{0.2F, 1, 0, 2}}, {{3, 3.8F, 0, 2}})}, third}, left_cell, {"third"}, {}});
  return all;
}

std::vector<Situation> holes() {
  std::vector<Situation> all;
  const auto rooms = [&](const std::string& name, const Mesh& between, Objects things, std::vector<std::string> hidden,
                         std::vector<std::string> kept) {
    all.push_back({name, two_rooms(between, std::move(things)), left_cell, std::move(hidden), std::move(kept)});
  };
  const auto low = std::pair<std::string, Mesh>("low", block({4.3F, 1, 0.01F}, {4.6F, 3, 0.5F}));
  const auto high = std::pair<std::string, Mesh>("high", block({5.5F, 1.5F, 2.2F}, {6.5F, 2.5F, 2.95F}));
  rooms("window_slit_between_rooms", wall_across_x(4, {{1.95F, 2.05F, 1, 1.1F}}), {opposite, beside}, {"beside"},
        {"opposite"});
  rooms("slit_of_five_centimetres", wall_across_x(4, {{1.975F, 2.025F, 0, 3}}), {opposite, beside}, {"beside"},
        {"opposite"});
  rooms("high_window", wall_across_x(4, {{1, 3, 2.2F, 2.8F}}), {low, high}, {"low"}, {"high"});
  rooms("partition_to_shoulder_height", wall_across_x(4, {}, 0, 4, 1.9F), {low, high}, {"low"}, {"high"});
  rooms("gap_under_the_ceiling", wall_across_x(4, {}, 0, 4, 2.8F), {low, high}, {"low", "high"}, {"walls"});
  rooms("row_of_windows", wall_across_x(4, {{0.2F, 0.8F, 1, 2}, {1.2F, 1.8F, 1, 2}, {2.2F, 2.8F, 1, 2}}), {opposite},
        {}, {"opposite"});
  rooms("wall_a_millimetre_off", together(block({4, 0, 0}, {4.2F, 2, 3}), block({4.001F, 2, 0}, {4.201F, 4, 3})),
        {opposite, beside}, {"opposite", "beside"}, {});
  // Up to shoulder height the partition makes a plane to divide space along; above it there is nothing but the poster.
  const auto poster = [&](const std::string& name, float off) {
    rooms(name, wall_across_x(4, {}, 0, 4, 1.9F),
          {{"poster", sheet({4 + off, 3, 2}, {4 + off, 1, 2}, {4 + off, 1, 2.8F}, {4 + off, 3, 2.8F})}}, {},
          {"poster"});
  };
  poster("poster_in_the_plane_of_a_partition", 0);
  poster("poster_three_millimetres_before_the_plane_of_a_partition", -0.003F);
  poster("poster_three_millimetres_behind_the_plane_of_a_partition", 0.003F);
  poster("poster_a_centimetre_behind_the_plane_of_a_partition", 0.01F);
  // Its front is seen from a little behind the plane of its nearest corner.
  rooms("poster_half_a_degree_askew", wall_across_x(4, {}, 0, 4, 1.9F),
        {{"poster", sheet({3.997F, 1, 2}, {4, 0.66F, 2}, {4, 0.66F, 2.8F}, {3.997F, 1, 2.8F})}}, {}, {"poster"});
  const auto between = [](uint32_t material, bool to_the_right) {
    return to_the_right ? sheet({4, 0, 0}, {4, 4, 0}, {4, 4, 3}, {4, 0, 3}, material)
                        : sheet({4, 4, 0}, {4, 0, 0}, {4, 0, 3}, {4, 4, 3}, material);
  };
  rooms("sheet_that_shows_its_front", between(kStone, false), {opposite}, {"opposite"}, {});
  rooms("sheet_that_shows_its_back", between(kStone, true), {opposite}, {}, {"opposite"});
  rooms("sheet_with_two_sides", between(kBothSides, true), {opposite}, {"opposite"}, {});
  rooms("wall_of_glass", between(kGlassPane, false), {opposite}, {}, {"opposite"});
  all.push_back(
      {"in_through_the_window",
       {{"walls", together(case_around({0, 0, 0}, {8, 4, 3}, true), wall_across_x(-0.2F, {{1.5F, 2.5F, 1, 2}}))},
        {"opposite", block({5.5F, 1.5F, 0.2F}, {6.5F, 2.5F, 1.2F})},
        {"below_the_window", block({0.05F, 1, 0.01F}, {0.3F, 3, 0.5F})}},
       {{-3, 1.5F, 0.2F}, {-2, 2.5F, 1.8F}},
       {"below_the_window"},
       {"opposite"}});
  all.push_back(
      {"out_of_the_window",
       {{"walls", together(case_around({0, 0, 0}, {8, 4, 3}, true), wall_across_x(-0.2F, {{1.5F, 2.5F, 1, 2}}))},
        {"in_view", block({-4, 1.5F, 0.5F}, {-3, 2.5F, 2})},
        {"behind_the_house", block({9, 1, 0}, {10, 3, 2})}},
       left_cell,
       {"behind_the_house"},
       {"in_view"}});
  return all;
}

std::vector<Situation> plans() {
  std::vector<Situation> all;
  const Box corridor_cell{{0.5F, 0.5F, 0.5F}, {1.5F, 1.5F, 1.8F}};
  all.push_back({"l_shaped_corridor",
                 {{"walls", together(case_around({0, 0, 0}, {10, 10, 3}), block({2, 2, 0}, {10, 10, 3}))},
                  {"round_the_corner", block({0.5F, 8, 0.1F}, {1.5F, 9, 1})},
                  {"in_the_corner", block({0.2F, 0.2F, 0.1F}, {0.6F, 0.6F, 1})}},
                 {{8, 0.5F, 0.5F}, {9, 1.5F, 1.8F}},
                 {"round_the_corner"},
                 {"in_the_corner"}});
  all.push_back({"niche_beside_a_corridor",
                 {{"walls", together(case_around({0, 0, 0}, {10, 4, 3}),
                                     together(block({0, 2, 0}, {6, 4, 3}), block({7, 2, 0}, {10, 4, 3})))},
                  {"deep_in_the_niche", block({6.1F, 3, 0.1F}, {6.5F, 3.8F, 1})}},
                 corridor_cell,
                 {"deep_in_the_niche"},
                 {"walls"}});
  Mesh offices = case_around({0, 0, 0}, {12, 6, 3});
  append(offices, swapped_xy(wall_across_x(2, {{1, 2, 0, 2}, {5, 6, 0, 2}, {9, 10, 0, 2}}, 0, 12)));
  append(offices, wall_across_x(4, {}, 2.2F, 6));
  append(offices, wall_across_x(8, {}, 2.2F, 6));
  const Objects of_offices = {{"walls", offices},
                              {"first_desk", block({0.1F, 5, 0.1F}, {0.9F, 5.8F, 0.8F})},
                              {"last_desk", block({9, 5, 0.1F}, {10, 5.8F, 0.8F})},
                              {"bench", block({1, 0.1F, 0.1F}, {2, 0.5F, 0.6F})}};
  all.push_back({"offices_do_not_see_each_other",
                 of_offices,
                 {{1, 3.5F, 0.5F}, {2, 4.5F, 1.8F}},
                 {"last_desk"},
                 {"first_desk", "bench"}});
  all.push_back({"corridor_sees_its_bench_but_no_far_desk",
                 of_offices,
                 {{3.5F, 0.5F, 0.5F}, {4.5F, 1.5F, 1.8F}},
                 {"last_desk"},
                 {"bench"}});
  const Mesh two_storeys = case_around({0, 0, 0}, {8, 4, 6.2F});
  const auto upstairs = std::pair<std::string, Mesh>("upstairs", block({6, 1, 3.3F}, {7, 2, 4}));
  const auto over_the_hole = std::pair<std::string, Mesh>("over_the_hole", block({1, 1.5F, 5}, {2, 2.5F, 6}));
  all.push_back({"floor_between_storeys",
                 {{"walls", together(two_storeys, block({0, 0, 3}, {8, 4, 3.2F}))}, upstairs, over_the_hole},
                 left_cell,
                 {"upstairs", "over_the_hole"},
                 {"walls"}});
  Mesh with_hole = block({0, 0, 3}, {1, 4, 3.2F});
  append(with_hole, block({2, 0, 3}, {8, 4, 3.2F}));
  append(with_hole, block({1, 0, 3}, {2, 1.5F, 3.2F}));
  append(with_hole, block({1, 2.5F, 3}, {2, 4, 3.2F}));
  all.push_back({"hole_in_the_floor",
                 {{"walls", together(two_storeys, with_hole)}, upstairs, over_the_hole},
                 left_cell,
                 {"upstairs"},
                 {"over_the_hole"}});
  all.push_back({"balcony_seen_from_the_hall",
                 {{"walls", together(two_storeys, block({5, 0, 3}, {8, 4, 3.2F}))}, upstairs, over_the_hole},
                 left_cell,
                 {},
                 {"over_the_hole", "walls"}});
  const Mesh hall = case_around({0, 0, 0}, {10, 8, 3});
  const Box hall_cell{{1, 3.6F, 0.5F}, {1.5F, 4.4F, 1.8F}};
  all.push_back({"thing_behind_a_pillar",
                 {{"walls", together(hall, block({4, 3, 0}, {6, 5, 3}))},
                  {"behind", block({6.1F, 3.8F, 0.1F}, {6.5F, 4.2F, 1})},
                  {"beside", block({6.1F, 6, 0.1F}, {6.5F, 7, 1})}},
                 hall_cell,
                 {"behind"},
                 {"beside"}});
  all.push_back({"room_in_a_room",
                 {{"walls", together(hall, case_around({4, 2, 0.2F}, {8, 6, 2.5F}))},
                  {"kernel", block({5, 3, 0.5F}, {6, 4, 1.5F})},
                  {"outside", block({2, 6, 0.1F}, {3, 7, 1})}},
                 hall_cell,
                 {"kernel"},
                 {"outside"}});
  all.push_back({"room_in_a_room_with_an_open_side",
                 {{"walls", together(hall, case_around({4, 2, 0.2F}, {8, 6, 2.5F}, true))},
                  {"kernel", block({5, 3, 0.5F}, {6, 4, 1.5F})}},
                 hall_cell,
                 {},
                 {"kernel"}});
  all.push_back({"open_side_turned_away",
                 {{"walls", together(hall, case_around({4, 2, 0.2F}, {8, 6, 2.5F}, true))},
                  {"kernel", block({7, 3, 0.5F}, {7.8F, 4, 1.5F})}},
                 {{9, 3.6F, 0.5F}, {9.5F, 4.4F, 1.8F}},
                 {"kernel"},
                 {}});
  return all;
}

class WhoSeesWhomIndoors : public testing::TestWithParam<Situation> {};

TEST_P(WhoSeesWhomIndoors, is_as_the_situation_says) { expect_as_said(GetParam(), {"portals"}); }

const auto name_of_situation = [](const auto& param_info) { return param_info.param.name; };
INSTANTIATE_TEST_SUITE_P(Doors, WhoSeesWhomIndoors, testing::ValuesIn(doors()), name_of_situation);
INSTANTIATE_TEST_SUITE_P(Holes, WhoSeesWhomIndoors, testing::ValuesIn(holes()), name_of_situation);
INSTANTIATE_TEST_SUITE_P(Plans, WhoSeesWhomIndoors, testing::ValuesIn(plans()), name_of_situation);

TEST(Indoors, cells_lie_along_walls_only_where_what_they_hide_is_worth_it) {
  const auto style_of = [](const SituationModel& model, const std::vector<std::string>& names) {
    JobMonitor monitor;
    CellOptions options;
    options.cells = CellStyle::automatic, options.smallest_cell_m = 1;
    const Result<ViewPlan> plan = plan_views(names, model.reader(), options, {}, monitor);
    EXPECT_TRUE(plan.ok());
    return plan->space.style;
  };
  Mesh walls = case_around({0, 0, 0}, {20.6F, 4, 3});
  Objects hall = {{"walls", walls}}, rooms;
  for (uint32_t i = 0; i < 5; ++i) {
    const float x = 4.2F * static_cast<float>(i);
    hall.emplace_back(fmt::format("thing {}", i), block({x + 2, 1.8F, 0.3F}, {x + 2.4F, 2.2F, 1}));
    if (i > 0) append(walls, wall_across_x(x - 0.2F, {}));
  }
  rooms = hall, rooms[0].second = walls;
  const std::vector<std::string> auto_names = {std::string(kAutoHiders)};
  EXPECT_EQ(style_of(SituationModel(rooms), auto_names), CellStyle::kd);
  EXPECT_EQ(style_of(SituationModel(hall), auto_names), CellStyle::octree) << "all that is in a hall is seen";
  EXPECT_EQ(style_of(SituationModel(hall), {"portals"}), CellStyle::kd) << "who names hiders is not guessed for";
}

TEST(Facing, tells_from_where_a_front_is_seen) {
  test::Numbers numbers(11);
  uint32_t no_front = 0, behind = 0;
  for (int i = 0; i < 4000; ++i) {
    glm::vec3 normal = glm::normalize(numbers.in_cube(1));
    if (i % 2 == 0) {
      const int axis = i / 2 % 3;
      for (int k = 0; k < 3; ++k) normal[k] = k == axis ? (normal[k] < 0 ? -1.0F : 1.0F) : 0.0F;
    }
    const Facing facing = Facing::of(normal);
    glm::vec3 way = numbers.in_cube(1);
    uint32_t octant = 0;
    for (int k = 0; k < 3; ++k) octant |= way[k] < 0 ? 1U << static_cast<uint32_t>(k) : 0U;
    if (glm::dot(glm::dvec3(way), glm::dvec3(normal)) < 0) {
      EXPECT_TRUE(facing.shows_front_to(octant)) << i;
    }
    no_front += facing.shows_front_to(octant) ? 0U : 1U;
    // A piece of the triangle's plane, and a cell with an eye somewhere in it.
    const glm::vec3 place = numbers.in_cube(3), eye = numbers.in_cube(3), more = glm::abs(numbers.in_cube(1));
    Box box{place, place};
    if (facing.axis == Facing::kNoAxis)
      box.max += more;
    else
      for (int k = 0; k < 3; ++k) box.max[k] += k == facing.axis / 2 ? 0 : more[k];
    const Box cell{eye - more, eye + more};
    const glm::vec3 corner = glm::mix(cell.min, cell.max, glm::abs(numbers.in_cube(1)));
    if (facing.axis != Facing::kNoAxis && glm::dot(normal, corner - place) > 0) {
      EXPECT_TRUE(facing.shows_front_to(cell, box)) << i;
    }
    behind += facing.shows_front_to(cell, box) ? 0U : 1U;
  }
  EXPECT_GT(no_front, 400U);
  EXPECT_GT(behind, 400U);
  EXPECT_EQ(Facing::of({0, 0, 0}), Facing()) << "two-sided: to all";
  EXPECT_EQ(Facing::of({0, -1, 0}).axis, 3);
}

TEST(LineBeam, keeps_every_line_that_touches_all_boxes) {
  test::Numbers numbers(7);
  const auto box_around = [&](const glm::dvec3& p) {
    const glm::dvec3 a(numbers.in_cube(1)), b(numbers.in_cube(1));
    return DBox{p - glm::abs(a), p + glm::abs(b)};
  };
  uint32_t held = 0;
  for (int i = 0; i < 2000; ++i) {
    const glm::dvec3 from(numbers.in_cube(5)), way(numbers.in_cube(1));
    const DBox start = box_around(from), second = box_around(from + way * 6.0), third = box_around(from + way * 15.0);
    for (uint32_t number = 0; number < LineSector::kCount; ++number) {
      const LineSector sector(number, from);
      const glm::dvec3 steps = way * sector.sign;
      bool of_sector = true;
      for (int axis = 0; axis < 3; ++axis) of_sector &= steps[axis] >= 0 && steps[axis] <= steps[sector.main];
      LineBeam beam(sector, sector.placed(start));
      beam.keep_touching(sector.placed(second));
      held += !beam.empty() && beam.touches(sector.placed(third)) ? 1U : 0U;
      if (!of_sector) continue;
      ASSERT_FALSE(beam.empty()) << i;
      EXPECT_TRUE(beam.touches(sector.placed(third))) << i;
      LineBeam both(sector, sector.placed(box_around(from + glm::dvec3(3))));
      both.add(beam);
      EXPECT_TRUE(both.touches(sector.placed(third))) << i;
    }
  }
  EXPECT_LT(held, 2000 * LineSector::kCount / 2) << "beams that go everywhere prove nothing";
}

TEST(LineBeam, ends_at_what_no_line_reaches) {
  const LineSector sector(0, {0, 0, 0});
  LineBeam beam(sector, {{0, 0, 0}, {1, 1, 1}});
  beam.keep_touching({{4, 0, 0}, {4, 1, 1}});
  EXPECT_TRUE(beam.touches({{8, 0, 0}, {8, 1, 1}}));
  EXPECT_FALSE(beam.touches({{8, 3.1, 0}, {8, 4, 1}}));
  beam.keep_touching({{5, 3, 0}, {5, 4, 1}});
  EXPECT_TRUE(beam.empty());
}

/// Two triangles.
void add_rectangle(std::vector<FlatTriangle>& wall, const glm::vec2& low, const glm::vec2& high) {
  wall.push_back({low, glm::vec2(high.x, low.y), high});
  wall.push_back({low, high, glm::vec2(low.x, high.y)});
}

TEST(WallOpenings, are_what_no_triangle_covers) {
  std::vector<FlatTriangle> wall;
  add_rectangle(wall, {0, 0}, {1.5, 3});
  add_rectangle(wall, {2.5, 0}, {4, 3});
  std::swap(wall[2][0], wall[2][1]);  // any winding
  const std::vector<WallOpening> openings = find_wall_openings({0, 0}, {4, 3}, wall, 0.02, 8);
  ASSERT_EQ(openings.size(), 1U);
  EXPECT_NEAR(openings[0].low.x, 1.5, 0.02);
  EXPECT_LE(openings[0].low.x, 1.5 + 0.001) << "but for the rim of a millimetre";
  EXPECT_NEAR(openings[0].high.x, 2.5, 0.02);
  EXPECT_GE(openings[0].high.x, 2.5 - 0.001);
  EXPECT_EQ(openings[0].low.y, 0);
  EXPECT_EQ(openings[0].high.y, 3);
}

TEST(WallOpenings, many_are_united_and_none_is_lost) {
  std::vector<FlatTriangle> wall;
  for (int i = 0; i < 40; i += 2) add_rectangle(wall, {float(i) * 0.1F, 0}, {float(i + 1) * 0.1F, 4});
  const std::vector<WallOpening> openings = find_wall_openings({0, 0}, {4, 4}, wall, 0.05, 5);
  EXPECT_LE(openings.size(), 5U);
  for (int i = 1; i < 40; i += 2) {
    const double x = i * 0.1 + 0.05;
    EXPECT_THAT(openings, testing::Contains(testing::Truly([&](const WallOpening& o) {
                  return o.low.x <= x && x <= o.high.x && o.low.y <= 0 && o.high.y >= 4;
                })))
        << x;
  }
}

TEST(WallOpenings, covered_altogether_is_closed_and_untouched_is_open) {
  std::vector<FlatTriangle> wall;
  add_rectangle(wall, {0, 0}, {1, 1});
  EXPECT_TRUE(find_wall_openings({0, 0}, {1, 1}, wall, 0.02, 4).empty());
  std::vector<FlatTriangle> none;
  const std::vector<WallOpening> open = find_wall_openings({0, 0}, {1, 1}, none, 0.02, 4);
  ASSERT_EQ(open.size(), 1U);
  EXPECT_EQ(open[0].low, glm::dvec2(0));
  EXPECT_EQ(open[0].high, glm::dvec2(1));
}

TEST(WallOpenings, a_slit_finer_than_the_grid_is_open_from_two_millimetres_on) {
  for (const double slit_m : {0.0, 0.0005, 0.0019, 0.0022, 0.005, 0.015}) {
    // Between two pieces, where the grid's points all lie on one or the other; and beneath a door, at the border.
    std::vector<FlatTriangle> pieces, beneath;
    add_rectangle(pieces, {0, 0}, {3, 1.0055}), add_rectangle(pieces, {0, static_cast<float>(1.0055 + slit_m)}, {3, 2});
    add_rectangle(beneath, {0, static_cast<float>(slit_m)}, {3, 2});
    for (std::vector<FlatTriangle>* wall : {&pieces, &beneath}) {
      const std::vector<WallOpening> openings = find_wall_openings({0, 0}, {3, 2}, *wall, 0.02, 4);
      if (slit_m < 0.002) {
        EXPECT_TRUE(openings.empty()) << slit_m;
        continue;
      }
      ASSERT_EQ(openings.size(), 1U) << slit_m;
      const WallOpening& open = openings[0];
      const double at = wall == &pieces ? 1.0055 + slit_m / 2 : 0.0;
      EXPECT_TRUE(open.low.x <= 0 && open.high.x >= 3 && open.low.y <= at && open.high.y >= at) << slit_m;
      EXPECT_LE(open.high.y - open.low.y, 0.021) << "no wider than a square of the grid";
    }
  }
}

TEST(WallOpenings, many_triangles_that_meet_leave_nothing_between_them) {
  // A fan around a point that no grid has, each piece rounded by itself, half of them more than once.
  Random random(5);
  std::vector<FlatTriangle> wall;
  const glm::vec2 middle(1.2345F, 0.8765F);
  std::vector<glm::vec2> rim;
  const auto along = [&](const glm::vec2& from, const glm::vec2& to) {
    for (int i = 0; i < 25; ++i) rim.push_back(from + (to - from) * (float(i) / 25));
  };
  along({0, 0}, {2, 0}), along({2, 0}, {2, 2}), along({2, 2}, {0, 2}), along({0, 2}, {0, 0});
  const auto rounded = [&](const glm::vec2& p) {
    return p + glm::vec2(random.range(-0.0003F, 0.0003F), random.range(-0.0003F, 0.0003F));
  };
  for (size_t i = 0; i < rim.size(); ++i)
    for (size_t k = 0; k <= i % 2; ++k)
      wall.push_back({rounded(middle), rounded(rim[i]), rounded(rim[(i + 1) % rim.size()])});
  EXPECT_TRUE(find_wall_openings({0, 0}, {2, 2}, wall, 0.02, 24).empty());
  std::vector<FlatTriangle> missing = wall;
  const size_t gone = missing.size() / 2;
  const glm::vec2 at = (missing[gone][0] + missing[gone][1] + missing[gone][2]) / 3.0F;
  std::erase_if(missing, [&](const FlatTriangle& t) { return glm::length((t[0] + t[1] + t[2]) / 3.0F - at) < 0.005F; });
  const std::vector<WallOpening> openings = find_wall_openings({0, 0}, {2, 2}, missing, 0.02, 24);
  EXPECT_THAT(openings, testing::Contains(testing::Truly([&](const WallOpening& o) {
                return o.low.x <= double(at.x) && double(at.x) <= o.high.x && o.low.y <= double(at.y) &&
                       double(at.y) <= o.high.y;
              })));
  std::reverse(missing.begin(), missing.end());
  const std::vector<WallOpening> again = find_wall_openings({0, 0}, {2, 2}, missing, 0.02, 24);
  ASSERT_EQ(again.size(), openings.size());
  for (size_t i = 0; i < again.size(); ++i)
    EXPECT_TRUE(again[i].low == openings[i].low && again[i].high == openings[i].high);
}

}  // namespace
}  // namespace promenade
