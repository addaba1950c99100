#include "runtime/overlay.h"

#include <gtest/gtest.h>

#include <vector>

namespace promenade {
namespace {

/// From zero along +y; a metre at ten metres is ten pixels.
RasterView view() {
  RasterView v;
  v.width_px = 200, v.height_px = 100;
  v.scale_px = 100;
  return v;
}

std::vector<Line> lines_of_box(const Box& box) {
  std::vector<Line> lines;
  draw_box(view(), box, [&](const Line& line) { lines.push_back(line); });
  return lines;
}

TEST(Overlay, a_line_stands_where_its_ends_are_seen) {
  std::vector<Line> lines;
  draw_line(view(), {-1, 10, 2}, {1, 10, 2}, [&](const Line& line) { lines.push_back(line); });
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_NEAR(lines[0][0].x, 90, 1e-4);
  EXPECT_NEAR(lines[0][0].y, 30, 1e-4);
  EXPECT_NEAR(lines[0][1].x, 110, 1e-4);
}

TEST(Overlay, what_is_behind_is_left_out_and_what_crosses_is_cut) {
  std::vector<Line> lines;
  const auto keep = [&](const Line& line) { lines.push_back(line); };
  draw_line(view(), {0, -5, 0}, {0, -1, 0}, keep);
  EXPECT_TRUE(lines.empty());
  draw_line(view(), {1, -10, 0}, {1, 10, 0}, keep);
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_NEAR(lines[0][0].x, 100 + 1 / view().near_m * 100, 0.1) << "at the near plane";
  EXPECT_NEAR(lines[0][1].x, 110, 1e-4);
}

TEST(Overlay, a_box_has_twelve_edges) {
  EXPECT_EQ(lines_of_box({{-1, 10, -1}, {1, 12, 1}}).size(), 12U);
  EXPECT_EQ(lines_of_box({{-1, -12, -1}, {1, -10, 1}}).size(), 0U);
}

TEST(Overlay, the_bird_has_the_eye_and_its_surroundings_in_view) {
  Camera camera;
  camera.pose = {{100, 50, 2}, 30, 10, 20};
  const Camera bird = birds_eye(camera, 100);
  const Frustum frustum = frustum_of(bird, glm::dvec3(0));
  const glm::vec3 eye(camera.pose.eye);
  EXPECT_EQ(classify(frustum, Box{eye - 20.0F, eye + glm::vec3(20, 20, 2)}), Overlap::inside);
  EXPECT_EQ(bird.pose.roll_deg, 0);
}

TEST(Overlay, false_colours_go_from_blue_to_red) {
  EXPECT_GT(false_color(0).b, false_color(0).r);
  EXPECT_GT(false_color(1).r, false_color(1).b);
  EXPECT_EQ(false_color(-3), false_color(0));
}

}  // namespace
}  // namespace promenade
