// Whether the background can be seen from within closed surfaces, through fronts of leaves and of levels mixed at
// random, also while levels fade and where ancestors stand in. PROMENADE_CRACK_VIEWS sets how many views a surface gets
// (default 400; 10,000 take a minute), and prints the counts.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <glm/geometric.hpp>
#include <numbers>

#include "raster/visibility.h"
#include "tests/preprocess/build_fixtures.h"
#include "tests/preprocess/surfaces.h"

namespace promenade {
namespace {

constexpr uint32_t kWidthPx = 160, kHeightPx = 120;

uint32_t views_wanted() {
  const char* text = std::getenv("PROMENADE_CRACK_VIEWS");
  const long wanted = text != nullptr ? std::strtol(text, nullptr, 10) : 0;
  return wanted > 0 ? static_cast<uint32_t>(wanted) : 400;
}

/// A closed surface whose fronts look inward, and where eyes are inside of it.
struct Inside {
  Mesh mesh;
  glm::vec3 (*eye)(test::Numbers&);
};

/// Uneven by some centimetres, the same for all that is at one place.
glm::vec3 plastered(const glm::vec3& p) {
  const float d = 0.02F * (std::sin(p.x * 2.3F + p.z) + std::sin(p.y * 3.1F + 2 * p.z) + std::sin((p.x - p.y) * 5.7F));
  return p * (1 + d / 4);
}

/// 8 by 8 by 8 m about the origin; each wall of 32 by 32 squares.
Inside room_of_tessellated_walls() {
  constexpr uint32_t kSquares = 32;  // a power of two: sides meet to the bit
  Mesh room;
  for (int side = 0; side < 6; ++side) {
    Mesh wall = test::flat_grid(kSquares, 8);
    for (glm::vec3& p : wall.positions) {
      p = {p.x - 4, p.y - 4, -4};
      if (side % 2 == 1) p = {p.x, -p.y, -p.z};
      for (int turn = 0; turn < side / 2; ++turn) p = {p.y, p.z, p.x};
      p = plastered(p);
    }
    append(room, wall);
  }
  return {room, [](test::Numbers& numbers) { return numbers.in_cube(3.7F); }};
}

float hill_m(float x, float y) {
  return 3 * std::sin(x * 0.11F) * std::cos(y * 0.13F) + 0.5F * std::sin(x * 0.9F + y * 0.5F);
}

/// A hilly disc of 60 m beneath a hemisphere.
Inside terrain_under_a_dome() {
  constexpr uint32_t kRings = 60, kSectors = 120;
  constexpr float kRadiusM = 60;
  Mesh mesh;
  for (const bool dome : {false, true}) {
    const auto first = static_cast<uint32_t>(mesh.positions.size());
    for (uint32_t r = 0; r <= kRings; ++r)
      for (uint32_t s = 0; s < kSectors; ++s) {
        const double turn = 2 * std::numbers::pi * s / kSectors, share = double(r) / kRings;
        const double angle = share * std::numbers::pi / 2, out = kRadiusM * (dome ? std::sin(angle) : share);
        const auto x = static_cast<float>(out * std::cos(turn)), y = static_cast<float>(out * std::sin(turn));
        const float rim = hill_m(kRadiusM * float(std::cos(turn)), kRadiusM * float(std::sin(turn)));
        const auto up = static_cast<float>(std::cos(angle));
        // Ends of the two grids are the same to the bit.
        const float z = r == kRings ? rim : dome ? rim * (1 - up) + kRadiusM * up : hill_m(x, y);
        const auto edge_x = static_cast<float>(kRadiusM * std::cos(turn)),
                   edge_y = static_cast<float>(kRadiusM * std::sin(turn));
        mesh.positions.emplace_back(r == kRings ? edge_x : x, r == kRings ? edge_y : y, z);
      }
    for (uint32_t r = 0; r < kRings; ++r)
      for (uint32_t s = 0; s < kSectors; ++s) {
        const uint32_t a = first + r * kSectors + s, b = first + r * kSectors + (s + 1) % kSectors;
        const uint32_t c = a + kSectors, d = b + kSectors;
        if (dome)
          mesh.indices.insert(mesh.indices.end(), {a, b, c, c, b, d});
        else
          mesh.indices.insert(mesh.indices.end(), {a, c, b, b, c, d});
      }
  }
  return {mesh, [](test::Numbers& numbers) {
            const float out = 50 * std::sqrt(numbers.unit()), turn = numbers.between(0, 6.28F);
            const float x = out * std::cos(turn), y = out * std::sin(turn);
            return glm::vec3(x, y, hill_m(x, y) + numbers.between(0.5F, 12));
          }};
}

Inside sphere_seen_from_within() {
  Mesh mesh = test::ball(80);
  mesh.normals.clear();
  for (size_t i = 0; i < mesh.indices.size(); i += 3) std::swap(mesh.indices[i + 1], mesh.indices[i + 2]);
  return {mesh, [](test::Numbers& numbers) {
            for (;;)
              if (const glm::vec3 eye = numbers.in_cube(9); glm::length(eye) < 9) return eye;
          }};
}

Camera random_camera(test::Numbers& numbers, const glm::vec3& eye) {
  Camera camera;
  camera.pose = {glm::dvec3(eye), double(numbers.between(-180, 180)), double(numbers.between(-80, 80)), 0};
  camera.width_px = kWidthPx, camera.height_px = kHeightPx;
  camera.near_m = 0.01;
  return camera;
}

/// Takes some of the inner nodes that are within the bound seen from the eye, more of them in some views than in
/// others.
class RandomChoice {
 public:
  /// fading: of the nodes that it takes, this share fades to what is below.
  RandomChoice(const Model& model, double most_px, float fading = 0)
      : model_(model), most_px_(most_px), fading_(fading) {}
  /// At which share of the pixels it takes a node: none, all or, in a fade, some.
  float takes(const Camera& camera, uint32_t node) {
    if (node == 0) taken_ = numbers_.between(0.3F, 1);
    const NodeRecord& record = model_.tables.nodes[node];
    const glm::vec3 eye(camera.pose.eye - model_.manifest.origin);
    const auto distance_m = double(record.box.distance(eye));
    const bool is_good = screen_error_px(double(record.error_m), distance_m, pixels_per_radian(camera)) <= most_px_;
    if (!is_good || numbers_.unit() >= taken_) return 0;
    return numbers_.unit() < fading_ ? numbers_.between(0.1F, 0.9F) : 1;
  }

