#include "runtime/gl_renderer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/ext/matrix_transform.hpp>
#include <glm/gtc/quaternion.hpp>
#include <limits>

#include "runtime/gl_staging.h"
#include "tests/runtime/scenes.h"

namespace promenade {
namespace {

using scenes::colored, scenes::filled, scenes::looking_along_x, scenes::square_at;

constexpr NodeId kSeven{7}, kEight{8};

/// Light that shows every colour as it is: ambient 1 from everywhere.
Lighting even_light() {
  Lighting light;
  light.sun = glm::vec3(0);
  light.sky_ambient = light.ground_ambient = glm::vec3(1);
  return light;
}

class OsmesaRenderer : public testing::TestWithParam<bool> {
 protected:
  void SetUp() override {
    Result<std::unique_ptr<GlContext>> context = create_offscreen_context(OffscreenKind::osmesa);
    ASSERT_TRUE(context) << context.error().message;
    context_ = std::move(*context);
    GlRendererOptions options;
    options.reversed_depth = GetParam();
    Result<std::unique_ptr<GlRenderer>> renderer = create_gl_renderer(*context_, options);
    ASSERT_TRUE(renderer) << renderer.error().message;
    renderer_ = std::move(*renderer);
    view_.camera = looking_along_x();
    view_.lighting = even_light();
    view_.background.sky = false;
    view_.background.plain = {10, 20, 30, 255};
  }

  MeshHandle add(const Mesh& mesh, const std::vector<Material>& materials,
                 const std::vector<TextureHandle>& textures = {}) {
    EXPECT_EQ(find_defect(mesh), "");
    Result<MeshHandle> handle = renderer_->create_mesh(*renderer_->stage_mesh(mesh, materials), textures);
    EXPECT_TRUE(handle);
    return *handle;
  }
  TextureHandle add(const Image& image) {
    Result<TextureHandle> handle = renderer_->create_texture(*renderer_->stage_texture(image));
    EXPECT_TRUE(handle);
    return *handle;
  }
  void draw(const std::vector<DrawItem>& items) {
    const Status status = renderer_->draw(view_, items);
    ASSERT_TRUE(status) << status.error().message;
  }
  glm::ivec4 color_at(uint32_t x, uint32_t y) { return glm::ivec4(renderer_->read_color()->at(x, y)); }
  float depth_at(uint32_t x, uint32_t y) { return (*renderer_->read_depth())[size_t(y) * 64 + x]; }
  uint32_t node_at(uint32_t x, uint32_t y) { return (*renderer_->read_nodes())[size_t(y) * 64 + x]; }

