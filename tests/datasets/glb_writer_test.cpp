#include "datasets/glb_writer.h"

#include <gtest/gtest.h>

#include <cstring>
#include <fstream>
#include <glm/ext/matrix_transform.hpp>

#include "tests/datasets/glb_small_disk.h"

// Compiled here: Debian's library of it was built with other settings than its header shows, and its classes differ.
#define TINYGLTF_IMPLEMENTATION
#define TINYGLTF_NO_STB_IMAGE
#define TINYGLTF_NO_STB_IMAGE_WRITE
#include <tiny_gltf.h>

namespace promenade {
namespace {

namespace fs = std::filesystem;

/// An empty folder that goes away with the test.
class GlbWriterTest : public testing::Test {
 protected:
  void SetUp() override {
    const testing::TestInfo* info = testing::UnitTest::GetInstance()->current_test_info();
    folder_ = fs::path(testing::TempDir()) / (std::string("promenade_glb_") + info->name());
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }
  fs::path file() const { return folder_ / "out.glb"; }
  const fs::path& folder() const { return folder_; }

  tinygltf::Model load() const {
    tinygltf::Model model;
    tinygltf::TinyGLTF loader;
    // The pictures of these tests are no pictures: they are kept as bytes.
    loader.SetImageLoader(
        [](tinygltf::Image* image, int, std::string*, std::string*, int, int, const unsigned char* bytes, int size,
           void*) {
          image->image.assign(bytes, bytes + size);
          return true;
        },
        nullptr);
    std::string error, warning;
    std::ifstream in(file(), std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(in), {}};
    std::vector<unsigned char> unsigned_bytes(bytes.begin(), bytes.end());
    EXPECT_TRUE(loader.LoadBinaryFromMemory(&model, &error, &warning, unsigned_bytes.data(),
                                            static_cast<unsigned>(unsigned_bytes.size())))
        << error;
    EXPECT_EQ(warning, "");
    return model;
  }