 private:
  const Model& model_;
  double most_px_;
  float fading_;
  float taken_ = 1;
  test::Numbers numbers_{6};
};

class Cracks : public testing::TestWithParam<std::pair<const char*, Inside (*)()>> {
 protected:
  void SetUp() override {
    inside_ = GetParam().second();
    ASSERT_TRUE(test::open_edges({inside_.mesh}).empty());
    const BuildOptions options =
        small_build(folder_.write("source.obj", obj_text(inside_.mesh)), folder_.path() / "model.prom");
    JobMonitor monitor;
    const Result<BuildFigures> figures = build_model(options, monitor);
    ASSERT_TRUE(figures.ok()) << figures.error().message;
    ASSERT_GE(figures->levels, 4U);
    Result<ModelReader> reader = ModelReader::open(options.model);
    ASSERT_TRUE(reader.ok());
    model_ = reader->model();
    for (uint32_t i = 0; i < model_.tables.nodes.size(); ++i)
      meshes_.push_back(*prepare(mesh_of(*reader, i), model_.tables.materials));
  }

  /// Background pixels in all views of fronts of the inner nodes that `takes` takes, and of leaves. Below a node that
  /// fades there are no other fades.
  template <class Takes>
  uint64_t look_around(const Takes& takes) {
    test::Numbers numbers(5);
    uint64_t pixels = 0, views = 0, nodes = 0, inner = 0;
    for (uint32_t i = 0; i < views_wanted(); ++i) {
      const Camera camera = random_camera(numbers, inside_.eye(numbers));
      std::vector<RasterItem> items;
      const std::function<void(uint32_t, float)> descend = [&](uint32_t node, float from) {
        const bool is_leaf = model_.tables.nodes[node].child_count == 0;
        float share = is_leaf ? 1 : takes(camera, node);
        if (from > 0 && share > 0) share = 1;
        if (share > 0) {
          items.push_back({&meshes_[node], node, nullptr, {}, from, share, model_.tables.nodes[node].error_m});
          inner += is_leaf ? 0U : 1U;
        }
        if (share >= 1) return;
        for (const NodeId child : model_.children_of(NodeId{node})) descend(index_of(child), std::max(from, share));
      };
      descend(0, 0);
      nodes += items.size();
      const uint64_t here = background_pixels(camera, items);
      pixels += here, views += here > 0 ? 1U : 0U;
    }
    std::printf("%s: %u views of %.0f nodes, %.0f of them inner: %llu background pixels in %llu views\n",
                GetParam().first, views_wanted(), double(nodes) / views_wanted(), double(inner) / views_wanted(),
                static_cast<unsigned long long>(pixels), static_cast<unsigned long long>(views));
    return pixels;
  }

  /// Pixels that show nothing.
  uint64_t background_pixels(const Camera& camera, const std::vector<RasterItem>& items) {
    EXPECT_TRUE(
        buffer_.draw(perspective_view(camera, model_.manifest.origin), items, {.threads = 1, .close_gaps = true}).ok());
    std::vector<uint32_t> nodes(size_t(camera.width_px) * camera.height_px);
    buffer_.read_nodes(nodes);
    return static_cast<uint64_t>(std::count(nodes.begin(), nodes.end(), kNoTriangle));
  }

  TemporaryFolder folder_;
  Inside inside_;
  Model model_;
  std::vector<PreparedMesh> meshes_;
  VisibilityBuffer buffer_;
};

TEST_P(Cracks, show_no_background_between_leaves) {
  const uint64_t pixels = look_around([](const Camera&, uint32_t) { return 0.0F; });
  EXPECT_EQ(pixels, 0U);
}

TEST_P(Cracks, show_no_background_between_levels_mixed_at_random) {
  RandomChoice choice(model_, 1);
  EXPECT_EQ(look_around([&](const Camera& camera, uint32_t node) { return choice.takes(camera, node); }), 0U);
}

TEST_P(Cracks, show_no_background_while_levels_fade) {
  RandomChoice choice(model_, 1, 0.5F);
  EXPECT_EQ(look_around([&](const Camera& camera, uint32_t node) { return choice.takes(camera, node); }), 0U);
}

// What is not there yet has an ancestor in its place, whatever its error.
TEST_P(Cracks, show_no_background_beside_ancestors_that_stand_in) {
  RandomChoice choice(model_, 4);
  EXPECT_EQ(look_around([&](const Camera& camera, uint32_t node) { return choice.takes(camera, node); }), 0U);
}

INSTANTIATE_TEST_SUITE_P(Inside, Cracks,
                         testing::Values(std::pair("room", &room_of_tessellated_walls),
                                         std::pair("terrain", &terrain_under_a_dome),
                                         std::pair("sphere", &sphere_seen_from_within)),
                         [](const auto& param) { return std::string(param.param.first); });

}  // namespace
}  // namespace promenade
