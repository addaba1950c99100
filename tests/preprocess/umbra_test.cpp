// Who sees whom past solid boxes that need not stand on the ground.

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
      {{"near", block({-20, -20, 2}, {6, 20, 4})},
       {"far", block({-6, -20, -2}, {20, 20, 1})},
       {"wide", block({-19, -1, -20}, {19, 1, -19})}},
      {"wide"}, {});
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

TEST_P(WhoSeesWhomInTheAir, is_as_umbra_says) { expect_as_said(GetParam(), {"umbra"}); }
TEST_P(WhoSeesWhomInTheAir, is_as_shrunk_says) { expect_as_said(GetParam(), {"shrunk"}); }

INSTANTIATE_TEST_SUITE_P(SolidBoxes, WhoSeesWhomInTheAir, testing::ValuesIn(situations_in_the_air()),
                         [](const auto& param_info) { return param_info.param.name; });

TEST(Umbra, closes_a_gap_between_two_shadows_by_halving_the_cell) {
  const std::pair<std::string, Mesh> near("near", block({-20, -20, 2}, {1, 20, 4})),
      far("far", block({-1, -20, -2}, {20, 20, 1})), below("below", thing_at(0, 0, -20));
  const Situation from_all{"two_slabs_that_overlap_less_than_the_cell", {near, far, below}, cell_in_the_air, {}, {}};
  Situation halved = from_all, whole = from_all;
  halved.hidden = whole.kept = {"below"};
  expect_as_said(halved, {"umbra"});
  expect_as_said(whole, {"shrunk"});
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
