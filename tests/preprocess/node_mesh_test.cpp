#include "preprocess/node_mesh.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <set>

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

}  // namespace
}  // namespace promenade
