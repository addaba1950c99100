#include "runtime/popping.h"

#include <gtest/gtest.h>

#include "runtime/cpu_renderer.h"
#include "tests/runtime/scenes.h"

namespace promenade {
namespace {

/// A wall of stripes 10 m ahead, 64 x 64 pixels, drawn for real.
class Wall {
 public:
  Wall() : renderer_(create_cpu_renderer()) {
    Mesh mesh = scenes::square_at(10, 30);
    mesh.texcoords = {{0, 0}, {0, 1}, {1, 1}, {1, 0}};
    Image stripes{64, 1, {}};
    for (int i = 0; i < 64; ++i) stripes.pixels.emplace_back(i % 8 < 4 ? 200 : 60, 120, 80, 255);
    texture_ = *renderer_->create_texture(*renderer_->stage_texture(stripes));
    Material material;
    material.texture = 0;
    mesh_ = *renderer_->create_mesh(*renderer_->stage_mesh(mesh, {&material, 1}), {&texture_, 1});
  }
  SeenFrame seen_from(const Pose& pose, bool textured = true) {
    FrameView view;
    view.camera = scenes::looking_along_x();
    view.camera.pose = pose;
    view.textures = textured;
    const DrawItem item{mesh_, NodeId{0}, glm::mat4(1)};
    EXPECT_TRUE(renderer_->draw(view, {&item, 1}));
    return {view.camera, *renderer_->read_color(), *renderer_->read_depth()};
  }

 private:
  std::unique_ptr<Renderer> renderer_;
  TextureHandle texture_{};
  MeshHandle mesh_{};
};

TEST(Popping, motion_alone_pops_nothing) {
  Wall wall;
  const Popping still = popping_between(wall.seen_from({}), wall.seen_from({}));
  EXPECT_EQ(still.compared, 64U * 64U);
  EXPECT_EQ(still.popped, 0U);
  for (const Pose& to : {Pose{{0.3, 0, 0}, 0, 0, 0}, Pose{{0, 0.4, 0.1}, 0, 0, 0}, Pose{{0, 0, 0}, 3, 1, 0}}) {
    const Popping moved = popping_between(wall.seen_from({}), wall.seen_from(to));
    EXPECT_GT(moved.compared, 64U * 64U * 8U / 10U);
    EXPECT_LT(moved.popped_share(), 0.02);
  }
}

TEST(Popping, another_picture_of_the_same_surface_pops) {
  Wall wall;
  const Popping popped = popping_between(wall.seen_from({}), wall.seen_from({{0.1, 0, 0}, 0, 0, 0}, false));
  EXPECT_GT(popped.popped_share(), 0.3);
}

TEST(Popping, what_comes_into_view_is_not_compared) {
  Wall wall;
  const Popping turned = popping_between(wall.seen_from({}), wall.seen_from({{0, 0, 0}, 45, 0, 0}));
  EXPECT_LT(turned.compared, 64U * 64U * 6U / 10U);
  SeenFrame other = wall.seen_from({});
  other.depth_m.pop_back();
  EXPECT_EQ(popping_between(other, wall.seen_from({})).compared, 0U) << "sizes differ";
}

/// 64 x 64 pixels of a surface 10 m away: at a pixel `after` where its place in a pattern of 8 x 8 is below `share`.
SeenFrame partly(double share, uint8_t before, uint8_t after) {
  SeenFrame frame{scenes::looking_along_x(), {64, 64, {}}, std::vector<float>(64 * 64, 10.0F)};
  for (uint32_t y = 0; y < 64; ++y)
    for (uint32_t x = 0; x < 64; ++x) {
      const double place = ((x % 8) * 8 + (y % 8)) * 37 % 64 / 64.0;  // scattered: 37 and 64 have no common factor
      const uint8_t value = place < share ? after : before;
      frame.color.pixels.emplace_back(value, value, value, 255);
    }
  return frame;
}

TEST(Popping, by_areas_a_fade_does_not_pop_where_a_switch_does) {
  const Popping at_once = popping_between(partly(0, 100, 140), partly(1, 100, 140));
  EXPECT_EQ(at_once.popped_area_share(), 1);
  EXPECT_EQ(at_once.popped_share(), 1);
  constexpr int kSteps = 9;
  uint64_t pixels = 0;
  for (int i = 0; i < kSteps; ++i) {
    const Popping step =
        popping_between(partly(i / double(kSteps), 100, 140), partly((i + 1) / double(kSteps), 100, 140));
    EXPECT_LE(step.popped_areas, 4U) << i << ": but for the picture's corners, which see a quarter of the pattern";
    pixels += step.popped;
  }
  EXPECT_GT(pixels, 0U) << "single pixels do not tell a fade from a switch";
}

TEST(Popping, by_areas_motion_alone_pops_nothing) {
  Wall wall;
  for (const Pose& to : {Pose{{0.3, 0, 0}, 0, 0, 0}, Pose{{0, 0.4, 0.1}, 0, 0, 0}, Pose{{0, 0, 0}, 3, 1, 0}})
    EXPECT_LT(popping_between(wall.seen_from({}), wall.seen_from(to)).popped_area_share(), 0.05);
}

}  // namespace
}  // namespace promenade
