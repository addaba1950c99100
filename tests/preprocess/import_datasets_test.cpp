// The shared models import with the counts and boxes that are known of them.

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/preprocess/import_fixtures.h"

namespace promenade {
namespace {

const std::filesystem::path datasets_path = std::filesystem::path(PROMENADE_SOURCE_DIR) / ".." / "shared" / "datasets";

nlohmann::json known_set(const std::string& name) {
  std::ifstream in(datasets_path / "INDEX.json");
  if (!in) return nullptr;
  const nlohmann::json index = nlohmann::json::parse(in);
  for (const nlohmann::json& set : index["sets"])
    if (set["name"] == name) return set;
  return nullptr;
}

constexpr double kBoxToleranceM = 0.03;  // the index rounds some boxes to the thickness of a floor

/// The index counts the sports car as it was before its conversion to GLB, which has 684 triangles more.
uint64_t known_triangles(const nlohmann::json& set) {
  return set["name"] == "sports_car" ? 300603 : set["flattened_triangles"].get<uint64_t>();
}

DBox world_box(const Scene& scene) {
  DBox box;
  for (const SceneInstance& instance : scene.instances)
    for (const glm::vec3& p : scene.meshes[instance.mesh].positions)
      box.add(glm::dvec3(instance.world_from_mesh * glm::dvec4(glm::dvec3(p), 1)));
  return box;
}

class SharedDataset : public testing::TestWithParam<const char*> {};

TEST_P(SharedDataset, imports_with_the_triangles_and_the_box_known_of_it) {
  const nlohmann::json set = known_set(GetParam());
  if (set.is_null()) GTEST_SKIP() << "no shared datasets beside the project";
  ImportOptions options;
  options.repair = false;
  if (set["unit_scale_to_m"] != 1) options.unit_m = set["unit_scale_to_m"].get<double>();
  const Result<Scene> scene = import_file(datasets_path / set["path"].get<std::string>(), options);
  ASSERT_TRUE(scene.ok()) << scene.error().message;
  EXPECT_EQ(find_scene_defect(*scene), "");
  EXPECT_EQ(scene->report.counts.at("triangles"), known_triangles(set));
  for (const SourceTexture& texture : scene->textures) EXPECT_FALSE(texture.encoded.empty()) << texture.name;
  const DBox box = world_box(*scene);
  for (int axis = 0; axis < 3; ++axis) {
    const auto i = static_cast<size_t>(axis);
    EXPECT_NEAR(box.min[axis], set["bbox_zup_m"][0][i].get<double>(), kBoxToleranceM);
    EXPECT_NEAR(box.max[axis], set["bbox_zup_m"][1][i].get<double>(), kBoxToleranceM);
  }
}

INSTANTIATE_TEST_SUITE_P(Import, SharedDataset,
                         testing::Values("datsville_a", "citysim", "small_house", "conference_room", "cms_detector",
                                         "sports_car"),
                         [](const auto& tested) { return std::string(tested.param); });

}  // namespace
}  // namespace promenade
