// The rooms and the arrows between them: a room may include itself and the rooms below it, nothing else.

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <string>

namespace {

namespace fs = std::filesystem;
using Arrows = std::map<std::string, std::set<std::string>>;

const Arrows& allowed_arrows() {
  static const Arrows arrows = {
      {"geometry", {}},
      {"codec", {"geometry"}},
      {"raster", {"geometry"}},
      {"layout", {"geometry", "codec"}},
      {"datasets", {"geometry", "codec", "layout"}},
      {"preprocess", {"geometry", "codec", "raster", "layout"}},
      {"runtime", {"geometry", "codec", "raster", "layout"}},
      {"cli", {"geometry", "codec", "raster", "layout", "datasets", "preprocess", "runtime"}},
  };
  return arrows;
}

/// Rooms that a file's includes name, by their folders.
std::set<std::string> rooms_included(const fs::path& file) {
  static const std::regex include(R"(^\s*#\s*include\s*\"([a-z_]+)/)");
  std::ifstream in(file);
  std::set<std::string> rooms;
  std::smatch match;
  for (std::string line; std::getline(in, line);)
    if (std::regex_search(line, match, include)) rooms.insert(match[1]);
  return rooms;
}

class EveryRoom : public testing::TestWithParam<Arrows::value_type> {};

TEST_P(EveryRoom, includes_only_the_rooms_below_it) {
  const auto& [room, allowed] = GetParam();
  size_t files = 0;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(fs::path(PROMENADE_SOURCE_DIR) / room)) {
    if (entry.path().extension() != ".h" && entry.path().extension() != ".cpp") continue;
    ++files;
    for (const std::string& included : rooms_included(entry.path()))
      EXPECT_TRUE(included == room || allowed.contains(included)) << entry.path() << " includes " << included << "/";
  }
  EXPECT_GT(files, 0U) << "no sources in " << room << "/: is the scan looking in the right place?";
}

INSTANTIATE_TEST_SUITE_P(House, EveryRoom, testing::ValuesIn(allowed_arrows()),
                         [](const auto& param_info) { return param_info.param.first; });

TEST(IncludeScan, sees_an_include_with_a_room_and_not_a_library) {
  const fs::path file = fs::path(testing::TempDir()) / "include_scan_fixture.h";
  std::ofstream(file)
      << "#include <codec/x.h>\n  # include \"layout/model.h\"\n// nothing\n#include \"geometry/box.h\"\n";
  EXPECT_EQ(rooms_included(file), (std::set<std::string>{"layout", "geometry"}));
}

}  // namespace
