#include "runtime/memory_fit.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "runtime/flight.h"
#include "runtime/node_sizes.h"
#include "tests/runtime/chooser.h"
#include "tests/runtime/null_renderer.h"

namespace promenade {
namespace {

using forest::Forest;
using scenes::ahead_pose, scenes::Chooser;

TEST(BytesByFactor, least_factor_that_fits_is_found) {
  BytesByFactor bytes;
  bytes.add(1.5, 100);
  bytes.add(3, 50);
  bytes.add(1e9, 10);  // a root
  EXPECT_EQ(bytes.at(1), 160U);
  EXPECT_EQ(bytes.at(2), 60U);
  EXPECT_EQ(bytes.at(100), 10U);
  EXPECT_EQ(bytes.fitting(160), 1);
  EXPECT_NEAR(bytes.fitting(159), 1.5, 0.07);
  EXPECT_NEAR(bytes.fitting(59), 3, 0.14);
  EXPECT_EQ(bytes.fitting(59, 5), 5) << "no less than the least";
  EXPECT_EQ(bytes.fitting(9), BytesByFactor::kCoarsest) << "nothing does";
  for (const uint64_t enough : {160U, 100U, 60U, 20U}) EXPECT_LE(bytes.at(bytes.fitting(enough)), enough);
}

TEST(MemoryFit, grows_at_once_and_falls_slowly) {
  BytesByFactor much, little;
  much.add(4, 100);
  little.add(4, 10);
  MemoryFit fit;
  fit.follow({much, {}, {}}, 50, false, false);
  EXPECT_GE(fit.asked, 4);
  EXPECT_LE(fit.asked, 4.5);
  EXPECT_EQ(fit.drawn, fit.asked);
  EXPECT_LE(much.at(fit.asked), 50U);
  double before = fit.asked;
  int frames = 0;
  for (; fit.drawn > 1 && frames < 1000; ++frames) {
    fit.follow({little, {}, {}}, 50, false, false);
    ASSERT_GE(fit.asked, before * 0.98);
    ASSERT_GE(fit.drawn, fit.asked) << "nothing is drawn that is not asked for";
    before = fit.asked;
  }
  EXPECT_GT(frames, 30);
  EXPECT_LT(frames, 300);
  EXPECT_EQ(fit.asked, 1);
}

TEST(MemoryFit, keeps_its_factor_while_what_fits_changes_a_little) {
  BytesByFactor one, other;
  one.add(4, 100);
  other.add(4.1, 100);
  MemoryFit fit;
  fit.follow({other, {}, {}}, 50, false, true);
  fit.follow({other, {}, {}}, 50, false, false);
  const double kept = fit.asked;
  for (int i = 0; i < 20; ++i) {
    fit.follow({i % 2 == 0 ? one : other, {}, {}}, 50, false, false);
    EXPECT_EQ(fit.asked, kept);
  }
}

TEST(MemoryFit, the_next_cell_is_entered_at_the_factor_that_it_was_foreseen_with) {
  BytesByFactor here, elsewhere;
  here.add(8, 20);
  elsewhere.add(8, 100);
  MemoryFit fit;
  for (int i = 0; i < 3; ++i) fit.follow({here, {}, elsewhere}, 50, false, false);
  EXPECT_EQ(fit.asked, 1) << "what is seen here fits";
  EXPECT_GE(fit.elsewhere, 8);
  const double foreseen = fit.elsewhere;
  fit.follow({elsewhere, {}, {}}, 50, true, false);
  EXPECT_GE(fit.asked, foreseen);
  EXPECT_EQ(fit.drawn, fit.asked);
  fit.follow({here, {}, {}}, 50, false, true);
  EXPECT_EQ(fit.asked, 1) << "after a jump nothing of that holds";
  EXPECT_EQ(fit.drawn, 1);
}

TEST(MemoryFit, what_is_drawn_gives_way_to_what_is_foreseen_by_half_at_most) {
  BytesByFactor view, little, much;
  view.add(8, 40);
  little.add(1.4, 100);
  much.add(8, 100);
  MemoryFit fit;
  fit.follow({view, little, {}}, 50, false, true);
  EXPECT_NEAR(fit.asked, 1.4, 0.07);
  EXPECT_EQ(fit.cell, fit.asked);
  fit.follow({view, much, {}}, 50, false, true);
  EXPECT_EQ(fit.asked, 1.5);
  EXPECT_GE(fit.cell, 8);
  EXPECT_GE(fit.elsewhere, fit.cell);
}

TEST(MemoryFit, gives_way_little_where_that_gains_little) {
  BytesByFactor view;
  view.add(1e9, 40);  // must be there whatever is drawn
  view.add(20, 15);
  MemoryFit fit;
  fit.follow({view, {}, {}}, 50, false, true);
  EXPECT_DOUBLE_EQ(fit.asked, 1.1 * 1.1) << "not the factor of 20 at which it would fit";
  fit.follow({view, {}, {}}, 45, false, true);
  EXPECT_NEAR(fit.asked, 20, 1) << "a fifth too large is no small matter";
}

TEST(BytesAsked, a_picture_that_nodes_share_counts_once_for_who_needs_it_most) {
  Forest model;
  const NodeId top = model.root(ahead_pose, 1);
  const std::vector<NodeId> children = model.split(top, 2, 0);
  model.texture(8, children);
  const MemoryBudget budget{0, {1, 10, 10}, {1000}};
  std::vector<AheadNode> scratch;
  const BytesAsked asked = bytes_asked(
      model.model(), budget,
      {{top, 1e9F, AskedBy::view}, {children[0], 2, AskedBy::view}, {children[1], 4, AskedBy::elsewhere}}, scratch);
  EXPECT_EQ(asked.view.at(1), 1011U);
  EXPECT_EQ(asked.view.at(3), 1U);
  EXPECT_EQ(asked.cell.at(1), 0U);
  EXPECT_EQ(asked.elsewhere.at(1), 10U) << "the picture is needed here already";
}

TEST(NodeSizes, what_is_not_known_is_as_far_below_its_bound_as_what_is) {
  Forest model;
  const NodeId top = model.root(ahead_pose, 1);
  const std::vector<NodeId> children = model.split(top, 2, 0, 3000);
  const NullRenderer renderer;
  NodeSizes sizes(model.model(), renderer, {});
  const uint32_t bound = sizes.budget().node_bytes[0], child_bound = sizes.budget().node_bytes[1];
  EXPECT_EQ(bound, renderer.mesh_bytes_bound(4, 1000));
  sizes.learn(top, bound / 4);
  EXPECT_EQ(sizes.budget().node_bytes[0], bound / 4);
  EXPECT_NEAR(sizes.budget().node_bytes[1], child_bound / 4.0, 2);
  sizes.learn(children[0], 77);
  EXPECT_EQ(sizes.budget().node_bytes[1], 77U);
}

/// A wall seen whole, of which a finer front takes more bytes.
struct Wall : Forest {
  Wall() { grow(root(ahead_pose, 8), 3, 4); }
};

MemoryBudget room_for(const Forest& model, uint64_t nodes) {
  return {nodes * 100, std::vector<uint32_t>(model.model().tables.nodes.size(), 100), {}};
}

constexpr Policy kThatGiveWay[] = {Policy::static_error, Policy::feedback,    Policy::cost_benefit,
                                   Policy::vlod,         Policy::time_slices, Policy::vlod_time_slices};

TEST(FittingFront, all_that_is_asked_for_fits) {
  const Wall model;
  for (const Policy policy : kThatGiveWay)
    for (const uint64_t nodes : {1U, 5U, 20U, 60U}) {
      const MemoryBudget room = room_for(model, nodes);
      Chooser choose(model);
      choose.options.policy = policy;
      choose.options.pixel_error = 0.1;
      choose.options.time.target_ms = 1e6;
      choose.view.memory = &room;
      choose();
      EXPECT_LE(choose.selection.updates.size(), nodes) << name_of(policy);
      EXPECT_GT(choose.selection.coarser, 1) << name_of(policy);
      // With what it asked for in memory, and nothing else, nothing is missing.
      std::fill(choose.resident.begin(), choose.resident.end(), uint8_t(0));
      for (int frame = 0; frame < 50; ++frame) {
        for (const PriorityUpdate& u : choose.selection.updates) choose.resident[index_of(u.node)] = 1;
        choose();
      }
      EXPECT_EQ(choose.selection.nodes_missing, 0U) << name_of(policy);
    }
}

TEST(FittingFront, nothing_gives_way_where_memory_suffices) {
  const Wall model;
  const MemoryBudget room = room_for(model, model.model().tables.nodes.size());
  for (const Policy policy : all_policies()) {
    if (uses_far(policy)) continue;
    Chooser with(model), without(model);
    with.options.policy = without.options.policy = policy;
    with.options.pixel_error = without.options.pixel_error = 0.1;
    with.view.memory = &room;
    for (int frame = 0; frame < 5; ++frame) EXPECT_EQ(with().front, without().front) << name_of(policy);
    EXPECT_EQ(with.selection.coarser, 1) << name_of(policy);
  }
}

TEST(FittingFront, published_policies_and_who_says_so_ask_in_vain) {
  const Wall model;
  const MemoryBudget room = room_for(model, 5);
  for (const Policy policy : {Policy::none, Policy::lakhia, Policy::front, Policy::static_error}) {
    Chooser choose(model);
    choose.options.policy = policy;
    choose.options.pixel_error = 0.1;
    choose.options.fit_memory = false;
    choose.view.memory = &room;
    EXPECT_GT(choose().updates.size(), 5U) << name_of(policy);
    choose.options.fit_memory = policy != Policy::static_error;
    EXPECT_GT(choose().updates.size(), 5U) << name_of(policy);
    EXPECT_EQ(choose.selection.coarser, 1) << name_of(policy);
  }
}

/// What is missing at the end of two seconds in front of the wall in a megabyte less than it takes.
uint64_t missing_in_short_memory(bool fit_memory) {
  const Wall model;
  NullRenderer renderer;
  JobMonitor monitor;
  CameraPath path;
  path.fps = 30;
  path.keys = {{0, {}}, {2, {}}};
  FlightOptions options;
  options.session.select.policy = Policy::static_error;
  options.session.select.pixel_error = 1.5;  // half of what the last level but one is off by
  options.session.select.fit_memory = fit_memory;
  options.session.loader_thread = false;
  options.session.loader.memory_bytes = 500000;  // 121 nodes of 6,112 bytes take 739,552
  options.width_px = options.height_px = 64;
  options.vertical_fov_deg = 90;
  const Result<FlightReport> report = fly(
      model, renderer, path, options, [](const FrameRow&, Renderer&) -> Status { return Done{}; }, monitor);
  EXPECT_TRUE(report) << report.error().message;
  if (!report) return 0;
  EXPECT_LE(report->totals.resident_bytes_peak, options.session.loader.memory_bytes);
  EXPECT_EQ(report->totals.coarsening_max > 1, fit_memory);
  return report->rows.back().nodes_missing;
}

TEST(FittingFront, nothing_is_missing_in_short_memory) {
  EXPECT_EQ(missing_in_short_memory(true), 0U);
  EXPECT_GT(missing_in_short_memory(false), 0U);
}

}  // namespace
}  // namespace promenade
