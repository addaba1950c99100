#include "layout/cell_front.h"

#include <gtest/gtest.h>

#include <set>

#include "tests/layout/cell_fixtures.h"
#include "tests/layout/model_fixtures.h"

namespace promenade {
namespace {

/// A street of 64 houses along x, 10 m each, halved again and again; errors double with each level.
Model street() {
  Model model;
  ModelTables& tables = model.tables;
  constexpr uint32_t kLevels = 7;
  const auto add = [&tables](uint32_t level, uint32_t place) {
    const float width = 640.0F / float(1U << level);
    const Box box{{width * float(place), 5, 0}, {width * float(place + 1), 9, 8}};
    const float error_m = level + 1 == kLevels ? 0 : 0.01F * float(1U << (kLevels - 2 - level));
    const NodeId parent = level == 0 ? kNoNode : NodeId{(1U << (level - 1)) - 1 + place / 2};
    tables.nodes.push_back(node_with(box, error_m, level, parent, 0));
  };
  for (uint32_t level = 0; level < kLevels; ++level)
    for (uint32_t place = 0; place < 1U << level; ++place) add(level, place);
  for (uint32_t i = 0; 2 * i + 2 < tables.nodes.size(); ++i) {
    tables.nodes[i].first_child = static_cast<uint32_t>(tables.children.size());
    tables.nodes[i].child_count = 2;
    tables.children.push_back(NodeId{2 * i + 1});
    tables.children.push_back(NodeId{2 * i + 2});
  }
  tables.roots = {NodeId{0}};
  return model;
}

TEST(CellFront, is_the_coarsest_within_the_bound_and_cuts_every_path_once) {
  const Model model = street();
  const FrontBound bound = one_pixel();
  for (const Box& cell : {Box{{0, 0, 0}, {8, 4, 2}}, Box{{300, 0, 0}, {308, 4, 2}}, Box{{0, -900, 0}, {9, -890, 20}},
                          Box{{100, 5, 1}, {101, 6, 2}}}) {
    const std::vector<NodeId> front = cell_front(model, cell, bound);
    EXPECT_TRUE(std::is_sorted(front.begin(), front.end()));
    const std::set<NodeId> members(front.begin(), front.end());
    const auto fits = [&](NodeId id) {
      const NodeRecord& node = model.tables.nodes[index_of(id)];
      return double(node.error_m) <= allowed_error_m(cell, node.box, bound.pixel_error, bound.scale);
    };
    for (uint32_t i = 0; i < model.tables.nodes.size(); ++i) {
      if (model.tables.nodes[i].child_count != 0) continue;
      int met = 0;
      for (NodeId at{i}; at != kNoNode; at = model.tables.nodes[index_of(at)].parent)
        met += members.contains(at) ? 1 : 0;
      EXPECT_EQ(met, 1) << "leaf " << i;
    }
    for (const NodeId id : front) {
      EXPECT_TRUE(fits(id) || model.tables.nodes[index_of(id)].child_count == 0);
      const NodeId parent = model.tables.nodes[index_of(id)].parent;
      EXPECT_TRUE(parent == kNoNode || !fits(parent)) << "a coarser one would do";
    }
  }
}

TEST(CellFront, of_a_part_is_no_finer) {
  const Model model = street();
  const Box whole{{100, 0, 0}, {200, 4, 4}}, part{{150, 0, 0}, {175, 2, 2}};
  EXPECT_LE(cell_front(model, part, one_pixel()).size(), cell_front(model, whole, one_pixel()).size());
}

TEST(CellFront, is_finer_for_a_finer_bound) {
  const Model model = street();
  const Box cell{{0, 0, 0}, {8, 4, 2}};
  FrontBound bound = one_pixel();
  const size_t coarse = cell_front(model, cell, bound).size();
  bound.pixel_error = 0.1;
  const size_t fine = cell_front(model, cell, bound).size();
  EXPECT_GT(fine, coarse);
  bound.pixel_error = 1e9;
  EXPECT_EQ(cell_front(model, cell, bound).size(), 1U);
}

}  // namespace
}  // namespace promenade
