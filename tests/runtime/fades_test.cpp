#include "runtime/fades.h"

#include <gtest/gtest.h>

#include <map>
#include <random>

#include "tests/runtime/forest.h"
#include "tests/runtime/scenes.h"

namespace promenade {
namespace {

using forest::Forest;

constexpr uint32_t kFrames = 4;

struct Fading {
  explicit Fading(const Forest& f)
      : source(f),
        fades(f.model()),
        resident(f.model().tables.nodes.size(), 1),
        frustum(frustum_of(scenes::looking_along_x(), glm::dvec3(0))) {}
  const std::vector<FadedNode>& operator()(const std::vector<NodeId>& front, uint32_t frames = kFrames) {
    fades.follow(front, resident, frustum, nullptr, frames, items);
    expect_whole();
    return items;
  }
  /// At every threshold each leaf in view is drawn exactly once: by itself or an ancestor.
  void expect_whole() const {
    const Model& model = source.model();
    for (float threshold = 1.0F / 128; threshold < 1; threshold += 1.0F / 64)
      for (uint32_t i = 0; i < model.tables.nodes.size(); ++i) {
        if (model.tables.nodes[i].child_count > 0) continue;
        if (classify(frustum, model.tables.nodes[i].box) == Overlap::outside) continue;
        int drawn = 0;
        for (NodeId at{i}; at != kNoNode; at = model.tables.nodes[index_of(at)].parent)
          for (const FadedNode& f : items) drawn += f.node == at && threshold >= f.from && threshold < f.to ? 1 : 0;
        ASSERT_EQ(drawn, 1) << "leaf " << i << " at " << threshold;
      }
  }
  float share_of(NodeId id) const {
    for (const FadedNode& f : items)
      if (f.node == id) return f.to - f.from;
    return 0;
  }

  const Forest& source;
  Fades fades;
  std::vector<uint8_t> resident;
  Frustum frustum;
  std::vector<FadedNode> items;
};

struct OneSplit : Forest {
  OneSplit() {
    top = root({{10, -8, -1}, {10.5F, 8, 1}}, 1);
    children = split(top, 2, 0);
  }
  NodeId top{};
  std::vector<NodeId> children;
};

TEST(Fades, run_from_a_node_to_its_children_and_back) {
  const OneSplit model;
  Fading fade(model);
  EXPECT_EQ(fade({model.top}).size(), 1U);
  float last = 1;
  for (uint32_t i = 0; i < kFrames; ++i) {
    ASSERT_EQ(fade(model.children).size(), 3U) << i;
    EXPECT_LT(fade.share_of(model.top), last);
    last = fade.share_of(model.top);
  }
  EXPECT_EQ(fade(model.children).size(), 2U) << "over";
  for (uint32_t i = 0; i < kFrames; ++i) {
    ASSERT_EQ(fade({model.top}).size(), 3U) << i;
    EXPECT_GT(fade.share_of(model.top), last - 0.01F);
    last = fade.share_of(model.top);
  }
  EXPECT_EQ(fade({model.top}).size(), 1U);
}

TEST(Fades, turn_around_where_they_are) {
  const OneSplit model;
  Fading fade(model);
  fade({model.top});
  fade(model.children);
  fade(model.children);
  const float there = fade.share_of(model.top);
  fade({model.top});
  EXPECT_NEAR(fade.share_of(model.top), there + 1.0F / (kFrames + 1), 1e-5);
}

TEST(Fades, zero_frames_switch_at_once) {
  const OneSplit model;
  Fading fade(model);
  fade({model.top}, 0);
  EXPECT_EQ(fade(model.children, 0).size(), 2U);
}

TEST(Fades, end_when_the_other_side_is_gone) {
  const OneSplit model;
  Fading fade(model);
  fade({model.top});
  fade(model.children);
  fade.resident[index_of(model.top)] = 0;
  EXPECT_EQ(fade(model.children).size(), 2U);
  fade.resident[index_of(model.top)] = 1;
  fade({model.top});
  EXPECT_EQ(fade.fades.running(), 1U);
  fade.resident[index_of(model.children[1])] = 0;
  EXPECT_EQ(fade({model.top}).size(), 1U);
}

TEST(Fades, what_comes_into_view_never_lies_in_a_hole) {
  Forest model;  // the last of four children lies left of the view at first
  const NodeId top = model.root({{10, -8, -1}, {10.5F, 40, 1}}, 5);
  const std::vector<NodeId> children = model.split(top, 4, 0);
  Fading fade(model);
  Camera camera = scenes::looking_along_x();
  fade({children[0], children[1]});
  camera.pose.yaw_deg = 30;  // and comes into it as the node is coarsened
  fade.frustum = frustum_of(camera, glm::dvec3(0));
  EXPECT_EQ(fade({top}).size(), 1U) << "no fade from what does not cover the view";
}

TEST(Fades, draw_every_place_once_whatever_fronts_come) {
  Forest model;
  model.grow(model.root({{10, -8, -1}, {10.5F, 8, 1}}, 8), 3, 3);
  const Model& m = model.model();
  Fading fade(model);
  std::mt19937 random(11);
  for (int round = 0; round < 300; ++round) {
    std::vector<NodeId> front, stack = m.tables.roots;
    while (!stack.empty()) {
      const NodeId id = stack.back();
      stack.pop_back();
      if (m.tables.nodes[index_of(id)].child_count > 0 && random() % 3 != 0)
        for (const NodeId child : m.children_of(id)) stack.push_back(child);
      else
        front.push_back(id);
    }
    const int still = int(random() % 4);
    for (int i = 0; i <= still; ++i) {
      fade(front);
      if (testing::Test::HasFatalFailure()) return;
    }
  }
}

}  // namespace
}  // namespace promenade
