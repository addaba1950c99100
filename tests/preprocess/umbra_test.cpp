// Who sees whom past solid boxes that need not stand on the ground.

#include "preprocess/visibility/box_view.h"
#include "preprocess/visibility/solid_boxes.h"
#include "tests/preprocess/who_sees_whom.h"

namespace promenade {
namespace {

const Box cell_in_the_air{{-2, -2, 8}, {2, 2, 12}};

std::vector<Situation> situations_in_the_air() {
  std::vector<Situation> all;
  const auto add = [&](const std::string& name, Objects objects, std::vector<std::string> hidden,
                       std::vector<std::string> kept) {
    all.push_back({name, std::move(objects), cell_in_the_air, std::move(hidden), std::move(kept)});
  };
  const std::pair<std::string, Mesh> below("below", thing_at(0, 0, -20)), behind("behind", thing_at(30, 0, 9.5F));
  add("nothing_between", {below, behind}, {}, {"below", "behind"});
  add("thing_below_a_floating_slab", {{"slab", block({-15, -15, 2}, {15, 15, 4})}, below}, {"below"}, {"slab"});
  add("thing_above_a_floating_slab", {{"slab", block({-15, -15, 16}, {15, 15, 18})}, {"above", thing_at(0, 0, 40)}},
      {"above"}, {"slab"});
  add("thing_behind_a_floating_wall", {{"wall", block({10, -15, 0}, {12, 15, 20})}, behind}, {"behind"}, {"wall"});
  add("thing_beside_a_floating_wall", {{"wall", block({10, 4, 0}, {12, 15, 20})}, behind}, {}, {"behind"});
  add("thing_below_the_edge_of_a_wall",
      {{"wall", block({10, -15, 9}, {12, 15, 30})}, {"low", thing_at(30, 0, -9)}, {"high", thing_at(30, 0, 14)}},
      {"high"}, {"low"});
  add("slab_with_a_hole",
      {{"slab", together(together(block({-15, -15, 2}, {-1, 15, 4}), block({1, -15, 2}, {15, 15, 4})),
                         together(block({-1, -15, 2}, {1, -1, 4}), block({-1, 1, 2}, {1, 15, 4})))},
       below},
      {}, {"below"});
  add("slab_of_glass", {{"slab", block({-15, -15, 2}, {15, 15, 4}, kGlassPane)}, below}, {}, {"below"});
  add("slab_of_leaves", {{"slab", block({-15, -15, 2}, {15, 15, 4}, kLeaves)}, below}, {}, {"below"});
  add("sheet_that_shows_its_back_from_above",
      {{"sheet", sheet({-15, 15, 2}, {15, 15, 2}, {15, -15, 2}, {-15, -15, 2})}, below}, {}, {"below"});
  add("sheet_hides_nothing_for_it_is_no_solid",
      {{"sheet", sheet({-15, -15, 2}, {15, -15, 2}, {15, 15, 2}, {-15, 15, 2})}, below}, {}, {"below"});
  add("box_open_at_the_bottom_is_no_solid_from_below",
      {{"box", together(together(sheet({-9, -9, 20}, {9, -9, 20}, {9, 9, 20}, {-9, 9, 20}),
                                 together(sheet({-9, -9, 14}, {9, -9, 14}, {9, -9, 20}, {-9, -9, 20}),
                                          sheet({9, 9, 14}, {-9, 9, 14}, {-9, 9, 20}, {9, 9, 20}))),
                        together(sheet({9, -9, 14}, {9, 9, 14}, {9, 9, 20}, {9, -9, 20}),
                                 sheet({-9, 9, 14}, {-9, -9, 14}, {-9, -9, 20}, {-9, 9, 20})))},
       {"above", thing_at(0, 0, 40)}},
      {}, {"above"});
  add("two_slabs_together_hide_what_neither_does",
      {{"near", block({-20, -20, 2}, {1, 20, 4})}, {"far", block({-1, -20, -2}, {20, 20, 1})}, below}, {"below"}, {});
  add("two_slabs_with_a_gap_between",
      {{"near", block({-20, -20, 2}, {-1, 20, 4})}, {"far", block({1, -20, -2}, {20, 20, 1})}, below}, {}, {"below"});
  add("cage_of_bars_above",
      {{"bars",
        [] {
          Mesh bars;
          for (float y = -10; y <= 10; y += 0.2F) append(bars, block({-10, y, 2}, {10, y + 0.05F, 2.5F}));
          return bars;
        }()},
       below},
      {}, {"below"});
  return all;
}

class WhoSeesWhomInTheAir : public testing::TestWithParam<Situation> {};

TEST_P(WhoSeesWhomInTheAir, is_as_the_situation_says) { expect_as_said(GetParam(), {"umbra"}); }

INSTANTIATE_TEST_SUITE_P(Umbra, WhoSeesWhomInTheAir, testing::ValuesIn(situations_in_the_air()),
                         [](const auto& param_info) { return param_info.param.name; });

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

TEST(SolidBoxes, lie_in_what_is_solid) {
  const SituationModel model({{"house", block({10, -10, 2}, {20, 10, 10})},
                              {"turned", turned_block({40, 0}, {9, 6}, 0, 12, 0.6F)},
                              {"sheet", sheet({-40, -9, 0}, {-20, -9, 0}, {-20, 9, 0}, {-40, 9, 0})}});
  JobMonitor monitor;
  const Result<std::vector<Box>> boxes = find_solid_boxes(model.reader(), {}, monitor);
  ASSERT_TRUE(boxes.ok());
  double in_house_m3 = 0, in_turned_m3 = 0;
  for (const Box& box : *boxes) {
    const glm::dvec3 size(box.size());
    const double volume_m3 = size.x * size.y * size.z;
    if (Box{{10, -10, 2}, {20, 10, 10}}.contains(box)) {
      in_house_m3 = std::max(in_house_m3, volume_m3);
      continue;
    }
    in_turned_m3 = std::max(in_turned_m3, volume_m3);
    for (int i = 0; i < 4; ++i) {
      const glm::dvec2 corner((i & 1) != 0 ? box.max.x : box.min.x, (i & 2) != 0 ? box.max.y : box.min.y);
      const glm::dvec2 off = corner - glm::dvec2(40, 0);
      const double c = std::cos(0.6), s = std::sin(0.6);
      EXPECT_LE(std::abs(off.x * c + off.y * s), 9.001) << "sticks out of the turned block";
      EXPECT_LE(std::abs(off.y * c - off.x * s), 6.001);
    }
    EXPECT_GE(box.min.z, -0.001F);
    EXPECT_LE(box.max.z, 12.001F);
  }
  EXPECT_GT(in_house_m3, 0.85 * 10 * 20 * 8);
  EXPECT_GT(in_turned_m3, 0.3 * 18 * 12 * 12);
}

}  // namespace
}  // namespace promenade
