// The CPU renderer behind the renderer's interface: what it promises, and its pictures beside OpenGL's.

#include "runtime/cpu_renderer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/ext/matrix_transform.hpp>
#include <limits>

#include "runtime/gl_renderer.h"
#include "tests/runtime/scenes.h"

namespace promenade {
namespace {

using scenes::colored, scenes::filled, scenes::looking_along_x, scenes::square_at;

constexpr NodeId kSeven{7}, kEight{8};

MeshHandle add_mesh(Renderer& renderer, const Mesh& mesh, const std::vector<Material>& materials,
                    const std::vector<TextureHandle>& textures = {}) {
  Result<MeshHandle> handle = renderer.create_mesh(*renderer.stage_mesh(mesh, materials), textures);
  EXPECT_TRUE(handle);
  return *handle;
}

TextureHandle add_texture(Renderer& renderer, const Image& image) {
  Result<TextureHandle> handle = renderer.create_texture(*renderer.stage_texture(image));
  EXPECT_TRUE(handle);
  return *handle;
}

class CpuRendererTest : public testing::Test {
 protected:
  CpuRendererTest() {
    view_.camera = looking_along_x();
    view_.lighting.sun = glm::vec3(0);
    view_.lighting.sky_ambient = view_.lighting.ground_ambient = glm::vec3(1);
    view_.background.sky = false;
    view_.background.plain = {10, 20, 30, 255};
  }
  MeshHandle add(const Mesh& mesh, const std::vector<Material>& materials,
                 const std::vector<TextureHandle>& textures = {}) {
    return add_mesh(*renderer_, mesh, materials, textures);
  }
  TextureHandle add(const Image& image) { return add_texture(*renderer_, image); }
  void draw(const std::vector<DrawItem>& items) { ASSERT_TRUE(renderer_->draw(view_, items)); }
  glm::ivec4 color_at(uint32_t x, uint32_t y) { return glm::ivec4(renderer_->read_color()->at(x, y)); }
  float depth_at(uint32_t x, uint32_t y) { return (*renderer_->read_depth())[size_t(y) * 64 + x]; }
  uint32_t node_at(uint32_t x, uint32_t y) { return (*renderer_->read_nodes())[size_t(y) * 64 + x]; }

