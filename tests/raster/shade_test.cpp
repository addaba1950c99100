// Colours: the same on every processor, right in known cases.

#include "raster/shade.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <tuple>

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

Image picture(const RasterView& view, const Scene& scene, const ShadeOptions& shading) {
  VisibilityBuffer buffer;
  VisibilityOptions options;
  options.threads = shading.threads, options.simd = shading.simd;
  EXPECT_TRUE(buffer.draw(view, scene.items, options).ok());
  Image image;
  shade(buffer, shading, image);
  return image;
}

/// Spheres and a ground with textures that repeat, mirror and clamp; some of it with holes, some seen through.
Scene textured_scene() {
  Scene scene;
  scene.textures.push_back(*MipTexture::make(chequers(64, 8)));
  Image odd = chequers(37, 5);
  for (glm::u8vec4& p : odd.pixels) p.a = 255;
  scene.textures.push_back(*MipTexture::make(odd));
  scene.materials.resize(4);
  for (uint32_t i = 0; i < 4; ++i) {
    scene.materials[i].texture = i % 2;
    scene.materials[i].color = {200, uint8_t(60 * i), 250, uint8_t(i == 3 ? 150 : 255)};
    scene.materials[i].wrap_u = Wrap(i % 3), scene.materials[i].wrap_v = Wrap((i + 1) % 3);
    scene.materials[i].two_sided = i % 2 == 0;
  }
  scene.materials[2].alpha = AlphaMode::mask;
  scene.materials[3].alpha = AlphaMode::blend;
  Random random(7);
  for (uint32_t i = 0; i < 8; ++i) {
    Mesh mesh = bumpy_sphere(random.point(6), float(random.within(0.5, 2)), 8 + random.below(20), random.bits());
    mesh.materials.assign(mesh.triangle_count(), i % 4);
    if (i % 3 == 0) mesh.normals.clear();
    if (i % 3 == 1)
      for (size_t v = 0; v < mesh.positions.size(); ++v)
        mesh.colors.emplace_back(v % 256, v * 7 % 256, v * 13 % 256, 255);
    scene.meshes.push_back(mesh);
  }
  Mesh ground;
  add_triangle(ground, {-500, -500, -3}, {500, -500, -3}, {0, 800, -3});
  ground.texcoords = {{-100, -100}, {100, -100}, {0, 160}};
  scene.meshes.push_back(ground);
  scene.finish();
  return scene;
}

TEST(Shade, all_processors_and_threads_give_the_same_bytes) {
  const Scene scene = textured_scene();
  Random random(8);
  for (uint32_t i = 0; i < 8; ++i) {
    RasterView view = perspective_view(random_camera(random, 7, 213, 117), glm::dvec3(0));
    if (i % 4 == 3) view.orthographic = true, view.scale_px = 20;
    ShadeOptions options;
    options.threads = 1, options.simd = Simd::portable;
    const Image portable = picture(view, scene, options);
    for (const Simd simd : {Simd::avx2, Simd::avx512}) {
      options.simd = simd;
      EXPECT_EQ(portable.pixels, picture(view, scene, options).pixels);
    }
    options.threads = 3;
    EXPECT_EQ(portable.pixels, picture(view, scene, options).pixels);
  }
}

/// A wall at y = 4 across the view along +y, 2 m to each side, with texture coordinates from 0 to 1.
Scene wall(const Image& image, float slant = 0) {
  Scene scene;
  scene.textures.push_back(*MipTexture::make(image));
  scene.materials[0].texture = 0;
  scene.materials[0].wrap_u = scene.materials[0].wrap_v = Wrap::clamp;
  Mesh mesh;
  const glm::vec3 p[4] = {{-2, 4 - slant, -2}, {2, 4 + slant, -2}, {2, 4 + slant, 2}, {-2, 4 - slant, 2}};
  add_triangle(mesh, p[0], p[1], p[2]);
  add_triangle(mesh, p[0], p[2], p[3]);
  mesh.texcoords = {{0, 1}, {1, 1}, {1, 0}, {0, 1}, {1, 0}, {0, 0}};
  scene.meshes.push_back(mesh);
  scene.finish();
  return scene;
}

