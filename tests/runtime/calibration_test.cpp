// The renderer's calibration: measured once, measured again when what is stored is not of this machine or not whole.

#include "runtime/calibration.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>

#include "layout/file_io.h"
#include "runtime/cpu_renderer.h"

namespace promenade {
namespace {

class CalibrationTest : public testing::Test {
 protected:
  void SetUp() override {
    std::string pattern = (std::filesystem::temp_directory_path() / "promenade_calibration_XXXXXX").string();
    folder_ = mkdtemp(pattern.data());
    file_ = folder_ / "promenade" / "renderer.json";
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  Result<Calibration> ask(const std::string& machine = "a machine") {
    return calibrated(file_, machine, [this]() -> Result<Calibration> {
      ++measured_;
      return Calibration{80, 10, "osmesa: \"llvmpipe\"\xff", false};
    });
  }

  std::filesystem::path folder_, file_;
  int measured_ = 0;
};

TEST_F(CalibrationTest, is_measured_once_and_read_from_then_on) {
  EXPECT_FALSE(ask()->stored);
  const Result<Calibration> again = ask();
  ASSERT_TRUE(again);
  EXPECT_TRUE(again->stored);
  EXPECT_EQ(again->gl_ms, 80);
  EXPECT_EQ(again->cpu_ms, 10);
  EXPECT_EQ(measured_, 1);
}

TEST_F(CalibrationTest, is_measured_again_on_another_machine) {
  ASSERT_TRUE(ask());
  EXPECT_FALSE(ask("another machine")->stored);
  EXPECT_EQ(measured_, 2);
}

TEST_F(CalibrationTest, is_measured_again_after_every_truncation_and_nonsense) {
  ASSERT_TRUE(ask());
  const std::string whole = *read_text_file(file_);
  std::vector<std::string> broken = {"[]", "null", "{\"format\": 1}", "{\"format\": {}, \"machine\": []}", "\xff\xfe"};
  for (size_t n = 0; n + 2 < whole.size(); n += 7) broken.push_back(whole.substr(0, n));
  std::string negative = whole;
  negative.replace(negative.find("80"), 2, "-8");
  broken.push_back(negative);
  for (const std::string& text : broken) {
    std::ofstream(file_, std::ios::binary) << text;
    const int before = measured_;
    ASSERT_TRUE(ask());
    EXPECT_EQ(measured_, before + 1) << text;
    EXPECT_EQ(*read_text_file(file_), whole) << "mended";
  }
}

TEST_F(CalibrationTest, does_without_a_place_to_store) {
  file_ = "/dev/null/promenade/renderer.json";
  EXPECT_TRUE(ask());
  file_.clear();
  EXPECT_TRUE(ask());
  EXPECT_EQ(measured_, 2);
}

TEST_F(CalibrationTest, a_failed_measurement_is_not_stored) {
  const auto failing = []() -> Result<Calibration> { return Error{"no OpenGL"}; };
  EXPECT_FALSE(calibrated(file_, "a machine", failing));
  EXPECT_FALSE(std::filesystem::exists(file_));
}

TEST(CalibrationFile, is_one_for_each_way_to_opengl_below_the_cache_folder_that_is_asked_for) {
  const char* before = std::getenv("XDG_CACHE_HOME");
  const std::string kept = before == nullptr ? "" : before;
  setenv("XDG_CACHE_HOME", "/some/cache", 1);
  EXPECT_EQ(calibration_file("window"), "/some/cache/promenade/renderer-window.json");
  EXPECT_EQ(calibration_file("egl"), "/some/cache/promenade/renderer-egl.json");
  before == nullptr ? unsetenv("XDG_CACHE_HOME") : setenv("XDG_CACHE_HOME", kept.c_str(), 1);
}

TEST(CalibrationFrame, times_both_and_says_which_is_faster) {
  const std::unique_ptr<Renderer> renderer = create_cpu_renderer();  // in OpenGL's place
  const Result<Calibration> both = calibrate(*renderer, "a driver");
  ASSERT_TRUE(both) << both.error().message;
  EXPECT_GT(both->gl_ms, 0);
  EXPECT_GT(both->cpu_ms, 0);
  EXPECT_EQ(both->cpu_is_faster(), both->cpu_ms <= both->gl_ms);
  EXPECT_NE(reason_of(*both, "a file").find("a driver; measured now"), std::string::npos);
}

TEST(CalibrationFrame, takes_time_and_leaves_nothing_behind) {
  const std::unique_ptr<Renderer> renderer = create_cpu_renderer();
  const Result<double> ms = calibration_frame_ms(*renderer);
  ASSERT_TRUE(ms);
  EXPECT_GT(*ms, 0);
  EXPECT_EQ(renderer->bytes(), 0U);
}

}  // namespace
}  // namespace promenade
