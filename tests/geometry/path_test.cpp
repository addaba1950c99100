#include "geometry/path.h"

#include <gtest/gtest.h>

namespace promenade {
namespace {

TEST(CameraPath, is_linear_between_keys_and_stands_still_outside) {
  const auto path = parse_path(R"({"fps": 10, "keys": [{"t": 1, "eye": [0,0,0], "yaw_deg": 350, "pitch_deg": 0},
                                                       {"t": 3, "eye": [4,0,0], "yaw_deg": 370, "pitch_deg": -10}]})",
                               "p");
  ASSERT_TRUE(path.ok());
  EXPECT_EQ(path->frame_count(), 21U);
  EXPECT_DOUBLE_EQ(pose_at(*path, 2).eye.x, 2);
  EXPECT_DOUBLE_EQ(pose_at(*path, 2).yaw_deg, 360);
  EXPECT_DOUBLE_EQ(pose_at(*path, 0).eye.x, 0);
  EXPECT_DOUBLE_EQ(pose_at(*path, 9).pitch_deg, -10);
  EXPECT_DOUBLE_EQ(pose_of_frame(*path, 10).eye.x, 2);
}

TEST(CameraPath, round_trips_through_json) {
  CameraPath path;
  path.fps = 25;
  path.keys = {{0, {{1.5, -2, 3}, 10, 20, 0}}, {2, {{448251.123, 5, 6}, -30, 0, 5}}};
  const auto read = parse_path(to_json(path), "p");
  ASSERT_TRUE(read.ok());
  EXPECT_EQ(read->keys[1].pose.eye, path.keys[1].pose.eye);
  EXPECT_EQ(read->keys[1].pose.roll_deg, 5);
  EXPECT_EQ(read->fps, 25);
}

TEST(CameraPath, refuses_bad_text_and_says_where) {
  const char* bad[] = {"",
                       "[]",
                       "{\"keys\": []}",
                       R"({"keys": [{"t": 0}]})",
                       R"({"keys": [{"t": 0, "eye": [1, 2]}]})",
                       R"({"fps": 0, "keys": [{"t": 0, "eye": [1, 2, 3]}]})",
                       R"({"keys": [{"t": 0, "eye": [1, 2, null]}]})",
                       R"({"keys": [{"t": 0, "eye": [1,2,3]}, {"t": 0, "eye": [1,2,3]}]})",
                       R"({"keys": [{"t": 0, "eye": [1,2,1e999]}]})"};
  for (const char* text : bad) {
    const auto path = parse_path(text, "walk.json");
    ASSERT_FALSE(path.ok()) << text;
    EXPECT_EQ(path.error().message.rfind("walk.json: ", 0), 0U) << path.error().message;
  }
}

TEST(StopsAlong, stands_at_places_of_the_whole_path) {
  CameraPath path;
  path.fps = 10;
  path.keys = {{5, {{0, 0, 0}, 0, 0}}, {15, {{100, 0, 0}, 0, 0}}};
  const CameraPath stops = stops_along(path, 2, 6);
  ASSERT_EQ(stops.frame_count(), 60U);
  for (uint32_t frame = 0; frame < 60; ++frame)
    EXPECT_DOUBLE_EQ(pose_of_frame(stops, frame).eye.x, frame < 20 ? 0 : frame < 40 ? 50 : 100) << frame;
  EXPECT_EQ(stops_along(path, 1e-9, 1).frame_count(), 10U) << "a frame each";
  EXPECT_EQ(stops_along(path, 2, 0).frame_count(), 100U) << "as long as the path";
  EXPECT_EQ(stops_along(path, 1e9, 0).keys.front().pose.eye.x, 0) << "one place";
  EXPECT_TRUE(stops_along({}, 1, 1).keys.empty());
}

}  // namespace
}  // namespace promenade
