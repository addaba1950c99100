// Antialiased edges: what a pixel mixes is what covers it.

#include <gtest/gtest.h>

#include <cmath>

#include "raster/shade.h"
#include "scenes.h"

namespace promenade {
namespace {

using namespace test_scenes;  // NOLINT(google-build-using-namespace)

ShadeOptions even_light(Simd simd = Simd::best) {
  ShadeOptions o;
  o.threads = 1, o.simd = simd, o.sky = false;
  o.sun = glm::vec3(0), o.sky_ambient = o.ground_ambient = glm::vec3(1);
  return o;
}

struct Pictures {
  Image plain, smooth;
};

Pictures pictures(const RasterView& view, const std::vector<RasterItem>& items, const ShadeOptions& shading) {
  VisibilityBuffer buffer;
  VisibilityOptions options;
  options.threads = shading.threads, options.simd = shading.simd;
  EXPECT_TRUE(buffer.draw(view, items, options).ok());
  Pictures p;
  shade(buffer, shading, p.plain);
  smooth_edges(buffer, shading, p.plain, p.smooth);
  return p;
}

RasterView view_from_above(uint32_t side, double scale) {
  return orthographic_view({{0, 0, 10}, 90, -90, 0}, glm::dvec3(0), side, side, scale, 0.1);
}

/// Root of the mean squared difference of linear brightness.
double difference(const Image& a, const Image& b) {
  double sum = 0;
  for (size_t i = 0; i < a.pixels.size(); ++i)
    for (int c = 0; c < 3; ++c) {
      const double d = double(srgb_to_linear(a.pixels[i][c])) - double(srgb_to_linear(b.pixels[i][c]));
      sum += d * d;
    }
  return std::sqrt(sum / double(a.pixels.size() * 3));
}

/// The mean of squares of `times` x `times` pixels.
Image reduced(const Image& large, uint32_t times) {
  Image out;
  out.width = large.width / times, out.height = large.height / times;
  for (uint32_t y = 0; y < out.height; ++y)
    for (uint32_t x = 0; x < out.width; ++x) {
      glm::vec3 sum(0);
      for (uint32_t j = 0; j < times; ++j)
        for (uint32_t i = 0; i < times; ++i)
          for (int c = 0; c < 3; ++c) sum[c] += srgb_to_linear(large.at(x * times + i, y * times + j)[c]);
      sum /= float(times * times);
      out.pixels.emplace_back(linear_to_srgb(sum.x), linear_to_srgb(sum.y), linear_to_srgb(sum.z), uint8_t(255));
    }
  return out;
}

/// White before black: large faces that lean, cross and meet.
Scene leaning_faces() {
  Scene scene;
  scene.materials.resize(4);
  for (Material& m : scene.materials) m.two_sided = true;
  scene.materials[1].color = {250, 20, 20, 255}, scene.materials[2].color = {20, 30, 250, 255};
  scene.materials[3].color = {30, 200, 40, 255};
  Mesh mesh;
  add_triangle(mesh, {-3, -2, 0}, {3.3F, -1.2F, 0}, {0.2F, 2.9F, 0});
  add_triangle(mesh, {-2.1F, -2.7F, 1}, {-1.3F, 2.8F, -1}, {0.4F, 0.3F, 0.7F});
  add_triangle(mesh, {3, -3, 0.5F}, {3.1F, 3, 0.5F}, {2.2F, -2, 0.6F});
  add_box(mesh, {-0.7F, -1.9F, -0.3F}, {0.3F, -0.8F, 0.9F});
  for (size_t t = 0; t < mesh.triangle_count(); ++t) mesh.materials.push_back(static_cast<uint32_t>(t % 4));
  scene.meshes.push_back(mesh);
  scene.finish();
  return scene;
}

TEST(SmoothEdges, a_pixel_half_covered_by_white_on_black_is_half_as_bright) {
  Mesh mesh;
  add_triangle(mesh, {-9, -9, 0}, {0.7F / 16, -9, 0}, {0.7F / 16, 9, 0});  // a vertical edge 0.7 of a pixel along
  const PreparedMesh prepared = *prepare(mesh, {});
  const Pictures p = pictures(view_from_above(64, 16), {{&prepared, 0, nullptr, {}}}, even_light());
  EXPECT_EQ(p.plain.at(32, 40).r, 255);
  EXPECT_NEAR(srgb_to_linear(p.smooth.at(32, 40).r), 0.7F, 0.04F);
  EXPECT_EQ(p.smooth.at(31, 40).r, 255);
  EXPECT_EQ(p.smooth.at(33, 40).r, 0);
}

TEST(SmoothEdges, comes_nearer_to_a_picture_of_64_samples_a_pixel) {
  const Scene scene = leaning_faces();
  Random random(7);
  for (uint32_t i = 0; i < 8; ++i) {
    Camera camera = random_camera(random, 1, 160, 120);
    camera.pose.eye = glm::dvec3(random.within(-2, 2), random.within(-2, 2), 6);
    camera.pose.pitch_deg = -90, camera.vertical_fov_deg = 60;
    RasterView view = perspective_view(camera, glm::dvec3(0)), large = view;
    large.width_px *= 8, large.height_px *= 8, large.scale_px *= 8;
    const Pictures p = pictures(view, scene.items, even_light());
    const Image truth = reduced(pictures(large, scene.items, even_light()).plain, 8);
    EXPECT_LT(difference(p.smooth, truth), 0.45 * difference(p.plain, truth)) << "view " << i;
  }
}

TEST(SmoothEdges, surfaces_of_one_colour_stay_as_they_are) {
  Scene scene;
  scene.meshes.push_back(bumpy_sphere({0, 0, 0}, 30, 40, 3));  // the eye is inside: all of the picture
  scene.materials[0].two_sided = true;
  scene.finish();
  Camera camera;
  camera.width_px = 200, camera.height_px = 150;
  const Pictures p = pictures(perspective_view(camera, glm::dvec3(0)), scene.items, even_light());
  EXPECT_EQ(p.plain.pixels, p.smooth.pixels);
}

TEST(SmoothEdges, holes_are_smoothed_by_their_opacity) {
  Scene scene;
  scene.textures.push_back(*MipTexture::make(chequers(64, 4)));
  scene.materials[0].texture = 0, scene.materials[0].alpha = AlphaMode::mask;
  Mesh mesh;
  add_triangle(mesh, {-1, -1, 0}, {1, -1, 0}, {1, 1, 0});
  add_triangle(mesh, {-1, -1, 0}, {1, 1, 0}, {-1, 1, 0});
  for (const glm::vec3& q : mesh.positions) mesh.texcoords.emplace_back((q.x + 1) / 2, (1 - q.y) / 2);
  scene.meshes.push_back(mesh);
  scene.finish();
  RasterView view = orthographic_view({{0, 0, 10}, 83, -90, 0}, glm::dvec3(0), 96, 96, 31, 0.1), large = view;
  large.width_px *= 8, large.height_px *= 8, large.scale_px *= 8;
  const Pictures p = pictures(view, scene.items, even_light());
  const Image truth = reduced(pictures(large, scene.items, even_light()).plain, 8);
  EXPECT_LT(difference(p.smooth, truth), 0.65 * difference(p.plain, truth));
}

TEST(SmoothEdges, all_processors_and_threads_give_the_same_bytes) {
  Random random(9);
  std::vector<Scene> scenes;
  scenes.push_back(mixed_scene(91, true)), scenes.push_back(hostile_scene(92)), scenes.push_back(leaning_faces());
  for (const Scene& scene : scenes)
    for (uint32_t i = 0; i < 6; ++i) {
      RasterView view = perspective_view(random_camera(random, 6, 173, 101), glm::dvec3(0));
      if (i % 3 == 2) view.orthographic = true, view.scale_px = 14;
      const Image portable = pictures(view, scene.items, even_light(Simd::portable)).smooth;
      EXPECT_EQ(portable.pixels, pictures(view, scene.items, even_light(Simd::avx2)).smooth.pixels);
      EXPECT_EQ(portable.pixels, pictures(view, scene.items, even_light(Simd::avx512)).smooth.pixels);
      ShadeOptions threads = even_light();
      threads.threads = 2;
      EXPECT_EQ(portable.pixels, pictures(view, scene.items, threads).smooth.pixels);
    }
}

TEST(SmoothEdges, no_more_pixels_than_asked_for_change) {
  const Scene scene = leaning_faces();
  const RasterView view = view_from_above(160, 20);
  const auto changed = [](const Pictures& p) {
    uint32_t count = 0;
    for (size_t i = 0; i < p.plain.pixels.size(); ++i) count += p.plain.pixels[i] != p.smooth.pixels[i];
    return count;
  };
  const Pictures all = pictures(view, scene.items, even_light());
  ShadeOptions some = even_light();
  some.most_smoothed = 0, some.least_smoothed_px = changed(all) - 1;
  const Pictures few = pictures(view, scene.items, some);
  EXPECT_GT(changed(few), 0U);
  EXPECT_LT(changed(few), changed(all));
  for (size_t i = 0; i < few.plain.pixels.size(); ++i)
    EXPECT_TRUE(few.smooth.pixels[i] == few.plain.pixels[i] || few.smooth.pixels[i] == all.smooth.pixels[i]);
  some.least_smoothed_px = 0;
  EXPECT_EQ(changed(pictures(view, scene.items, some)), 0U);
}

TEST(SmoothEdges, in_place_gives_the_same_as_into_another_picture) {
  const Scene scene = leaning_faces();
  VisibilityBuffer buffer;
  ASSERT_TRUE(buffer.draw(view_from_above(160, 20), scene.items).ok());
  Image picture, smooth;
  shade(buffer, even_light(), picture);
  smooth_edges(buffer, even_light(), picture, smooth);
  EXPECT_NE(picture.pixels, smooth.pixels);
  smooth_edges(buffer, even_light(), picture);
  EXPECT_EQ(picture.pixels, smooth.pixels);
}

TEST(SmoothEdges, pictures_of_any_small_size_do) {
  const Scene scene = leaning_faces();
  for (uint32_t w = 1; w < 20; w += 3)
    for (uint32_t h = 1; h < 20; h += 5) {
      const RasterView view = orthographic_view({{0, 0, 10}, 77, -90, 0}, glm::dvec3(0), w, h, 3, 0.1);
      EXPECT_EQ(pictures(view, scene.items, even_light()).smooth.pixels.size(), size_t(w) * h);
    }
}

}  // namespace
}  // namespace promenade
