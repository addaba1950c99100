#include "raster/picture_error.h"

#include <gtest/gtest.h>

#include <limits>

namespace promenade {
namespace {

constexpr uint32_t kSide = 64;
constexpr float kNothing = std::numeric_limits<float>::infinity();

/// Looks along +y at walls ten metres away: 10 cm a pixel.
RasterView straight_view() {
  RasterView view;
  view.width_px = view.height_px = kSide;
  view.scale_px = 100;
  return view;
}

/// Upright, far larger than the picture.
ClosestPointTree wall_at(float y_m, float left_m = -50) {
  const std::vector<glm::vec3> positions{{left_m, y_m, -50}, {50, y_m, -50}, {50, y_m, 50}, {left_m, y_m, 50}};
  return ClosestPointTree(positions, std::vector<uint32_t>{0, 1, 2, 0, 2, 3});
}

struct Picture {
  std::vector<float> depth_m = std::vector<float>(size_t(kSide) * kSide, 10.0F);
  std::vector<glm::u8vec4> color = std::vector<glm::u8vec4>(size_t(kSide) * kSide, {100, 100, 100, 255});
  DepthPicture view() const { return {depth_m, color}; }
  static size_t at(uint32_t x, uint32_t y) { return size_t(y) * kSide + x; }
};

TEST(PictureErrors, are_none_between_a_picture_and_itself) {
  PictureErrors errors;
  const Picture same;
  errors.add(straight_view(), same.view(), same.view(), wall_at(10));
  EXPECT_EQ(errors.points(), uint64_t(kSide) * kSide);
  EXPECT_LT(errors.largest_px(), 1e-3);
  EXPECT_EQ(errors.background_pixels(), 0U);
  EXPECT_EQ(errors.pixels_of_other_color(), 0U);
}

TEST(PictureErrors, measure_how_far_the_nearest_surface_lies_in_the_picture) {
  PictureErrors errors;
  const Picture reference;
  // The drawn wall begins 30 cm right of the picture's middle: three pixels for the points left of it.
  errors.add(straight_view(), reference.view(), reference.view(), wall_at(10, 0.3F));
  EXPECT_NEAR(errors.largest_px(), kSide / 2.0 - 0.5 + 3, 0.02);
  EXPECT_LT(errors.quantile_px(0.40), 0.05);
  EXPECT_NEAR(errors.quantile_px(0.75), kSide / 4.0 + 3, 1.1);
}

TEST(PictureErrors, see_nothing_of_a_shift_along_the_ray_in_the_middle_but_do_at_the_side) {
  PictureErrors errors;
  const Picture reference;
  errors.add(straight_view(), reference.view(), reference.view(), wall_at(11));
  // A point 32 pixels beside the axis at 10 m is 3.2 m off; the nearest of the wall 1 m behind projects to 29.1.
  EXPECT_NEAR(errors.largest_px(), std::sqrt(2.0) * 31.5 * (1 - 10.0 / 11), 0.05);
}

TEST(PictureErrors, count_holes_but_not_silhouettes) {
  PictureErrors errors;
  Picture reference, drawn;
  drawn.depth_m[Picture::at(20, 20)] = kNothing;                                           // a hole
  drawn.depth_m[Picture::at(40, 40)] = reference.depth_m[Picture::at(41, 40)] = kNothing;  // beside an outline
  drawn.depth_m[Picture::at(41, 40)] = kNothing;
  errors.add(straight_view(), reference.view(), drawn.view(), wall_at(10));
  EXPECT_EQ(errors.background_pixels(), 1U);
  EXPECT_EQ(errors.points(), uint64_t(kSide) * kSide - 1);
}

TEST(PictureErrors, forgive_colours_that_a_neighbour_has) {
  PictureErrors errors;
  Picture reference, drawn;
  reference.color[Picture::at(10, 10)] = {200, 100, 100, 255};
  drawn.color[Picture::at(11, 11)] = {200, 100, 100, 255};  // one pixel on: the same corner
  drawn.color[Picture::at(30, 30)] = {117, 100, 100, 255};  // 17 off
  drawn.color[Picture::at(50, 50)] = {116, 100, 100, 255};  // 16 off
  drawn.color[Picture::at(0, kSide - 1)] = {100, 100, 250, 255};
  errors.add(straight_view(), reference.view(), drawn.view(), wall_at(10));
  EXPECT_EQ(errors.pixels_of_other_color(), 2U);
}

TEST(PictureErrors, of_a_picture_without_a_surface_are_the_largest_there_are) {
  PictureErrors errors;
  const Picture reference;
  errors.add(straight_view(), reference.view(), reference.view(), ClosestPointTree({}, {}));
  EXPECT_GE(errors.quantile_px(0.5), 256.0);
}

}  // namespace
}  // namespace promenade
