// glTF: what each feature of the format becomes, on files of a few hundred bytes.

#include <draco/compression/encode.h>
#include <draco/mesh/triangle_soup_mesh_builder.h>
#include <gtest/gtest.h>
#include <meshoptimizer.h>

#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <limits>

#include "tests/preprocess/import_fixtures.h"

namespace promenade {
namespace {

using nlohmann::json;

ImportOptions as_it_is() {
  ImportOptions options;
  options.repair = false;
  return options;
}

Scene imported(const std::string& name, std::string_view bytes, const ImportOptions& options = as_it_is()) {
  Result<Scene> scene = import_bytes(name, bytes, options);
  if (!scene.ok()) {
    ADD_FAILURE() << scene.error().message;
    return {};
  }
  EXPECT_EQ(find_scene_defect(*scene), "");
  return *std::move(scene);
}

Scene imported(const GlbFixture& glb) { return imported("fixture.glb", glb.bytes()); }

DBox world_box(const Scene& scene) {
  DBox box;
  for (const SceneInstance& instance : scene.instances)
    for (const glm::vec3& p : flattened(scene, instance, glm::dvec3(0)).positions) box.add(glm::dvec3(p));
  return box;
}

void expect_box(const Scene& scene, const glm::dvec3& min, const glm::dvec3& max, double tolerance = 1e-6) {
  const DBox box = world_box(scene);
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(box.min[axis], min[axis], tolerance) << axis;
    EXPECT_NEAR(box.max[axis], max[axis], tolerance) << axis;
  }
}

/// Six times the volume that the triangles enclose; positive: fronts outwards.
double signed_volume(const Mesh& mesh) {
  double volume = 0;
  for (size_t t = 0; t < mesh.triangle_count(); ++t) {
    const auto p = [&](size_t c) { return glm::dvec3(mesh.positions[mesh.indices[3 * t + c]]); };
    volume += glm::dot(p(0), glm::cross(p(1), p(2)));
  }
  return volume;
}

TEST(ImportGltf, tetrahedron_comes_z_up_with_its_name_and_fronts_outwards) {
  const Scene scene = imported(tetrahedron_glb());
  ASSERT_EQ(scene.instances.size(), 1U);
  EXPECT_EQ(scene.instances[0].name, "tetrahedron");
  EXPECT_EQ(scene.report.counts.at("triangles"), 4U);
  expect_box(scene, {0, -1, 0}, {1, 0, 1});  // (x, y, z) -> (x, -z, y)
  EXPECT_NEAR(signed_volume(flattened(scene, scene.instances[0], {})), 1, 1e-6);
}

TEST(ImportGltf, units_and_up_axis_are_the_callers_when_given) {
  ImportOptions options = as_it_is();
  options.unit_m = 0.01;
  options.up = UpAxis::z;
  expect_box(imported("fixture.glb", tetrahedron_glb().bytes(), options), {0, 0, 0}, {0.01, 0.01, 0.01}, 1e-9);
}

TEST(ImportGltf, node_hierarchy_multiplies_transforms) {
  GlbFixture glb = tetrahedron_glb();
  glb.json["nodes"] = {{{"children", {1}}, {"translation", {10, 0, 0}}},
                       {{"children", {2}}, {"scale", {2, 2, 2}}},
                       {{"mesh", 0}, {"matrix", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 5, 0, 1}}}};
  expect_box(imported(glb), {10, -2, 10}, {12, 0, 12});
}

TEST(ImportGltf, quaternions_turn_counter_clockwise) {
  GlbFixture glb = tetrahedron_glb();
  const double h = std::sqrt(0.5);
  glb.json["nodes"] = {{{"mesh", 0}, {"rotation", {0, h, 0, h}}}};  // 90 degrees about the file's y, our z
  expect_box(imported(glb), {0, 0, 0}, {1, 1, 1});                  // +x goes to the file's -z, our +y
}

