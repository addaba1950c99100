// may_be_seen against brute force: what it calls hidden is hidden, and what it calls seen mostly is.

#include <gtest/gtest.h>

#include "scenes.h"

namespace promenade {
namespace {

using namespace test_scenes;  // NOLINT(google-build-using-namespace)

/// Walls with gaps between them, seen from the origin along +x.
Scene walls(uint64_t seed) {
  Scene scene;
  scene.materials[0].two_sided = true;
  Random random(seed);
  for (uint32_t i = 0; i < 12; ++i) {
    Mesh mesh;
    const glm::vec3 low(float(random.within(4, 12)), float(random.within(-8, 6)), float(random.within(-6, 2)));
    add_box(mesh, low, low + glm::vec3(0.3F, float(random.within(1, 4)), float(random.within(1, 6))));
    scene.meshes.push_back(mesh);
  }
  scene.finish();
  return scene;
}

RasterView view_of(uint32_t width, uint32_t height, bool orthographic) {
  Camera camera;
  camera.width_px = width, camera.height_px = height, camera.vertical_fov_deg = 70;
  RasterView view = perspective_view(camera, glm::dvec3(0));
  if (orthographic) view.orthographic = true, view.scale_px = double(height) / 16;
  return view;
}

VisibilityBuffer occluders_of(const Scene& scene, const RasterView& view) {
  VisibilityBuffer buffer;
  VisibilityOptions options;
  options.threads = 1, options.rule = PixelRule::inner;
  EXPECT_TRUE(buffer.draw(view, scene.items, options).ok());
  return buffer;
}

/// Whether the point is in the picture, nearer than the occluder at its pixel.
bool point_shows(const VisibilityBuffer& occluders, const glm::dvec3& p) {
  const RasterView& v = occluders.view();
  const glm::dvec3 d = p - v.eye;
  const double w = glm::dot(d, v.forward), q = v.orthographic ? 1 : w;
  if (w < v.near_m) return false;
  const double x = v.width_px / 2.0 + glm::dot(d, v.right) / q * v.scale_px;
  const double y = v.height_px / 2.0 - glm::dot(d, v.up) / q * v.scale_px;
  if (x < 0 || y < 0 || x >= v.width_px || y >= v.height_px) return false;
  return w < double(occluders.depth_m(uint32_t(x), uint32_t(y)));
}

TEST(Occlusion, boxes_called_hidden_show_no_point_and_few_false_alarms_are_raised) {
  Random random(3);
  uint32_t hidden = 0, seen = 0, false_alarms = 0;
  for (uint64_t seed = 0; seed < 6; ++seed) {
    const Scene scene = walls(seed + 10);
    const VisibilityBuffer occluders = occluders_of(scene, view_of(200, 150, seed % 3 == 2));
    for (uint32_t i = 0; i < 300; ++i) {
      const glm::vec3 low(float(random.within(-2, 30)), float(random.within(-12, 10)), float(random.within(-8, 6)));
      Box box;
      box.add(low), box.add(low + glm::abs(random.point(i % 3 == 0 ? 3 : 0.6)));
      uint32_t shown = 0;
      for (uint32_t k = 0; k < 2000; ++k) {
        const glm::dvec3 at(random.unit(), random.unit(), random.unit());
        shown += point_shows(occluders, glm::dvec3(box.min) + at * glm::dvec3(box.size()));
      }
      const bool answer = occluders.may_be_seen(box);
      ASSERT_TRUE(answer || shown == 0) << "scene " << seed << " box " << i;
      hidden += !answer, seen += answer, false_alarms += answer && shown == 0;
    }
  }
  EXPECT_GT(hidden, 300U);
  EXPECT_GT(seen, 200U);
  EXPECT_LT(false_alarms, seen / 5);
}

TEST(Occlusion, meshes_called_hidden_win_no_pixel_at_eight_times_the_resolution) {
  Random random(4);
  uint32_t hidden = 0, seen = 0, false_alarms = 0;
  for (uint64_t seed = 0; seed < 3; ++seed) {
    const Scene scene = walls(seed + 20);
    const VisibilityBuffer occluders = occluders_of(scene, view_of(120, 90, false));
    for (uint32_t i = 0; i < 60; ++i) {
      const glm::vec3 at(float(random.within(2, 25)), float(random.within(-12, 12)), float(random.within(-8, 8)));
      const PreparedMesh mesh = *prepare(bumpy_sphere(at, float(random.within(0.05, 1)), 6, i), scene.materials);
      const RasterItem item{&mesh, 0, nullptr, {}};
      VisibilityBuffer fine;
      ASSERT_TRUE(fine.draw(view_of(120 * 8, 90 * 8, false), {&item, 1}).ok());
      uint32_t shown = 0;
      for (uint32_t y = 0; y < 720; ++y)
        for (uint32_t x = 0; x < 960; ++x) shown += fine.depth_m(x, y) < occluders.depth_m(x / 8, y / 8);
      const bool answer = occluders.may_be_seen(item);
      ASSERT_TRUE(answer || shown == 0) << "scene " << seed << " mesh " << i;
      ASSERT_TRUE(!answer || occluders.may_be_seen(mesh.box)) << "a box shows what its mesh shows";
      hidden += !answer, seen += answer, false_alarms += answer && shown == 0;
    }
  }
  EXPECT_GT(hidden, 20U);
  EXPECT_GT(seen, 20U);
  EXPECT_LT(false_alarms, seen / 4);
}

TEST(Occlusion, nothing_is_hidden_before_a_picture_and_by_an_empty_one) {
  Box box;
  box.add(glm::vec3(5, -1, -1)), box.add(glm::vec3(6, 1, 1));
  VisibilityBuffer buffer;
  EXPECT_TRUE(buffer.may_be_seen(box));
  ASSERT_TRUE(buffer.draw(view_of(100, 100, false), {}).ok());
  EXPECT_TRUE(buffer.may_be_seen(box));
  EXPECT_FALSE(buffer.may_be_seen(Box{})) << "nothing cannot be seen";
  Box behind;
  behind.add(glm::vec3(-6, -1, -1)), behind.add(glm::vec3(-5, 1, 1));
  EXPECT_FALSE(buffer.may_be_seen(behind));
}

TEST(Occlusion, flat_boxes_and_the_box_around_the_eye_are_seen) {
  const Scene scene = walls(31);
  const VisibilityBuffer occluders = occluders_of(scene, view_of(100, 100, false));
  Box around, flat, point;
  around.add(glm::vec3(-1)), around.add(glm::vec3(1));
  flat.add(glm::vec3(2, -1, 0)), flat.add(glm::vec3(3, 1, 0));
  point.add(glm::vec3(2, 0, 0));
  for (const Box& box : {around, flat, point}) EXPECT_TRUE(occluders.may_be_seen(box));
}

}  // namespace
}  // namespace promenade
