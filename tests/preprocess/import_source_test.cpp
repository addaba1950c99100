// Which files make a source, and what is said when there are none.

#include <gtest/gtest.h>

#include "tests/preprocess/import_fixtures.h"

namespace promenade {
namespace {

Result<std::vector<SourcePart>> list(const std::vector<std::filesystem::path>& paths) { return list_source(paths); }

TEST(ListSource, folder_of_tiles_comes_sorted_and_without_its_paths) {
  const TemporaryFolder folder;
  folder.write("city/tile_1.glb", "x");
  folder.write("city/tile_0.glb", "x");
  folder.write("city/city_walk.json", R"({"fps": 30, "keys": []})");
  folder.write("city/textures/wall.png", "x");
  folder.write("city/deep/part.OBJ", "xyz");
  folder.write("city/town.city.json", R"({"type":"CityJSON","version":"2.0"})");
  const auto parts = list({folder.path() / "city"});
  ASSERT_TRUE(parts.ok()) << parts.error().message;
  std::vector<std::string> names;
  for (const SourcePart& part : *parts) names.push_back(part.name);
  EXPECT_EQ(names, (std::vector<std::string>{"deep/part.OBJ", "tile_0.glb", "tile_1.glb", "town.city.json"}));
  EXPECT_EQ((*parts)[0].bytes, 3U);
}

TEST(ListSource, files_keep_the_order_given) {
  const TemporaryFolder folder;
  const auto parts = list({folder.write("b.glb", "x"), folder.write("a.ply", "x")});
  ASSERT_TRUE(parts.ok());
  EXPECT_EQ((*parts)[0].name, "b.glb");
  EXPECT_EQ((*parts)[1].name, "a.ply");
}

TEST(ListSource, what_is_no_source_is_an_error_that_names_it) {
  const TemporaryFolder folder;
  const auto message = [](const std::vector<std::filesystem::path>& paths) {
    const auto parts = list(paths);
    return parts.ok() ? std::string() : parts.error().message;
  };
  EXPECT_NE(message({folder.path() / "absent.glb"}).find("absent.glb"), std::string::npos);
  EXPECT_NE(message({folder.write("a.xyz", "x")}).find("known formats: glb"), std::string::npos);
  EXPECT_NE(message({folder.write("path.json", "{}")}).find("no CityJSON"), std::string::npos);
  EXPECT_NE(message({folder.path()}).find("no model file"), std::string::npos);
  EXPECT_FALSE(list({}).ok());
}

TEST(ImportPart, absent_and_empty_files_are_errors_that_name_them) {
  const TemporaryFolder folder;
  for (const char* extension : {"glb", "gltf", "obj", "ply", "json", "jsonl", "stl", "ifc", "dae"}) {
    const std::string name = std::string("nothing.") + extension;
    const Result<Scene> absent = import_file(folder.path() / name);
    ASSERT_FALSE(absent.ok()) << name;
    EXPECT_NE(absent.error().message.find(name), std::string::npos) << absent.error().message;
    const Result<Scene> empty = import_file(folder.write(name, ""));
    ASSERT_FALSE(empty.ok()) << name;
    EXPECT_NE(empty.error().message.find(name), std::string::npos) << empty.error().message;
  }
}

TEST(ImportPart, cancelled_import_says_interrupted) {
  class Cancelled : public JobMonitor {
    bool cancelled() const override { return true; }
  } monitor;
  const TemporaryFolder folder;
  const std::filesystem::path path = folder.write("t.glb", tetrahedron_glb().bytes());
  const Result<Scene> scene = import_part({path, "t.glb", 0}, {}, monitor);
  ASSERT_FALSE(scene.ok());
  EXPECT_EQ(scene.error().message, "interrupted");
}

}  // namespace
}  // namespace promenade
