// Objects that glTF animates, from the file to the model.

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

#include "tests/preprocess/build_fixtures.h"
#include "tests/preprocess/import_fixtures.h"

namespace promenade {
namespace {

using nlohmann::json;

struct Channel {
  const char* path;
  const char* type;
  std::vector<float> times, values;
  const char* interpolation = "LINEAR";
};

/// The tetrahedron with an animation of its node.
GlbFixture animated(const std::vector<Channel>& channels) {
  GlbFixture glb = tetrahedron_glb();
  json animation = {{"samplers", json::array()}, {"channels", json::array()}};
  for (const Channel& channel : channels) {
    const size_t input = glb.add_floats(channel.times, "SCALAR"), output = glb.add_floats(channel.values, channel.type);
    animation["channels"].push_back(
        {{"sampler", animation["samplers"].size()}, {"target", {{"node", 0}, {"path", channel.path}}}});
    animation["samplers"].push_back({{"input", input}, {"output", output}, {"interpolation", channel.interpolation}});
  }
  glb.json["animations"] = {animation};
  return glb;
}

const Channel goes_east{"translation", "VEC3", {0, 4}, {0, 0, 0, 8, 0, 0}};

Scene imported(const GlbFixture& glb) {
  Result<Scene> scene = import_bytes("fixture.glb", glb.bytes());
  EXPECT_TRUE(scene.ok()) << (scene.ok() ? "" : scene.error().message);
  if (!scene.ok()) return {};
  EXPECT_EQ(find_scene_defect(*scene), "");
  EXPECT_EQ(find_defect(scene->animation), "");
  return *std::move(scene);
}

/// Where the corner that is farthest along glTF's y (our z) stands at a time.
glm::dvec3 top_at(const Scene& scene, double time_s) {
  const SceneInstance& instance = scene.instances.at(0);
  const glm::dmat4 m = poses_at(scene.animation, time_s).at(instance.joint) * instance.joint_from_mesh;
  return glm::dvec3(m * glm::dvec4(0, 0, 1, 1));
}

TEST(ImportAnimation, nodes_move_in_our_frame) {
  const Scene scene = imported(animated({{"translation", "VEC3", {0, 4}, {0, 0, 0, 8, 0, -2}}}));
  ASSERT_NE(scene.instances.at(0).joint, kNoJoint);
  EXPECT_EQ(scene.report.counts.at("moving_objects"), 1U);
  // glTF (8, 0, -2) is (8, 2, 0) with z up; the tip is one metre above.
  EXPECT_NEAR(glm::distance(top_at(scene, 2), {4, 1, 1}), 0, 1e-6);
  EXPECT_NEAR(glm::distance(top_at(scene, 5), {2, 0.5, 1}), 0, 1e-6) << "it begins anew after 4 s";
}

TEST(ImportAnimation, children_move_with_what_they_hang_on) {
  GlbFixture glb = animated({goes_east});
  glb.json["nodes"][0]["children"] = {1};
  glb.json["nodes"].push_back({{"mesh", 0}, {"translation", {0, 10, 0}}, {"scale", {2, 2, 2}}});
  const Scene scene = imported(glb);
  ASSERT_EQ(scene.instances.size(), 2U);
  EXPECT_EQ(scene.animation.joints.size(), 1U) << "what hangs on a joint without moving of its own is part of it";
  const SceneInstance& child = scene.instances[1];
  const glm::dmat4 m = poses_at(scene.animation, 1)[child.joint] * child.joint_from_mesh;
  EXPECT_NEAR(glm::distance(glm::dvec3(m * glm::dvec4(0, 0, 1, 1)), {2, 0, 12}), 0, 1e-6);
}

TEST(ImportAnimation, rests_where_the_node_says) {
  GlbFixture glb = animated({goes_east});
  glb.json["nodes"][0]["translation"] = {0, 3, 0};
  const Scene scene = imported(glb);
  EXPECT_EQ(scene.instances[0].world_from_mesh[3], glm::dvec4(0, 0, 3, 1));
}

TEST(ImportAnimation, what_cannot_be_played_is_left_out_and_counted) {
  const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
  const Channel broken[] = {
      {"translation", "VEC3", {}, {}},
      {"translation", "VEC3", {0, nan}, {0, 0, 0, 1, 0, 0}},
      {"translation", "VEC3", {0, 1}, {0, 0, 0, inf, 0, 0}},
      {"translation", "VEC3", {1, 0}, {0, 0, 0, 1, 0, 0}},
      {"translation", "VEC3", {1, 1}, {0, 0, 0, 1, 0, 0}},
      {"translation", "VEC3", {0, 1}, {0, 0, 0}},
      {"translation", "VEC3", {0, 1}, {0, 0, 0, 1, 0, 0}, "CUBICSPLINE"},
      {"translation", "VEC3", {0, 1}, {0, 0, 0, 1, 0, 0}, "SPLINES"},
      {"rotation", "VEC3", {0, 1}, {0, 0, 0, 1, 0, 0}},
      {"weights", "SCALAR", {0, 1}, {0, 1}},
  };
  for (const Channel& channel : broken) {
    const Scene scene = imported(animated({channel}));
    EXPECT_EQ(scene.instances.at(0).joint, kNoJoint) << channel.path << channel.interpolation;
    EXPECT_TRUE(scene.animation.empty());
    EXPECT_EQ(scene.report.counts.at("animation_channels_dropped"), 1U);
  }
}

TEST(ImportAnimation, objects_that_leave_every_model_stand_still) {
  for (const float far : {1e9F, 1e30F}) {
    const Scene scene = imported(animated({{"translation", "VEC3", {0, 1}, {0, 0, 0, far, 0, 0}}}));
    EXPECT_EQ(scene.instances.at(0).joint, kNoJoint);
    EXPECT_EQ(scene.report.counts.at("animations_dropped"), 1U);
  }
  const Scene gone = imported(animated({{"scale", "VEC3", {0, 1}, {0, 0, 0, 0, 0, 0}}}));
  EXPECT_EQ(gone.instances.at(0).joint, kNoJoint) << "never larger than nothing";
}

class BuildMoving : public testing::Test {
 protected:
  Result<ModelReader> built(const std::string& glb, uint32_t jobs = 2) {
    BuildOptions options = small_build(folder.write("moving.glb", glb), folder.path() / "model.prom");
    options.import.up.reset();
    options.jobs = jobs;
    const Result<BuildFigures> figures = build_model(options, monitor);
    EXPECT_TRUE(figures.ok()) << (figures.ok() ? "" : figures.error().message);
    return ModelReader::open(options.model);
  }
  TemporaryFolder folder;
  JobMonitor monitor;
};

/// One tetrahedron that moves, one that stands 20 m to the north (glTF -z).
GlbFixture one_of_two_moves() {
  GlbFixture glb = animated({goes_east});
  glb.json["nodes"][0]["extras"] = {{"class", "car"}};
  glb.json["nodes"].push_back({{"mesh", 0}, {"translation", {0, 0, -20}}, {"extras", {{"class", "house"}}}});
  glb.json["scenes"][0]["nodes"] = {0, 1};
  return glb;
}

TEST_F(BuildMoving, gives_what_moves_a_tree_of_its_own_with_the_box_that_it_sweeps) {
  const Result<ModelReader> reader = built(one_of_two_moves().bytes());
  ASSERT_TRUE(reader.ok()) << reader.error().message;
  const Model& model = reader->model();
  ASSERT_EQ(model.tables.roots.size(), 2U);
  ASSERT_EQ(model.objects.moving.size(), 1U);
  EXPECT_EQ(model.first_moving_node(), 1U);
  EXPECT_FALSE(model.is_moving(NodeId{0}));
  const Box& swept = model.tables.nodes[1].box;
  EXPECT_NEAR(swept.max.x - swept.min.x, 9, 1e-3);
  EXPECT_NEAR(swept.max.y - swept.min.y, 1, 1e-3);
  EXPECT_NEAR(double(model.manifest.world_box.max.x), 9, 1e-3);
  // The node's mesh, placed, is where the animation has it.
  const Mesh placed = transformed(mesh_of(*reader, 1), model_from_objects(model, 3)[0]);
  EXPECT_NEAR(bounds(placed).min.x, 6, 2e-3);
  EXPECT_NEAR(bounds(placed).max.z, 1, 2e-3);
}

TEST_F(BuildMoving, keeps_classes_by_area) {
  const Result<ModelReader> reader = built(one_of_two_moves().bytes());
  ASSERT_TRUE(reader.ok());
  const ModelObjects& objects = reader->model().objects;
  ASSERT_EQ(objects.class_shares.size(), 2U);
  EXPECT_EQ(objects.classes[objects.class_shares[0].class_index], "house");
  EXPECT_EQ(objects.classes[objects.class_shares[1].class_index], "car");
  const float area = 1.5F + std::sqrt(3.0F) / 2;
  EXPECT_NEAR(objects.class_shares[0].area_m2, area, 1e-3);
  EXPECT_NEAR(objects.class_shares[1].area_m2, area, 1e-3);
}

TEST_F(BuildMoving, a_source_in_which_everything_moves_has_no_tree_that_stands) {
  const Result<ModelReader> reader = built(animated({goes_east}).bytes());
  ASSERT_TRUE(reader.ok()) << reader.error().message;
  EXPECT_EQ(reader->model().first_moving_node(), 0U);
  EXPECT_EQ(reader->model().manifest.source_triangles, 4U);
}

TEST_F(BuildMoving, what_is_stored_never_grows_on_the_way_so_that_errors_hold) {
  // A tenth of a metre in the file, shown a hundred times as large for a moment.
  const Result<ModelReader> reader =
      built(animated({{"scale", "VEC3", {0, 1, 2}, {1, 1, 1, 100, 100, 100, 1, 1, 1}}}).bytes());
  ASSERT_TRUE(reader.ok());
  const glm::dmat4 largest = model_from_objects(reader->model(), 1)[0];
  EXPECT_NEAR(glm::length(glm::dvec3(largest[0])), 1, 1e-6);
  EXPECT_NEAR(bounds(transformed(mesh_of(*reader, 0), largest)).max.x, 100, 0.01);
}

TEST_F(BuildMoving, gives_the_same_bytes_with_any_number_of_threads) {
  ASSERT_TRUE(built(one_of_two_moves().bytes(), 1).ok());
  const auto one = bytes_of(folder.path() / "model.prom");
  ASSERT_TRUE(built(one_of_two_moves().bytes(), 3).ok());
  EXPECT_EQ(bytes_of(folder.path() / "model.prom"), one);
  EXPECT_TRUE(one.contains("objects.bin"));
}

}  // namespace
}  // namespace promenade
