// CityJSON and CityJSONSeq: one situation a test.

#include <gtest/gtest.h>

#include <glm/geometric.hpp>

#include "tests/preprocess/import_fixtures.h"

namespace promenade {
namespace {

using nlohmann::json;

Scene imported(const std::string& name, const std::string& bytes) {
  Result<Scene> scene = import_bytes(name, bytes);
  if (!scene.ok()) {
    ADD_FAILURE() << scene.error().message;
    return {};
  }
  EXPECT_EQ(find_scene_defect(*scene), "");
  return *std::move(scene);
}

Scene imported(const json& document) { return imported("t.city.json", document.dump()); }

uint64_t count(const Scene& scene, const std::string& key) {
  const auto found = scene.report.counts.find(key);
  return found == scene.report.counts.end() ? 0 : found->second;
}

Box world_box(const Scene& scene, const glm::dvec3& origin = {}) {
  Box box;
  for (const SceneInstance& instance : scene.instances) box.add(bounds(flattened(scene, instance, origin)));
  return box;
}

json document() {
  return {{"type", "CityJSON"},
          {"version", "2.0"},
          {"transform", {{"scale", {0.001, 0.001, 0.001}}, {"translate", {500000.0, 5800000.0, 10.0}}}},
          {"CityObjects", json::object()},
          {"vertices", json::array()}};
}

/// The boundaries of a box as a solid's shell, its vertices added in millimetres.
json box_shell(json& vertices, int x, int y, int z, int size) {
  const size_t base = vertices.size();
  for (int i = 0; i < 8; ++i)
    vertices.push_back({x + (i & 1) * size, y + ((i >> 1) & 1) * size, z + ((i >> 2) & 1) * size});
  json shell = json::array();
  for (const std::vector<size_t>& face : std::vector<std::vector<size_t>>{
           {0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}) {
    json ring = json::array();
    for (const size_t v : face) ring.push_back(base + v);
    shell.push_back({ring});
  }
  return shell;
}

json solid_building(json& vertices, const char* lod = "2") {
  return {{"type", "Building"},
          {"geometry", {{{"type", "Solid"}, {"lod", lod}, {"boundaries", {box_shell(vertices, 0, 0, 0, 10000)}}}}}};
}

TEST(ImportCityJson, building_is_named_classed_and_keeps_its_millimetres) {
  json city = document();
  city["CityObjects"]["house-1"] = solid_building(city["vertices"]);
  city["vertices"][0][0] = -1;  // one millimetre out
  const Scene scene = imported(city);
  ASSERT_EQ(scene.instances.size(), 1U);
  EXPECT_TRUE(scene.instances[0].is_solid);
  EXPECT_EQ(scene.instances[0].name, "house-1");
  EXPECT_EQ(scene.instances[0].class_name, "Building");
  EXPECT_EQ(count(scene, "triangles"), 12U);
  const Box box = world_box(scene, {500000, 5800000, 0});
  EXPECT_NEAR(box.min.x, -0.001, 1e-4);
  EXPECT_NEAR(box.max.x, 10, 1e-4);
  EXPECT_NEAR(box.min.z, 10, 1e-4);
  EXPECT_FALSE(scene.materials[0].two_sided);
}

TEST(ImportCityJson, cityjson_building_with_courtyard_has_a_hole_in_its_roof) {
  json city = document();
  city["vertices"] = {{0, 0, 0},       {9000, 0, 0},    {9000, 9000, 0}, {0, 9000, 0},
                      {3000, 3000, 0}, {3000, 6000, 0}, {6000, 6000, 0}, {6000, 3000, 0}};
  city["CityObjects"]["b"] = {
      {"type", "Building"},
      {"geometry", {{{"type", "MultiSurface"}, {"lod", "2"}, {"boundaries", {{{0, 1, 2, 3}, {4, 5, 6, 7}}}}}}}};
  const Scene scene = imported(city);
  ASSERT_EQ(scene.meshes.size(), 1U);
  EXPECT_NEAR(surface_area_m2(scene.meshes[0]), 81 - 9, 1e-3);
  EXPECT_EQ(scene.meshes[0].triangle_count(), 8U);
  for (size_t t = 0; t < 8; ++t) EXPECT_GT(triangle_cross(scene.meshes[0], t).z, 0);
  EXPECT_TRUE(scene.materials[0].two_sided);
  EXPECT_FALSE(scene.instances[0].is_solid);
}

TEST(ImportCityJson, highest_level_of_detail_wins) {
  json city = document();
  json building = solid_building(city["vertices"], "1");
  json finer = building["geometry"][0];
  finer["lod"] = "2.2";
  finer["boundaries"] = {box_shell(city["vertices"], 0, 0, 0, 5000)};
  building["geometry"].push_back(finer);
  city["CityObjects"]["b"] = building;
  const Scene scene = imported(city);
  EXPECT_EQ(count(scene, "triangles"), 12U);
  EXPECT_NEAR(world_box(scene).size().x, 5, 1e-3);
}

TEST(ImportCityJson, parts_in_more_detail_replace_their_buildings_block) {
  json city = document();
  city["CityObjects"]["b"] = solid_building(city["vertices"], "1");
  city["CityObjects"]["b"]["children"] = {"p"};
  city["CityObjects"]["p"] = solid_building(city["vertices"], "2");
  city["CityObjects"]["p"]["type"] = "BuildingPart";
  const Scene scene = imported(city);
  ASSERT_EQ(scene.instances.size(), 1U);
  EXPECT_EQ(scene.instances[0].name, "p");
}

TEST(ImportCityJson, template_is_one_mesh_with_instances) {
  json city = document();
  json vertices = json::array();
  const json shell = box_shell(vertices, 0, 0, 0, 1);
  city["geometry-templates"] = {{"templates", {{{"type", "Solid"}, {"lod", "2"}, {"boundaries", {shell}}}}},
                                {"vertices-templates", vertices}};
  city["vertices"] = {{0, 0, 0}, {20000, 0, 0}};
  for (int i = 0; i < 2; ++i)
    city["CityObjects"]["tree" + std::to_string(i)] = {
        {"type", "SolitaryVegetationObject"},
        {"geometry",
         {{{"type", "GeometryInstance"},
           {"template", 0},
           {"boundaries", {i}},
           {"transformationMatrix", {2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 5, 0, 0, 0, 1}}}}}};
  const Scene scene = imported(city);
  EXPECT_EQ(scene.meshes.size(), 1U);
  ASSERT_EQ(scene.instances.size(), 2U);
  const Box box = world_box(scene, {500000, 5800000, 10});
  EXPECT_NEAR(box.max.x, 22, 1e-4);
  EXPECT_NEAR(box.min.z, 5, 1e-4);
}

TEST(ImportCityJson, nested_solids_and_extensions_are_read) {
  json city = document();
  json solids = json::array();
  solids.push_back({box_shell(city["vertices"], 0, 0, 0, 1000)});
  solids.push_back({box_shell(city["vertices"], 5000, 0, 0, 1000)});
  city["extensions"]["Noise"] = {{"url", "https://example.org/noise.json"}};
  city["CityObjects"]["x"] = {{"type", "+NoiseBarrier"},
                              {"geometry", {{{"type", "MultiSolid"}, {"lod", 1}, {"boundaries", solids}}}},
                              {"+attribute", {{"a", 1}}}};
  const Scene scene = imported(city);
  EXPECT_EQ(count(scene, "triangles"), 24U);
  EXPECT_EQ(scene.instances[0].class_name, "+NoiseBarrier");
}

TEST(ImportCityJson, materials_and_textures_of_surfaces_are_kept) {
  const TemporaryFolder folder;
  folder.write("appearances/roof.jpg", "picture");
  json city = document();
  city["vertices"] = {{0, 0, 0}, {1000, 0, 0}, {0, 1000, 0}, {1000, 0, 1000}};
  city["appearance"] = {{"materials", {{{"name", "red"}, {"diffuseColor", {1.0, 0.0, 0.0}}, {"transparency", 0.5}}}},
                        {"textures", {{{"type", "JPG"}, {"image", "appearances/roof.jpg"}, {"wrapMode", "mirror"}}}},
                        {"vertices-texture", {{0.0, 0.25}, {1.0, 0.0}, {0.0, 1.0}}}};
  city["CityObjects"]["b"] = {{"type", "Building"},
                              {"geometry",
                               {{{"type", "MultiSurface"},
                                 {"lod", "2"},
                                 {"boundaries", {{{0, 1, 2}}, {{0, 1, 3}}}},
                                 {"material", {{"summer", {{"values", {nullptr, 0}}}}}},
                                 {"texture", {{"summer", {{"values", {{{0, 0, 1, 2}}, {{nullptr}}}}}}}}}}}};
  const Result<Scene> result = import_file(folder.write("t.json", city.dump()));
  ASSERT_TRUE(result.ok()) << result.error().message;
  const Scene& scene = *result;
  ASSERT_EQ(scene.meshes.size(), 1U);
  const Mesh& mesh = scene.meshes[0];
  const Material& textured = scene.materials[mesh.material_of(0)];
  ASSERT_NE(textured.texture, kNoTexture);
  EXPECT_EQ(textured.wrap_u, Wrap::mirror);
  EXPECT_EQ(scene.textures[textured.texture].encoded.size(), 7U);
  EXPECT_EQ(mesh.texcoords[mesh.indices[0]], glm::vec2(0, 0.75F));
  EXPECT_EQ(scene.materials[mesh.material_of(1)].color, glm::u8vec4(255, 0, 0, 128));
}

TEST(ImportCityJson, semantics_colour_what_has_no_appearance) {
  json city = document();
  city["CityObjects"]["b"] = solid_building(city["vertices"]);
  city["CityObjects"]["b"]["geometry"][0]["semantics"] = {
      {"surfaces", {{{"type", "RoofSurface"}}, {{"type", "WallSurface"}}}}, {"values", {{1, 0, 1, 1, 1, nullptr}}}};
  const Scene scene = imported(city);
  const Mesh& mesh = scene.meshes[0];
  EXPECT_NE(scene.materials[mesh.material_of(0)].color, scene.materials[mesh.material_of(2)].color);
  EXPECT_EQ(scene.materials.size(), 3U);
}

TEST(ImportCityJson, sequence_is_read_feature_by_feature) {
  json header = document();
  json lines = json::array();
  for (int i = 0; i < 3; ++i) {
    json feature = {{"type", "CityJSONFeature"}, {"id", "f"}, {"vertices", json::array()}};
    feature["CityObjects"]["house" + std::to_string(i)] = solid_building(feature["vertices"]);
    lines.push_back(feature);
  }
  std::string text = header.dump();
  for (const json& line : lines) text += "\n" + line.dump();
  const Scene scene = imported("t.city.jsonl", text + "\r\n\n");
  EXPECT_EQ(scene.instances.size(), 3U);
  EXPECT_EQ(count(scene, "triangles"), 36U);
  EXPECT_EQ(scene.materials.size(), 1U);
}

TEST(ImportCityJson, vertices_that_are_not_there_cost_their_face) {
  json city = document();
  city["CityObjects"]["b"] = solid_building(city["vertices"]);
  city["CityObjects"]["b"]["geometry"][0]["boundaries"][0][0][0][0] = 4096;
  city["CityObjects"]["b"]["geometry"][0]["boundaries"][0][1] = "surface";
  const Scene scene = imported(city);
  EXPECT_EQ(count(scene, "faces_dropped"), 2U);
  EXPECT_EQ(count(scene, "triangles"), 8U);
}

TEST(ImportCityJson, other_json_and_unknown_versions_are_refused) {
  EXPECT_FALSE(import_bytes("t.json", R"({"type": "FeatureCollection", "x": "CityJSON"})").ok());
  json city = document();
  city["version"] = "7.0";
  const Result<Scene> scene = import_bytes("t.json", city.dump());
  ASSERT_FALSE(scene.ok());
  EXPECT_NE(scene.error().message.find("7.0"), std::string::npos);
}

}  // namespace
}  // namespace promenade
