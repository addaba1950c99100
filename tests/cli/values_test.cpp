#include <gtest/gtest.h>

#include "cli/plot.h"
#include "cli/values.h"

namespace promenade {
namespace {

TEST(ParseBytes, knows_units_of_1024_and_of_1000) {
  EXPECT_EQ(*parse_bytes("4GiB"), uint64_t(4) << 30);
  EXPECT_EQ(*parse_bytes("256 MiB"), uint64_t(256) << 20);
  EXPECT_EQ(*parse_bytes("2GB"), 2'000'000'000U);
  EXPECT_EQ(*parse_bytes("1.5KiB"), 1536U);
  EXPECT_EQ(*parse_bytes("77"), 77U);
  for (const char* bad : {"", "GiB", "-1", "1XiB", "nan", "inf", "1e30GiB", "4 G iB", "0x10"})
    EXPECT_FALSE(parse_bytes(bad).ok()) << bad;
}

TEST(ParseSize, refuses_what_no_renderer_can_draw) {
  EXPECT_EQ(parse_size("1280x720")->width, 1280U);
  for (const char* bad : {"", "1280", "0x720", "1280x0", "16385x1", "1.5x2", "x", "axb", "-3x4"})
    EXPECT_FALSE(parse_size(bad).ok()) << bad;
}

TEST(ParsePose, takes_five_numbers_or_six) {
  EXPECT_EQ(parse_pose("1,2,3,90,-10")->yaw_deg, 90);
  EXPECT_EQ(parse_pose("1,2,3,90,-10,5")->roll_deg, 5);
  for (const char* bad : {"", "1,2,3", "1,2,3,4,5,6,7", "1,2,3,4,x", "1,2,3,4,nan", "1,2,3,4,"})
    EXPECT_FALSE(parse_pose(bad).ok()) << bad;
}

TEST(ParseWeight, takes_a_name_and_a_part) {
  EXPECT_EQ(parse_weight("chair=0.25")->first, "chair");
  EXPECT_EQ(parse_weight("chair=0.25")->second, 0.25);
  EXPECT_EQ(parse_weight("a=b=1")->first, "a=b");
  EXPECT_EQ(parse_weight("=0")->first, "") << "what has no class";
  for (const char* bad : {"", "chair", "chair=", "chair=2", "chair=-0.1", "chair=nan", "chair=0.5x"})
    EXPECT_FALSE(parse_weight(bad).ok()) << bad;
}

TEST(LinePlot, escapes_names_and_survives_gaps_and_nothing) {
  const std::string svg = line_plot({{"a<b", {1, 2, std::numeric_limits<double>::quiet_NaN(), 4}}, {"c", {}}},
                                    {.title = "t&t", .y_label = "ms", .lines = {}});
  EXPECT_NE(svg.find("a&lt;b"), std::string::npos);
  EXPECT_NE(svg.find("t&amp;t"), std::string::npos);
  EXPECT_EQ(svg.find("nan"), std::string::npos);
  EXPECT_NE(line_plot({}, {.title = "", .y_label = "", .lines = {}}).find("</svg>"), std::string::npos);
}

TEST(MovingAverage, shortens_its_window_at_the_ends) {
  EXPECT_EQ(moving_average({1, 2, 6}, 3), (std::vector<double>{1.5, 3, 4}));
}

}  // namespace
}  // namespace promenade
