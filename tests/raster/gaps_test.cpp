// Gaps between meshes that should meet: which are closed, and which are not ours to close.

#include "raster/gaps.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "scenes.h"

namespace promenade {
namespace {

using namespace test_scenes;  // NOLINT(google-build-using-namespace)

constexpr uint32_t kSidePx = 64;
constexpr double kDistanceM = 10, kPixelsAMetre = 8;  // at that distance

/// Along +y from the origin; at kDistanceM a pixel is 1/8 m wide, and column c's centre lies at x = (c - 31.5) / 8.
RasterView view_ahead() {
  RasterView view;
  view.width_px = view.height_px = kSidePx;
  view.scale_px = kPixelsAMetre * kDistanceM;
  return view;
}

constexpr float at_px(double column) { return float((column - kSidePx / 2.0) / kPixelsAMetre); }

/// Upright, facing the eye, from one column's left side to another's, over the picture's whole height.
Mesh wall(double from_px, double to_px, float distance_m = float(kDistanceM)) {
  Mesh mesh;
  const float scale = distance_m / float(kDistanceM), l = at_px(from_px) * scale, r = at_px(to_px) * scale;
  add_triangle(mesh, {l, distance_m, -40}, {r, distance_m, -40}, {r, distance_m, 40});
  add_triangle(mesh, {l, distance_m, -40}, {r, distance_m, 40}, {l, distance_m, 40});
  return mesh;
}

struct Walls {
  Scene scene;
  VisibilityBuffer buffer;
  explicit Walls(std::vector<Mesh> meshes) {
    scene.meshes = std::move(meshes);
    scene.finish();
    for (RasterItem& item : scene.items) item.error_m = float(0.5 / kPixelsAMetre);  // half a pixel
  }
  /// Pixels closed.
  uint64_t draw(const VisibilityOptions& options = {.threads = 1, .close_gaps = true}) {
    EXPECT_TRUE(buffer.draw(view_ahead(), scene.items, options).ok());
    return buffer.stats().gaps_closed;
  }
};

TEST(Gaps, one_pixel_wide_between_two_nodes_is_closed) {
  Walls walls({wall(-40, 32.2), wall(32.9, 100)});  // the centre of column 32 lies in neither
  EXPECT_EQ(walls.draw({.threads = 1}), 0U);
  EXPECT_EQ(walls.buffer.node(32, 20), kNoTriangle) << "only when asked";
  EXPECT_EQ(walls.draw(), kSidePx);
  for (uint32_t y = 0; y < kSidePx; ++y) {
    EXPECT_EQ(walls.buffer.node(32, y), 0U) << "0.3 pixels away, the other 0.4";
    EXPECT_NEAR(walls.buffer.depth_m(32, y), kDistanceM, 1e-4);
  }
}

TEST(Gaps, two_pixels_wide_are_closed_from_both_sides) {
  Walls walls({wall(-40, 32.2), wall(33.9, 100)});
  EXPECT_EQ(walls.draw(), 0U) << "wider than half a pixel and half a pixel";
  for (RasterItem& item : walls.scene.items) item.error_m *= 2;
  EXPECT_EQ(walls.draw(), 2 * kSidePx);
  EXPECT_EQ(walls.buffer.node(32, 20), 0U);
  EXPECT_EQ(walls.buffer.node(33, 20), 1U);
}

TEST(Gaps, wider_than_the_errors_stay) {
  Walls walls({wall(-40, 32.2), wall(32.9, 100)});
  walls.scene.items[0].error_m = 0;
  EXPECT_EQ(walls.draw(), 0U) << "half a pixel, together, and a gap of 0.7";
  walls.scene.items[0].error_m = float(0.25 / kPixelsAMetre);
  EXPECT_EQ(walls.draw(), kSidePx) << "three quarters";
}

TEST(Gaps, of_exact_meshes_are_the_sources_own) {
  Walls walls({wall(-40, 32.2), wall(32.9, 100)});
  for (RasterItem& item : walls.scene.items) item.error_m = 0;
  EXPECT_EQ(walls.draw(), 0U);
}

TEST(Gaps, within_one_node_are_the_sources_own) {
  Mesh both = wall(-40, 32.2);
  const Mesh right = wall(32.9, 100);
  for (size_t i = 0; i < right.indices.size(); i += 3)
    add_triangle(both, right.positions[right.indices[i]], right.positions[right.indices[i + 1]],
                 right.positions[right.indices[i + 2]]);
  Walls walls({both});
  EXPECT_EQ(walls.draw(), 0U);
}

TEST(Gaps, between_things_one_behind_the_other_stay) {
  Walls walls({wall(-40, 32.2), wall(32.9, 100, 14)});
  EXPECT_EQ(walls.draw(), 0U);
}

TEST(Gaps, silhouettes_stay_where_they_are) {
  Walls walls({wall(20, 32.2)});
  EXPECT_EQ(walls.draw(), 0U);
}

TEST(Gaps, show_what_lies_behind_them_no_more) {
  Walls walls({wall(-40, 32.2), wall(32.9, 100), wall(-40, 100, 30)});
  EXPECT_EQ(walls.draw(), kSidePx);
  EXPECT_EQ(walls.buffer.node(32, 20), 0U);
}

TEST(Gaps, beside_surfaces_with_holes_stay) {
  Walls walls({wall(-40, 32.2), wall(32.9, 100)});
  walls.scene.materials[0].alpha = AlphaMode::mask, walls.scene.materials[0].alpha_cutoff = 128;
  Scene& scene = walls.scene;
  scene.prepared.clear(), scene.items.clear();
  scene.finish();
  for (RasterItem& item : scene.items) item.error_m = float(0.5 / kPixelsAMetre);
  EXPECT_EQ(walls.draw(), 0U);
}

/// Strips at many angles, each its own node, with slits between them and a wall far behind.
Scene slatted_scene() {
  Scene scene;
  Random random(3);
  for (int i = 0; i < 400; ++i) {
    const glm::vec3 at(float(random.within(-4, 4)), float(random.within(8, 12)), float(random.within(-4, 4)));
    const glm::vec3 along = glm::normalize(random.point(1)) * 3.0F, up = glm::normalize(random.point(1)) * 0.4F;
    Mesh strip, beside;
    const glm::vec3 slit = up * float(random.within(1.0, 1.3));
    for (Mesh* mesh : {&strip, &beside}) {
      const glm::vec3 from = at + (mesh == &strip ? glm::vec3(0) : slit);
      for (const bool turned : {false, true}) {
        const glm::vec3 b = from + along, c = from + along + up, d = from + up;
        turned ? add_triangle(*mesh, from, c, b) : add_triangle(*mesh, from, b, c);
        turned ? add_triangle(*mesh, from, d, c) : add_triangle(*mesh, from, c, d);
      }
    }
    scene.meshes.push_back(strip), scene.meshes.push_back(beside);
  }
  scene.meshes.push_back(wall(-100, 200, 60));
  scene.finish();
  for (RasterItem& item : scene.items) item.error_m = 0.1F;
  return scene;
}

TEST(Gaps, closed_alike_by_any_processor_and_number_of_threads) {
  const Scene scene = slatted_scene();
  RasterView view = view_ahead();
  view.width_px = 203, view.height_px = 149, view.scale_px = 200;
  std::vector<uint32_t> expected_ids;
  std::vector<float> expected_m;
  for (const Simd simd : {Simd::portable, Simd::avx2, Simd::avx512})
    for (const unsigned threads : {1U, 2U, 5U}) {
      VisibilityBuffer buffer;
      VisibilityOptions options;
      options.simd = simd, options.threads = threads, options.close_gaps = true;
      ASSERT_TRUE(buffer.draw(view, scene.items, options).ok());
      std::vector<uint32_t> ids(size_t(view.width_px) * view.height_px);
      std::vector<float> depths_m(ids.size());
      buffer.read_triangles(ids), buffer.read_depth_m(depths_m);
      if (expected_ids.empty()) {
        expected_ids = ids, expected_m = depths_m;
        EXPECT_GT(buffer.stats().gaps_closed, 20U);
      }
      EXPECT_TRUE(ids == expected_ids && depths_m == expected_m) << int(simd) << ", " << threads << " threads";
    }
}

TEST(Gaps, pictures_of_any_size_and_without_anything_are_sound) {
  const Scene scene = slatted_scene();
  for (const uint32_t side : {1U, 2U, 7U, 8U, 9U, 17U}) {
    RasterView view = view_ahead();
    view.width_px = side, view.height_px = 18 - side;
    VisibilityBuffer buffer;
    EXPECT_TRUE(buffer.draw(view, scene.items, {.threads = 1, .close_gaps = true}).ok());
    EXPECT_TRUE(buffer.draw(view, {}, {.threads = 1, .close_gaps = true}).ok());
    EXPECT_EQ(buffer.stats().gaps_closed, 0U);
  }
}

}  // namespace
}  // namespace promenade