TEST(ImportGltf, gltf_with_mirrored_instance_keeps_its_sign_and_its_fronts) {
  GlbFixture glb = tetrahedron_glb();
  glb.json["nodes"] = {{{"mesh", 0}, {"scale", {-1, 1, 1}}}};
  const Scene scene = imported(glb);
  ASSERT_EQ(scene.instances.size(), 1U);
  EXPECT_LT(glm::determinant(glm::dmat3(scene.instances[0].world_from_mesh)), 0);
  EXPECT_NEAR(signed_volume(flattened(scene, scene.instances[0], {})), 1, 1e-6);
  expect_box(scene, {-1, -1, 0}, {0, 0, 1});
}

TEST(ImportGltf, flattened_mesh_is_relative_to_the_models_origin) {
  GlbFixture glb = tetrahedron_glb();
  glb.json["nodes"] = {{{"mesh", 0}, {"translation", {500000.001, 0, 0}}}};
  const Scene scene = imported(glb);
  const Mesh mesh = flattened(scene, scene.instances[0], {500000, 0, 0});
  EXPECT_NEAR(bounds(mesh).min.x, 0.001, 1e-6);
}

TEST(ImportGltf, two_nodes_share_one_mesh) {
  GlbFixture glb = tetrahedron_glb();
  glb.json["scenes"] = {{{"nodes", {0, 1}}}};
  glb.json["nodes"] = {{{"mesh", 0}}, {{"mesh", 0}, {"translation", {5, 0, 0}}}};
  const Scene scene = imported(glb);
  EXPECT_EQ(scene.meshes.size(), 1U);
  EXPECT_EQ(scene.instances.size(), 2U);
  EXPECT_EQ(scene.report.counts.at("triangles"), 8U);
  EXPECT_EQ(scene.report.counts.at("triangles_unique"), 4U);
}

TEST(ImportGltf, meshes_of_the_same_accessors_are_read_once) {
  GlbFixture glb = tetrahedron_glb();
  glb.json["meshes"].push_back(glb.json["meshes"][0]);
  glb.json["meshes"][1]["name"] = "again";
  glb.json["scenes"] = {{{"nodes", {0, 1}}}};
  glb.json["nodes"] = {{{"mesh", 0}}, {{"mesh", 1}}};
  EXPECT_EQ(imported(glb).meshes.size(), 1U);
}

TEST(ImportGltf, gpu_instances_stay_instances) {
  GlbFixture glb = tetrahedron_glb();
  const size_t translation = glb.add_floats({0, 0, 0, 10, 0, 0, 20, 0, 0}, "VEC3");
  const size_t scale = glb.add_floats({1, 1, 1, 1, 1, 1, 3, 3, 3}, "VEC3");
  const size_t rotation = glb.add_values<int16_t>({0, 0, 0, 32767, 0, 0, 0, 32767, 0, 0, 0, 32767}, "VEC4", 5122, true);
  glb.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = {
      {"TRANSLATION", translation}, {"SCALE", scale}, {"ROTATION", rotation}};
  const Scene scene = imported(glb);
  EXPECT_EQ(scene.meshes.size(), 1U);
  EXPECT_EQ(scene.instances.size(), 3U);
  expect_box(scene, {0, -3, 0}, {23, 0, 3});
}

TEST(ImportGltf, class_is_the_nodes_or_its_nearest_ancestors) {
  GlbFixture glb = tetrahedron_glb();
  glb.json["nodes"] = {{{"children", {1, 2}}, {"extras", {{"class", "furniture"}}}},
                       {{"mesh", 0}, {"extras", {{"class", "chair"}}}, {"name", "a"}},
                       {{"mesh", 0}, {"name", "b"}}};
  const Scene scene = imported(glb);
  ASSERT_EQ(scene.instances.size(), 2U);
  EXPECT_EQ(scene.instances[0].class_name, "chair");
  EXPECT_EQ(scene.instances[1].class_name, "furniture");
}

