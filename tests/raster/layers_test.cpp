// Fades between levels, and what is seen through blended in layers.

#include <gtest/gtest.h>

#include <cmath>

#include "raster/shade.h"
#include "scenes.h"

namespace promenade {
namespace {

using namespace test_scenes;  // NOLINT(google-build-using-namespace)

RasterView view_from_above(uint32_t side, double scale) {
  return orthographic_view({{0, 0, 10}, 90, -90, 0}, glm::dvec3(0), side, side, scale, 0.1);
}

VisibilityOptions one_thread(Simd simd = Simd::best) {
  VisibilityOptions o;
  o.threads = 1, o.simd = simd;
  return o;
}

std::vector<uint32_t> nodes_of(const VisibilityBuffer& buffer) {
  std::vector<uint32_t> nodes(size_t(buffer.width_px()) * buffer.height_px());
  buffer.read_nodes(nodes);
  return nodes;
}

/// A square of a metre a side at a height.
Mesh square(float height) {
  Mesh mesh;
  add_triangle(mesh, {-1, -1, height}, {1, -1, height}, {1, 1, height});
  add_triangle(mesh, {-1, -1, height}, {1, 1, height}, {-1, 1, height});
  return mesh;
}

TEST(Fade, a_node_and_its_children_share_every_pixel_exactly) {
  const PreparedMesh parent = *prepare(bumpy_sphere({0, 0, 0}, 1, 12, 1), {});
  const RasterView view = view_from_above(128, 40);
  VisibilityBuffer buffer;
  ASSERT_TRUE(buffer.draw(view, std::vector<RasterItem>{{&parent, 1, nullptr, {}}}, one_thread()).ok());
  const std::vector<uint32_t> whole = nodes_of(buffer);
  size_t before = 0;
  for (const float a : {0.0F, 0.1F, 0.25F, 0.5F, 0.77F, 1.0F}) {
    RasterItem out{&parent, 1, nullptr, {}}, in{&parent, 2, nullptr, {}};
    out.fade_to = a, in.fade_from = a;
    size_t shares[3] = {};
    for (const Simd simd : {Simd::portable, Simd::avx2, Simd::avx512}) {
      ASSERT_TRUE(buffer.draw(view, std::vector<RasterItem>{out, in}, one_thread(simd)).ok());
      const std::vector<uint32_t> both = nodes_of(buffer);
      ASSERT_TRUE(buffer.draw(view, std::vector<RasterItem>{in}, one_thread(simd)).ok());
      const std::vector<uint32_t> alone = nodes_of(buffer);
      shares[1] = shares[2] = 0;
      for (size_t i = 0; i < whole.size(); ++i) {
        ASSERT_EQ(whole[i] == kNoTriangle, both[i] == kNoTriangle) << "a hole, or a pixel too many";
        ASSERT_EQ(both[i] == 2, alone[i] == 2);
        if (both[i] != kNoTriangle) ++shares[both[i]];
      }
    }
    EXPECT_NEAR(double(shares[1]) / double(shares[1] + shares[2]), a, 0.03);
    EXPECT_GE(shares[1], before) << "what has faded stays so";
    before = shares[1];
  }
}

TEST(Fade, hides_nothing_by_halves) {
  const PreparedMesh wall = *prepare(square(1), {});
  RasterItem item{&wall, 0, nullptr, {}};
  item.fade_to = 0.9F;
  VisibilityOptions inner = one_thread();
  inner.rule = PixelRule::inner;
  VisibilityBuffer buffer;
  ASSERT_TRUE(buffer.draw(view_from_above(64, 20), std::vector<RasterItem>{item}, inner).ok());
  for (const uint32_t n : nodes_of(buffer)) EXPECT_EQ(n, kNoTriangle);
}

/// Panes one above the other over a ground; all see-through but the ground.
struct Panes {
  std::vector<Material> materials;
  std::vector<PreparedMesh> meshes;
  std::unique_ptr<SurfaceTable> surfaces;
  std::vector<RasterItem> items;
  explicit Panes(const std::vector<glm::u8vec4>& colors) {
    for (const glm::u8vec4& color : colors) {
      Material m;
      m.color = color, m.two_sided = true, m.alpha = color.a == 255 ? AlphaMode::opaque : AlphaMode::blend;
      materials.push_back(m);
    }
    surfaces = std::make_unique<SurfaceTable>(materials, std::span<const MipTexture* const>{});
    for (uint32_t i = 0; i < colors.size(); ++i) {
      Mesh mesh = square(float(i));
      mesh.materials.assign(2, i);
      meshes.push_back(*prepare(mesh, materials));
    }
    for (uint32_t i = 0; i < meshes.size(); ++i) items.push_back({&meshes[i], i, surfaces.get(), {}});
  }
};

struct Layered {
  VisibilityBuffer solid;
  std::vector<VisibilityBuffer> layers;
  Image picture;
};

Layered layered(const RasterView& view, std::span<const RasterItem> items, size_t count, Simd simd = Simd::best,
                unsigned threads = 1) {
  Layered out;
  VisibilityOptions options = one_thread(simd);
  options.threads = threads, options.draw_blended = false;
  EXPECT_TRUE(out.solid.draw(view, items, options).ok());
  ShadeOptions shading;
  shading.threads = threads, shading.simd = simd, shading.sky = false;
  shading.sun = glm::vec3(0), shading.sky_ambient = shading.ground_ambient = glm::vec3(1);
  shade(out.solid, shading, out.picture);
  out.layers.resize(count);
  std::vector<const VisibilityBuffer*> pointers;
  for (size_t i = 0; i < count; ++i) {
    EXPECT_TRUE(out.layers[i].draw_layer(out.solid, i == 0 ? nullptr : &out.layers[i - 1], items, options).ok());
    pointers.push_back(&out.layers[i]);
  }
  blend_layers(pointers, shading, out.picture);
  return out;
}

TEST(Layers, come_from_the_nearest_to_the_farthest_and_blend_in_linear_light) {
  const Panes panes({{200, 200, 200, 255}, {255, 0, 0, 128}, {0, 255, 0, 64}, {0, 0, 255, 200}});
  const RasterView view = view_from_above(64, 20);
  const Layered p = layered(view, panes.items, 4);
  EXPECT_EQ(p.solid.node(32, 32), 0U);
  EXPECT_EQ(p.layers[0].node(32, 32), 3U);
  EXPECT_EQ(p.layers[1].node(32, 32), 2U);
  EXPECT_EQ(p.layers[2].node(32, 32), 1U);
  EXPECT_EQ(p.layers[3].node(32, 32), kNoTriangle);
  EXPECT_EQ(p.layers[0].node(2, 2), kNoTriangle);
  EXPECT_FLOAT_EQ(p.solid.depth_m(32, 32), 10.0F) << "depth is of what is solid";
  glm::vec3 expected(srgb_to_linear(200));
  for (const glm::u8vec4& color :
       {glm::u8vec4{255, 0, 0, 128}, glm::u8vec4{0, 255, 0, 64}, glm::u8vec4{0, 0, 255, 200}})
    for (int c = 0; c < 3; ++c) expected[c] += (srgb_to_linear(color[c]) - expected[c]) * float(color.a) / 255.0F;
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(p.picture.at(32, 32)[c], linear_to_srgb(expected[c]), 1);
  EXPECT_EQ(p.picture.at(2, 2), glm::u8vec4(0, 0, 0, 255));
}

TEST(Layers, behind_solid_surfaces_do_not_show) {
  Panes panes({{255, 0, 0, 128}, {200, 200, 200, 255}});
  const Layered p = layered(view_from_above(64, 20), panes.items, 1);
  for (const uint32_t n : nodes_of(p.layers[0])) EXPECT_EQ(n, kNoTriangle);
}

TEST(Layers, all_processors_and_threads_give_the_same_bytes) {
  Scene scene;
  scene.textures.push_back(*MipTexture::make(chequers(64, 8)));
  scene.materials.resize(2);
  for (Material& m : scene.materials) m.texture = 0, m.two_sided = true;
  scene.materials[1].alpha = AlphaMode::blend, scene.materials[1].color.a = 180;
  Random random(5);
  for (uint32_t i = 0; i < 8; ++i) {
    scene.meshes.push_back(bumpy_sphere(random.point(3), float(random.within(0.5, 2)), 8 + random.below(10), i));
    scene.meshes.back().materials.assign(scene.meshes.back().triangle_count(), i % 4 == 0 ? 0 : 1);
  }
  scene.finish();
  for (uint32_t i = 0; i < 4; ++i) {
    const RasterView view = perspective_view(random_camera(random, 6, 173, 101), glm::dvec3(0));
    const Layered portable = layered(view, scene.items, 3, Simd::portable);
    for (const Simd simd : {Simd::avx2, Simd::avx512}) {
      const Layered other = layered(view, scene.items, 3, simd, 2);
      EXPECT_EQ(portable.picture.pixels, other.picture.pixels);
      for (size_t l = 0; l < 3; ++l) EXPECT_EQ(nodes_of(portable.layers[l]), nodes_of(other.layers[l]));
    }
    for (uint32_t y = 0; y < 101; ++y)
      for (uint32_t x = 0; x < 173; ++x)
        for (size_t l = 1; l < 3; ++l) {
          if (portable.layers[l].node(x, y) == kNoTriangle) continue;
          ASSERT_NE(portable.layers[l - 1].node(x, y), kNoTriangle);
          ASSERT_GE(portable.layers[l].depth_m(x, y), portable.layers[l - 1].depth_m(x, y));
          ASSERT_GE(portable.solid.depth_m(x, y), portable.layers[l].depth_m(x, y));
        }
  }
}

TEST(Layers, drawn_into_once_more_show_nothing_of_before) {
  Panes panes({{200, 200, 200, 255}, {255, 0, 0, 128}, {0, 255, 0, 64}});
  std::vector<RasterItem> aside = panes.items;
  for (RasterItem& item : aside) item.model_from_mesh = glm::dmat4(1.0), (*item.model_from_mesh)[3].x = 9;
  const RasterView large = view_from_above(203, 20), small = view_from_above(150, 13);
  const auto same = [](const VisibilityBuffer& kept, const VisibilityBuffer& fresh) {
    EXPECT_EQ(nodes_of(kept), nodes_of(fresh));
    for (uint32_t y = 0; y < kept.height_px(); ++y)
      for (uint32_t x = 0; x < kept.width_px(); ++x) ASSERT_EQ(kept.depth_m(x, y), fresh.depth_m(x, y));
  };
  VisibilityBuffer solid, first, second;
  const std::vector<RasterItem> none(panes.items.begin(), panes.items.begin() + 1);
  for (const auto& [view, items] : {std::pair(large, panes.items),
                                    {large, aside},
                                    {small, panes.items},
                                    {large, none},
                                    {small, aside},
                                    {small, panes.items},
                                    {large, panes.items}})
    for (const unsigned threads : {1U, 2U}) {
      VisibilityOptions options = one_thread();
      options.threads = threads, options.draw_blended = false;
      ASSERT_TRUE(solid.draw(view, items, options).ok());
      ASSERT_TRUE(first.draw_layer(solid, nullptr, items, options).ok());
      ASSERT_TRUE(second.draw_layer(solid, &first, items, options).ok());
      VisibilityBuffer fresh_first, fresh_second;
      ASSERT_TRUE(fresh_first.draw_layer(solid, nullptr, items, one_thread()).ok());
      ASSERT_TRUE(fresh_second.draw_layer(solid, &fresh_first, items, one_thread()).ok());
      same(first, fresh_first), same(second, fresh_second);
      const bool seen = items.size() > 1 && !items[0].model_from_mesh;
      EXPECT_EQ(first.node(view.width_px / 2, view.height_px / 2), seen ? 2U : kNoTriangle);
      EXPECT_EQ(second.node(view.width_px / 2, view.height_px / 2), seen ? 1U : kNoTriangle);
    }
}

TEST(Layers, refuse_to_go_before_a_picture_that_is_not_there) {
  VisibilityBuffer none, layer;
  EXPECT_FALSE(layer.draw_layer(none, nullptr, {}, one_thread()).ok());
}

}  // namespace
}  // namespace promenade