 private:
  fs::path folder_;
};

Mesh coloured_quad_of_two_materials() {
  Mesh mesh;
  mesh.positions = {{0, 0, 1}, {2, 0, 1}, {2, 3, 1}, {0, 3, 1}};
  mesh.normals.assign(4, {0, 0, 1});
  mesh.texcoords = {{0, 1}, {1, 1}, {1, 0}, {0, 0}};
  mesh.colors = {{0, 1, 2, 255}, {30, 60, 90, 128}, {250, 251, 252, 0}, {255, 255, 255, 255}};
  mesh.indices = {0, 1, 2, 0, 2, 3};
  mesh.materials = {0, 1};
  return mesh;
}

template <class T>
T value_at(const tinygltf::Model& model, int accessor, size_t byte) {
  const tinygltf::Accessor& a = model.accessors[static_cast<size_t>(accessor)];
  const tinygltf::BufferView& view = model.bufferViews[static_cast<size_t>(a.bufferView)];
  T value;
  std::memcpy(&value, model.buffers[0].data.data() + view.byteOffset + a.byteOffset + byte, sizeof(T));
  return value;
}

TEST_F(GlbWriterTest, another_reader_finds_what_was_written) {
  Result<GlbWriter> writer = GlbWriter::create(file(), "test \"1\"");
  ASSERT_TRUE(writer.ok()) << writer.error().message;
  const std::vector<std::byte> picture(5, std::byte{7});
  const Result<uint32_t> texture = writer->add_texture("bricks", "image/jpeg", picture);
  ASSERT_TRUE(texture.ok());
  Material plain;
  plain.color = {255, 0, 128, 51};
  plain.alpha = AlphaMode::blend;
  Material textured;
  textured.texture = *texture;
  textured.wrap_u = Wrap::clamp;
  textured.two_sided = true;
  EXPECT_EQ(writer->add_material("plain", plain), 0U);
  EXPECT_EQ(writer->add_material("textured", textured), 1U);
  const Result<uint32_t> mesh = writer->add_mesh("quad", coloured_quad_of_two_materials());
  ASSERT_TRUE(mesh.ok()) << mesh.error().message;
  writer->add_node("first \\ \"quad\"", "sign", *mesh, glm::dmat4(1));
  writer->add_node("moved", "sign", *mesh, glm::translate(glm::dmat4(1), glm::dvec3(1, 2, 3)));
  writer->add_node("turned", "sign", *mesh, glm::rotate(glm::dmat4(1), 0.5, glm::dvec3(0, 0, 1)));
  const Status finished = writer->finish();
  ASSERT_TRUE(finished.ok()) << finished.error().message;

  const tinygltf::Model model = load();
  EXPECT_EQ(model.asset.generator, "test \"1\"");
  ASSERT_EQ(model.nodes.size(), 3U);
  EXPECT_EQ(model.nodes[0].name, "first \\ \"quad\"");
  EXPECT_EQ(model.nodes[0].extras.Get("class").Get<std::string>(), "sign");
  EXPECT_EQ(model.nodes[1].translation, (std::vector<double>{1, 3, -2}));
  ASSERT_EQ(model.nodes[2].matrix.size(), 16U);
  EXPECT_DOUBLE_EQ(model.nodes[2].matrix[0], std::cos(0.5));
  EXPECT_DOUBLE_EQ(model.nodes[2].matrix[2], -std::sin(0.5));  // +x turns towards +y, which is -z in the file
  EXPECT_DOUBLE_EQ(model.nodes[2].matrix[5], 1);
  ASSERT_EQ(model.images.size(), 1U);
  EXPECT_EQ(model.images[0].image, std::vector<unsigned char>(5, 7));
  ASSERT_EQ(model.samplers.size(), 1U);
  EXPECT_EQ(model.samplers[0].wrapS, TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE);
  EXPECT_EQ(model.samplers[0].wrapT, TINYGLTF_TEXTURE_WRAP_REPEAT);
  EXPECT_EQ(model.materials[0].alphaMode, "BLEND");
  EXPECT_NEAR(model.materials[0].pbrMetallicRoughness.baseColorFactor[3], 0.2, 1e-6);
  EXPECT_TRUE(model.materials[1].doubleSided);
  ASSERT_EQ(model.meshes[0].primitives.size(), 2U);
  const tinygltf::Primitive& first = model.meshes[0].primitives[0];
  EXPECT_FALSE(first.attributes.contains("TEXCOORD_0")) << "the plain material needs none";
  const tinygltf::Primitive& second = model.meshes[0].primitives[1];
  EXPECT_EQ(model.accessors[static_cast<size_t>(second.indices)].componentType, TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT);
  // The second triangle's corners are vertices 0, 2, 3 of the quad, y up.
  const int positions = second.attributes.at("POSITION");
  EXPECT_EQ(value_at<glm::vec3>(model, positions, 12), glm::vec3(2, 1, -3));
  EXPECT_EQ(value_at<glm::vec3>(model, second.attributes.at("NORMAL"), 0), glm::vec3(0, 1, 0));
  EXPECT_EQ(value_at<glm::vec2>(model, second.attributes.at("TEXCOORD_0"), 8), glm::vec2(1, 0));
  EXPECT_EQ(model.accessors[static_cast<size_t>(positions)].minValues, (std::vector<double>{0, 1, -3}));
  EXPECT_EQ(model.accessors[static_cast<size_t>(positions)].maxValues, (std::vector<double>{2, 1, 0}));
  for (size_t vertex = 0; vertex < 3; ++vertex) {
    const glm::u8vec4 expected = coloured_quad_of_two_materials().colors[vertex == 0 ? 0 : vertex + 1];
    for (size_t channel = 0; channel < 4; ++channel) {
      const auto value = value_at<uint16_t>(model, second.attributes.at("COLOR_0"), 8 * vertex + 2 * channel);
      const float linear = static_cast<float>(value) / 65535.0F;
      const int read = channel == 3 ? value / 257 : linear_to_srgb(linear);
      EXPECT_EQ(read, expected[static_cast<glm::length_t>(channel)]);
    }
  }
}

TEST_F(GlbWriterTest, wide_indices_only_where_they_are_needed) {
  Result<GlbWriter> writer = GlbWriter::create(file(), "test");
  ASSERT_TRUE(writer.ok());
  Mesh mesh;
  mesh.positions.resize(65535);
  for (size_t i = 0; i < mesh.positions.size(); ++i) mesh.positions[i] = {float(i % 256), float(i / 256), 0};
  mesh.indices = {0, 1, 65534};
  ASSERT_TRUE(writer->add_mesh("narrow", mesh).ok());
  mesh.positions.emplace_back(0, 0, 1);
  mesh.indices[2] = 65535;
  ASSERT_TRUE(writer->add_mesh("wide", mesh).ok());
  ASSERT_TRUE(writer->finish().ok());
  const tinygltf::Model model = load();
  ASSERT_EQ(model.meshes.size(), 2U);
  const auto type_of = [&](size_t mesh_index) {
    return model.accessors[static_cast<size_t>(model.meshes[mesh_index].primitives[0].indices)].componentType;
  };
  EXPECT_EQ(type_of(0), TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT);
  EXPECT_EQ(type_of(1), TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT);
}

TEST_F(GlbWriterTest, refuses_what_would_make_a_broken_file) {
  Result<GlbWriter> writer = GlbWriter::create(file(), "test");
  ASSERT_TRUE(writer.ok());
  Mesh bad = coloured_quad_of_two_materials();
  bad.indices[3] = 4;
  EXPECT_NE(writer->add_mesh("bad", bad).error().message.find("out.glb: mesh bad: index 3 is 4"), std::string::npos);
  EXPECT_FALSE(writer->add_mesh("empty", Mesh{}).ok());
  EXPECT_FALSE(writer->add_mesh("no material 1", coloured_quad_of_two_materials()).ok());
  EXPECT_FALSE(writer->add_texture("t", "image/webp", std::vector<std::byte>(3)).ok());
  EXPECT_FALSE(writer->add_texture("t", "image/png", {}).ok());
}

TEST_F(GlbWriterTest, leaves_nothing_without_finish) {
  {
    Result<GlbWriter> writer = GlbWriter::create(file(), "test");
    ASSERT_TRUE(writer.ok());
    Mesh mesh = coloured_quad_of_two_materials();
    mesh.materials.clear();
    ASSERT_TRUE(writer->add_mesh("quad", mesh).ok());
  }
  EXPECT_TRUE(fs::is_empty(folder()));
}

TEST_F(GlbWriterTest, names_a_folder_that_is_not_there) {
  const Result<GlbWriter> writer = GlbWriter::create(folder() / "missing" / "out.glb", "test");
  ASSERT_FALSE(writer.ok());
  EXPECT_NE(writer.error().message.find("out.glb"), std::string::npos);
  EXPECT_NE(writer.error().message.find("No such file"), std::string::npos);
}

TEST_F(GlbWriterTest, a_full_disk_is_an_error_and_leaves_nothing) {
  const SmallDisk disk(100'000);
  Status status = Done{};
  {
    Result<GlbWriter> writer = GlbWriter::create(file(), "test");
    ASSERT_TRUE(writer.ok());
    Mesh mesh;
    mesh.positions.resize(20'000, glm::vec3(1, 2, 3));
    mesh.indices = {0, 1, 2};
    for (int i = 0; i < 3 && status.ok(); ++i)
      if (const Result<uint32_t> added = writer->add_mesh("big", mesh); !added) status = added.error();
    if (status.ok()) status = writer->finish();
  }
  ASSERT_FALSE(status.ok());
  EXPECT_NE(status.error().message.find("out.glb"), std::string::npos) << status.error().message;
  EXPECT_TRUE(fs::is_empty(folder()));
}

}  // namespace
}  // namespace promenade
