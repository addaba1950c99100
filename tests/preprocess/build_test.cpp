#include "preprocess/build.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>

#include "codec/image_codec.h"
#include "geometry/closest_point.h"
#include "tests/layout/faulty_file_system.h"
#include "tests/preprocess/build_fixtures.h"
#include "tests/preprocess/surfaces.h"

namespace promenade {
namespace {

using testing::HasSubstr;

/// Stops the build at the n-th progress of a stage.
class CancelAt : public JobMonitor {
 public:
  CancelAt(std::string stage, int calls) : stage_(std::move(stage)), calls_(calls) {}
  void progress(std::string_view stage, uint64_t, uint64_t) override {
    if (stage == stage_ && --calls_ == 0) cancelled_ = true;
  }
  bool cancelled() const override { return cancelled_; }

 private:
  std::string stage_;
  std::atomic<int> calls_;
  std::atomic<bool> cancelled_ = false;
};

class Build : public testing::Test {
 protected:
  Result<ModelReader> built(const BuildOptions& options) {
    figures = build_model(options, monitor);
    EXPECT_TRUE(figures.ok()) << figures.error().message;
    Result<ModelReader> reader = ModelReader::open(options.model);
    EXPECT_TRUE(reader.ok()) << reader.error().message;
    return reader;
  }
  std::string error_of(const BuildOptions& options) {
    const Result<BuildFigures> result = build_model(options, monitor);
    return result.ok() ? "" : result.error().message;
  }

