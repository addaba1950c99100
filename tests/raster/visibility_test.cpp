// The visibility buffer against itself: fill rule, processors, threads, culling, hostile input.

#include "raster/visibility.h"

#include <gtest/gtest.h>

#include <bit>
#include <limits>

#include "scenes.h"

namespace promenade {
namespace {

using namespace test_scenes;  // NOLINT(google-build-using-namespace)

struct Picture {
  std::vector<float> depth_m;
  std::vector<uint32_t> nodes, triangles;
  bool operator==(const Picture&) const = default;
};

Picture picture_of(const VisibilityBuffer& buffer) {
  const size_t pixels = size_t(buffer.width_px()) * buffer.height_px();
  Picture p = {std::vector<float>(pixels), std::vector<uint32_t>(pixels), std::vector<uint32_t>(pixels)};
  buffer.read_depth_m(p.depth_m);
  buffer.read_nodes(p.nodes);
  buffer.read_triangles(p.triangles);
  return p;
}

Picture draw(const RasterView& view, std::span<const RasterItem> items, const VisibilityOptions& options = {}) {
  VisibilityBuffer buffer;
  const Status status = buffer.draw(view, items, options);
  EXPECT_TRUE(status.ok());
  return picture_of(buffer);
}

VisibilityOptions one_thread(Simd simd = Simd::best) {
  VisibilityOptions o;
  o.threads = 1, o.simd = simd;
  return o;
}

/// Looks down -z from 10 m above; 1 m is `scale` pixels on the plane z = 0.
RasterView view_from_above(uint32_t width, uint32_t height, double scale) {
  return orthographic_view({{0, 0, 10}, 90, -90, 0}, glm::dvec3(0), width, height, scale, 0.1);
}

size_t covered(const Picture& p) {
  return static_cast<size_t>(
      std::count_if(p.nodes.begin(), p.nodes.end(), [](uint32_t n) { return n != kNoTriangle; }));
}

/// A convex polygon about the origin, cut into a fan at an inner point: all triangles share edges, corners lie on and
/// between the sub-pixel grid.
std::vector<std::array<glm::vec3, 3>> random_fan(Random& random, double radius, bool on_grid, double scale) {
  const uint32_t count = 3 + random.below(9);
  std::vector<glm::vec3> ring;
  const auto snap = [&](double v) { return float(on_grid ? std::round(v * scale * 2) / (scale * 2) : v); };
  for (uint32_t i = 0; i < count; ++i) {
    const double a = 2 * M_PI * (i + random.within(0, 0.8)) / count, r = radius * random.within(0.8, 1);
    ring.emplace_back(snap(r * std::cos(a)), snap(r * std::sin(a)), 0.0F);
  }
  const glm::vec3 hub(snap(random.within(-0.1, 0.1) * radius), snap(random.within(-0.1, 0.1) * radius), 0.0F);
  std::vector<std::array<glm::vec3, 3>> fan;
  for (uint32_t i = 0; i < count; ++i) fan.push_back({hub, ring[i], ring[(i + 1) % count]});
  return fan;
}

class EachSimd : public testing::TestWithParam<Simd> {};

TEST_P(EachSimd, fans_cover_each_pixel_exactly_once) {
  Random random(1);
  for (uint32_t round = 0; round < 60; ++round) {
    const double scale = 16, radius = std::pow(10.0, random.within(-1, 0.7));  // triangles of 1 to 100 pixels
    const auto fan = random_fan(random, radius, round % 2 == 0, scale);
    const RasterView view = view_from_above(176, 176, scale);
    Mesh whole;
    std::vector<uint32_t> times(size_t(176) * 176);
    for (const auto& t : fan) {
      Mesh one;
      add_triangle(one, t[0], t[1], t[2]);
      add_triangle(whole, t[0], t[1], t[2]);
      const PreparedMesh prepared = *prepare(one, {});
      const RasterItem item{&prepared, 0, nullptr, {}};
      const Picture p = draw(view, {&item, 1}, one_thread(GetParam()));
      for (size_t i = 0; i < times.size(); ++i) times[i] += p.nodes[i] != kNoTriangle;
    }
    const PreparedMesh prepared = *prepare(whole, {});
    const RasterItem item{&prepared, 0, nullptr, {}};
    const Picture p = draw(view, {&item, 1}, one_thread(GetParam()));
    for (uint32_t y = 0, i = 0; y < 176; ++y) {
      bool inside = false, left = false;
      for (uint32_t x = 0; x < 176; ++x, ++i) {
        ASSERT_LE(times[i], 1U) << "round " << round << " pixel " << x << ", " << y;
        ASSERT_EQ(times[i] == 1, p.nodes[i] != kNoTriangle) << "round " << round << " pixel " << x << ", " << y;
        ASSERT_FALSE(left && times[i] == 1) << "a gap in row " << y << " of round " << round;
        left = left || (inside && times[i] == 0);
        inside = inside || times[i] == 1;
      }
    }
  }
}

TEST_P(EachSimd, squares_on_pixel_borders_cover_just_their_pixels) {
  Mesh square;
  add_triangle(square, {-0.5F, -0.5F, 0}, {0.5F, -0.5F, 0}, {0.5F, 0.5F, 0});
  add_triangle(square, {-0.5F, -0.5F, 0}, {0.5F, 0.5F, 0}, {-0.5F, 0.5F, 0});
  const PreparedMesh prepared = *prepare(square, {});
  const RasterItem item{&prepared, 3, nullptr, {}};
  for (const uint32_t side : {2U, 8U, 30U, 200U, 1000U}) {  // small, large, and in between
    const Picture p = draw(view_from_above(side + 40, side + 40, side), {&item, 1}, one_thread(GetParam()));
    EXPECT_EQ(covered(p), size_t(side) * side);
    EXPECT_EQ(p.nodes[size_t(20) * (side + 40) + 20], 3U);
    EXPECT_EQ(p.nodes[size_t(19) * (side + 40) + 20], kNoTriangle);
    EXPECT_FLOAT_EQ(p.depth_m[size_t(20) * (side + 40) + 20], 10.0F);
  }
}

TEST_P(EachSimd, back_faces_show_only_where_a_mesh_is_two_sided) {
  Mesh mesh;
  add_triangle(mesh, {-1, -1, 0}, {1, -1, 0}, {0, 1, 0});  // counter-clockwise from above
  std::vector<Material> materials(1);
  RasterView above = view_from_above(64, 64, 16), below = above;
  below.eye = {0, 0, -10}, below.forward = {0, 0, 1}, below.right = -above.right;
  const PreparedMesh culled = *prepare(mesh, materials);
  materials[0].two_sided = true;
  const PreparedMesh both = *prepare(mesh, materials);
  const RasterItem one_sided{&culled, 0, nullptr, {}}, two_sided{&both, 0, nullptr, {}};
  EXPECT_GT(covered(draw(above, {&one_sided, 1}, one_thread(GetParam()))), 400U);
  EXPECT_EQ(covered(draw(below, {&one_sided, 1}, one_thread(GetParam()))), 0U);
  EXPECT_GT(covered(draw(below, {&two_sided, 1}, one_thread(GetParam()))), 400U);
  RasterItem mirrored = one_sided;
  mirrored.model_from_mesh = glm::dmat4(1.0);
  (*mirrored.model_from_mesh)[0][0] = -1;
  EXPECT_GT(covered(draw(above, {&mirrored, 1}, one_thread(GetParam()))), 400U)
      << "fronts of a mirrored mesh stay fronts";
  EXPECT_EQ(covered(draw(below, {&mirrored, 1}, one_thread(GetParam()))), 0U);
}

TEST_P(EachSimd, the_nearer_wins_and_of_equal_ones_the_smaller_node) {
  Mesh mesh;
  add_triangle(mesh, {-1, -1, 0}, {1, -1, 0}, {0, 1, 0});
  add_triangle(mesh, {-1, -1, 0}, {1, -1, 0}, {0, 1, 0});
  Mesh nearer = mesh;
  for (glm::vec3& p : nearer.positions) p = p * 0.25F + glm::vec3(0, 0, 1e-4F);
  const PreparedMesh flat = *prepare(mesh, {}), above = *prepare(nearer, {});
  const std::vector<RasterItem> items = {
      {&flat, 9, nullptr, {}}, {&flat, 4, nullptr, {}}, {&above, 12, nullptr, {}}, {&flat, 7, nullptr, {}}};
  const Picture p = draw(view_from_above(64, 64, 16), items, one_thread(GetParam()));
  EXPECT_EQ(p.nodes[32 * 64 + 32], 12U);
  EXPECT_EQ(p.nodes[40 * 64 + 32], 4U);
  EXPECT_EQ(p.triangles[40 * 64 + 32], 0U);
}

INSTANTIATE_TEST_SUITE_P(
    Raster, EachSimd, testing::Values(Simd::portable, Simd::avx2, Simd::avx512), [](const auto& simd) {
      return std::string(simd.param == Simd::portable ? "portable" : simd.param == Simd::avx2 ? "avx2" : "avx512");
    });

std::vector<Scene> scenes() {
  std::vector<Scene> all;
  all.push_back(mixed_scene(11, false));
  all.push_back(mixed_scene(12, true));
  all.push_back(hostile_scene(13));
  return all;
}

TEST(Visibility, all_processors_draw_the_same_bits) {
  Random random(2);
  for (const Scene& scene : scenes()) {
    for (uint32_t i = 0; i < 12; ++i) {
      RasterView view = perspective_view(random_camera(random, 10, 301, 203), glm::dvec3(0));
      if (i % 4 == 3) view.orthographic = true, view.scale_px = 12;
      for (const PixelRule rule : {PixelRule::center, PixelRule::inner, PixelRule::outer}) {
        VisibilityOptions options = one_thread(Simd::portable);
        options.rule = rule;
        const Picture portable = draw(view, scene.items, options);
        options.simd = Simd::avx2;
        EXPECT_EQ(portable, draw(view, scene.items, options));
        options.simd = Simd::avx512;
        EXPECT_EQ(portable, draw(view, scene.items, options));
      }
    }
  }
}

TEST(Visibility, threads_order_and_culling_leave_the_picture_alone) {
  Random random(3);
  for (const Scene& scene : scenes()) {
    for (uint32_t i = 0; i < 10; ++i) {
      const RasterView view = perspective_view(random_camera(random, 9, 640, 333), glm::dvec3(0));
      const Picture plain = draw(view, scene.items, one_thread());
      for (const unsigned threads : {2U, 7U}) {
        VisibilityOptions options;
        options.threads = threads;
        EXPECT_EQ(plain, draw(view, scene.items, options));
      }
      VisibilityOptions all = one_thread();
      all.cull_hidden = false;
      EXPECT_EQ(plain, draw(view, scene.items, all));
      const std::vector<RasterItem> reversed(scene.items.rbegin(), scene.items.rend());
      EXPECT_EQ(plain, draw(view, reversed, one_thread()));
    }
  }
}

TEST(Visibility, inner_is_within_exact_is_within_outer) {
  Random random(4);
  Mesh soup = triangle_soup(60, 4, 5);
  std::vector<Material> materials(1);
  materials[0].two_sided = true;
  for (uint32_t t = 0; t < soup.triangle_count(); ++t) {
    Mesh one;
    add_triangle(one, soup.positions[3 * t], soup.positions[3 * t + 1], soup.positions[3 * t + 2]);
    const PreparedMesh prepared = *prepare(one, materials);
    const RasterItem item{&prepared, 0, nullptr, {}};
    Camera camera = random_camera(random, 6, 160, 120);
    const RasterView view = perspective_view(camera, glm::dvec3(0));
    std::array<Picture, 3> p;
    for (const PixelRule rule : {PixelRule::inner, PixelRule::center, PixelRule::outer}) {
      VisibilityOptions options = one_thread();
      options.rule = rule;
      p[rule == PixelRule::inner ? 0 : rule == PixelRule::center ? 1 : 2] = draw(view, {&item, 1}, options);
    }
    for (size_t i = 0; i < p[0].nodes.size(); ++i) {
      if (p[0].nodes[i] != kNoTriangle) {
        ASSERT_EQ(p[1].nodes[i], 0U);
        ASSERT_GE(p[0].depth_m[i], p[1].depth_m[i]);
      }
      if (p[1].nodes[i] == kNoTriangle) continue;
      ASSERT_EQ(p[2].nodes[i], 0U);
      ASSERT_LE(p[2].depth_m[i], p[1].depth_m[i]);
    }
  }
}

TEST(Visibility, nothing_shows_when_everything_is_behind_the_eye) {
  Scene scene;
  scene.meshes.push_back(bumpy_sphere({-5, 0, 0}, 2, 20, 1));
  scene.finish();
  Camera camera;
  camera.width_px = 200, camera.height_px = 100;
  EXPECT_EQ(covered(draw(perspective_view(camera, glm::dvec3(0)), scene.items)), 0U);
}

TEST(Visibility, degenerate_and_empty_meshes_draw_nothing) {
  Mesh mesh;
  add_triangle(mesh, {1, 0, 0}, {1, 0, 0}, {1, 0, 0});
  add_triangle(mesh, {1, 0, 0}, {2, 0, 0}, {3, 0, 0});
  const PreparedMesh prepared = *prepare(mesh, {}), empty = *prepare(Mesh{}, {});
  const std::vector<RasterItem> items = {{&prepared, 0, nullptr, {}}, {&empty, 1, nullptr, {}}};
  EXPECT_EQ(covered(draw(view_from_above(64, 64, 16), items)), 0U);
}

TEST(Visibility, refuses_what_it_cannot_draw_with_a_line_that_says_why) {
  VisibilityBuffer buffer;
  RasterView view = view_from_above(64, 64, 1);
  view.width_px = kMaxPictureSide + 1;
  EXPECT_NE(buffer.draw(view, {}).error().message.find("16385 x 64"), std::string::npos);
  view = view_from_above(64, 64, 1);
  view.eye.x = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(buffer.draw(view, {}).ok());
  view = perspective_view(Camera{}, glm::dvec3(0));
  view.near_m = 0;
  EXPECT_FALSE(buffer.draw(view, {}).ok());
  Mesh mesh;
  add_triangle(mesh, {0, 0, 0}, {1, 0, 0}, {std::numeric_limits<float>::infinity(), 1, 0});
  EXPECT_FALSE(prepare(mesh, {}).ok());
  mesh.positions[2] = {1e13F, 1, 0};
  EXPECT_FALSE(prepare(mesh, {}).ok());
}

TEST(Visibility, depths_are_finite_and_in_front_wherever_something_is_seen) {
  Random random(6);
  const Scene scene = hostile_scene(21);
  for (uint32_t i = 0; i < 20; ++i) {
    const Camera camera = random_camera(random, 0.2, 320, 200);
    const Picture p = draw(perspective_view(camera, glm::dvec3(0)), scene.items);
    for (size_t k = 0; k < p.nodes.size(); ++k) {
      if (p.nodes[k] == kNoTriangle) continue;
      ASSERT_GE(p.depth_m[k], float(camera.near_m) * 0.99999F);
      ASSERT_LT(p.depth_m[k], std::numeric_limits<float>::infinity());
    }
  }
}

}  // namespace
}  // namespace promenade
