// Broken files of every format give an error of one line or a sound scene, and never anything else. The corpus is small
// files of each format; each is cut off everywhere and has bytes changed at random (seeded).

#include <gtest/gtest.h>

#include <random>

#include "tests/preprocess/import_corpus.h"
#include "tests/preprocess/import_fixtures.h"

namespace promenade {
namespace {

class HostileFile : public testing::TestWithParam<CorpusFile> {
 protected:
  void expect_error_or_sound_scene(std::string_view bytes, const std::string& what) const {
    const Result<Scene> scene = import_file(folder_.write(GetParam().name, bytes));
    if (scene.ok()) {
      EXPECT_EQ(find_scene_defect(*scene), "") << what;
      return;
    }
    EXPECT_FALSE(scene.error().message.empty()) << what;
    EXPECT_EQ(scene.error().message.find('\n'), std::string::npos) << what;
  }

 private:
  TemporaryFolder folder_;
};

TEST_P(HostileFile, whole_file_is_read) {
  const Result<Scene> scene = import_bytes(GetParam().name, GetParam().bytes);
  ASSERT_TRUE(scene.ok()) << scene.error().message;
  EXPECT_GT(scene->report.counts.at("triangles"), 0U);
}

TEST_P(HostileFile, every_truncation_is_an_error_or_a_sound_scene) {
  const CorpusFile& file = GetParam();
  for (size_t size = 0; size < file.bytes.size(); size += file.cheap ? 1 : file.bytes.size() / 20 + 1)
    expect_error_or_sound_scene(std::string_view(file.bytes).substr(0, size), "cut at " + std::to_string(size));
}

TEST_P(HostileFile, random_mutations_are_errors_or_sound_scenes) {
  const CorpusFile& file = GetParam();
  std::mt19937 random(2003);
  const int rounds = file.cheap ? 400 : 20;
  for (int round = 0; round < rounds; ++round)
    expect_error_or_sound_scene(mutated(file.bytes, random), "mutation " + std::to_string(round));
}

INSTANTIATE_TEST_SUITE_P(Import, HostileFile, testing::ValuesIn(import_corpus()), [](const auto& tested) {
  std::string name = tested.param.name;
  for (char& c : name)
    if (c == '.') c = '_';
  return name;
});

}  // namespace
}  // namespace promenade
