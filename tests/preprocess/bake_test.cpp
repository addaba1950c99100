#include "preprocess/bake.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <set>

#include "preprocess/charts.h"
#include "preprocess/texture_sampler.h"

namespace promenade {
namespace {

using testing::HasSubstr;
using Pictures = std::vector<Image>;

std::function<const Image*(uint32_t)> from(const Pictures& pictures) {
  return [&pictures](uint32_t i) { return i < pictures.size() ? &pictures[i] : nullptr; };
}

Image checker(uint32_t side, const glm::u8vec4& a, const glm::u8vec4& b) {
  Image image{side, side, {}};
  for (uint32_t y = 0; y < side; ++y)
    for (uint32_t x = 0; x < side; ++x) image.pixels.push_back((x + y) % 2 == 0 ? a : b);
  return image;
}

void add_quad(Mesh& mesh, const glm::vec3& at, const glm::vec3& u, const glm::vec3& v, uint32_t material) {
  const auto base = static_cast<uint32_t>(mesh.positions.size());
  for (const glm::vec2& st : {glm::vec2(0, 0), glm::vec2(1, 0), glm::vec2(1, 1), glm::vec2(0, 1)}) {
    mesh.positions.push_back(at + st.x * u + st.y * v);
    mesh.texcoords.push_back(st);
  }
  for (const uint32_t i : {0U, 1U, 2U, 0U, 2U, 3U}) mesh.indices.push_back(base + i);
  mesh.materials.insert(mesh.materials.end(), 2, material);
}

/// A cube from 0 to `side` whose faces have the materials given.
Mesh cube(float side, const std::array<uint32_t, 6>& materials) {
  Mesh mesh;
  const glm::vec3 x(side, 0, 0), y(0, side, 0), z(0, 0, side), o(0);
  add_quad(mesh, o, y, x, materials[0]);
  add_quad(mesh, z, x, y, materials[1]);
  add_quad(mesh, o, x, z, materials[2]);
  add_quad(mesh, y, z, x, materials[3]);
  add_quad(mesh, o, z, y, materials[4]);
  add_quad(mesh, x, y, z, materials[5]);
  return mesh;
}

/// The same surface without looks, its corners shared.
Mesh bare(const Mesh& mesh) {
  Mesh out;
  out.indices = mesh.indices;
  for (uint32_t& i : out.indices) {
    uint32_t v = 0;
    while (v < out.positions.size() && out.positions[v] != mesh.positions[i]) ++v;
    if (v == out.positions.size()) out.positions.push_back(mesh.positions[i]);
    i = v;
  }
  return out;
}

Material textured(uint32_t texture) {
  Material m;
  m.texture = texture;
  return m;
}

Material colored(const glm::u8vec4& color) {
  Material m;
  m.color = color;
  return m;
}

/// Colour of the atlas at a triangle's point, as a renderer with bilinear filter finds it.
glm::vec4 seen(const BakedMesh& baked, size_t triangle, const glm::vec3& weights) {
  glm::vec2 t(0);
  for (int c = 0; c < 3; ++c)
    t += weights[c] * baked.mesh.texcoords[baked.mesh.indices[3 * triangle + static_cast<size_t>(c)]];
  const glm::vec2 p = t * glm::vec2(float(baked.atlas.width), float(baked.atlas.height)) - 0.5F;
  const glm::vec2 low = glm::floor(p), share = p - low;
  const auto at = [&baked](float x, float y) {
    return glm::vec4(baked.atlas.at(static_cast<uint32_t>(std::clamp(x, 0.0F, float(baked.atlas.width) - 1)),
                                    static_cast<uint32_t>(std::clamp(y, 0.0F, float(baked.atlas.height) - 1))));
  };
  return glm::mix(glm::mix(at(low.x, low.y), at(low.x + 1, low.y), share.x),
                  glm::mix(at(low.x, low.y + 1), at(low.x + 1, low.y + 1), share.x), share.y);
}

/// Weights of many points of a triangle, corners and edges among them.
std::vector<glm::vec3> points_of_triangle(int steps) {
  std::vector<glm::vec3> points;
  for (int i = 0; i <= steps; ++i)
    for (int j = 0; i + j <= steps; ++j)
      points.push_back(glm::vec3(float(steps - i - j), float(i), float(j)) / float(steps));
  return points;
}

BakedMesh baked_ok(const Mesh& simplified, const Mesh& detailed, std::span<const Material> materials,
                   const Pictures& pictures, const BakeOptions& options) {
  Result<BakedMesh> baked = bake_atlas(simplified, detailed, materials, from(pictures), options);
  EXPECT_TRUE(baked) << (baked ? "" : baked.error().message);
  return baked ? *baked : BakedMesh{};
}

TEST(Bake, keeps_the_checker_of_a_box) {
  const Pictures pictures = {checker(4, {255, 255, 255, 255}, {0, 0, 0, 255})};
  const std::vector<Material> materials = {textured(0)};
  const Mesh box = cube(4, {});
  const BakedMesh baked = baked_ok(bare(box), box, materials, pictures, {0.05, 1024, 2});
  EXPECT_NEAR(baked.texel_m, 0.05, 1e-6);
  size_t right = 0, asked = 0;
  for (size_t t = 0; t < box.triangle_count(); ++t)
    for (const glm::vec3& w : points_of_triangle(37)) {
      glm::vec2 uv(0);
      for (int c = 0; c < 3; ++c) uv += w[c] * box.texcoords[box.indices[3 * t + static_cast<size_t>(c)]];
      const glm::vec2 in_cell = glm::fract(uv * 4.0F);
      // The picture itself is filtered linearly between its texels; in their middles it is plain.
      if (glm::any(glm::lessThan(in_cell, glm::vec2(0.45F))) || glm::any(glm::greaterThan(in_cell, glm::vec2(0.55F))))
        continue;
      const bool white = static_cast<int>(std::floor(uv.x * 4) + std::floor(uv.y * 4)) % 2 == 0;
      const float value = seen(baked, t, w).r;
      ++asked;
      right += (white ? value > 215 : value < 110) ? 1U : 0U;
    }
  EXPECT_GT(asked, 50U);
  EXPECT_EQ(right, asked);
}

TEST(Bake, lets_no_colour_bleed_between_charts) {
  const std::vector<Material> materials = {colored({255, 0, 0, 255}), colored({0, 0, 255, 255})};
  const Mesh box = cube(3, {0, 1, 0, 1, 0, 1});
  for (const double texel_m : {0.011, 0.1, 0.37, 5.0}) {
    const BakedMesh baked = baked_ok(bare(box), box, materials, {}, {texel_m, 1024, 2});
    for (size_t t = 0; t < box.triangle_count(); ++t)
      for (const glm::vec3& w : points_of_triangle(23)) {
        const glm::vec4 expected(materials[box.materials[t]].color);
        ASSERT_EQ(seen(baked, t, w), expected) << "texel " << texel_m << ", triangle " << t;
      }
  }
}

TEST(Bake, fills_the_padding_with_the_charts_own_colour) {
  const std::vector<Material> materials = {colored({255, 0, 0, 255}), colored({0, 0, 255, 255})};
  const Mesh box = cube(3, {0, 1, 0, 1, 0, 1});
  const BakedMesh baked = baked_ok(bare(box), box, materials, {}, {0.1, 1024, 3});
  for (const glm::vec2& uv : baked.mesh.texcoords) {
    const glm::ivec2 p(uv * glm::vec2(float(baked.atlas.width), float(baked.atlas.height)));
    std::set<uint32_t> reds;
    for (int y = p.y - 3; y <= p.y + 3; ++y)
      for (int x = p.x - 3; x <= p.x + 3; ++x)
        if (x >= 0 && y >= 0 && x < int(baked.atlas.width) && y < int(baked.atlas.height))
          reds.insert(baked.atlas.at(static_cast<uint32_t>(x), static_cast<uint32_t>(y)).r);
    EXPECT_EQ(reds.size(), 1U);
  }
}

TEST(Bake, keeps_cut_outs_and_says_so) {
  Mesh sheet;
  add_quad(sheet, {0, 0, 0}, {4, 0, 0}, {0, 4, 0}, 0);
  const Pictures pictures = {checker(2, {10, 200, 10, 255}, {10, 200, 10, 0})};
  std::vector<Material> materials = {textured(0)};
  EXPECT_FALSE(baked_ok(bare(sheet), sheet, materials, pictures, {0.1, 256, 2}).has_opacity);
  materials[0].alpha = AlphaMode::mask;
  const BakedMesh baked = baked_ok(bare(sheet), sheet, materials, pictures, {0.1, 256, 2});
  EXPECT_TRUE(baked.has_opacity);
  size_t clear = 0, there = 0;
  for (const glm::u8vec4& p : baked.atlas.pixels) {
    clear += p.a < 100 ? 1U : 0U;
    there += p.a > 155 ? 1U : 0U;
    EXPECT_NEAR(p.g, 200, 60);  // clear texels keep the colour, so that filters do not see black
  }
  EXPECT_GT(clear, 300U);
  EXPECT_GT(there, 300U);
}

TEST(Bake, says_which_triangles_are_seen_through_and_how) {
  Mesh parts;  // apart and turned, so that each is a chart of its own
  add_quad(parts, {0, 0, 0}, {4, 0, 0}, {0, 4, 0}, 0);
  add_quad(parts, {0, 9, 0}, {4, 0, 0}, {0, 0, 4}, 1);
  add_quad(parts, {9, 0, 0}, {0, 4, 0}, {0, 0, 4}, 2);
  // A wall with a pane in it: one chart, half of it glass.
  add_quad(parts, {20, 0, 0}, {4, 0, 0}, {0, 4, 0}, 0);
  add_quad(parts, {24, 0, 0}, {4, 0, 0}, {0, 4, 0}, 2);
  const Pictures pictures = {checker(2, {10, 200, 10, 255}, {10, 200, 10, 0})};
  std::vector<Material> materials = {textured(0), textured(0), Material{}};
  materials[1].alpha = AlphaMode::mask;
  materials[2].alpha = AlphaMode::blend, materials[2].color.a = 90;
  const BakedMesh baked = baked_ok(bare(parts), parts, materials, pictures, {0.1, 1024, 2});
  constexpr auto kO = AlphaMode::opaque, kM = AlphaMode::mask, kB = AlphaMode::blend;
  EXPECT_EQ(baked.alpha, (std::vector<AlphaMode>{kO, kO, kM, kM, kB, kB, kO, kO, kB, kB}));
}

TEST(Bake, leaves_opaque_what_only_its_vertices_call_clear) {
  Mesh sheet;
  add_quad(sheet, {0, 0, 0}, {4, 0, 0}, {0, 4, 0}, 0);
  sheet.colors.assign(4, {255, 255, 255, 40});
  const Pictures pictures = {Image{1, 1, {{200, 200, 0, 255}}}};
  const std::vector<Material> materials = {textured(0)};
  const BakedMesh baked = baked_ok(bare(sheet), sheet, materials, pictures, {0.1, 256, 2});
  EXPECT_FALSE(baked.has_opacity);
  EXPECT_EQ(baked.alpha, std::vector<AlphaMode>(2, AlphaMode::opaque));
}

TEST(Bake, multiplies_texture_material_and_vertex_colours) {
  Mesh sheet;
  add_quad(sheet, {0, 0, 0}, {4, 0, 0}, {0, 4, 0}, 0);
  sheet.colors.assign(4, {255, 128, 255, 255});
  const Pictures pictures = {Image{1, 1, {{200, 200, 0, 255}}}};
  std::vector<Material> materials = {textured(0)};
  materials[0].color = {128, 255, 255, 255};
  const glm::vec4 color =
      seen(baked_ok(bare(sheet), sheet, materials, pictures, {0.1, 256, 2}), 0, glm::vec3(1.0F / 3));
  const float expected = linear_to_srgb(srgb_to_linear(200) * srgb_to_linear(128));
  EXPECT_NEAR(color.r, expected, 1);
  EXPECT_NEAR(color.g, expected, 1);
  EXPECT_EQ(color.b, 0);
}

TEST(Bake, shows_the_materials_colour_for_a_missing_texture) {
  Mesh sheet;
  add_quad(sheet, {0, 0, 0}, {4, 0, 0}, {0, 4, 0}, 0);
  std::vector<Material> materials = {textured(7)};
  materials[0].color = {1, 99, 3, 255};
  EXPECT_EQ(seen(baked_ok(bare(sheet), sheet, materials, {}, {0.1, 256, 2}), 1, glm::vec3(1.0F / 3)).g, 99);
}

TEST(Bake, takes_each_side_of_a_thin_wall_from_its_own_side) {
  Mesh wall;
  add_quad(wall, {0, 0.02F, 0}, {0, 0, 4}, {4, 0, 0}, 0);  // faces +y, is nearer to both sheets below
  add_quad(wall, {0, 0, 0}, {4, 0, 0}, {0, 0, 4}, 1);      // faces -y
  Mesh simplified;
  add_quad(simplified, {0, 0.012F, 0}, {0, 0, 4}, {4, 0, 0}, 0);
  add_quad(simplified, {0, 0.012F, 0}, {4, 0, 0}, {0, 0, 4}, 0);
  const std::vector<Material> materials = {colored({255, 0, 0, 255}), colored({0, 0, 255, 255})};
  const BakedMesh baked = baked_ok(bare(simplified), wall, materials, {}, {0.1, 256, 2});
  for (const glm::vec3& w : points_of_triangle(5)) {
    EXPECT_EQ(seen(baked, 0, w).r, 255);
    EXPECT_EQ(seen(baked, 2, w).b, 255);
  }
}

TEST(Bake, coarsens_texels_until_the_atlas_fits) {
  const Mesh box = cube(100, {});
  const std::vector<Material> materials = {colored({9, 9, 9, 255})};
  const BakedMesh baked = baked_ok(bare(box), box, materials, {}, {0.01, 128, 2});
  EXPECT_LE(std::max(baked.atlas.width, baked.atlas.height), 128U);
  EXPECT_GT(baked.texel_m, 1.0);
  EXPECT_LT(baked.texel_m, 4.0);
}

TEST(Bake, takes_the_mean_where_an_edge_crosses_a_texel) {
  Mesh sheet;
  add_quad(sheet, {0, 0, 0}, {2.5F, 0, 0}, {0, 5, 0}, 0);  // a texel of 0.5 m around x = 2.5 is half and half
  add_quad(sheet, {2.5F, 0, 0}, {2.5F, 0, 0}, {0, 5, 0}, 1);
  const std::vector<Material> materials = {colored({0, 0, 0, 255}), colored({255, 255, 255, 255})};
  const BakedMesh baked = baked_ok(bare(sheet), sheet, materials, {}, {1.0, 256, 2});
  std::set<uint32_t> values;
  for (const glm::u8vec4& p : baked.atlas.pixels) values.insert(p.r);
  EXPECT_THAT(values, testing::UnorderedElementsAre(0U, 188U, 255U));
}

TEST(Bake, survives_triangles_without_area) {
  Mesh mesh = bare(cube(2, {}));
  mesh.positions.emplace_back(1, 1, 2);
  mesh.indices.insert(mesh.indices.end(), {8, 8, 8, 0, 0, 1, 0, 1, 0});
  Mesh detailed = cube(2, {});
  detailed.indices.insert(detailed.indices.end(), {0, 0, 0, 1, 2, 1});
  detailed.materials.insert(detailed.materials.end(), {0, 0});
  const std::vector<Material> materials = {colored({50, 60, 70, 255})};
  const BakedMesh baked = baked_ok(mesh, detailed, materials, {}, {0.1, 512, 2});
  EXPECT_EQ(find_defect(baked.mesh), "");
  EXPECT_EQ(baked.mesh.triangle_count(), mesh.triangle_count());
  for (const glm::u8vec4& p : baked.atlas.pixels) EXPECT_EQ(p, glm::u8vec4(50, 60, 70, 255));
}

TEST(Bake, keeps_triangles_in_order_and_texture_coordinates_inside) {
  const Mesh box = cube(2, {});
  const Mesh simplified = bare(box);
  const std::vector<Material> materials = {colored({50, 60, 70, 255})};
  const BakedMesh baked = baked_ok(simplified, box, materials, {}, {0.1, 512, 2});
  ASSERT_EQ(baked.mesh.indices.size(), simplified.indices.size());
  for (size_t i = 0; i < simplified.indices.size(); ++i)
    EXPECT_EQ(baked.mesh.positions[baked.mesh.indices[i]], simplified.positions[simplified.indices[i]]);
  for (const glm::vec2& uv : baked.mesh.texcoords) {
    EXPECT_TRUE(glm::all(glm::greaterThanEqual(uv, glm::vec2(0))) && glm::all(glm::lessThanEqual(uv, glm::vec2(1))));
  }
  EXPECT_EQ(baked.mesh.vertex_count(), 24U);
  EXPECT_TRUE(baked.mesh.materials.empty() && baked.mesh.colors.empty());
}

TEST(Bake, gives_the_same_bytes_each_time) {
  const Pictures pictures = {checker(64, {255, 20, 255, 255}, {0, 90, 0, 255})};
  const std::vector<Material> materials = {textured(0)};
  const Mesh box = cube(7, {});
  const BakedMesh a = baked_ok(bare(box), box, materials, pictures, {0.07, 1024, 2});
  const BakedMesh b = baked_ok(bare(box), box, materials, pictures, {0.07, 1024, 2});
  EXPECT_EQ(a.atlas.pixels, b.atlas.pixels);
  EXPECT_EQ(a.mesh.texcoords, b.mesh.texcoords);
}

TEST(Bake, refuses_nothing_and_options_out_of_range) {
  const Mesh box = cube(2, {});
  const std::vector<Material> materials = {Material{}};
  EXPECT_FALSE(bake_atlas(Mesh{}, box, materials, from({}), {}));
  EXPECT_FALSE(bake_atlas(box, Mesh{}, materials, from({}), {}));
  EXPECT_THAT(bake_atlas(box, cube(2, {1}), materials, from({}), {}).error().message, HasSubstr("material 1 of 1"));
  EXPECT_FALSE(bake_atlas(box, box, materials, from({}), {0, 1024, 2}));
  EXPECT_FALSE(bake_atlas(box, box, materials, from({}), {0.1, 1, 2}));
  EXPECT_FALSE(bake_atlas(box, box, materials, from({}), {0.1, 1024, 0}));
}

TEST(Charts, are_the_faces_of_a_box) {
  const std::vector<Chart> charts = make_charts(bare(cube(2, {})));
  ASSERT_EQ(charts.size(), 6U);
  for (const Chart& chart : charts) {
    EXPECT_EQ(chart.triangles.size(), 2U);
    EXPECT_NEAR(chart.size_m.x, 2, 1e-5);
    EXPECT_NEAR(chart.size_m.y, 2, 1e-5);
  }
}

/// A ramp that winds `turns` times around an axis.
Mesh winding_ramp(float turns) {
  Mesh mesh;
  const int steps = static_cast<int>(turns * 24);
  for (int i = 0; i <= steps; ++i) {
    const float angle = float(i) * 6.2831853F / 24;
    for (const float radius : {1.0F, 3.0F})
      mesh.positions.emplace_back(radius * std::cos(angle), radius * std::sin(angle), float(i) * 0.02F);
  }
  for (uint32_t i = 0; i < static_cast<uint32_t>(steps); ++i)
    for (const uint32_t v : {0U, 1U, 3U, 0U, 3U, 2U}) mesh.indices.push_back(2 * i + v);
  return mesh;
}

TEST(Charts, do_not_lie_on_themselves_where_a_ramp_winds_up) {
  EXPECT_EQ(make_charts(winding_ramp(0.9F)).size(), 1U);
  const std::vector<Chart> charts = make_charts(winding_ramp(2.5F));
  EXPECT_GE(charts.size(), 3U);
  size_t triangles = 0;
  for (const Chart& chart : charts) {
    triangles += chart.triangles.size();
    EXPECT_LE(chart.triangles.size(), 50U);
  }
  EXPECT_EQ(triangles, winding_ramp(2.5F).triangle_count());
}

TEST(PackedCharts, do_not_overlap_and_stay_inside) {
  std::vector<Chart> charts(300);
  for (size_t i = 0; i < charts.size(); ++i) charts[i].size_m = {float(i % 17) * 0.3F, float(i % 29) * 0.1F};
  const Result<AtlasLayout> layout = pack_charts(charts, {0.05, 512, 2});
  ASSERT_TRUE(layout) << layout.error().message;
  std::vector<int> used(size_t(layout->width) * layout->height);
  for (const AtlasPlace& p : layout->places)
    for (uint32_t y = p.y; y < p.y + p.height; ++y)
      for (uint32_t x = p.x; x < p.x + p.width; ++x) {
        ASSERT_LT(x, layout->width);
        ASSERT_LT(y, layout->height);
        EXPECT_EQ(used[size_t(y) * layout->width + x]++, 0);
      }
}

TEST(PackedCharts, give_up_padding_before_they_give_up) {
  const std::vector<Chart> charts(3000);
  const Result<AtlasLayout> layout = pack_charts(charts, {0.05, 200, 2});
  ASSERT_TRUE(layout) << layout.error().message;
  EXPECT_LT(layout->padding_px, 2U);
  EXPECT_THAT(pack_charts(charts, {0.05, 64, 2}).error().message, HasSubstr("3000 charts do not fit"));
}

TEST(FilteredTexture, shows_the_mean_light_of_what_is_far_away) {
  const Image image = checker(256, {255, 255, 255, 255}, {0, 0, 0, 255});
  FilteredTexture texture(image, Material{});
  for (const float footprint : {4.0F, 64.0F, 1e6F}) EXPECT_NEAR(texture.at({0.3F, 0.7F}, footprint).r, 0.5F, 1e-3);
  EXPECT_NEAR(texture.at({0.5F / 256, 0.5F / 256}, 1).r, 1, 1e-5);
}

TEST(FilteredTexture, wraps_as_its_material_says) {
  const Image image{2, 1, {{255, 0, 0, 255}, {0, 0, 255, 255}}};
  Material material;
  const auto red_at = [&](float u) { return FilteredTexture(image, material).at({u, 0.5F}, 1).r; };
  EXPECT_NEAR(red_at(1.25F), 1, 1e-5);
  EXPECT_NEAR(red_at(-0.25F), 0, 1e-5);
  material.wrap_u = Wrap::mirror;
  EXPECT_NEAR(red_at(1.25F), 0, 1e-5);
  EXPECT_NEAR(red_at(-0.25F), 1, 1e-5);
  material.wrap_u = Wrap::clamp;
  EXPECT_NEAR(red_at(7), 0, 1e-5);
  EXPECT_NEAR(red_at(-7), 1, 1e-5);
}

}  // namespace
}  // namespace promenade