  std::unique_ptr<GlContext> context_;
  std::unique_ptr<GlRenderer> renderer_;
  FrameView view_;
};

/// Each channel to one level: drivers round differently.
testing::AssertionResult is_color(const glm::ivec4& found, int r, int g, int b) {
  const glm::ivec4 off = glm::abs(found - glm::ivec4(r, g, b, 255));
  if (off.r <= 1 && off.g <= 1 && off.b <= 1 && off.a == 0) return testing::AssertionSuccess();
  return testing::AssertionFailure() << "found " << found.r << ", " << found.g << ", " << found.b << ", " << found.a;
}

TEST_P(OsmesaRenderer, square_covers_exactly_its_pixels) {
  const MeshHandle square = add(square_at(10, 5), {colored(200, 100, 50)});
  draw({{square, kSeven}});
  const Image image = *renderer_->read_color();
  for (uint32_t y = 0; y < 64; ++y)
    for (uint32_t x = 0; x < 64; ++x) {
      const bool inside = x >= 16 && x < 48 && y >= 16 && y < 48;
      ASSERT_NEAR(image.at(x, y).r, inside ? 200 : 10, 1) << x << ", " << y;
    }
  EXPECT_TRUE(is_color(color_at(32, 32), 200, 100, 50));
  EXPECT_TRUE(is_color(color_at(0, 0), 10, 20, 30));
}

TEST_P(OsmesaRenderer, depth_is_metres_along_the_view_axis) {
  const MeshHandle near = add(square_at(10, 5), {colored(200, 100, 50)});
  const MeshHandle far = add(square_at(4000, 10000), {colored(0, 100, 50)});
  draw({{near, kSeven}, {far, kEight}});
  EXPECT_NEAR(depth_at(32, 32), 10, 1e-4);
  EXPECT_NEAR(depth_at(0, 0), 4000, GetParam() ? 0.01 : 30) << "the same at the picture's corner as in its middle";
  draw({{near, kSeven}});
  EXPECT_EQ(depth_at(0, 0), std::numeric_limits<float>::infinity());
}

TEST_P(OsmesaRenderer, node_ids_keep_all_their_bits) {
  const MeshHandle near = add(square_at(10, 5), {colored(200, 100, 50)});
  const MeshHandle far = add(square_at(20, 15), {colored(200, 100, 50)});
  draw({{far, NodeId{0xfedcba98U}}, {near, kSeven}});
  EXPECT_EQ(node_at(32, 32), 7U);
  EXPECT_EQ(node_at(10, 32), 0xfedcba98U);
  EXPECT_EQ(node_at(1, 1), 0xffffffffU);
  EXPECT_TRUE(is_color(color_at(32, 32), 200, 100, 50));
}

TEST_P(OsmesaRenderer, fading_items_share_the_pixels_exactly) {
  const MeshHandle one = add(square_at(10, 15), {colored(200, 100, 50)});
  const MeshHandle other = add(square_at(10, 15), {colored(200, 100, 50)});
  for (const float share : {0.25F, 0.5F, 0.8F}) {
    draw({{one, kSeven, glm::mat4(1), 0, share}, {other, kEight, glm::mat4(1), share, 1}});
    const std::vector<uint32_t> nodes = *renderer_->read_nodes();
    size_t first = 0;
    for (const uint32_t node : nodes) {
      ASSERT_NE(node, 0xffffffffU) << "a hole";
      first += node == 7 ? 1 : 0;
    }
    EXPECT_NEAR(double(first) / double(nodes.size()), double(share), 1.0 / 64);
    EXPECT_TRUE(is_color(color_at(32, 32), 200, 100, 50));
  }
}

TEST_P(OsmesaRenderer, back_faces_are_not_drawn_unless_two_sided) {
  Material sheet = colored(200, 100, 50);
  const MeshHandle away = add(square_at(10, 5, true), {sheet});
  draw({{away, kSeven}});
  EXPECT_TRUE(is_color(color_at(32, 32), 10, 20, 30));
  sheet.two_sided = true;
  const MeshHandle both = add(square_at(10, 5, true), {sheet});
  draw({{both, kSeven}});
  EXPECT_TRUE(is_color(color_at(32, 32), 200, 100, 50));
}

TEST_P(OsmesaRenderer, mirrored_instance_keeps_its_front) {
  const MeshHandle square = add(square_at(10, 5), {colored(200, 100, 50)});
  draw({{square, kSeven, glm::scale(glm::mat4(1), glm::vec3(1, -1, 1))}});
  EXPECT_TRUE(is_color(color_at(32, 32), 200, 100, 50));
}

TEST_P(OsmesaRenderer, instances_stand_where_their_matrices_put_them) {
  const MeshHandle square = add(square_at(10, 1), {colored(200, 100, 50)});
  draw({{square, kSeven, glm::translate(glm::mat4(1), glm::vec3(0, 5, 5))},
        {square, kEight, glm::translate(glm::mat4(1), glm::vec3(0, -5, -5))}});
  EXPECT_EQ(node_at(16, 16), 7U) << "left and up";
  EXPECT_EQ(node_at(47, 47), 8U) << "right and down";
  EXPECT_EQ(node_at(32, 32), 0xffffffffU);
  EXPECT_EQ(renderer_->counts().triangles, 4U);
}

TEST_P(OsmesaRenderer, masked_texels_are_not_there) {
  Image half = filled(2, {255, 255, 255, 255});
  half.at(0, 0).a = half.at(0, 1).a = 0;
  Material leaf = colored(200, 100, 50);
  leaf.texture = 0;
  leaf.alpha = AlphaMode::mask;
  leaf.wrap_u = leaf.wrap_v = Wrap::clamp;
  const MeshHandle square = add(square_at(10, 5), {leaf}, {add(half)});
  draw({{square, kSeven}});
  EXPECT_TRUE(is_color(color_at(20, 32), 10, 20, 30));
  EXPECT_TRUE(is_color(color_at(44, 32), 200, 100, 50));
  EXPECT_EQ(node_at(20, 32), 0xffffffffU);
  EXPECT_EQ(node_at(44, 32), 7U);
  EXPECT_TRUE(std::isinf(depth_at(20, 32)));
}

TEST_P(OsmesaRenderer, glass_blends_in_linear_light_behind_first) {
  const MeshHandle wall = add(square_at(30, 30), {colored(255, 255, 255)});
  const MeshHandle red = add(square_at(20, 20), {colored(255, 0, 0, 128)});
  const MeshHandle blue = add(square_at(10, 10), {colored(0, 0, 255, 128)});
  draw({{blue, kSeven}, {red, kEight}, {wall, NodeId{9}}});
  const float a = 128.0F / 255.0F;
  const glm::vec3 behind = glm::mix(glm::vec3(1), glm::vec3(1, 0, 0), a);
  const glm::vec3 seen = glm::mix(behind, glm::vec3(0, 0, 1), a);
  EXPECT_TRUE(is_color(color_at(32, 32), linear_to_srgb(seen.r), linear_to_srgb(seen.g), linear_to_srgb(seen.b)));
  EXPECT_EQ(node_at(32, 32), 9U) << "glass hides nothing";
  EXPECT_NEAR(depth_at(32, 32), 30, 0.01);
}

TEST_P(OsmesaRenderer, glass_behind_a_wall_is_hidden) {
  const MeshHandle wall = add(square_at(10, 10), {colored(50, 60, 70)});
  const MeshHandle red = add(square_at(20, 20), {colored(255, 0, 0, 128)});
  draw({{red, kEight}, {wall, NodeId{9}}});
  EXPECT_TRUE(is_color(color_at(32, 32), 50, 60, 70));
}

TEST_P(OsmesaRenderer, texture_stands_upright) {
  Image image = filled(2, {255, 0, 0, 255});
  image.at(1, 0) = {0, 255, 0, 255};
  image.at(0, 1) = {0, 0, 255, 255};
  image.at(1, 1) = {255, 255, 255, 255};
  Material poster = colored(255, 255, 255);
  poster.texture = 0;
  poster.wrap_u = poster.wrap_v = Wrap::clamp;
  const MeshHandle square = add(square_at(10, 9.99F), {poster}, {add(image)});
  draw({{square, kSeven}});
  EXPECT_TRUE(is_color(color_at(4, 4), 255, 0, 0));
  EXPECT_TRUE(is_color(color_at(60, 4), 0, 255, 0));
  EXPECT_TRUE(is_color(color_at(4, 60), 0, 0, 255));
  EXPECT_TRUE(is_color(color_at(60, 60), 255, 255, 255));
}

TEST_P(OsmesaRenderer, colors_multiply_in_linear_light) {
  Mesh mesh = square_at(10, 5);
  mesh.colors.assign(4, glm::u8vec4(128, 255, 255, 255));
  Material paper = colored(255, 128, 255);
  paper.texture = 0;
  const MeshHandle square = add(mesh, {paper}, {add(filled(4, {255, 255, 128, 255}))});
  draw({{square, kSeven}});
  EXPECT_TRUE(is_color(color_at(32, 32), 128, 128, 128));
}

TEST_P(OsmesaRenderer, sun_lights_by_the_cosine_with_and_without_normals) {
  view_.lighting.sky_ambient = view_.lighting.ground_ambient = glm::vec3(0);
  view_.lighting.sun = glm::vec3(1);
  view_.lighting.to_sun = glm::vec3(-1, 0, std::sqrt(3.0F));
  Mesh mesh = square_at(10, 5);
  const MeshHandle flat = add(mesh, {colored(255, 255, 255)});
  mesh.normals.assign(4, glm::vec3(-1, 0, 0));
  const MeshHandle smooth = add(mesh, {colored(255, 255, 255)});
  for (const MeshHandle handle : {flat, smooth}) {
    draw({{handle, kSeven}});
    EXPECT_TRUE(is_color(color_at(32, 32), linear_to_srgb(0.5F), linear_to_srgb(0.5F), linear_to_srgb(0.5F)));
  }
}

TEST_P(OsmesaRenderer, sky_fills_what_no_surface_covers) {
  view_.background = Background{};
  const MeshHandle square = add(square_at(10, 5), {colored(200, 100, 50)});
  draw({{square, kSeven}});
  const glm::ivec4 top = color_at(32, 0), bottom = color_at(32, 63);
  EXPECT_GT(top.b, top.r) << "blue above";
  EXPECT_NEAR(bottom.r, 120, 2);
  EXPECT_TRUE(is_color(color_at(32, 32), 200, 100, 50));
}

TEST_P(OsmesaRenderer, far_eye_shifts_nothing) {
  // The same view a hundred kilometres from the model's origin: the origin is subtracted in double.
  const MeshHandle square = add(square_at(10, 5), {colored(200, 100, 50)});
  view_.camera.pose.eye = {1e7, -5e6, 300};
  view_.model_origin = view_.camera.pose.eye;
  draw({{square, kSeven}});
  EXPECT_TRUE(is_color(color_at(16, 16), 200, 100, 50));
  EXPECT_TRUE(is_color(color_at(15, 15), 10, 20, 30));
}

TEST_P(OsmesaRenderer, bytes_are_exact_and_return_to_zero) {
  const TextureHandle texture = add(filled(4, {255, 255, 255, 255}));
  EXPECT_EQ(renderer_->bytes_of(texture), (16U + 4U + 1U) * 4U);
  EXPECT_EQ(renderer_->texture_bytes_bound(4, 4), renderer_->bytes_of(texture));
  const MeshHandle mesh = add(square_at(10, 5), {colored(200, 100, 50)});
  EXPECT_GE(renderer_->bytes_of(mesh), 4U * 28U + 6U * 2U);
  EXPECT_LE(renderer_->bytes_of(mesh), renderer_->mesh_bytes_bound(4, 2));
  EXPECT_EQ(renderer_->bytes(), renderer_->bytes_of(mesh) + renderer_->bytes_of(texture));
  renderer_->destroy(mesh);
  renderer_->destroy(texture);
  EXPECT_EQ(renderer_->bytes(), 0U);
}

TEST_P(OsmesaRenderer, missing_texture_shows_the_plain_color) {
  Material poster = colored(200, 100, 50);
  poster.texture = 5;
  const MeshHandle square = add(square_at(10, 5), {poster});
  draw({{square, kSeven}});
  EXPECT_TRUE(is_color(color_at(32, 32), 200, 100, 50));
}

INSTANTIATE_TEST_SUITE_P(Depth, OsmesaRenderer, testing::Bool(),
                         [](const auto& param_info) { return param_info.param ? "reversed" : "standard"; });

TEST(Context, offscreen_kinds_have_names) {
  EXPECT_EQ(offscreen_kind_named("osmesa"), OffscreenKind::osmesa);
  EXPECT_EQ(offscreen_kind_named("vulkan"), std::nullopt);
}

TEST(Context, two_renderers_take_turns) {
  Result<std::unique_ptr<GlContext>> a = create_offscreen_context(OffscreenKind::osmesa);
  ASSERT_TRUE(a);
  { ASSERT_TRUE(create_offscreen_context(OffscreenKind::osmesa)); }
  ASSERT_TRUE((*a)->make_current());
  EXPECT_NE((*a)->description().find("OpenGL"), std::string::npos);
  EXPECT_TRUE(create_gl_renderer(**a));
}

TEST(Staging, halves_in_linear_light) {
  Image image = filled(2, {255, 255, 255, 255});
  image.at(0, 0) = image.at(1, 1) = {0, 0, 0, 255};
  const Image half = halved(image);
  ASSERT_EQ(half.pixels.size(), 1U);
  EXPECT_EQ(half.at(0, 0).r, linear_to_srgb(0.5F));
}

TEST(Staging, transparent_texels_do_not_tint_their_neighbours) {
  Image image = filled(2, {0, 255, 0, 0});
  image.at(0, 0) = {255, 0, 0, 255};
  const Image half = halved(image);
  EXPECT_EQ(half.at(0, 0), glm::u8vec4(255, 0, 0, 64));
}

TEST(Staging, odd_pictures_keep_their_mean) {
  Image image{3, 1, {{0, 0, 0, 255}, {255, 255, 255, 255}, {0, 0, 0, 255}}};
  EXPECT_EQ(halved(image).at(0, 0).r, linear_to_srgb(1.0F / 3.0F));
}

TEST(Staging, groups_stand_opaque_masked_blended) {
  Mesh mesh = square_at(10, 5);
  append(mesh, square_at(11, 5));
  mesh.materials = {2, 1, 0, 2};
  Material mask;
  mask.alpha = AlphaMode::mask;
  const std::vector<Material> materials = {colored(1, 2, 3, 100), mask, colored(4, 5, 6)};
  const GlStagedMesh staged = stage_gl_mesh(mesh, materials);
  ASSERT_EQ(staged.groups.size(), 3U);
  EXPECT_EQ(staged.groups[0].material.alpha, AlphaMode::opaque);
  EXPECT_EQ(staged.groups[0].index_count, 6U);
  EXPECT_EQ(staged.groups[1].material.alpha, AlphaMode::mask);
  EXPECT_EQ(staged.groups[2].material.alpha, AlphaMode::blend);
  EXPECT_EQ(staged.indices16.size(), 12U);
}

TEST(Staging, many_vertices_take_wide_indices) {
  Mesh mesh;
  mesh.positions.assign(65537, glm::vec3(0));
  mesh.indices = {0, 1, 65536};
  const std::vector<Material> materials(1);
  const GlStagedMesh staged = stage_gl_mesh(mesh, materials);
  EXPECT_TRUE(staged.indices16.empty());
  EXPECT_EQ(staged.indices32, (std::vector<uint32_t>{0, 1, 65536}));
  EXPECT_LE(staged.byte_size(), gl_mesh_bytes_bound(65537, 1));
}

TEST(Staging, normals_pack_within_a_tenth_of_a_degree) {
  const glm::vec3 n = glm::normalize(glm::vec3(0.3F, -0.8F, 0.5F));
  const uint32_t packed = pack_normal(n);
  const auto part = [packed](int shift) {
    const int raw = static_cast<int>(packed >> shift & 1023U);
    return float(raw >= 512 ? raw - 1024 : raw) / 511.0F;
  };
  const glm::vec3 back(part(0), part(10), part(20));
  EXPECT_LT(glm::length(back - n), 0.0018F);
}

}  // namespace
}  // namespace promenade
