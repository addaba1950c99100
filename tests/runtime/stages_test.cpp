// Frames ahead: queues between stages, and a session whose frames are chosen beside the drawing.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <numeric>
#include <random>
#include <thread>

#include "runtime/bounded_queue.h"
#include "runtime/flight.h"
#include "tests/runtime/forest.h"
#include "tests/runtime/null_renderer.h"
#include "tests/runtime/scenes.h"

namespace promenade {
namespace {

using forest::Forest;

TEST(BoundedQueue, gives_in_order_and_makes_the_fast_side_wait) {
  BoundedQueue<int> queue(2);
  std::atomic<int> put{0};
  std::thread producer([&] {
    for (int i = 0; i < 100; ++i) {
      ASSERT_TRUE(queue.put(i));
      ++put;
    }
  });
  std::vector<int> taken;
  for (int i = 0; i < 100; ++i) {
    EXPECT_LE(queue.size(), 2U);
    taken.push_back(*queue.take());
    EXPECT_LE(put.load(), i + 1 + 2 + 1) << "no more than the queue holds, and one on its way";
  }
  producer.join();
  std::vector<int> expected(100);
  std::iota(expected.begin(), expected.end(), 0);
  EXPECT_EQ(taken, expected);
  EXPECT_FALSE(queue.take_if_there());
}

TEST(BoundedQueue, closed_lets_go_of_everyone_and_still_gives_what_it_has) {
  BoundedQueue<std::unique_ptr<int>> full(1), empty(1);
  ASSERT_TRUE(full.put(std::make_unique<int>(7)));
  std::thread putting([&] { EXPECT_FALSE(full.put(std::make_unique<int>(8))); });
  std::thread taking([&] { EXPECT_FALSE(empty.take()); });
  full.close();
  empty.close();
  putting.join();
  taking.join();
  EXPECT_EQ(**full.take(), 7);
  EXPECT_FALSE(full.take());
  EXPECT_FALSE(full.put(nullptr));
}

struct Wood : Forest {
  Wood() { grow(root({{10, -8, -1}, {10.5F, 8, 1}}, 2), 3, 3); }
};

SessionOptions ahead(uint32_t frames, uint64_t memory_bytes = uint64_t(64) << 20) {
  SessionOptions options;
  options.select.policy = Policy::static_error;
  options.loader.memory_bytes = memory_bytes;
  options.loader.piece_bytes = 300;
  options.frames_ahead = frames;
  return options;
}

TEST(FramesAhead, are_drawn_in_the_order_in_which_they_were_asked_for) {
  const Wood wood;
  NullRenderer renderer;
  Result<Session> session = Session::open(wood, renderer, ahead(3));
  ASSERT_TRUE(session) << session.error().message;
  Camera camera = scenes::looking_along_x();
  std::vector<double> drawn_at;
  for (int i = 0; i < 20; ++i) {
    camera.pose.eye.x = -i;
    session->ask(camera, 0.1);
    if (session->frames_asked() <= session->frames_ahead()) continue;
    const Result<FrameRow> row = session->draw_next();
    ASSERT_TRUE(row);
    EXPECT_EQ(row->frame, drawn_at.size());
    drawn_at.push_back(-session->camera_drawn().pose.eye.x);
  }
  EXPECT_EQ(session->frames_asked(), 3U);
  std::vector<double> expected(17);
  std::iota(expected.begin(), expected.end(), 0);
  EXPECT_EQ(drawn_at, expected);
}

TEST(FramesAhead, settle_to_what_is_drawn_one_after_the_other) {
  const Wood wood;
  for (const uint32_t frames : {0U, 1U, 4U}) {
    NullRenderer renderer;
    Result<Session> session = Session::open(wood, renderer, ahead(frames));
    ASSERT_TRUE(session);
    const Result<FrameRow> row = session->settle(scenes::looking_along_x());
    ASSERT_TRUE(row);
    EXPECT_EQ(row->nodes_drawn, 27U) << frames;
    EXPECT_EQ(row->nodes_missing, 0U);
  }
}

/// What is drawn has not been destroyed (NullRenderer asks), the memory bound holds, and the session can end with
/// frames on their way, while nodes come and go all the time.
TEST(FramesAhead, never_draw_what_has_left_memory) {
  Forest forest;
  for (float y = -60; y < 60; y += 20) forest.grow(forest.root({{10, y, -1}, {10.5F, y + 16, 1}}, 2), 3, 3);
  constexpr uint64_t kMemory = 700000;
  for (const uint32_t frames : {1U, 3U}) {
    NullRenderer renderer;
    uint64_t evicted = 0;
    {
      Result<Session> session = Session::open(forest, renderer, ahead(frames, kMemory));
      ASSERT_TRUE(session) << session.error().message;
      std::mt19937 random(frames);
      Camera camera = scenes::looking_along_x();
      for (int i = 0; i < 600; ++i) {
        if (i % 5 == 0)
          camera.pose.yaw_deg = double(random() % 140) - 70, camera.pose.eye.y = double(random() % 100) - 50;
        session->select_options().pixel_error = double(1 + random() % 3);
        session->ask(camera, 0.03);
        if (session->frames_asked() <= session->frames_ahead()) continue;
        ASSERT_TRUE(session->draw_next());
        ASSERT_LE(session->resident_bytes(), kMemory);
        if (i % 50 == 0) {
          ASSERT_TRUE(session->draw_from(camera));
        }
        if (i % 3 == 0) session->wait_for_loader();
      }
      evicted = session->loader_counts().nodes_evicted;
      EXPECT_LE(session->resident_bytes_peak(), kMemory);
      EXPECT_EQ(session->frames_asked(), frames) << "left over";
    }
    EXPECT_GT(evicted, 50U) << "the bound was no bound";
    EXPECT_EQ(renderer.bytes(), 0U) << "all handles given back";
  }
}

CameraPath standing() {
  CameraPath path;
  path.fps = 10;
  path.keys = {{0, {}}, {2, {}}};
  path.keys[1].pose.eye.y = 4;
  return path;
}

TEST(FramesAhead, fly_the_same_frames_and_answer_later) {
  const Wood wood;
  JobMonitor monitor;
  std::vector<std::vector<double>> times;
  for (const uint32_t frames : {0U, 2U}) {
    NullRenderer renderer;
    FlightOptions options;
    options.session = ahead(frames);
    options.width_px = options.height_px = 64;
    const auto nothing = [](const FrameRow&, Renderer&) -> Status { return Done{}; };
    const Result<FlightReport> report = fly(wood, renderer, standing(), options, nothing, monitor);
    ASSERT_TRUE(report) << report.error().message;
    ASSERT_EQ(report->rows.size(), 21U);
    std::vector<double>& t_s = times.emplace_back();
    for (const FrameRow& row : report->rows) {
      t_s.push_back(row.t_s);
      EXPECT_GE(row.response_ms, row.draw_ms);
      EXPECT_NEAR(row.frame_ms, row.upload_ms + row.draw_ms + (frames == 0 ? row.select_ms : row.wait_ms), 2);
      if (frames == 0) {
        EXPECT_EQ(row.wait_ms, 0);
      }
    }
    EXPECT_GT(report->totals.response_ms_mean, 0);
    EXPECT_EQ(report->rows.back().nodes_missing, 0U);
    EXPECT_EQ(renderer.bytes(), 0U);
  }
  EXPECT_EQ(times[0], times[1]);
}

TEST(FramesAhead, wait_in_the_queue_while_drawing_is_slowest) {
  const Wood wood;
  JobMonitor monitor;
  for (const uint32_t frames : {0U, 1U, 4U}) {
    NullRenderer renderer;
    renderer.draw_takes = std::chrono::milliseconds(4);
    FlightOptions options;
    options.session = ahead(frames);
    options.width_px = options.height_px = 64;
    options.settle_first = true;
    const auto nothing = [](const FrameRow&, Renderer&) -> Status { return Done{}; };
    const Result<FlightReport> report = fly(wood, renderer, standing(), options, nothing, monitor);
    ASSERT_TRUE(report) << report.error().message;
    // The pose of a frame is read so many whole frames before it is shown.
    EXPECT_GE(report->totals.response_ms_p50, 4.0 * (1 + frames)) << frames;
  }
}

}  // namespace
}  // namespace promenade
