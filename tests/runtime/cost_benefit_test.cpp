#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "runtime/benefit.h"
#include "tests/runtime/chooser.h"

namespace promenade {
namespace {

using forest::Forest;
using scenes::ahead_pose;
using testing::ElementsAre, testing::UnorderedElementsAre;

constexpr double kMsPerCost = 1e-3;  // cost 500 for 1000 triangles: half a millisecond a node

/// With v_time for a clock.
struct Optimising : scenes::Chooser {
  explicit Optimising(const Forest& f) : Chooser(f) {
    options.policy = Policy::cost_benefit;
    options.pixel_error = 0;
    options.benefit.hysteresis_weight = 0;
    state.ms_per_cost = kMsPerCost;
  }
  const Selection& operator()(double target_ms) {
    options.time.target_ms = target_ms;
    return Chooser::operator()();
  }
  double benefit_of(NodeId id) const {
    const Sight sight(source.model(), view, options);
    return Benefit(source.model(), sight, view, options).of(id, true);
  }
  double front_benefit() const {
    double sum = 0;
    for (const NodeId id : selection.front) sum += benefit_of(id);
    return sum;
  }
};

struct Value {
  double benefit, ms;
};

/// Every front below a node, by benefit and time.
std::vector<Value> all_fronts(const Optimising& o, NodeId id) {
  const Model& model = o.source.model();
  const NodeRecord& node = model.tables.nodes[index_of(id)];
  std::vector<Value> fronts = {{o.benefit_of(id), kMsPerCost * node_cost(node, o.options.time)}};
  if (node.child_count == 0) return fronts;
  std::vector<Value> together = {{0, 0}};
  for (const NodeId child : model.children_of(id)) {
    std::vector<Value> next;
    for (const Value& rest : together)
      for (const Value& own : all_fronts(o, child)) next.push_back({rest.benefit + own.benefit, rest.ms + own.ms});
    together = std::move(next);
  }
  fronts.insert(fronts.end(), together.begin(), together.end());
  return fronts;
}

double best_benefit(const Optimising& o, double budget_ms) {
  std::vector<Value> together = {{0, 0}};
  for (const NodeId root : o.source.model().tables.roots) {
    std::vector<Value> next;
    for (const Value& rest : together)
      for (const Value& own : all_fronts(o, root)) next.push_back({rest.benefit + own.benefit, rest.ms + own.ms});
    together = std::move(next);
  }
  double best = 0;
  for (const Value& front : together)
    if (front.ms <= budget_ms) best = std::max(best, front.benefit);
  return best;
}

/// A tree whose nodes have random sizes: small enough to try every front.
struct Thicket : Forest {
  explicit Thicket(uint32_t seed) {
    std::mt19937 twister(seed);
    const auto random = [&twister] { return static_cast<uint32_t>(twister()); };
    for (int tree = 0; tree < 2; ++tree) {
      const float y = tree == 0 ? -8.0F : 0.0F;
      const NodeId top = root({{10, y, -1}, {10.5F, y + 8, 1}}, 4, 200);
      for (const NodeId child : split(top, 2 + random() % 2, 2, 200 + random() % 800))
        if (random() % 3 != 0) split(child, 2, 0, 200 + random() % 800);
    }
  }
};

TEST(CostBenefit, is_at_least_half_as_good_as_trying_every_front) {
  double worst = 1;
  double sum = 0;
  int tried = 0;
  for (uint32_t seed = 1; seed <= 40; ++seed) {
    const Thicket model(seed);
    for (const double target_ms : {0.5, 1.0, 1.5, 2.5, 100.0}) {
      Optimising optimise(model);
      optimise(target_ms);
      const double best = best_benefit(optimise, target_ms);
      ASSERT_GT(best, 0);
      ASSERT_LE(optimise.selection.cost * kMsPerCost, std::max(target_ms, 0.2) + 1e-9) << seed;
      const double share = optimise.front_benefit() / best;
      worst = std::min(worst, share);
      sum += share;
      ++tried;
    }
  }
  EXPECT_GE(worst, 0.5) << "[funkhouser1993]: at least half as good as the optimum";
  EXPECT_GE(sum / tried, 0.95);
}

TEST(CostBenefit, takes_everything_when_there_is_time) {
  const Thicket model(7);
  Optimising optimise(model);
  optimise(1e6);
  for (const NodeId id : optimise.selection.front) EXPECT_EQ(model.model().tables.nodes[index_of(id)].child_count, 0U);
}

TEST(CostBenefit, goes_on_from_the_last_front) {
  Forest model;
  model.grow(model.root(ahead_pose, 8), 4, 4);
  Optimising optimise(model);
  optimise(30);
  const std::vector<NodeId> first = optimise.selection.front;
  const uint64_t cold = optimise.selection.optimisation_steps;
  optimise(30);
  EXPECT_EQ(optimise.selection.front, first);
  EXPECT_GT(cold, 10U);
  EXPECT_LE(optimise.selection.optimisation_steps, 2U) << "one step there and back";
}

TEST(CostBenefit, hysteresis_keeps_levels_that_are_shown) {
  Forest model;
  model.grow(model.root({{10, -8, -1}, {10.5F, 0, 1}}, 8), 2, 2);
  model.grow(model.root({{10, 0, -1}, {10.5F, 8, 1}}, 8), 2, 2);
  Optimising optimise(model);
  optimise.options.benefit.hysteresis_weight = 0.3;
  optimise(2.0);
  uint64_t toggles = 0;
  for (int i = 0; i < 20; ++i) {  // the time that is left wavers a little
    optimise(2.0 + 0.02 * (i % 2));
    toggles += optimise.selection.toggles_up + optimise.selection.toggles_down;
  }
  EXPECT_EQ(toggles, 0U);
}

TEST(CostBenefit, missing_children_keep_their_parent) {
  Forest model;
  const NodeId top = model.root(ahead_pose, 1);
  const std::vector<NodeId> children = model.split(top, 2, 0);
  Optimising optimise(model);
  optimise.resident[index_of(children[0])] = 0;
  EXPECT_THAT(optimise(100).front, ElementsAre(top));
  EXPECT_EQ(optimise.selection.nodes_missing, 1U);
  optimise.resident[index_of(children[0])] = 1;
  EXPECT_THAT(optimise(100).front, UnorderedElementsAre(children[0], children[1]));
  EXPECT_EQ(optimise.selection.toggles_up, 1U);
  EXPECT_EQ(optimise.selection.toggles_loading, 1U);
}

TEST(CostBenefit, factors_are_what_the_thesis_says) {
  Forest model;
  const NodeId near = model.root({{10, -1, -1}, {11, 1, 1}}, 0.5), far = model.root({{100, -1, -1}, {101, 1, 1}}, 0.5);
  const NodeId beside = model.root({{10, 7, -1}, {11, 9, 1}}, 0.5);
  Optimising o(model);
  const std::vector<float> importance = {0.25F, 1, 1};
  o.view.importance = importance;
  o.view.velocity_m_per_s = {0, 30, 0};
  const Sight sight(model.model(), o.view, o.options);
  const Benefit benefit(model.model(), sight, o.view, o.options);
  EXPECT_NEAR(benefit.size_px(near) / benefit.size_px(far), 100, 1e-3) << "by the square of the distance";
  EXPECT_LT(benefit.accuracy(near), benefit.accuracy(far)) << "the same error shows less from afar";
  EXPECT_NEAR(benefit.importance(near), 0.25, 1e-6);
  EXPECT_NEAR(benefit.focus(near), 1, 1e-6);
  EXPECT_LT(benefit.focus(beside), 1);
  EXPECT_LT(benefit.motion(near), benefit.motion(far)) << "what is near flies by";
  EXPECT_NEAR(benefit.of(near, false) / benefit.of(near, true), 1, 1e-9) << "its weight is 0 here";
  o.options.benefit.hysteresis_weight = 0.2;
  EXPECT_NEAR(benefit.of(near, false) / benefit.of(near, true), 0.8, 1e-9);
}

TEST(Feedback, policy_feedback_coarsens_after_slow_frames_and_comes_back) {
  Forest model;
  model.grow(model.root(ahead_pose, 8), 4, 4);
  Optimising choose(model);
  choose.options.policy = Policy::feedback;
  choose.options.pixel_error = 1;
  choose(10);
  const size_t fine = choose.selection.front.size();
  for (int i = 0; i < 20; ++i) {
    feed_back(choose.selection, 40, 40, choose.options.time, choose.state);
    choose(10);
  }
  EXPECT_LT(choose.selection.front.size(), fine);
  for (int i = 0; i < 60; ++i) {
    feed_back(choose.selection, 2, 2, choose.options.time, choose.state);
    choose(10);
  }
  EXPECT_EQ(choose.selection.front.size(), fine) << "never finer than asked for";
}

}  // namespace
}  // namespace promenade
