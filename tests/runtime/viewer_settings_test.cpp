#include "runtime/viewer_settings.h"

#include <gtest/gtest.h>

#include "layout/file_io.h"
#include "tests/temporary_folder.h"

namespace promenade {
namespace {

TEST(ViewerSettings, are_read_as_they_were_written_model_by_model) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder / "deep" / "viewer.json";
  ViewerSettings city;
  city.speed_m_per_s = 2.5, city.on_foot = true, city.policy = "vlod";
  city.bookmarks[3] = {{1, 2, 3}, 40, 5, -6};
  ASSERT_TRUE(write_viewer_settings(city, file, "/models/city.prom"));
  ViewerSettings house;
  house.bookmarks[1] = {{7, 8, 9}, 0, 0, 0};
  ASSERT_TRUE(write_viewer_settings(house, file, "/models/house.prom"));

  const ViewerSettings read = read_viewer_settings(file, "/models/city.prom");
  EXPECT_EQ(read.speed_m_per_s, 2.5) << "what a later visit does not say stays";
  EXPECT_EQ(read.on_foot, true);
  EXPECT_EQ(read.policy, "vlod");
  EXPECT_FALSE(read.panel);
  ASSERT_EQ(read.bookmarks.size(), 1U);
  EXPECT_EQ(read.bookmarks.at(3).eye, glm::dvec3(1, 2, 3));
  EXPECT_EQ(read.bookmarks.at(3).roll_deg, -6);
  EXPECT_EQ(read_viewer_settings(file, "/models/house.prom").bookmarks.count(1), 1U);
}

TEST(ViewerSettings, that_are_broken_count_as_none) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder / "viewer.json";
  for (const char* text : {"", "{", "[]", "{\"bookmarks\": 3, \"speed_m_per_s\": \"fast\", \"pixel_error\": -1}",
                           "{\"bookmarks\": {\"/m\": {\"1\": [1, 2], \"2\": [1, 2, 3, 4, 5, \"x\"], \"77\": []}}}"}) {
    ASSERT_TRUE(write_file(file, std::string_view(text)));
    const ViewerSettings read = read_viewer_settings(file, "/m");
    EXPECT_TRUE(read.bookmarks.empty()) << text;
    EXPECT_FALSE(read.speed_m_per_s || read.pixel_error) << text;
    ASSERT_TRUE(write_viewer_settings(read, file, "/m")) << text;
  }
  EXPECT_TRUE(read_viewer_settings(folder / "none.json", "/m").bookmarks.empty());
  EXPECT_TRUE(read_viewer_settings({}, "/m").bookmarks.empty());
}

}  // namespace
}  // namespace promenade