  std::unique_ptr<Renderer> renderer_ = create_cpu_renderer();
  FrameView view_;
};

testing::AssertionResult is_color(const glm::ivec4& found, int r, int g, int b) {
  const glm::ivec4 off = glm::abs(found - glm::ivec4(r, g, b, 255));
  if (off.r <= 1 && off.g <= 1 && off.b <= 1 && off.a == 0) return testing::AssertionSuccess();
  return testing::AssertionFailure() << "found " << found.r << ", " << found.g << ", " << found.b << ", " << found.a;
}

TEST_F(CpuRendererTest, square_covers_exactly_its_pixels_with_its_color_depth_and_node) {
  const MeshHandle square = add(square_at(10, 5), {colored(200, 100, 50)});
  draw({{square, kSeven}});
  for (uint32_t y = 0; y < 64; ++y)
    for (uint32_t x = 0; x < 64; ++x) {
      const bool inside = x >= 16 && x < 48 && y >= 16 && y < 48;
      ASSERT_EQ(node_at(x, y), inside ? 7U : 0xffffffffU) << x << ", " << y;
    }
  EXPECT_TRUE(is_color(color_at(32, 32), 200, 100, 50));
  EXPECT_TRUE(is_color(color_at(0, 0), 10, 20, 30));
  EXPECT_NEAR(depth_at(17, 47), 10, 1e-4);
  EXPECT_EQ(depth_at(0, 0), std::numeric_limits<float>::infinity());
}

TEST_F(CpuRendererTest, instances_stand_where_their_matrices_put_them_and_mirrored_ones_keep_their_fronts) {
  const MeshHandle square = add(square_at(10, 1), {colored(200, 100, 50)});
  draw({{square, kSeven, glm::translate(glm::mat4(1), glm::vec3(0, 5, 5))},
        {square, kEight, glm::scale(glm::translate(glm::mat4(1), glm::vec3(0, -5, -5)), glm::vec3(1, -1, 1))}});
  EXPECT_EQ(node_at(16, 16), 7U);
  EXPECT_EQ(node_at(47, 47), 8U);
  EXPECT_TRUE(is_color(color_at(47, 47), 200, 100, 50));
  EXPECT_EQ(node_at(32, 32), 0xffffffffU);
}

TEST_F(CpuRendererTest, masked_texels_are_not_there) {
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
  EXPECT_TRUE(std::isinf(depth_at(20, 32)));
}

TEST_F(CpuRendererTest, glass_lets_its_share_of_light_through_and_hides_nothing_from_depth_and_nodes) {
  const MeshHandle wall = add(square_at(30, 30), {colored(255, 255, 255)});
  const MeshHandle red = add(square_at(20, 20), {colored(255, 0, 0, 64)});
  draw({{red, kEight}, {wall, NodeId{9}}});
  const int through = linear_to_srgb(1.0F - 64.0F / 255.0F);
  for (uint32_t y = 0; y < 64; y += 7)
    for (uint32_t x = 0; x < 64; x += 5) EXPECT_TRUE(is_color(color_at(x, y), 255, through, through));
  EXPECT_EQ(node_at(32, 32), 9U);
  EXPECT_NEAR(depth_at(32, 32), 30, 0.01);
}

TEST_F(CpuRendererTest, nodes_that_fade_into_each_other_leave_no_hole) {
  const MeshHandle square = add(square_at(20, 30), {colored(255, 255, 255)});
  for (const float a : {0.0F, 0.3F, 0.8F, 1.0F}) {
    draw({{square, kEight, glm::mat4(1.0F), 0, a}, {square, NodeId{9}, glm::mat4(1.0F), a, 1}});
    const std::vector<uint32_t> nodes = *renderer_->read_nodes();
    EXPECT_NEAR(double(std::count(nodes.begin(), nodes.end(), 8U)) / (64 * 64), a, 0.02);
    EXPECT_EQ(std::count(nodes.begin(), nodes.end(), 0xffffffffU), 0);
  }
}

TEST_F(CpuRendererTest, bytes_stay_below_their_bounds_and_return_to_zero) {
  const TextureHandle texture = add(filled(5, {255, 255, 255, 77}));
  EXPECT_LE(renderer_->bytes_of(texture), renderer_->texture_bytes_bound(5, 5));
  Mesh grid;
  for (uint32_t i = 0; i < 1000; ++i) append(grid, square_at(10 + float(i), 1));
  grid.normals.assign(grid.positions.size(), glm::vec3(1, 0, 0));
  grid.colors.assign(grid.positions.size(), glm::u8vec4(255));
  grid.materials.assign(grid.triangle_count(), 0);
  const std::unique_ptr<StagedMesh> staged = renderer_->stage_mesh(grid, std::vector<Material>(1));
  EXPECT_LE(staged->byte_size(), renderer_->mesh_bytes_bound(grid.vertex_count(), grid.triangle_count()));
  const MeshHandle mesh = *renderer_->create_mesh(*staged, {});
  EXPECT_EQ(renderer_->bytes(), renderer_->bytes_of(mesh) + renderer_->bytes_of(texture));
  renderer_->destroy(mesh);
  renderer_->destroy(texture);
  EXPECT_EQ(renderer_->bytes(), 0U);
}

TEST_F(CpuRendererTest, refuses_to_read_before_a_frame) {
  EXPECT_FALSE(renderer_->read_color());
  EXPECT_FALSE(renderer_->read_depth());
  EXPECT_FALSE(renderer_->read_nodes());
}

/// Boxes with textures, vertex colours and normals, under sun and sky.
std::vector<DrawItem> fill_market(Renderer& renderer) {
  Image bricks = filled(64, {180, 90, 70, 255});
  for (uint32_t y = 0; y < 64; ++y)
    for (uint32_t x = 0; x < 64; ++x)
      if (y % 16 == 0 || (x + y / 16 * 8) % 32 == 0) bricks.at(x, y) = {200, 200, 190, 255};
  Material wall = colored(255, 255, 255);
  wall.texture = 0, wall.two_sided = true;
  const TextureHandle texture = add_texture(renderer, bricks);
  Mesh plain = square_at(8, 3), painted = square_at(12, 7);
  painted.normals.assign(4, glm::normalize(glm::vec3(-1, 0.3F, 0.5F)));
  painted.colors = {{255, 0, 0, 255}, {0, 255, 0, 255}, {0, 0, 255, 255}, {255, 255, 255, 255}};
  const MeshHandle a = add_mesh(renderer, plain, {wall}, {texture}), b = add_mesh(renderer, painted, {wall}, {texture});
  const MeshHandle ground = add_mesh(renderer, square_at(2, 60), {wall}, {texture});
  return {{a, kSeven, glm::rotate(glm::mat4(1), 0.3F, glm::vec3(0, 0, 1))},
          {b, kEight, glm::mat4(1)},
          {ground, NodeId{9}, glm::rotate(glm::mat4(1), 1.5707963F, glm::vec3(0, 1, 0))}};
}

TEST(CpuRendererBesideOpenGl, pictures_differ_by_little_and_ids_and_depths_hardly_at_all) {
  Result<std::unique_ptr<GlContext>> context = create_offscreen_context(OffscreenKind::osmesa);
  ASSERT_TRUE(context) << context.error().message;
  Result<std::unique_ptr<GlRenderer>> gl = create_gl_renderer(**context);
  ASSERT_TRUE(gl) << gl.error().message;
  const std::unique_ptr<Renderer> cpu = create_cpu_renderer();
  FrameView view;
  view.camera = looking_along_x(256);
  view.camera.pose.pitch_deg = -5;
  Renderer* renderers[] = {gl->get(), cpu.get()};
  Image color[2];
  std::vector<float> depth[2];
  std::vector<uint32_t> nodes[2];
  for (int i = 0; i < 2; ++i) {
    ASSERT_TRUE(renderers[i]->draw(view, fill_market(*renderers[i])));
    color[i] = *renderers[i]->read_color(), depth[i] = *renderers[i]->read_depth(),
    nodes[i] = *renderers[i]->read_nodes();
  }
  double squares = 0;
  size_t other_nodes = 0, other_depths = 0;
  for (size_t i = 0; i < nodes[0].size(); ++i) {
    const glm::ivec3 d = glm::ivec3(color[0].pixels[i]) - glm::ivec3(color[1].pixels[i]);
    squares += d.x * d.x + d.y * d.y + d.z * d.z;
    other_nodes += nodes[0][i] != nodes[1][i];
    other_depths += nodes[0][i] == nodes[1][i] && std::abs(depth[0][i] - depth[1][i]) > 1e-3F * depth[1][i];
  }
  const double psnr = 10 * std::log10(255.0 * 255.0 / (squares / (3.0 * double(nodes[0].size()))));
  EXPECT_GT(psnr, 32);
  EXPECT_LT(other_nodes, nodes[0].size() / 1000);
  EXPECT_EQ(other_depths, 0U);
  RecordProperty("psnr_db", std::to_string(psnr));
}

}  // namespace
}  // namespace promenade