  TemporaryFolder folder;
  std::filesystem::path model = folder.path() / "model.prom";
  JobMonitor monitor;
  Result<BuildFigures> figures = BuildFigures{};
};

TEST_F(Build, one_triangle_becomes_one_node) {
  const auto source = folder.write("one.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  const Result<ModelReader> reader = built(small_build(source, model));
  ASSERT_TRUE(reader.ok());
  ASSERT_EQ(reader->model().tables.nodes.size(), 1);
  const NodeRecord& node = reader->model().tables.nodes[0];
  EXPECT_EQ(node.child_count, 0);
  EXPECT_EQ(node.triangles, 1);
  EXPECT_LT(node.error_m, 1e-5);
  EXPECT_NEAR(node.surface_m2, 0.5, 1e-4);
  EXPECT_EQ(node.average_normal, glm::vec3(0, 0, 1));
  EXPECT_EQ(reader->model().manifest.source_triangles, 1);
  EXPECT_EQ(figures->triangles_in, 1);
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "model.prom.work"));
}

/// Hills of 20,000 triangles in chunks, nodes and levels.
class BuildHills : public Build {
 protected:
  Mesh mesh = test::hills(100);
  std::filesystem::path source = folder.write("hills.obj", obj_text(mesh));
  BuildOptions options = small_build(source, model);
};

TEST_F(BuildHills, makes_a_sound_tree_whose_leaves_are_the_source) {
  const Result<ModelReader> reader = built(options);
  ASSERT_TRUE(reader.ok());
  const Model& m = reader->model();
  EXPECT_EQ(find_defect(m), "");
  EXPECT_EQ(m.tables.roots.size(), 1);
  EXPECT_EQ(figures->nodes, m.tables.nodes.size());
  EXPECT_GE(figures->levels, 4);
  uint64_t triangles = 0;
  for (uint32_t i = 0; i < m.tables.nodes.size(); ++i) {
    const NodeRecord& node = m.tables.nodes[i];
    EXPECT_LE(node.triangles, 300) << "node " << i;
    EXPECT_LE(node.child_count, 6) << "node " << i;
    if (node.child_count == 0) triangles += node.triangles;
  }
  EXPECT_EQ(triangles, 20'000) << "no triangle here is large enough to be cut";
  EXPECT_EQ(m.manifest.source_triangles, 20'000);
}

/// A ball in a box whose sides are two large triangles each, which must be cut.
TEST_F(Build, leaves_of_a_closed_surface_leave_no_gap_between_them) {
  Mesh mesh = test::ball(40);
  mesh.normals.clear();
  Mesh box;
  for (uint32_t i = 0; i < 8; ++i)
    box.positions.emplace_back((i & 1U) != 0 ? 41.3F : -37, (i & 2U) != 0 ? 33.7F : -40, (i & 4U) != 0 ? 27 : -30.9F);
  box.indices = {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4,
                 2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5};
  append(mesh, box);
  ASSERT_TRUE(test::open_edges({mesh}).empty());
  BuildOptions options = small_build(folder.write("box.obj", obj_text(mesh)), model);
  options.chunk_triangles = 1500;
  const Result<ModelReader> reader = built(options);
  ASSERT_TRUE(reader.ok());
  const std::vector<uint32_t> leaves = leaves_below(reader->model(), 0);
  EXPECT_GT(leaves.size(), 10);
  std::vector<Mesh> meshes;
  size_t triangles = 0;
  for (const uint32_t leaf : leaves) triangles += meshes.emplace_back(mesh_of(*reader, leaf)).triangle_count();
  EXPECT_GT(triangles, mesh.triangle_count()) << "the box's sides must be cut";
  EXPECT_TRUE(test::open_edges(meshes).empty());
}

TEST_F(BuildHills, errors_bound_the_distance_to_the_source_both_ways) {
  const Result<ModelReader> reader = built(options);
  ASSERT_TRUE(reader.ok());
  const ClosestPointTree source_tree(mesh);
  const Model& m = reader->model();
  for (uint32_t i = 0; i < m.tables.nodes.size(); ++i) {
    const NodeRecord& node = m.tables.nodes[i];
    const Mesh surface = mesh_of(*reader, i);
    for (const glm::vec3& p : surface.positions) {
      EXPECT_TRUE(node.box.contains(p));
      EXPECT_LE(std::sqrt(source_tree.nearest(p).distance2_m2), node.error_m * 1.0001F) << "node " << i;
    }
    const ClosestPointTree tree(surface);
    for (const uint32_t leaf : leaves_below(m, i)) {
      const Mesh detail = mesh_of(*reader, leaf);
      const float leaf_error_m = m.tables.nodes[leaf].error_m;
      for (uint32_t t = 0; t < detail.triangle_count(); ++t) {
        glm::vec3 p(0);
        for (size_t c = 0; c < 3; ++c) p += detail.positions[detail.indices[3 * t + c]] / 3.0F;
        EXPECT_LE(std::sqrt(tree.nearest(p).distance2_m2), node.error_m + leaf_error_m) << "node " << i;
      }
    }
  }
}

TEST_F(BuildHills, gives_the_same_bytes_for_any_number_of_jobs) {
  options.jobs = 1;
  ASSERT_TRUE(built(options).ok());
  const auto one = bytes_of(model);
  options.jobs = 3;
  options.model = folder.path() / "other.prom";
  ASSERT_TRUE(built(options).ok());
  EXPECT_EQ(bytes_of(options.model), one);
}

TEST_F(BuildHills, goes_on_after_an_interruption_and_gives_the_same_bytes) {
  ASSERT_TRUE(built(options).ok());
  const auto expected = bytes_of(model);
  options.model = folder.path() / "other.prom";
  CancelAt cancel("simplify", 60);
  const Result<BuildFigures> stopped = build_model(options, cancel);
  ASSERT_FALSE(stopped.ok());
  EXPECT_EQ(stopped.error().message, "interrupted; run the same command to go on");
  EXPECT_FALSE(std::filesystem::exists(options.model));
  EXPECT_TRUE(std::filesystem::exists(folder.path() / "other.prom.work"));
  ASSERT_TRUE(built(options).ok());
  EXPECT_GT(figures->units_resumed, 0);
  EXPECT_LT(figures->units_resumed, figures->units_total);
  EXPECT_EQ(bytes_of(options.model), expected);
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "other.prom.work"));
}

TEST_F(BuildHills, can_be_interrupted_at_every_stage) {
  for (const char* stage : {"survey", "partition", "simplify", "write"}) {
    CancelAt cancel(stage, 1);
    const Result<BuildFigures> stopped = build_model(options, cancel);
    EXPECT_FALSE(stopped.ok()) << stage;
    EXPECT_FALSE(std::filesystem::exists(model)) << stage;
  }
  EXPECT_TRUE(built(options).ok());
}

TEST_F(BuildHills, does_not_take_up_work_done_with_other_settings) {
  CancelAt cancel("simplify", 60);
  ASSERT_FALSE(build_model(options, cancel).ok());
  options.node_triangles = 400;
  ASSERT_TRUE(built(options).ok());
  EXPECT_EQ(figures->units_resumed, 0);
}

TEST_F(BuildHills, refuses_to_build_into_a_model_that_another_build_has_locked) {
  const Result<FileLock> lock = FileLock::acquire(folder.path() / "model.prom.lock", "model");
  ASSERT_TRUE(lock.ok());
  EXPECT_THAT(error_of(options), HasSubstr("model.prom"));
  EXPECT_FALSE(std::filesystem::exists(model));
}

TEST_F(BuildHills, leaves_nothing_under_the_models_name_when_the_disk_is_full) {
  options.jobs = 1;
  FaultyFileSystem counting;
  counting.free_bytes = uint64_t(1) << 30;
  ASSERT_TRUE(build_model(options, monitor, counting).ok());
  const uint64_t needed = (uint64_t(1) << 30) - counting.free_bytes;
  const auto expected = bytes_of(model);
  options.model = folder.path() / "other.prom";
  for (const uint64_t free_bytes : {uint64_t(0), uint64_t(1000), needed / 3, needed * 2 / 3, needed - 100}) {
    FaultyFileSystem files;
    files.free_bytes = free_bytes;
    const Result<BuildFigures> result = build_model(options, monitor, files);
    ASSERT_FALSE(result.ok()) << free_bytes << " bytes free";
    EXPECT_THAT(result.error().message, HasSubstr("other.prom")) << free_bytes;
    EXPECT_FALSE(std::filesystem::exists(options.model)) << free_bytes;
    if (free_bytes + 100 < needed) std::filesystem::remove_all(folder.path() / "other.prom.work");
  }
  ASSERT_TRUE(built(options).ok());
  EXPECT_EQ(bytes_of(options.model), expected);
}

TEST_F(BuildHills, tiles_hold_what_one_file_holds) {
  Mesh left, right;
  std::vector<uint32_t> sides[2];
  for (uint32_t t = 0; t < mesh.triangle_count(); ++t)
    sides[mesh.positions[mesh.indices[3 * t]].x < 50 ? 0 : 1].push_back(t);
  folder.write("tiles/a.obj", obj_text(submesh(mesh, sides[0])));
  folder.write("tiles/b.obj", obj_text(submesh(mesh, sides[1])));
  options.sources = {folder.path() / "tiles"};
  const Result<ModelReader> reader = built(options);
  ASSERT_TRUE(reader.ok());
  EXPECT_EQ(reader->model().manifest.source_triangles, 20'000);
  EXPECT_THAT(reader->model().manifest.sources, testing::ElementsAre("a.obj", "b.obj"));
  uint64_t triangles = 0;
  for (const NodeRecord& node : reader->model().tables.nodes) triangles += node.child_count == 0 ? node.triangles : 0;
  EXPECT_EQ(triangles, 20'000);
}

TEST_F(BuildHills, replaces_a_model_and_nothing_else) {
  ASSERT_TRUE(built(options).ok());
  ASSERT_TRUE(built(options).ok());
  folder.write("precious.txt", "text");
  options.model = folder.path() / "precious.txt";
  EXPECT_THAT(error_of(options), HasSubstr("precious.txt"));
}

TEST_F(Build, keeps_the_precision_of_coordinates_far_from_zero) {
  std::string text;
  const Mesh mesh = test::hills(30);
  for (const glm::vec3& p : mesh.positions)
    text += fmt::format("v {:.4f} {:.4f} {:.4f}\n", 500'000.0 + double(p.x), 5'400'000.0 + double(p.y), double(p.z));
  for (size_t i = 0; i < mesh.indices.size(); i += 3)
    text += fmt::format("f {} {} {}\n", mesh.indices[i] + 1, mesh.indices[i + 1] + 1, mesh.indices[i + 2] + 1);
  const Result<ModelReader> reader = built(small_build(folder.write("utm.obj", text), model));
  ASSERT_TRUE(reader.ok());
  const ModelManifest& manifest = reader->model().manifest;
  EXPECT_NEAR(manifest.origin.x, 500'050, 1);
  EXPECT_NEAR(manifest.origin.y, 5'400'050, 1);
  const ClosestPointTree tree(mesh);
  for (const uint32_t leaf : leaves_below(reader->model(), 0))
    for (const glm::vec3& p : mesh_of(*reader, leaf).positions) {
      const glm::vec3 at(glm::dvec3(p) + manifest.origin - glm::dvec3(500'000, 5'400'000, 0));
      EXPECT_LT(std::sqrt(tree.nearest(at).distance2_m2), 0.002);
    }
}

TEST_F(Build, cuts_a_large_ground_so_that_boxes_stay_tight) {
  Mesh mesh = test::hills(60);
  append(mesh, test::flat_grid(1, 100, -10));
  const Result<ModelReader> reader = built(small_build(folder.write("ground.obj", obj_text(mesh)), model));
  ASSERT_TRUE(reader.ok());
  for (const uint32_t leaf : leaves_below(reader->model(), 0))
    EXPECT_LT(reader->model().tables.nodes[leaf].box.diagonal(), 100);
}

TEST_F(Build, says_when_there_are_no_triangles) {
  const auto source = folder.write("empty.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n");
  EXPECT_THAT(error_of(small_build(source, model)), HasSubstr("empty.obj: no triangles"));
  EXPECT_FALSE(std::filesystem::exists(model));
}

TEST_F(Build, refuses_settings_out_of_range) {
  BuildOptions options = small_build(folder.write("one.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"), model);
  options.node_triangles = 99;
  EXPECT_EQ(error_of(options), "--node-triangles 99: must be between 100 and 60000");
  options.node_triangles = 2000, options.level_factors = {3, 17};
  EXPECT_EQ(error_of(options), "--level-factor 17: must be between 2 and 16");
  options.level_factors = {4}, options.memory_bytes = 1 << 20;
  EXPECT_EQ(error_of(options), "--memory 1 MiB is too little to build with; give at least 256 MiB");
}

TEST_F(Build, ends_for_triangles_in_one_place) {
  Mesh mesh;
  for (int i = 0; i < 3000; ++i) append(mesh, test::flat_grid(1, 10, float(i) * 1e-4F));
  const Result<ModelReader> reader = built(small_build(folder.write("stack.obj", obj_text(mesh)), model));
  ASSERT_TRUE(reader.ok());
  EXPECT_EQ(find_defect(reader->model()), "");
}

/// A wall of 2 x 40 x 40 triangles with a picture of red and blue stripes, and a plain green floor of as many.
class BuildTextured : public Build {
 protected:
  void SetUp() override {
    write_stripes(128);
    write_source(2);
  }

  /// A wall of 40 m with stripes, and a floor. The more waves a wall has, the more is lost with each triangle.
  void write_source(float waves) {
    Mesh wall = test::grid(40, 20, [](float, float) { return 0.0F; });
    for (glm::vec3& p : wall.positions) {
      wall.texcoords.emplace_back(p.x / 20, p.y / 20);
      p = {p.x, 0.3F * std::sin(p.x * waves + p.y * (waves - 2)), p.y};
    }
    const std::string materials = "newmtl wall\nKd 1 1 1\nmap_Kd stripes.png\nnewmtl floor\nKd 0 1 0\n";
    folder.write("textured.mtl", materials);
    Mesh floor = test::grid(40, 20, [](float x, float y) { return 0.2F * std::sin(x + y); });
    floor.texcoords.resize(floor.vertex_count());
    const std::string first = obj_text(wall, "mtllib textured.mtl\nusemtl wall\n");
    source = folder.write("textured.obj", first + obj_text(floor, "usemtl floor\n", wall.vertex_count()));
  }

  void write_stripes(uint32_t side) {
    Image picture{side, side, std::vector<glm::u8vec4>(size_t(side) * side)};
    for (uint32_t y = 0; y < side; ++y)
      for (uint32_t x = 0; x < side; ++x) picture.at(x, y) = x / (side / 4) % 2 == 0 ? kRed : kBlue;
    write_picture("stripes.png", picture);
  }

  void write_picture(const std::string& name, const Image& picture) {
    const Result<std::vector<std::byte>> png = encode_image(picture, ImageFormat::png);
    ASSERT_TRUE(png.ok());
    folder.write(name, {reinterpret_cast<const char*>(png->data()), png->size()});
  }

  static constexpr glm::u8vec4 kRed{220, 20, 20, 255}, kBlue{20, 20, 220, 255};
  std::filesystem::path source;
};

bool near(const glm::u8vec4& a, const glm::u8vec4& b) {
  for (int i = 0; i < 3; ++i)
    if (std::abs(int(a[i]) - int(b[i])) > 60) return false;
  return true;
}

/// What is seen at the middle of a triangle, filters and lamps aside.
glm::u8vec4 color_at_middle(const ModelReader& reader, std::map<uint32_t, Image>& pictures, const Mesh& mesh,
                            uint32_t triangle) {
  const Material& material = reader.model().tables.materials[mesh.material_of(triangle)];
  glm::vec2 uv(0);
  glm::vec3 vertex_color(0);
  for (size_t c = 0; c < 3; ++c) {
    const uint32_t v = mesh.indices[3 * size_t(triangle) + c];
    if (!mesh.texcoords.empty()) uv += mesh.texcoords[v] / 3.0F;
    vertex_color += (mesh.colors.empty() ? glm::vec3(255) : glm::vec3(mesh.colors[v])) / 3.0F;
  }
  glm::vec3 color = vertex_color / 255.0F * glm::vec3(material.color);
  if (material.texture != kNoTexture) {
    if (!pictures.contains(material.texture)) pictures[material.texture] = *reader.read_texture(material.texture);
    const Image& image = pictures[material.texture];
    const auto texel = [](float t, uint32_t size) {
      return std::min(static_cast<uint32_t>((t - std::floor(t)) * float(size)), size - 1);
    };
    color *= glm::vec3(image.at(texel(uv.x, image.width), texel(uv.y, image.height))) / 255.0F;
  }
  return {color, 255};
}

TEST_F(BuildTextured, leaves_share_the_sources_picture_and_others_have_their_own) {
  const Result<ModelReader> reader = built(small_build(source, model));
  ASSERT_TRUE(reader.ok());
  const ModelTables& tables = reader->model().tables;
  uint32_t atlases = 0, shared = 0;
  for (uint32_t i = 0; i < tables.nodes.size(); ++i) {
    const NodeRecord& node = tables.nodes[i];
    EXPECT_EQ(node.texture_count > 0, node.textured_triangles > 0) << "node " << i;
    for (const uint32_t texture : reader->model().textures_of(NodeId{i})) {
      const bool is_atlas = (tables.textures[texture].flags & TextureRecord::kAtlas) != 0;
      EXPECT_EQ(is_atlas, node.child_count > 0) << "node " << i;
      ++(is_atlas ? atlases : shared);
    }
  }
  EXPECT_GT(atlases, 1);
  EXPECT_GT(shared, 4);
  EXPECT_EQ(tables.textures.size(), atlases + 1) << "the source's one picture is stored once";
  EXPECT_GT(figures->bytes_by_part["textures"], 0);
}

void expect_the_sources_colours(const ModelReader& reader, const glm::u8vec4& even, const glm::u8vec4& odd) {
  const glm::u8vec4 green(0, 255, 0, 255);
  std::map<uint32_t, Image> pictures;
  for (uint32_t i = 0; i < reader.model().tables.nodes.size(); ++i) {
    const Mesh mesh = mesh_of(reader, i);
    uint32_t wrong = 0;
    for (uint32_t t = 0; t < mesh.triangle_count(); ++t) {
      glm::vec3 p(0);
      for (size_t c = 0; c < 3; ++c) p += mesh.positions[mesh.indices[3 * t + c]] / 3.0F;
      // Nearer to where colours meet than this, they may blur: the error, and as much again for the filter.
      const float blur_m = 2 * reader.model().tables.nodes[i].error_m;
      const bool in_stripe = std::abs(p.x - 5 * std::round(p.x / 5)) > blur_m;
      const bool on_wall = std::abs(p.y) < 0.35F && p.z > 0.3F + blur_m && in_stripe;
      const bool on_floor = p.y > 0.5F + blur_m;
      const glm::u8vec4 expected = static_cast<int>(p.x / 5) % 2 == 0 ? even : odd;
      const glm::u8vec4 seen = color_at_middle(reader, pictures, mesh, t);
      wrong += (on_wall && !near(seen, expected)) || (on_floor && !near(seen, green)) ? 1U : 0U;
    }
    EXPECT_EQ(wrong, 0) << "of " << mesh.triangle_count() << " triangles of node " << i;
  }
}

TEST_F(BuildTextured, nodes_of_all_levels_show_the_sources_colours) {
  const Result<ModelReader> reader = built(small_build(source, model));
  ASSERT_TRUE(reader.ok());
  expect_the_sources_colours(*reader, kRed, kBlue);
}

/// Every corner of every triangle, in some order.
std::multiset<std::array<float, 3>> places_of(const Mesh& mesh) {
  std::multiset<std::array<float, 3>> places;
  for (const uint32_t v : mesh.indices) places.insert({mesh.positions[v].x, mesh.positions[v].y, mesh.positions[v].z});
  return places;
}

TEST_F(BuildTextured, leaves_stand_below_themselves_with_smaller_pictures) {
  write_stripes(2048);
  write_source(5);
  const Result<ModelReader> reader = built(small_build(source, model));
  ASSERT_TRUE(reader.ok());
  const Model& read = reader->model();
  const auto& nodes = read.tables.nodes;
  const auto side_of = [&](NodeId id) { return read.tables.textures[read.textures_of(id).front()].width; };
  std::set<uint32_t> sides;
  for (uint32_t i = 0; i < nodes.size(); ++i) {
    if (nodes[i].child_count != 1) continue;
    const NodeId child = read.children_of(NodeId{i})[0];
    const NodeRecord& finer = nodes[index_of(child)];
    EXPECT_LE(side_of(NodeId{i}) * 4, side_of(child)) << "node " << i;
    sides.insert(side_of(NodeId{i}));
    const double texel_m = 20.0 / side_of(NodeId{i});
    EXPECT_GE(nodes[i].error_m, texel_m * 0.7) << "node " << i;
    EXPECT_LE(nodes[i].error_m, texel_m) << "the wall is steep, not its texels that large; node " << i;
    EXPECT_LT(finer.error_m, nodes[i].error_m);
    EXPECT_EQ(places_of(mesh_of(*reader, i)), places_of(mesh_of(*reader, index_of(child)))) << "node " << i;
    const NodeRecord& parent = nodes[index_of(nodes[i].parent)];
    if (parent.child_count > 1) {
      EXPECT_GE(parent.error_m, 2 * nodes[i].error_m) << "node " << i;
      EXPECT_GE(parent.error_p99_m, nodes[i].error_p99_m) << "node " << i;
    }
    if (finer.child_count == 0) {
      EXPECT_EQ(side_of(child), 2048);
    }
  }
  EXPECT_TRUE(sides.contains(512));
  expect_the_sources_colours(*reader, kRed, kBlue);
}

TEST_F(BuildTextured, a_model_of_one_leaf_has_smaller_pictures_above_it) {
  write_stripes(1024);
  folder.write("textured.mtl", "newmtl wall\nmap_Kd stripes.png\n");
  source = folder.write("one.obj",
                        "mtllib textured.mtl\nusemtl wall\nv 0 0 0\nv 20 0 0\nv 0 0 20\nvt 0 0\nvt 1 0\nvt 0 1\n"
                        "f 1/1 2/2 3/3\n");
  const Result<ModelReader> reader = built(small_build(source, model));
  ASSERT_TRUE(reader.ok());
  const ModelTables& tables = reader->model().tables;
  ASSERT_EQ(tables.nodes.size(), 3);
  EXPECT_EQ(tables.textures[0].width, 1024);
  const std::vector<uint32_t> widths = {64, 256, 1024};
  for (uint32_t i = 0; i < 3; ++i)
    EXPECT_EQ(tables.textures[reader->model().textures_of(NodeId{i})[0]].width, widths[i]) << "node " << i;
}

TEST_F(BuildTextured, makes_large_pictures_smaller) {
  BuildOptions options = small_build(source, model);
  options.max_texture_px = 64;
  const Result<ModelReader> reader = built(options);
  ASSERT_TRUE(reader.ok());
  const TextureRecord& texture = reader->model().tables.textures[0];
  EXPECT_EQ(texture.width, 64);
  EXPECT_EQ(texture.height, 64);
  for (const NodeRecord& node : reader->model().tables.nodes)
    if (node.textured_triangles > 0) {
      EXPECT_GT(node.error_m, 0.2F) << "a texel is 20 / 64 m wide";
    }
}

TEST_F(BuildTextured, names_a_missing_picture_and_draws_its_material_plainly) {
  std::filesystem::remove(folder.path() / "stripes.png");
  const Result<ModelReader> reader = built(small_build(source, model));
  ASSERT_TRUE(reader.ok());
  EXPECT_TRUE(reader->model().tables.textures.empty());
  EXPECT_THAT(reader->model().manifest.notes, testing::Contains(HasSubstr("stripes.png")));
}

TEST_F(BuildTextured, names_a_broken_picture_and_draws_its_material_plainly) {
  folder.write("stripes.png", "this is no picture");
  const Result<ModelReader> reader = built(small_build(source, model));
  ASSERT_TRUE(reader.ok());
  EXPECT_TRUE(reader->model().tables.textures.empty());
  EXPECT_THAT(reader->model().manifest.notes, testing::Contains(HasSubstr("stripes.png")));
}

TEST_F(BuildTextured, gives_the_same_bytes_after_an_interruption_and_for_any_number_of_jobs) {
  write_stripes(1024);
  BuildOptions options = small_build(source, model);
  options.chunk_triangles = 1500;
  ASSERT_TRUE(built(options).ok());
  const auto expected = bytes_of(model);
  options.model = folder.path() / "other.prom";
  options.jobs = 1;
  CancelAt cancel("simplify", 12);
  ASSERT_FALSE(build_model(options, cancel).ok());
  options.jobs = 3;
  ASSERT_TRUE(built(options).ok());
  EXPECT_GT(figures->units_resumed, 0);
  EXPECT_EQ(bytes_of(options.model), expected);
}

}  // namespace
}  // namespace promenade