TEST(Shade, a_ramp_on_a_slanted_wall_is_right_in_perspective) {
  Image ramp;
  ramp.width = 256, ramp.height = 1;
  for (uint32_t x = 0; x < 256; ++x) ramp.pixels.emplace_back(x, 255 - x, 128, 255);
  const Scene scene = wall(ramp, 2);
  const RasterView view = perspective_view(along_y(400), glm::dvec3(0));
  const Image image = picture(view, scene, even_light());
  for (uint32_t x = 20; x < 380; x += 7) {
    const glm::dvec3 d = ray_direction(view, x + 0.5, 200.5);
    const double t = 4 / (d.y - d.x);  // the wall is y = 4 + x
    const double u = (d.x * t + 2) / 4;
    if (u < 0.05 || u > 0.95) continue;
    EXPECT_NEAR(image.at(x, 200).r, u * 256 - 0.5, 2.0) << x;
    EXPECT_NEAR(image.at(x, 200).g, 255.5 - u * 256, 2.0) << x;
  }
}

TEST(Shade, a_minified_texture_becomes_its_mean_in_linear_light) {
  Image image = chequers(256, 128);
  for (glm::u8vec4& p : image.pixels) p = p.a == 0 ? glm::u8vec4(0, 0, 0, 255) : glm::u8vec4(255);
  const Image far = picture(perspective_view(along_y(12), glm::dvec3(0)), wall(image), even_light());
  EXPECT_NEAR(far.at(6, 6).r, linear_to_srgb(0.5F), 2);
  EXPECT_NEAR(far.at(3, 8).g, linear_to_srgb(0.5F), 2);
}

TEST(Shade, plain_colors_come_back_as_they_were) {
  for (uint32_t level = 0; level < 256; level += 5) {
    Scene scene = wall(chequers(2, 1));
    scene.materials[0].texture = kNoTexture;
    scene.materials[0].color = {uint8_t(level), uint8_t(255 - level), 128, 255};
    scene.surfaces = std::make_unique<SurfaceTable>(scene.materials, std::span<const MipTexture* const>());
    scene.items[0].surfaces = scene.surfaces.get();
    const Image image = picture(perspective_view(along_y(16), glm::dvec3(0)), scene, even_light());
    EXPECT_NEAR(image.at(8, 8).r, int(level), 1);
    EXPECT_NEAR(image.at(8, 8).g, 255 - int(level), 1);
    EXPECT_NEAR(image.at(8, 8).b, 128, 1);
  }
}

TEST(Shade, vertex_colors_are_multiplied_by_the_material_s_and_mixed_by_place) {
  Scene scene = wall(chequers(2, 1));
  scene.materials[0].texture = kNoTexture;
  scene.materials[0].color = {220, 180, 255, 255};
  scene.surfaces = std::make_unique<SurfaceTable>(scene.materials, std::span<const MipTexture* const>());
  Mesh mesh = scene.meshes[0];
  const glm::u8vec4 left(250, 40, 120, 255), right(30, 200, 120, 255);
  for (const glm::vec3& p : mesh.positions) mesh.colors.push_back(p.x < 0 ? left : right);
  const PreparedMesh painted = *prepare(mesh, scene.materials), flat = *prepare(scene.meshes[0], scene.materials);
  scene.items = {{&painted, 0, scene.surfaces.get(), {}}, {&flat, 1, scene.surfaces.get(), {}}};
  scene.items[0].fade_to = 0.5F, scene.items[1].fade_from = 0.5F;  // pixels of both in every tile
  const RasterView view = perspective_view(along_y(64), glm::dvec3(0));
  VisibilityBuffer buffer;
  ASSERT_TRUE(buffer.draw(view, scene.items).ok());
  Image image;
  shade(buffer, even_light(), image);
  for (uint32_t y = 0; y < 64; y += 3)
    for (uint32_t x = 0; x < 64; ++x) {
      const float u = (static_cast<float>(x) + 0.5F) / 64;
      for (int c = 0; c < 3; ++c) {
        const float own = srgb_to_linear(left[c]) + u * (srgb_to_linear(right[c]) - srgb_to_linear(left[c]));
        const float material = srgb_to_linear(scene.materials[0].color[c]);
        EXPECT_NEAR(image.at(x, y)[c], linear_to_srgb(material * (buffer.node(x, y) == 0 ? own : 1.0F)), 1)
            << x << ", " << y << ", " << c;
      }
    }
}

