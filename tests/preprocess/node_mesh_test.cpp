#include "preprocess/node_mesh.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <set>
#include <tuple>

namespace promenade {
namespace {

TEST(RoundColors, leaves_64_values_two_off_at_most_with_black_white_and_opacity_as_they_were) {
  Mesh mesh;
  for (int i = 0; i < 256; ++i) mesh.colors.emplace_back(i, 255 - i, i, i);
  const std::vector<glm::u8vec4> before = mesh.colors;
  round_colors(mesh);
  std::set<int> values;
  for (size_t i = 0; i < before.size(); ++i) {
    for (int axis = 0; axis < 3; ++axis) EXPECT_LE(std::abs(int(mesh.colors[i][axis]) - int(before[i][axis])), 2);
    EXPECT_EQ(mesh.colors[i].a, before[i].a);
    values.insert(mesh.colors[i].r);
  }
  EXPECT_EQ(values.size(), 64U);
  EXPECT_EQ(*values.begin(), 0);
  EXPECT_EQ(*values.rbegin(), 255);
  const std::vector<glm::u8vec4> once = mesh.colors;
  round_colors(mesh);
  EXPECT_EQ(mesh.colors, once);
}

/// Two squares of 1 m2 that see 0.5 x 0.5 of the picture, and of the sides given.
Mesh squares_that_see(float side, float side_m) {
  Mesh mesh;
  for (const auto& [x, see, size] : {std::tuple(0.0F, 0.5F, 1.0F), std::tuple(2.0F, side, side_m)}) {
    const auto first = static_cast<uint32_t>(mesh.positions.size());
    for (const glm::vec2& corner : {glm::vec2(0, 0), glm::vec2(1, 0), glm::vec2(1, 1), glm::vec2(0, 1)}) {
      mesh.positions.emplace_back(x + corner.x * size, corner.y * size, 0);
      mesh.texcoords.push_back(corner * see);
    }
    for (const uint32_t i : {0U, 1U, 2U, 0U, 2U, 3U}) mesh.indices.push_back(first + i);
  }
  return mesh;
}

TEST(LargestTexel, is_that_of_the_coarsest_part_worth_naming) {
  EXPECT_DOUBLE_EQ(largest_texel_m(squares_that_see(0.5F, 1), 0, 100, 100), 0.02);
  EXPECT_DOUBLE_EQ(largest_texel_m(squares_that_see(0.125F, 1), 0, 100, 100), 0.08);
  EXPECT_LT(texel_size_m(squares_that_see(0.125F, 1), 0, 100, 100), 0.03) << "the mean says nothing of it";
  EXPECT_NEAR(largest_texel_m(squares_that_see(0.001F, 0.05F), 0, 100, 100), 0.02, 1e-6) << "a four-hundredth";
}

TEST(LargestTexel, is_none_where_a_point_of_the_picture_is_seen) {
  EXPECT_EQ(largest_texel_m(squares_that_see(0, 1), 0, 100, 100), 0);
  EXPECT_GT(texel_size_m(squares_that_see(0, 1), 0, 100, 100), 0);
  EXPECT_EQ(largest_texel_m(Mesh{}, 0, 100, 100), 0);
}

}  // namespace
}  // namespace promenade
