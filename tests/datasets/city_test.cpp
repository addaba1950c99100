#include "datasets/city.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "geometry/path.h"
#include "layout/file_io.h"
#include "tests/datasets/glb_small_disk.h"

namespace promenade {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::HasSubstr;

/// An empty folder that goes away with the test.
class CityTest : public testing::Test {
 protected:
  void SetUp() override {
    const testing::TestInfo* info = testing::UnitTest::GetInstance()->current_test_info();
    std::string name = std::string("promenade_city_") + info->test_suite_name() + "_" + info->name();
    std::replace(name.begin(), name.end(), '/', '_');
    folder_ = fs::path(testing::TempDir()) / name;
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }
  fs::path at(const std::string& name) const { return folder_ / name; }
  bool nothing_left() const { return fs::is_empty(folder_); }

 private:
  fs::path folder_;
};

CityOptions small_city() {
  CityOptions options;
  options.triangles = 60'000;
  options.blocks_x = options.blocks_y = 2;
  return options;
}

Result<CityFigures> generate(const CityOptions& options, const fs::path& output) {
  JobMonitor nobody;
  return generate_city(options, output, nobody);
}

std::string bytes_of(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// A .glb as its JSON and its binary chunk.
struct Glb {
  json document;
  std::string bin;

  explicit Glb(const fs::path& path) {
    const std::string bytes = bytes_of(path);
    uint32_t json_bytes = 0;
    if (bytes.size() < 28) return;
    std::memcpy(&json_bytes, bytes.data() + 12, 4);
    document = json::parse(bytes.substr(20, json_bytes));
    bin = bytes.substr(28 + json_bytes);
  }
  /// Element i of an accessor; count components.
  template <class T>
  std::vector<T> values(size_t accessor) const {
    const json& a = document["accessors"][accessor];
    const json& view = document["bufferViews"][a["bufferView"].get<size_t>()];
    const size_t width = a["type"] == "SCALAR" ? 1 : a["type"] == "VEC2" ? 2 : a["type"] == "VEC3" ? 3 : 4;
    std::vector<T> result(a["count"].get<size_t>() * width);
    const auto offset = view["byteOffset"].get<size_t>(), length = view["byteLength"].get<size_t>();
    EXPECT_EQ(length, result.size() * sizeof(T));
    EXPECT_LE(offset + length, bin.size());
    EXPECT_EQ(offset % 4, 0U);
    std::memcpy(result.data(), bin.data() + offset, length);
    return result;
  }
  std::vector<uint32_t> indices(const json& primitive) const {
    const auto accessor = primitive["indices"].get<size_t>();
    if (document["accessors"][accessor]["componentType"] == 5125) return values<uint32_t>(accessor);
    const std::vector<uint16_t> narrow = values<uint16_t>(accessor);
    return {narrow.begin(), narrow.end()};
  }
  uint64_t triangles_of_mesh(size_t mesh) const {
    uint64_t sum = 0;
    for (const json& primitive : document["meshes"][mesh]["primitives"])
      sum += document["accessors"][primitive["indices"].get<size_t>()]["count"].get<uint64_t>() / 3;
    return sum;
  }
};

/// Corners of every triangle, in the world, z up.
std::vector<std::array<glm::dvec3, 3>> triangles_of(const Glb& glb) {
  std::vector<std::array<glm::dvec3, 3>> result;
  for (const json& node : glb.document["nodes"]) {
    glm::dmat4 m(1);
    if (node.contains("translation"))
      for (int i = 0; i < 3; ++i) m[3][i] = node["translation"][static_cast<size_t>(i)];
    if (node.contains("matrix"))
      for (int i = 0; i < 16; ++i) m[i / 4][i % 4] = node["matrix"][static_cast<size_t>(i)];
    for (const json& primitive : glb.document["meshes"][node["mesh"].get<size_t>()]["primitives"]) {
      const std::vector<float> p = glb.values<float>(primitive["attributes"]["POSITION"]);
      const std::vector<uint32_t> indices = glb.indices(primitive);
      for (size_t t = 0; t < indices.size(); t += 3) {
        std::array<glm::dvec3, 3> corners;
        for (size_t c = 0; c < 3; ++c) {
          const size_t v = 3 * size_t(indices[t + c]);
          const glm::dvec3 y_up(m * glm::dvec4(p[v], p[v + 1], p[v + 2], 1));
          corners[c] = {y_up.x, -y_up.z, y_up.y};
        }
        result.push_back(corners);
      }
    }
  }
  return result;
}

double distance_to_segment(const glm::dvec3& p, const glm::dvec3& a, const glm::dvec3& b) {
  const glm::dvec3 ab = b - a;
  const double t = std::clamp(glm::dot(p - a, ab) / std::max(glm::dot(ab, ab), 1e-30), 0.0, 1.0);
  return glm::distance(p, a + ab * t);
}

double distance_to_triangle(const glm::dvec3& p, const std::array<glm::dvec3, 3>& t) {
  const glm::dvec3 n = glm::cross(t[1] - t[0], t[2] - t[0]);
  const double area = glm::length(n);
  bool above = area > 1e-12;
  for (size_t i = 0; i < 3 && above; ++i) above = glm::dot(glm::cross(t[(i + 1) % 3] - t[i], p - t[i]), n) >= 0;
  if (above) return std::abs(glm::dot(p - t[0], n)) / area;
  return std::min(
      {distance_to_segment(p, t[0], t[1]), distance_to_segment(p, t[1], t[2]), distance_to_segment(p, t[2], t[0])});
}

/// The smallest distance between the path's eyes and anything, up to `limit_m`.
double clearance_m(const std::vector<std::array<glm::dvec3, 3>>& triangles, const CameraPath& path, double step_s,
                   double limit_m) {
  double least = limit_m;
  DBox around;
  std::vector<glm::dvec3> eyes;
  for (double t = 0; t <= path.duration_s(); t += step_s) eyes.push_back(pose_at(path, t).eye), around.add(eyes.back());
  for (const auto& triangle : triangles) {
    DBox box;
    for (const glm::dvec3& corner : triangle) box.add(corner);
    if (!box.overlaps(around.grown(limit_m))) continue;
    for (const glm::dvec3& eye : eyes)
      if (box.distance(eye) < least) least = std::min(least, distance_to_triangle(eye, triangle));
  }
  return least;
}

CameraPath load_path(const fs::path& file) {
  const Result<CameraPath> path = parse_path(bytes_of(file), file.string());
  EXPECT_TRUE(path.ok());
  return path.ok() ? *path : CameraPath{};
}

TEST_F(CityTest, same_bytes_at_any_number_of_jobs) {
  CityOptions options = small_city();
  options.texture_megapixels = 0.3;
  options.jobs = 1;
  const Result<CityFigures> one = generate(options, at("one.glb"));
  ASSERT_TRUE(one.ok()) << one.error().message;
  options.jobs = 2;
  ASSERT_TRUE(generate(options, at("two.glb")).ok());
  EXPECT_TRUE(bytes_of(at("one.glb")) == bytes_of(at("two.glb")));
  EXPECT_EQ(one->bytes, bytes_of(at("one.glb")).size());
  for (const char* path : {"_walk.json", "_drive.json", "_fly.json"})
    EXPECT_EQ(bytes_of(at(std::string("one") + path)), bytes_of(at(std::string("two") + path)));
}

TEST_F(CityTest, another_seed_is_another_city) {
  CityOptions options = small_city();
  ASSERT_TRUE(generate(options, at("one.glb")).ok());
  options.seed = 2;
  ASSERT_TRUE(generate(options, at("two.glb")).ok());
  EXPECT_FALSE(bytes_of(at("one.glb")) == bytes_of(at("two.glb")));
}

TEST_F(CityTest, figures_say_what_the_file_holds) {
  const Result<CityFigures> figures = generate(small_city(), at("city.glb"));
  ASSERT_TRUE(figures.ok());
  const Glb glb(at("city.glb"));
  uint64_t triangles = 0, unique = 0, buildings = 0;
  for (const json& node : glb.document["nodes"]) {
    triangles += glb.triangles_of_mesh(node["mesh"].get<size_t>());
    buildings += node["extras"]["class"] == "building" ? 1U : 0U;
    EXPECT_THAT(node["name"].get<std::string>(), HasSubstr(node["extras"]["class"].get<std::string>()));
  }
  for (size_t m = 0; m < glb.document["meshes"].size(); ++m) unique += glb.triangles_of_mesh(m);
  EXPECT_EQ(figures->triangles, triangles);
  EXPECT_EQ(figures->unique_triangles, unique);
  EXPECT_EQ(figures->buildings, buildings);
  EXPECT_EQ(figures->objects, glb.document["nodes"].size());
  EXPECT_EQ(figures->files, 1U);
  DBox box;
  for (const auto& triangle : triangles_of(glb))
    for (const glm::dvec3& corner : triangle) box.add(corner);
  EXPECT_TRUE(figures->box.grown(0.01).contains(box));
  EXPECT_LE(box.max.z, small_city().max_height_m + 0.2);
}

TEST_F(CityTest, has_every_class_of_object) {
  CityOptions options;
  options.triangles = 500'000;
  options.blocks_x = options.blocks_y = 3;
  ASSERT_TRUE(generate(options, at("city.glb")).ok());
  std::set<std::string> classes;
  const Glb glb(at("city.glb"));
  for (const json& node : glb.document["nodes"]) classes.insert(node["extras"]["class"]);
  EXPECT_EQ(classes, (std::set<std::string>{"bench", "bin", "building", "bus_stop", "bush", "car", "fountain", "ground",
                                            "hydrant", "lamp", "park", "sign", "traffic_light", "tree"}));
}

TEST_F(CityTest, a_plain_one_has_few_triangles_a_building_and_trees_alone_on_its_streets) {
  CityOptions options = small_city();
  options.plain = true;
  options.triangles = 1000;
  options.blocks_x = options.blocks_y = 4;
  options.tree_distance_m = 40;
  const Result<CityFigures> figures = generate(options, at("city.glb"));
  ASSERT_TRUE(figures.ok()) << figures.error().message;
  ASSERT_GT(figures->buildings, 20U);
  EXPECT_LT(figures->triangles, 400 * figures->buildings);
  std::set<std::string> classes;
  const Glb glb(at("city.glb"));
  for (const json& node : glb.document["nodes"]) classes.insert(node["extras"]["class"]);
  EXPECT_EQ(classes, (std::set<std::string>{"building", "fountain", "ground", "park", "tree"}));
  options.interiors = true;
  const Result<CityFigures> refused = generate(options, at("rooms.glb"));
  ASSERT_FALSE(refused.ok());
  EXPECT_THAT(refused.error().message, HasSubstr("plain"));
}

TEST_F(CityTest, accessors_hold_sound_geometry) {
  CityOptions options = small_city();
  options.interiors = true;
  options.style = StreetStyle::organic;
  ASSERT_TRUE(generate(options, at("city.glb")).ok());
  const Glb glb(at("city.glb"));
  for (const json& mesh : glb.document["meshes"])
    for (const json& primitive : mesh["primitives"]) {
      const std::vector<float> p = glb.values<float>(primitive["attributes"]["POSITION"]);
      ASSERT_TRUE(std::all_of(p.begin(), p.end(), [](float v) { return std::isfinite(v); })) << mesh["name"];
      const std::vector<uint32_t> indices = glb.indices(primitive);
      ASSERT_LT(*std::max_element(indices.begin(), indices.end()), p.size() / 3) << mesh["name"];
      if (!primitive["attributes"].contains("NORMAL")) continue;
      const std::vector<float> n = glb.values<float>(primitive["attributes"]["NORMAL"]);
      for (size_t i = 0; i < n.size(); i += 3)
        ASSERT_NEAR(std::hypot(n[i], n[i + 1], n[i + 2]), 1, 1e-4) << mesh["name"];
    }
}

struct Wish {
  const char* name;
  uint64_t triangles;
  StreetStyle style;
  uint32_t blocks;
};
class CityOfSize : public CityTest, public testing::WithParamInterface<Wish> {};

TEST_P(CityOfSize, has_the_triangles_asked_for_within_a_tenth) {
  CityOptions options;
  options.triangles = GetParam().triangles;
  options.style = GetParam().style;
  options.blocks_x = options.blocks_y = GetParam().blocks;
  const Result<CityFigures> figures = generate(options, at("city.glb"));
  ASSERT_TRUE(figures.ok());
  EXPECT_NEAR(static_cast<double>(figures->triangles), static_cast<double>(options.triangles),
              0.1 * static_cast<double>(options.triangles));
}

INSTANTIATE_TEST_SUITE_P(Sizes, CityOfSize,
                         testing::Values(Wish{"smallest", 100'000, StreetStyle::grid, 0},
                                         Wish{"usual", 500'000, StreetStyle::grid, 0},
                                         Wish{"organic", 300'000, StreetStyle::organic, 0},
                                         Wish{"sparse", 150'000, StreetStyle::grid, 3},
                                         Wish{"dense", 600'000, StreetStyle::organic, 2}),
                         [](const auto& param_info) { return param_info.param.name; });

class CityOfStyle : public CityTest, public testing::WithParamInterface<StreetStyle> {};

TEST_P(CityOfStyle, paths_are_clear_of_geometry) {
  CityOptions options;
  options.triangles = 400'000;
  options.blocks_x = options.blocks_y = 3;
  options.style = GetParam();
  ASSERT_TRUE(generate(options, at("city.glb")).ok());
  const auto triangles = triangles_of(Glb(at("city.glb")));
  const CameraPath walk = load_path(at("city_walk.json")), drive = load_path(at("city_drive.json")),
                   fly = load_path(at("city_fly.json"));
  EXPECT_GE(walk.duration_s(), 60);
  EXPECT_GT(clearance_m(triangles, walk, 0.25, 0.6), 0.3);
  EXPECT_GT(clearance_m(triangles, drive, 0.03, 1.2), 0.8);
  EXPECT_GT(clearance_m(triangles, fly, 0.5, 20), 19);
  EXPECT_NEAR(pose_at(fly, 1).pitch_deg, -25, 1e-9);
  const double second = glm::distance(pose_at(drive, 3).eye, pose_at(drive, 4).eye);
  EXPECT_NEAR(second, 100 / 3.6, 0.5);
}

TEST_P(CityOfStyle, ground_lies_everywhere_beneath) {
  CityOptions options = small_city();
  options.style = GetParam();
  ASSERT_TRUE(generate(options, at("city.glb")).ok());
  // Upward triangles at street or pavement height, without the layer below that closes rounding's gaps.
  std::vector<std::array<glm::dvec3, 3>> ground;
  for (const auto& t : triangles_of(Glb(at("city.glb"))))
    if (glm::cross(t[1] - t[0], t[2] - t[0]).z > 0 && std::max({t[0].z, t[1].z, t[2].z}) < 0.2 &&
        std::min({t[0].z, t[1].z, t[2].z}) > -0.05)
      ground.push_back(t);
  int holes = 0;
  for (double x = -118; x < 118; x += 4.7)
    for (double y = -78; y < 78; y += 3.9) {
      const auto covers = [&](const std::array<glm::dvec3, 3>& t) {
        for (size_t i = 0; i < 3; ++i) {
          const glm::dvec3 e = t[(i + 1) % 3] - t[i];
          if (e.x * (y - t[i].y) - e.y * (x - t[i].x) < -1e-9) return false;
        }
        return true;
      };
      holes += std::any_of(ground.begin(), ground.end(), covers) ? 0 : 1;
    }
  EXPECT_EQ(holes, 0);
}

INSTANTIATE_TEST_SUITE_P(Styles, CityOfStyle, testing::Values(StreetStyle::grid, StreetStyle::organic),
                         [](const auto& param_info) {
                           return param_info.param == StreetStyle::grid ? "grid" : "organic";
                         });

TEST_F(CityTest, no_two_buildings_share_a_texture) {
  CityOptions options = small_city();
  options.texture_megapixels = 1;
  const Result<CityFigures> figures = generate(options, at("city.glb"));
  ASSERT_TRUE(figures.ok());
  EXPECT_NEAR(figures->texture_megapixels, 1, 0.1);
  const Glb glb(at("city.glb"));
  EXPECT_EQ(glb.document["images"].size(), figures->buildings);
  std::set<std::string> pictures;
  for (const json& image : glb.document["images"]) {
    const json& view = glb.document["bufferViews"][image["bufferView"].get<size_t>()];
    pictures.insert(glb.bin.substr(view["byteOffset"].get<size_t>(), view["byteLength"].get<size_t>()));
  }
  EXPECT_EQ(pictures.size(), figures->buildings);
}

TEST_F(CityTest, a_folder_holds_tiles_of_the_whole_city) {
  CityOptions options = small_city();
  const Result<CityFigures> whole = generate(options, at("city.glb"));
  options.tile_triangles = 20'000;
  const Result<CityFigures> tiles = generate(options, at("tiles"));
  ASSERT_TRUE(whole.ok() && tiles.ok());
  EXPECT_GT(tiles->files, 1U);
  EXPECT_EQ(tiles->triangles, whole->triangles);
  EXPECT_TRUE(fs::exists(at("tiles/tile_000_000.glb")));
  EXPECT_TRUE(fs::exists(at("tiles_walk.json")));
  EXPECT_FALSE(fs::exists(at(".tiles.partial")));
  const auto entries = std::distance(fs::directory_iterator(at("tiles")), fs::directory_iterator());
  EXPECT_EQ(static_cast<uint64_t>(entries), tiles->files);
  const Result<CityFigures> again = generate(options, at("tiles"));
  ASSERT_FALSE(again.ok());
  EXPECT_THAT(again.error().message, HasSubstr("exists already"));
}

TEST_F(CityTest, refuses_senseless_options_by_name) {
  const auto message_of = [&](const auto& change) {
    CityOptions options = small_city();
    change(options);
    const Result<CityFigures> figures = generate(options, at("city.glb"));
    return figures.ok() ? std::string("accepted") : figures.error().message;
  };
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(message_of([](CityOptions& o) { o.triangles = 0; }), HasSubstr("0 triangles"));
  EXPECT_THAT(message_of([](CityOptions& o) { o.block_length_m = 0; }), HasSubstr("block length is 0"));
  EXPECT_THAT(message_of([](CityOptions& o) { o.block_width_m = kNan; }), HasSubstr("block width is nan"));
  EXPECT_THAT(message_of([](CityOptions& o) { o.max_height_m = -3; }), HasSubstr("height is -3"));
  EXPECT_THAT(message_of([](CityOptions& o) { o.street_width_m = 1e9; }), HasSubstr("street width"));
  EXPECT_THAT(message_of([](CityOptions& o) { o.curb_height_m = -1; }), HasSubstr("kerb height"));
  EXPECT_THAT(message_of([](CityOptions& o) { o.tree_distance_m = 0.001; }), HasSubstr("trees"));
  EXPECT_THAT(message_of([](CityOptions& o) { o.texture_megapixels = kNan; }), HasSubstr("texture"));
  EXPECT_THAT(message_of([](CityOptions& o) { o.max_rows = 0; }), HasSubstr("rows"));
  EXPECT_THAT(message_of([](CityOptions& o) { o.tile_triangles = 0; }), HasSubstr("tiles"));
  EXPECT_THAT(message_of([](CityOptions& o) { o.blocks_x = o.blocks_y = 100'000; }), HasSubstr("too many"));
  EXPECT_THAT(message_of([](CityOptions& o) { o.curb_width_m = 20, o.block_width_m = 30; }), HasSubstr("no room"));
  EXPECT_TRUE(nothing_left());
}

TEST_F(CityTest, takes_extreme_but_sensible_options) {
  CityOptions options = small_city();
  options.block_length_m = options.block_width_m = 20;
  options.street_width_m = 3, options.curb_width_m = 0.5, options.curb_height_m = 0, options.street_height_m = 5;
  options.tree_distance_m = 0, options.max_rows = options.max_columns = 1, options.max_height_m = 4;
  ASSERT_TRUE(generate(options, at("tiny.glb")).ok());
  options.style = StreetStyle::organic;
  ASSERT_TRUE(generate(options, at("organic.glb")).ok());
  options = small_city();
  options.max_rows = options.max_columns = 40, options.max_height_m = 400, options.curb_width_m = 12;
  ASSERT_TRUE(generate(options, at("dense.glb")).ok());
}

TEST_F(CityTest, a_full_disk_leaves_nothing) {
  const SmallDisk disk(200'000);
  for (const char* name : {"city.glb", "tiles"}) {
    const Result<CityFigures> figures = generate(small_city(), at(name));
    ASSERT_FALSE(figures.ok());
    EXPECT_THAT(figures.error().message, HasSubstr(".glb"));
    EXPECT_TRUE(nothing_left()) << name;
  }
}

/// Wants to stop as soon as the first block is written.
class Impatient : public JobMonitor {
 public:
  void progress(std::string_view stage, uint64_t done, uint64_t) override {
    seen_ = seen_ || (stage == "city" && done > 0);
  }
  bool cancelled() const override { return seen_; }

 private:
  bool seen_ = false;
};

TEST_F(CityTest, interrupted_it_leaves_nothing) {
  for (const char* name : {"city.glb", "tiles"}) {
    Impatient monitor;
    const Result<CityFigures> figures = generate_city(small_city(), at(name), monitor);
    ASSERT_FALSE(figures.ok());
    EXPECT_EQ(figures.error().message, "interrupted");
    EXPECT_TRUE(nothing_left()) << name;
  }
}

TEST_F(CityTest, names_a_place_where_it_cannot_write) {
  for (const char* name : {"missing/city.glb", "missing/tiles"}) {
    const Result<CityFigures> figures = generate(small_city(), at(name));
    ASSERT_FALSE(figures.ok());
    EXPECT_THAT(figures.error().message, HasSubstr(name));
  }
}

/// The features of a CityJSON text sequence, its header checked.
std::vector<json> features_of(const fs::path& path) {
  std::ifstream in(path);
  std::string line;
  std::vector<json> features;
  while (std::getline(in, line)) features.push_back(json::parse(line));
  if (features.empty()) return features;
  EXPECT_EQ(features[0]["type"], "CityJSON");
  EXPECT_EQ(features[0]["transform"]["scale"], json({0.001, 0.001, 0.001}));
  features.erase(features.begin());
  return features;
}

/// Edges of a shell that no other face uses the other way.
size_t open_edges(const json& shell) {
  std::map<std::pair<int, int>, int> edges;
  for (const json& surface : shell)
    for (size_t i = 0; i < 3; ++i) {
      const int a = surface[0][i], b = surface[0][(i + 1) % 3];
      edges[{std::min(a, b), std::max(a, b)}] += a < b ? 1 : -1;
    }
  return static_cast<size_t>(std::count_if(edges.begin(), edges.end(), [](const auto& e) { return e.second != 0; }));
}

double volume_m3(const json& shell, const json& vertices) {
  double six = 0;
  for (const json& surface : shell) {
    std::array<std::array<double, 3>, 3> p{};
    for (size_t i = 0; i < 3; ++i)
      for (size_t k = 0; k < 3; ++k) p[i][k] = vertices[surface[0][i].get<size_t>()][k].get<double>() * 0.001;
    six += p[0][0] * (p[1][1] * p[2][2] - p[1][2] * p[2][1]) - p[0][1] * (p[1][0] * p[2][2] - p[1][2] * p[2][0]) +
           p[0][2] * (p[1][0] * p[2][1] - p[1][1] * p[2][0]);
  }
  return six / 6;
}

TEST_F(CityTest, buildings_in_cityjson_are_closed_solids_that_face_outwards) {
  for (const StreetStyle style : {StreetStyle::grid, StreetStyle::organic}) {
    CityOptions options = small_city();
    options.style = style;
    const Result<CityFigures> made = generate(options, at("c.city.jsonl"));
    ASSERT_TRUE(made) << made.error().message;
    uint64_t buildings = 0, triangles = 0;
    for (const json& feature : features_of(at("c.city.jsonl"))) {
      const json& geometry = feature["CityObjects"].begin().value()["geometry"][0];
      const bool building = feature["CityObjects"].begin().value()["type"] == "Building";
      EXPECT_EQ(geometry["type"], building ? "Solid" : "MultiSurface");
      const json& surfaces = building ? geometry["boundaries"][0] : geometry["boundaries"];
      triangles += surfaces.size();
      if (!building) continue;
      ++buildings;
      EXPECT_EQ(open_edges(surfaces), 0U) << feature["id"];
      EXPECT_GT(volume_m3(surfaces, feature["vertices"]), 10) << feature["id"];
      EXPECT_EQ(geometry["semantics"]["values"][0].size(), surfaces.size());
    }
    EXPECT_GT(buildings, 10U);
    EXPECT_EQ(buildings, made->buildings);
    EXPECT_EQ(triangles, made->triangles);
    EXPECT_TRUE(fs::exists(at("c_walk.json")));
  }
}

TEST_F(CityTest, cityjson_has_the_same_bytes_whatever_the_threads_and_refuses_what_it_cannot_hold) {
  CityOptions options = small_city();
  options.jobs = 1;
  ASSERT_TRUE(generate(options, at("a.city.jsonl")));
  options.jobs = 2;
  ASSERT_TRUE(generate(options, at("b.city.jsonl")));
  EXPECT_EQ(bytes_of(at("a.city.jsonl")), bytes_of(at("b.city.jsonl")));
  options.moving = 3;
  const Result<CityFigures> moving = generate(options, at("m.city.jsonl"));
  ASSERT_FALSE(moving);
  EXPECT_THAT(moving.error().message, HasSubstr("CityJSON"));
  EXPECT_FALSE(fs::exists(at("m.city.jsonl")));
}

}  // namespace
}  // namespace promenade
