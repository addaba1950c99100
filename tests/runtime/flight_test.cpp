#include "runtime/flight.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "runtime/brute_force.h"
#include "runtime/gl_renderer.h"
#include "tests/runtime/forest.h"
#include "tests/runtime/null_renderer.h"
#include "tests/runtime/scenes.h"

namespace promenade {
namespace {

using forest::Forest;

const Box ahead_pose{{10, -8, -1}, {10.5F, 8, 1}};

struct Wood : Forest {
  Wood() { grow(root(ahead_pose, 2), 3, 3); }
};

/// Two seconds of standing still, 10 frames a second.
CameraPath standing() {
  CameraPath path;
  path.fps = 10;
  path.keys = {{0, {}}, {2, {}}};
  return path;
}

FlightOptions stepped(Policy policy) {
  FlightOptions options;
  options.session.select.policy = policy;
  options.session.loader_thread = false;
  options.width_px = options.height_px = 64;
  options.vertical_fov_deg = 90;
  options.session.loader.memory_bytes = uint64_t(64) << 20;
  return options;
}

const FrameCallback nothing_there = [](const FrameRow&, Renderer&) -> Status { return Done{}; };

TEST(Flight, starts_with_roots_and_ends_with_all_detail) {
  Wood model;
  NullRenderer renderer;
  JobMonitor monitor;
  const Result<FlightReport> report =
      fly(model, renderer, standing(), stepped(Policy::static_error), nothing_there, monitor);
  ASSERT_TRUE(report) << report.error().message;
  ASSERT_EQ(report->rows.size(), 21U);
  EXPECT_EQ(report->rows.front().nodes_drawn, 1U);
  EXPECT_GT(report->rows.front().nodes_missing, 0U);
  EXPECT_EQ(report->rows.back().nodes_drawn, 27U);
  EXPECT_EQ(report->rows.back().nodes_missing, 0U);
  EXPECT_GT(report->totals.toggles_per_frame, 0);
  EXPECT_EQ(report->totals.bytes_read, 40U * 1000U);
  // The 27 leaves and the root; of the inner nodes those that a slow machine showed on the way.
  EXPECT_GE(report->totals.bytes_read_useful, 28U * 1000U);
  EXPECT_LE(report->totals.bytes_read_useful, report->totals.bytes_read);
  EXPECT_LE(report->totals.resident_bytes_peak, uint64_t(64) << 20);
  EXPECT_GT(report->totals.peak_rss_bytes, 1000000U);
  EXPECT_EQ(renderer.bytes(), 0U) << "all handles given back";
}

TEST(Flight, slow_disk_gives_as_much_as_path_time_allows) {
  Wood model;
  NullRenderer renderer;
  JobMonitor monitor;
  FlightOptions options = stepped(Policy::static_error);
  options.session.loader.disk_mbps = 0.01;  // a segment a path frame, however fast frames are drawn
  const Result<FlightReport> report = fly(model, renderer, standing(), options, nothing_there, monitor);
  ASSERT_TRUE(report);
  EXPECT_NEAR(double(report->totals.bytes_read), 21 * 1000, 2000);
  EXPECT_GT(report->rows.back().nodes_missing, 0U);
}

TEST(Flight, every_policy_flies_with_and_without_a_thread) {
  Wood model;
  JobMonitor monitor;
  for (const Policy policy : all_policies())
    for (const bool thread : {false, true}) {
      if (uses_far(policy)) continue;  // far_test.cpp: only in models with far pictures
      NullRenderer renderer;
      FlightOptions options = stepped(policy);
      options.session.loader_thread = thread;
      const Result<FlightReport> report = fly(model, renderer, standing(), options, nothing_there, monitor);
      ASSERT_TRUE(report) << report.error().message;
      EXPECT_EQ(report->rows.back().nodes_drawn, 27U) << name_of(policy);
    }
}

TEST(Flight, settled_starts_with_all_detail_and_foretells_by_costs) {
  Wood model;
  NullRenderer renderer;
  JobMonitor monitor;
  FlightOptions options = stepped(Policy::static_error);
  options.settle_first = true;
  options.redraw_every = 5;
  options.session.draw_costs = DrawCosts{{1e-3, 1e-4, 1e-6, 1e-3, 0}, false};
  const Result<FlightReport> report = fly(model, renderer, standing(), options, nothing_there, monitor);
  ASSERT_TRUE(report) << report.error().message;
  EXPECT_EQ(report->rows.front().frame, 0U);
  EXPECT_EQ(report->rows.front().nodes_drawn, 27U);
  EXPECT_EQ(report->totals.toggles_per_frame, 0);
  EXPECT_GT(report->rows.front().redraw_ms, 0);
  EXPECT_EQ(report->rows[1].redraw_ms, 0);
  for (const FrameRow& row : report->rows) EXPECT_GT(row.estimated_ms, 0);
}

TEST(Flight, switches_fade_for_as_many_frames_as_asked) {
  Wood model;
  JobMonitor monitor;
  uint64_t faded = 0;
  for (const uint32_t frames : {0U, 3U}) {
    NullRenderer renderer;
    FlightOptions options = stepped(Policy::static_error);
    options.session.fade_frames = frames;
    const Result<FlightReport> report = fly(model, renderer, standing(), options, nothing_there, monitor);
    ASSERT_TRUE(report);
    faded = 0;
    for (const FrameRow& row : report->rows) faded += row.nodes_fading > 0 ? 1 : 0;
    if (frames == 0) {
      EXPECT_EQ(faded, 0U);
    }
  }
  EXPECT_GE(faded, 3U);
}

TEST(Flight, toggles_while_loading_are_told_apart) {
  Wood model;
  NullRenderer renderer;
  JobMonitor monitor;
  const Result<FlightReport> report =
      fly(model, renderer, standing(), stepped(Policy::static_error), nothing_there, monitor);
  ASSERT_TRUE(report);
  EXPECT_GT(report->totals.toggles_loading, 0U);
  EXPECT_EQ(double(report->totals.toggles_loading), report->totals.toggles_per_frame * double(report->totals.frames));
}

TEST(Flight, real_time_takes_as_long_as_the_path) {
  Wood model;
  NullRenderer renderer;
  JobMonitor monitor;
  FlightOptions options = stepped(Policy::static_error);
  options.session.loader_thread = true;
  options.pacing = Pacing::real_time;
  CameraPath path = standing();
  path.fps = 100;
  path.keys[1].t_s = 0.1;
  const Result<FlightReport> report = fly(model, renderer, path, options, nothing_there, monitor);
  ASSERT_TRUE(report);
  EXPECT_GE(report->rows.back().t_s, 0.0);
  EXPECT_LE(report->rows.size(), 12U) << "no more than the path's own frames";
}

TEST(Flight, stops_with_the_callbacks_error_and_when_cancelled) {
  Wood model;
  NullRenderer renderer;
  JobMonitor monitor;
  const Result<FlightReport> failed = fly(
      model, renderer, standing(), stepped(Policy::none),
      [](const FrameRow& row, Renderer&) -> Status {
        if (row.frame == 2) return Error{"disk full"};
        return Done{};
      },
      monitor);
  ASSERT_FALSE(failed);
  EXPECT_EQ(failed.error().message, "disk full");
  struct Stopped : JobMonitor {
    bool cancelled() const override { return true; }
  } stopped;
  const Result<FlightReport> cancelled =
      fly(model, renderer, standing(), stepped(Policy::none), nothing_there, stopped);
  ASSERT_FALSE(cancelled);
  EXPECT_EQ(cancelled.error().message, "interrupted");
}

TEST(Flight, totals_are_nearest_rank_and_population) {
  std::vector<FrameRow> rows(4);
  const double ms[] = {10, 20, 30, 100};
  for (size_t i = 0; i < rows.size(); ++i) {
    rows[i].frame_ms = ms[i];
    rows[i].toggles = i;
  }
  const FlightTotals totals = totals_of(rows, 30);
  EXPECT_EQ(totals.frame_ms_p50, 20);
  EXPECT_EQ(totals.frame_ms_p99, 100);
  EXPECT_NEAR(totals.frame_ms_stddev, 35.3553, 1e-3);
  EXPECT_EQ(totals.toggles_per_frame, 1.5);
  EXPECT_EQ(totals.stalls, 1U);
}

std::vector<FrameRow> rows_of(const std::vector<std::pair<double, uint64_t>>& moved_and_missing) {
  std::vector<FrameRow> rows;
  for (const auto& [moved_m, missing] : moved_and_missing) {
    FrameRow& row = rows.emplace_back();
    row.t_s = double(rows.size()) * 0.1;
    row.moved_m = moved_m, row.nodes_missing = missing;
  }
  return rows;
}

TEST(Teleports, last_until_nothing_is_missing) {
  const std::vector<FrameRow> rows = rows_of({{0, 9}, {20, 9}, {31, 9}, {0, 4}, {0, 0}, {0, 3}, {500, 0}, {500, 1}});
  const Teleports found = teleports_of(rows);
  EXPECT_EQ(found.count, 3U) << "31 m in a tenth of a second is a jump, 20 are none";
  EXPECT_EQ(found.unfinished, 1U);
  EXPECT_NEAR(found.full_ms_mean, 100, 1e-9) << "200 ms and none";
  EXPECT_NEAR(found.full_ms_max, 200, 1e-9);
}

TEST(Teleports, cut_off_by_the_next_one_are_unfinished) {
  std::vector<FrameRow> rows = rows_of({{0, 0}, {90, 1}, {90, 1}, {0, 0}});
  rows[3].vlod_missing = true;
  EXPECT_EQ(teleports_of(rows).unfinished, 2U);
  rows[3].vlod_missing = false;
  EXPECT_EQ(teleports_of(rows).unfinished, 1U);
  EXPECT_EQ(teleports_of({}).count, 0U);
}

TEST(Flight, a_jump_is_no_speed_and_is_shown_in_the_next_frame) {
  const Wood wood;
  NullRenderer renderer;
  JobMonitor monitor;
  CameraPath path = standing();
  for (CameraPath::Key& key : path.keys) key.pose.eye.x = -1e5;
  path.keys[0].pose.eye.x = 0;
  path.keys.insert(path.keys.begin() + 1, {0.9, path.keys[0].pose});
  path.keys[1].t_s = 0.9;
  path.keys.insert(path.keys.begin() + 2, {1.0, path.keys.back().pose});
  const auto nothing = [](const FrameRow&, Renderer&) -> Status { return Done{}; };
  const Result<FlightReport> report = fly(wood, renderer, path, stepped(Policy::vlod_time_slices), nothing, monitor);
  ASSERT_TRUE(report) << report.error().message;
  EXPECT_EQ(report->totals.teleports.count, 1U);
  EXPECT_EQ(report->totals.teleports.unfinished, 0U);
  EXPECT_GT(report->rows[10].moved_m, 9e4);
}

TEST(Flight, empty_path_and_model_are_refused) {
  NullRenderer renderer;
  JobMonitor monitor;
  Wood wood;
  EXPECT_FALSE(fly(wood, renderer, CameraPath{}, stepped(Policy::none), nothing_there, monitor));
  Forest empty;
  EXPECT_FALSE(fly(empty, renderer, standing(), stepped(Policy::none), nothing_there, monitor));
}

// --- with pictures ------------------------------------------------------------------------------------------------

class Pictures : public testing::Test {
 protected:
  void SetUp() override {
    Result<std::unique_ptr<GlContext>> context = create_offscreen_context(OffscreenKind::osmesa);
    ASSERT_TRUE(context);
    context_ = std::move(*context);
    Result<std::unique_ptr<GlRenderer>> renderer = create_gl_renderer(*context_);
    ASSERT_TRUE(renderer);
    renderer_ = std::move(*renderer);
  }
  std::unique_ptr<GlContext> context_;
  std::unique_ptr<GlRenderer> renderer_;
};

TEST_F(Pictures, settled_session_shows_the_leaves) {
  Wood model;
  SessionOptions options;
  options.select.policy = Policy::static_error;
  options.loader.memory_bytes = uint64_t(64) << 20;
  {
    Result<Session> session = Session::open(model, *renderer_, options);
    ASSERT_TRUE(session) << session.error().message;
    const Result<FrameRow> row = session->settle(scenes::looking_along_x());
    ASSERT_TRUE(row);
    EXPECT_EQ(row->nodes_drawn, 27U);
    const std::vector<uint32_t> ids = *renderer_->read_nodes();
    std::set<uint32_t> seen;
    for (uint32_t x = 7; x < 57; ++x) seen.insert(ids[32 * 64 + x]);
    EXPECT_EQ(seen.size(), 27U) << "16 m of 20 m across 64 pixels, two pixels a leaf";
    for (const uint32_t id : seen) EXPECT_EQ(model.node(NodeId{id}).child_count, 0U);
  }
  EXPECT_EQ(renderer_->bytes(), 0U);
}

TEST_F(Pictures, brute_force_draws_instances_in_view) {
  const Mesh square = scenes::square_at(10, 1);
  const std::vector<Mesh> meshes = {square};
  const std::vector<Material> materials = {scenes::colored(200, 100, 50)};
  glm::mat4 left(1.0F), behind(1.0F);
  left[3] = {0, 5, 0, 1};
  behind[3] = {-100, 0, 0, 1};
  {
    BruteForceScene scene(*renderer_);
    const std::vector<PlacedMesh> placed = {{0, NodeId{1}, glm::mat4(1)}, {0, NodeId{2}, left}, {0, NodeId{3}, behind}};
    ASSERT_TRUE(scene.add(meshes, materials, {}, placed));
    FrameView view;
    view.camera = scenes::looking_along_x();
    ASSERT_TRUE(scene.draw(view));
    EXPECT_EQ(scene.nodes_drawn(), 2U);
    const std::vector<uint32_t> ids = *renderer_->read_nodes();
    EXPECT_EQ(ids[32 * 64 + 32], 1U);
    EXPECT_EQ(ids[32 * 64 + 16], 2U);
  }
  EXPECT_EQ(renderer_->bytes(), 0U);
}

}  // namespace
}  // namespace promenade