TEST(Shade, a_triangle_of_one_colour_has_it_at_all_of_its_pixels) {
  Scene scene = wall(chequers(2, 1), 3);
  scene.materials[0].texture = kNoTexture;
  scene.surfaces = std::make_unique<SurfaceTable>(scene.materials, std::span<const MipTexture* const>());
  Random random(4);
  for (uint32_t i = 0; i < 30; ++i) {
    Mesh mesh = scene.meshes[0];  // of two triangles: one painted from corner to corner, one of one colour
    const glm::u8vec4 own(random.below(256), random.below(256), random.below(256), 255);
    mesh.colors.assign(6, own);
    mesh.colors[1] = {9, 200, 90, 255};
    const PreparedMesh prepared = *prepare(mesh, scene.materials);
    scene.items = {{&prepared, 0, scene.surfaces.get(), {}}};
    const RasterView view = perspective_view(along_y(90), glm::dvec3(0));
    VisibilityBuffer buffer;
    ASSERT_TRUE(buffer.draw(view, scene.items).ok());
    Image image;
    shade(buffer, even_light(), image);
    std::optional<glm::u8vec4> first;
    for (uint32_t y = 0; y < 90; ++y)
      for (uint32_t x = 0; x < 90; ++x) {
        if (buffer.triangle(x, y) != 1) continue;
        if (!first) first = image.at(x, y);
        ASSERT_EQ(image.at(x, y), *first);
        for (int c = 0; c < 3; ++c) ASSERT_NEAR(image.at(x, y)[c], own[c], 1);
      }
    EXPECT_TRUE(first.has_value());
  }
}

TEST(Shade, through_holes_one_sees_what_is_behind) {
  Scene scene = wall(chequers(64, 4));
  scene.materials[0].alpha = AlphaMode::mask;
  scene.meshes.push_back(bumpy_sphere({0, 12, 0}, 6, 30, 1));
  scene.prepared.clear(), scene.items.clear();
  scene.meshes[1].materials.assign(scene.meshes[1].triangle_count(), 1);
  scene.materials.emplace_back();
  scene.finish();
  VisibilityBuffer buffer;
  ASSERT_TRUE(buffer.draw(perspective_view(along_y(64), glm::dvec3(0)), scene.items).ok());
  for (uint32_t y = 20; y < 44; ++y)
    for (uint32_t x = 20; x < 44; ++x) {
      if (x % 16 == 0 || x % 16 == 15 || y % 16 == 0 || y % 16 == 15) continue;  // between two squares
      EXPECT_EQ(buffer.node(x, y), (x / 16 + y / 16) % 2) << x << ", " << y;
    }
}

TEST(Shade, a_picture_kept_smaller_is_the_coarser_levels_of_the_whole) {
  Random random(12);
  for (const auto& [width, height, side] :
       {std::tuple(64U, 64U, 16U), {100U, 37U, 50U}, {5U, 300U, 9U}, {8U, 8U, 8U}}) {
    Image image = chequers(width, 4);
    image.height = height;
    image.pixels.resize(size_t(width) * height);
    for (glm::u8vec4& p : image.pixels)
      p = {random.below(256), random.below(256), random.below(256), random.below(256)};
    const MipTexture whole = *MipTexture::make(image), small = *MipTexture::make(image, side);
    uint32_t first = 0;
    while (std::max(width, height) >> first > side) ++first;
    ASSERT_EQ(small.view().levels + first, whole.view().levels);
    EXPECT_EQ(small.view().width, std::max(1U, width >> first));
    EXPECT_EQ(small.view().height, std::max(1U, height >> first));
    const uint32_t at = whole.view().level_offset[first];
    const size_t texels = small.byte_size() / (sizeof(int32_t) + 1);
    EXPECT_EQ(texels, whole.byte_size() / (sizeof(int32_t) + 1) - at);
    EXPECT_TRUE(std::equal(small.view().texels, small.view().texels + texels, whole.view().texels + at));
    EXPECT_TRUE(std::equal(small.view().opacity, small.view().opacity + texels, whole.view().opacity + at));
  }
}

TEST(Shade, textures_of_impossible_sizes_are_refused) {
  EXPECT_FALSE(MipTexture::make(Image{}).ok());
  EXPECT_FALSE(MipTexture::make(Image{2, 2, std::vector<glm::u8vec4>(3)}).ok());
  EXPECT_FALSE(MipTexture::make(Image{40000, 1, std::vector<glm::u8vec4>(40000)}).ok());
}

}  // namespace
}  // namespace promenade