TEST(ImportGltf, strips_and_fans_become_triangles_with_one_winding) {
  for (const int mode : {5, 6}) {
    GlbFixture glb;
    const size_t positions = mode == 5 ? glb.add_floats({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 0, 2, 0}, "VEC3")
                                       : glb.add_floats({0, 0, 0, 2, 0, 0, 2, 1, 0, 1, 2, 0, 0, 2, 0}, "VEC3");
    const size_t indices = glb.add_values<uint8_t>({0, 1, 2, 3, 4}, "SCALAR", 5121);
    glb.add_mesh(positions, indices);
    glb.json["meshes"][0]["primitives"][0]["mode"] = mode;
    glb.json["nodes"] = {{{"mesh", 0}}};
    const Scene scene = imported(glb);
    ASSERT_EQ(scene.meshes.size(), 1U);
    ASSERT_EQ(scene.meshes[0].triangle_count(), 3U);
    for (size_t t = 0; t < 3; ++t) EXPECT_LT(triangle_cross(scene.meshes[0], t).y, 0) << mode;  // the file's +z
  }
}

TEST(ImportGltf, triangles_without_indices_are_read) {
  GlbFixture glb;
  const size_t positions = glb.add_floats({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3");
  glb.json["meshes"] = {{{"primitives", {{{"attributes", {{"POSITION", positions}}}}}}}};
  glb.json["nodes"] = {{{"mesh", 0}}};
  EXPECT_EQ(imported(glb).report.counts.at("triangles"), 1U);
}

TEST(ImportGltf, points_and_lines_are_left_out_and_counted) {
  GlbFixture glb = tetrahedron_glb();
  json lines = glb.json["meshes"][0]["primitives"][0];
  lines["mode"] = 1;
  glb.json["meshes"][0]["primitives"].push_back(lines);
  const Scene scene = imported(glb);
  EXPECT_EQ(scene.report.counts.at("primitives_skipped"), 1U);
  EXPECT_EQ(scene.report.counts.at("triangles"), 4U);
}

TEST(ImportGltf, sparse_accessor_moves_the_vertices_that_it_names) {
  GlbFixture glb = tetrahedron_glb();
  const std::array<uint16_t, 1> place{3};
  const std::array<float, 3> value{0, 0, 7};
  const size_t where = glb.add_view(std::as_bytes(std::span(place)));
  const size_t what = glb.add_view(std::as_bytes(std::span(value)));
  glb.json["accessors"][0]["sparse"] = {
      {"count", 1}, {"indices", {{"bufferView", where}, {"componentType", 5123}}}, {"values", {{"bufferView", what}}}};
  expect_box(imported(glb), {0, -7, 0}, {1, 0, 1});
}

TEST(ImportGltf, interleaved_views_are_read_by_their_stride) {
  GlbFixture glb;
  const std::vector<float> vertices{0, 0, 0, 0, 0, 1, 1, 0, 0, 0, 0, 1, 0, 1, 0, 0, 0, 1};
  const size_t view = glb.add_view(std::as_bytes(std::span(vertices)), 24);
  const size_t positions = glb.add_accessor(view, 3, "VEC3", 5126);
  const size_t normals = glb.add_accessor(view, 3, "VEC3", 5126);
  glb.json["accessors"][normals]["byteOffset"] = 12;
  glb.add_mesh(positions, glb.add_values<uint32_t>({0, 1, 2}, "SCALAR", 5125));
  glb.json["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] = normals;
  glb.json["nodes"] = {{{"mesh", 0}}};
  const Scene scene = imported(glb);
  ASSERT_EQ(scene.meshes.size(), 1U);
  EXPECT_EQ(scene.meshes[0].normals[0], glm::vec3(0, -1, 0));
}

TEST(ImportGltf, quantised_positions_are_scaled_by_their_node) {
  GlbFixture glb;
  const size_t positions = glb.add_values<uint16_t>({0, 0, 0, 65535, 0, 0, 0, 65535, 0}, "VEC3", 5123, true);
  glb.add_mesh(positions, glb.add_values<uint16_t>({0, 1, 2}, "SCALAR", 5123));
  glb.json["nodes"] = {{{"mesh", 0}, {"scale", {4, 4, 4}}}};
  glb.json["extensionsRequired"] = {"KHR_mesh_quantization"};
  expect_box(imported(glb), {0, 0, 0}, {4, 0, 4});
}

TEST(ImportGltf, linear_vertex_colours_become_srgb) {
  GlbFixture glb = tetrahedron_glb();
  const size_t colors = glb.add_floats({0.5F, 0, 1, 0.5F, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1}, "VEC4");
  glb.json["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = colors;
  const Scene scene = imported(glb);
  ASSERT_EQ(scene.meshes.size(), 1U);
  EXPECT_EQ(scene.meshes[0].colors[0], glm::u8vec4(188, 0, 255, 128));
}

GlbFixture textured_triangle() {
  GlbFixture glb;
  const size_t positions = glb.add_floats({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3");
  const size_t texcoords = glb.add_floats({0.25F, 0.5F, 1, 0, 0, 1}, "VEC2");
  glb.add_mesh(positions, glb.add_values<uint16_t>({0, 1, 2}, "SCALAR", 5123));
  glb.json["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"] = texcoords;
  glb.json["meshes"][0]["primitives"][0]["material"] = 0;
  const std::array<uint8_t, 4> picture{1, 2, 3, 4};
  glb.json["images"] = {{{"bufferView", glb.add_view(std::as_bytes(std::span(picture)))}, {"mimeType", "image/png"}}};
  glb.json["samplers"] = {{{"wrapS", 33071}, {"wrapT", 33648}}};
  glb.json["textures"] = {{{"source", 0}, {"sampler", 0}}};
  glb.json["materials"] = {
      {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}, {"baseColorFactor", {0.5, 1, 0, 1}}}},
       {"doubleSided", true},
       {"alphaMode", "MASK"},
       {"alphaCutoff", 0.25}}};
  glb.json["nodes"] = {{{"mesh", 0}}};
  return glb;
}

TEST(ImportGltf, material_texture_and_sampler_are_kept) {
  const Scene scene = imported(textured_triangle());
  ASSERT_EQ(scene.textures.size(), 1U);
  EXPECT_EQ(scene.textures[0].encoded.size(), 4U);
  const Material& material = scene.materials[scene.meshes[0].material_of(0)];
  EXPECT_EQ(material, (Material{{188, 255, 0, 255}, 0, Wrap::clamp, Wrap::mirror, AlphaMode::mask, 64, true}));
  EXPECT_EQ(scene.meshes[0].texcoords[0], glm::vec2(0.25F, 0.5F));
}

TEST(ImportGltf, texture_transform_is_baked_into_the_coordinates) {
  GlbFixture glb = textured_triangle();
  glb.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["extensions"]["KHR_texture_transform"] = {
      {"offset", {10, 20}}, {"scale", {2, 4}}, {"rotation", std::acos(-1.0) / 2}};
  const Scene scene = imported(glb);
  // Scaled to (0.5, 2), turned to (2, -0.5), moved to (12, 19.5).
  EXPECT_NEAR(scene.meshes[0].texcoords[0].x, 12, 1e-5);
  EXPECT_NEAR(scene.meshes[0].texcoords[0].y, 19.5, 1e-5);
}

TEST(ImportGltf, second_set_of_coordinates_is_used_where_the_material_asks) {
  GlbFixture glb = textured_triangle();
  glb.json["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_1"] = glb.add_floats({7, 8, 0, 0, 0, 0}, "VEC2");
  glb.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["texCoord"] = 1;
  EXPECT_EQ(imported(glb).meshes[0].texcoords[0], glm::vec2(7, 8));
}

TEST(ImportGltf, primitives_with_several_materials_make_one_mesh) {
  GlbFixture glb = textured_triangle();
  json second = glb.json["meshes"][0]["primitives"][0];
  second.erase("material");
  second["attributes"].erase("TEXCOORD_0");
  glb.json["meshes"][0]["primitives"].push_back(second);
  const Scene scene = imported(glb);
  ASSERT_EQ(scene.meshes.size(), 1U);
  EXPECT_EQ(scene.meshes[0].materials, (std::vector<uint32_t>{0, 1}));
  EXPECT_EQ(scene.meshes[0].texcoords.size(), 6U);
  EXPECT_EQ(scene.materials[1], Material{});
}

TEST(ImportGltf, absent_texture_is_named_and_drawn_plain) {
  GlbFixture glb = textured_triangle();
  glb.json["images"] = {{{"uri", "facade.png"}}};
  glb.json["materials"][0]["pbrMetallicRoughness"].erase("baseColorFactor");
  const Scene scene = imported(glb);
  EXPECT_EQ(scene.report.counts.at("textures_missing"), 1U);
  ASSERT_EQ(scene.report.warnings.size(), 1U);
  EXPECT_EQ(scene.report.warnings[0], "missing texture facade.png");
  EXPECT_EQ(scene.materials[0].texture, kNoTexture);
  EXPECT_NE(glm::u8vec3(scene.materials[0].color), glm::u8vec3(255));
}

TEST(ImportGltf, specular_glossiness_gives_the_colour_where_nothing_else_does) {
  GlbFixture glb = textured_triangle();
  glb.json["materials"] = {
      {{"extensions", {{"KHR_materials_pbrSpecularGlossiness", {{"diffuseFactor", {0, 0.5, 0, 1}}}}}}}};
  EXPECT_EQ(imported(glb).materials[0].color, glm::u8vec4(0, 188, 0, 255));
}

TEST(ImportGltf, buffer_in_a_file_beside_the_source_is_read) {
  const TemporaryFolder folder;
  const GlbFixture glb = tetrahedron_glb();
  folder.write("deep/a b.bin", glb.binary());
  const Result<Scene> scene = import_file(folder.write("t.gltf", glb.gltf("deep/a%20b.bin")));
  ASSERT_TRUE(scene.ok()) << scene.error().message;
  EXPECT_EQ(scene->report.counts.at("triangles"), 4U);
}

TEST(ImportGltf, buffer_in_a_data_uri_is_read) {
  GlbFixture glb;
  glb.json["meshes"] = json::array();
  const Scene empty = imported("t.gltf", glb.gltf("data:application/octet-stream;base64,AAAA"));
  EXPECT_TRUE(empty.instances.empty());
  // Three positions (0,0,0) (1,0,0) (0,1,0) as floats.
  GlbFixture triangle;
  triangle.add_floats({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3");
  triangle.json["meshes"] = {{{"primitives", {{{"attributes", {{"POSITION", 0}}}}}}}};
  triangle.json["nodes"] = {{{"mesh", 0}}};
  const Scene scene = imported(
      "t.gltf", triangle.gltf("data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"));
  EXPECT_EQ(scene.report.counts.at("triangles"), 1U);
}

TEST(ImportGltf, references_that_leave_the_folder_are_refused) {
  const TemporaryFolder folder;
  const GlbFixture glb = tetrahedron_glb();
  folder.write("outside.bin", glb.binary());
  const std::filesystem::path absolute = folder.path() / "outside.bin";
  std::filesystem::create_directories(folder.path() / "in");
  std::filesystem::create_symlink(absolute, folder.path() / "in" / "link.bin");
  for (const std::string& uri : {std::string("../outside.bin"), std::string("x/../../outside.bin"),
                                 std::string("%2e%2e/outside.bin"), absolute.string(), "file://" + absolute.string(),
                                 std::string("http://example.org/outside.bin"), std::string("link.bin")}) {
    const Result<Scene> scene = import_file(folder.write("in/t.gltf", glb.gltf(uri)));
    ASSERT_FALSE(scene.ok()) << uri;
    EXPECT_NE(scene.error().message.find("t.gltf: buffer 0"), std::string::npos) << scene.error().message;
  }
}

TEST(ImportGltf, primitives_read_only_the_slice_of_a_shared_buffer_that_they_use) {
  GlbFixture glb;
  std::vector<float> many;
  for (int i = 0; i < 300; ++i) many.insert(many.end(), {float(i), float(i % 2), 0});
  const size_t positions = glb.add_floats(many, "VEC3");
  glb.add_mesh(positions, glb.add_values<uint16_t>({200, 201, 202}, "SCALAR", 5123));
  glb.json["nodes"] = {{{"mesh", 0}}};
  const Scene scene = imported(glb);
  ASSERT_EQ(scene.meshes.size(), 1U);
  EXPECT_EQ(scene.meshes[0].vertex_count(), 3U);
  expect_box(scene, {200, 0, 0}, {202, 0, 1});
}

TEST(ImportGltf, wild_indices_cost_their_triangle_only) {
  GlbFixture glb;
  const size_t positions = glb.add_floats({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3");
  glb.add_mesh(positions, glb.add_values<uint16_t>({0, 1, 2, 0, 1, 9}, "SCALAR", 5123));
  glb.json["nodes"] = {{{"mesh", 0}}};
  const Scene scene = imported(glb);
  EXPECT_EQ(scene.report.counts.at("triangles"), 1U);
  EXPECT_EQ(scene.report.counts.at("faces_dropped"), 1U);
}

TEST(ImportGltf, cycles_and_second_parents_end) {
  GlbFixture glb = tetrahedron_glb();
  glb.json["nodes"] = {{{"mesh", 0}, {"children", {1, 1}}}, {{"children", {0}}}};
  const Scene scene = imported(glb);
  EXPECT_EQ(scene.instances.size(), 1U);
  EXPECT_EQ(scene.report.counts.at("nodes_skipped"), 2U);
}

/// Moves the fixture's first accessors' data into compressed views.
void compress(GlbFixture& glb, size_t accessor, size_t count, size_t stride, const std::vector<unsigned char>& packed,
              const char* mode, const char* filter = nullptr) {
  const size_t view = glb.add_view(std::as_bytes(std::span(packed)));
  json& declared = glb.json["bufferViews"][view];
  const json stored = declared;
  declared["extensions"]["EXT_meshopt_compression"] = {{"buffer", 0},
                                                       {"byteOffset", stored["byteOffset"]},
                                                       {"byteLength", packed.size()},
                                                       {"byteStride", stride},
                                                       {"mode", mode},
                                                       {"count", count}};
  if (filter != nullptr) declared["extensions"]["EXT_meshopt_compression"]["filter"] = filter;
  declared["byteLength"] = count * stride;
  glb.json["accessors"][accessor]["bufferView"] = view;
}

TEST(ImportGltf, meshopt_compressed_positions_and_indices_are_the_same) {
  GlbFixture glb = tetrahedron_glb();
  const std::vector<float> positions{0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
  const std::vector<uint32_t> indices{0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3};
  std::vector<unsigned char> packed(meshopt_encodeVertexBufferBound(4, 12));
  packed.resize(meshopt_encodeVertexBuffer(packed.data(), packed.size(), positions.data(), 4, 12));
  compress(glb, 0, 4, 12, packed, "ATTRIBUTES");
  packed.resize(meshopt_encodeIndexBufferBound(12, 4));
  packed.resize(meshopt_encodeIndexBuffer(packed.data(), packed.size(), indices.data(), 12));
  compress(glb, 1, 12, 2, packed, "TRIANGLES");
  const Scene scene = imported(glb);
  EXPECT_EQ(scene.report.counts.at("triangles"), 4U);
  expect_box(scene, {0, -1, 0}, {1, 0, 1});
}

TEST(ImportGltf, meshopt_exponential_filter_and_index_sequences_decode) {
  GlbFixture glb = tetrahedron_glb();
  const std::vector<float> positions{0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
  std::vector<uint32_t> filtered(12);
  meshopt_encodeFilterExp(filtered.data(), 4, 12, 20, positions.data());
  std::vector<unsigned char> packed(meshopt_encodeVertexBufferBound(4, 12));
  packed.resize(meshopt_encodeVertexBuffer(packed.data(), packed.size(), filtered.data(), 4, 12));
  compress(glb, 0, 4, 12, packed, "ATTRIBUTES", "EXPONENTIAL");
  const std::vector<uint32_t> indices{0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3};
  packed.resize(meshopt_encodeIndexSequenceBound(12, 4));
  packed.resize(meshopt_encodeIndexSequence(packed.data(), packed.size(), indices.data(), 12));
  compress(glb, 1, 12, 2, packed, "INDICES");
  expect_box(imported(glb), {0, -1, 0}, {1, 0, 1}, 1e-4);
}

TEST(ImportGltf, meshopt_octahedral_normals_decode_to_unit_vectors) {
  GlbFixture glb = tetrahedron_glb();
  const std::vector<float> normals{0, 0, 1, 0, 1, 0, 0, 0, 0, 0, -1, 0, 1, 0, 0, 0};
  std::vector<int8_t> filtered(16);
  meshopt_encodeFilterOct(filtered.data(), 4, 4, 8, normals.data());
  std::vector<unsigned char> packed(meshopt_encodeVertexBufferBound(4, 4));
  packed.resize(meshopt_encodeVertexBuffer(packed.data(), packed.size(), filtered.data(), 4, 4));
  const size_t accessor = glb.add_accessor(0, 4, "VEC3", 5120, true);
  compress(glb, accessor, 4, 4, packed, "ATTRIBUTES", "OCTAHEDRAL");
  glb.json["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] = accessor;
  const Scene scene = imported(glb);
  ASSERT_EQ(scene.meshes.size(), 1U);
  ASSERT_EQ(scene.meshes[0].normals.size(), 4U);
  const glm::vec3 expected(0, -1, 0);  // the file's +z
  size_t found = 0;
  for (const glm::vec3& n : scene.meshes[0].normals) {
    EXPECT_NEAR(glm::length(n), 1, 1e-5);
    if (glm::distance(n, expected) < 0.02F) ++found;
  }
  EXPECT_EQ(found, 1U);
}

TEST(ImportGltf, draco_compressed_tetrahedron_is_whole) {
  draco::TriangleSoupMeshBuilder builder;
  builder.Start(4);
  const int position = builder.AddAttribute(draco::GeometryAttribute::POSITION, 3, draco::DT_FLOAT32);
  const std::array<std::array<float, 3>, 4> p{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  const std::array<std::array<size_t, 3>, 4> faces{{{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}};
  for (uint32_t f = 0; f < 4; ++f)
    builder.SetAttributeValuesForFace(position, draco::FaceIndex(f), p[faces[f][0]].data(), p[faces[f][1]].data(),
                                      p[faces[f][2]].data());
  const std::unique_ptr<draco::Mesh> mesh = builder.Finalize();
  draco::Encoder encoder;
  draco::EncoderBuffer buffer;
  ASSERT_TRUE(encoder.EncodeMeshToBuffer(*mesh, &buffer).ok());

  GlbFixture glb;
  const size_t view = glb.add_view(std::as_bytes(std::span(buffer.data(), buffer.size())));
  glb.json["accessors"] = {{{"count", 4}, {"type", "VEC3"}, {"componentType", 5126}},
                           {{"count", 12}, {"type", "SCALAR"}, {"componentType", 5123}}};
  glb.add_mesh(0, 1);
  glb.json["meshes"][0]["primitives"][0]["extensions"]["KHR_draco_mesh_compression"] = {
      {"bufferView", view}, {"attributes", {{"POSITION", 0}}}};
  glb.json["nodes"] = {{{"mesh", 0}}};
  glb.json["extensionsRequired"] = {"KHR_draco_mesh_compression"};
  const Scene scene = imported(glb);
  EXPECT_EQ(scene.report.counts.at("triangles"), 4U);
  expect_box(scene, {0, -1, 0}, {1, 0, 1}, 1e-3);
}

TEST(ImportGltf, unknown_required_extension_is_refused_by_name) {
  GlbFixture glb = tetrahedron_glb();
  glb.json["extensionsRequired"] = {"ACME_splats"};
  const Result<Scene> scene = import_bytes("t.glb", glb.bytes());
  ASSERT_FALSE(scene.ok());
  EXPECT_NE(scene.error().message.find("ACME_splats"), std::string::npos);
}

TEST(ImportGltf, claims_larger_than_the_file_are_refused) {
  const uint64_t huge = std::numeric_limits<uint64_t>::max();
  const auto refused = [](const GlbFixture& glb) {
    const Result<Scene> scene = import_bytes("t.glb", glb.bytes());
    EXPECT_FALSE(scene.ok());
    return scene.ok() ? std::string() : scene.error().message;
  };
  for (const uint64_t count : {huge, huge / 12, huge / 12 + 1, uint64_t(5), uint64_t(1) << 40}) {
    GlbFixture glb = tetrahedron_glb();
    glb.json["accessors"][0]["count"] = count;
    EXPECT_NE(refused(glb).find("accessor 0"), std::string::npos);
  }
  GlbFixture offset = tetrahedron_glb();
  offset.json["accessors"][0]["byteOffset"] = huge - 3;
  EXPECT_NE(refused(offset).find("accessor 0"), std::string::npos);
  GlbFixture view = tetrahedron_glb();
  view.json["bufferViews"][0]["byteOffset"] = huge - 10;
  EXPECT_NE(refused(view).find("bufferView 0"), std::string::npos);
  GlbFixture zeros = tetrahedron_glb();
  zeros.json["accessors"][0].erase("bufferView");
  zeros.json["accessors"][0]["count"] = uint64_t(1) << 33;
  EXPECT_NE(refused(zeros).find("accessor 0"), std::string::npos);
}

TEST(ImportGltf, deep_json_is_refused) {
  const std::string bomb = "{\"asset\":{\"version\":\"2.0\"},\"extras\":" + std::string(100000, '[');
  const Result<Scene> scene = import_bytes("t.gltf", bomb);
  ASSERT_FALSE(scene.ok());
  EXPECT_NE(scene.error().message.find("nested"), std::string::npos);
}

TEST(ImportGltf, nan_vertices_go_with_their_faces_and_are_counted) {
  GlbFixture glb;
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const size_t positions = glb.add_floats({0, 0, 0, 1, 0, 0, 0, 1, 0, nan, 0, 0}, "VEC3");
  glb.add_mesh(positions, glb.add_values<uint16_t>({0, 1, 2, 1, 2, 3}, "SCALAR", 5123));
  glb.json["nodes"] = {{{"mesh", 0}}};
  const Scene scene = imported(glb);
  EXPECT_EQ(scene.report.counts.at("vertices_non_finite"), 1U);
  EXPECT_EQ(scene.report.counts.at("faces_dropped"), 1U);
  EXPECT_EQ(scene.report.counts.at("triangles"), 1U);
}

TEST(ImportGltf, billion_metre_vertex_goes_with_its_face) {
  GlbFixture glb;
  const size_t positions = glb.add_floats({0, 0, 0, 1, 0, 0, 0, 1, 0, 1e9F, 0, 0}, "VEC3");
  glb.add_mesh(positions, glb.add_values<uint16_t>({0, 1, 2, 1, 2, 3}, "SCALAR", 5123));
  glb.json["nodes"] = {{{"mesh", 0}}};
  const Scene scene = imported(glb);
  EXPECT_EQ(scene.report.counts.at("vertices_out_of_range"), 1U);
  EXPECT_EQ(scene.report.counts.at("triangles"), 1U);
}

TEST(ImportGltf, instance_at_infinity_is_dropped_and_the_rest_stays) {
  GlbFixture glb = tetrahedron_glb();
  glb.json["scenes"] = {{{"nodes", {0, 1, 2}}}};
  glb.json["nodes"] = {
      {{"mesh", 0}}, {{"mesh", 0}, {"translation", {2, 0, 0}}}, {{"mesh", 0}, {"translation", {1e30, 0, 0}}}};
  const Scene scene = imported(glb);
  EXPECT_EQ(scene.instances.size(), 2U);
  EXPECT_EQ(scene.report.counts.at("instances_dropped"), 1U);
}

TEST(ImportGltf, empty_scene_is_no_error) {
  GlbFixture glb;
  glb.json["nodes"] = {{{"name", "nothing"}}};
  EXPECT_TRUE(imported(glb).meshes.empty());
}

}  // namespace
}  // namespace promenade
