#include "codec/far_mesh.h"

#include <gtest/gtest.h>

#include <cmath>

#include "geometry/random.h"

namespace promenade {
namespace {

/// Hills before the sky: a slanted plane of depths, nothing above a jagged line.
FarFace skyline(uint32_t levels, uint64_t seed) {
  Random random(seed);
  FarFace face;
  face.grid.levels = levels;
  const uint32_t side = face.grid.side();
  face.colors = {side, side, std::vector<glm::u8vec4>(face.grid.vertices(), {9, 9, 9, 255})};
  face.kept.assign(face.grid.vertices(), 0);
  face.depth.assign(face.grid.vertices(), 0);
  uint32_t top = side / 3;
  for (uint32_t x = 0; x < side; ++x) {
    if (random.chance(0.2)) top = side / 4 + random.below(side / 16);
    for (uint32_t y = 0; y < top; ++y) face.colors.at(x, y).a = 0;
  }
  for (uint32_t i = 0; i < 3; ++i) face.kept[random.below(static_cast<uint32_t>(face.grid.vertices()))] = 1;
  close_halvings(face.grid, face.kept);
  for (uint32_t i = 0; i < face.grid.vertices(); ++i)
    if (face.kept[i] != 0) face.depth[i] = static_cast<uint16_t>(20000 + 32 * (i % side) + 16 * (i / side));
  return face;
}

TEST(FarMesh, calls_solid_what_shows_something_everywhere_as_far_as_filters_reach) {
  for (uint64_t seed = 1; seed < 6; ++seed) {
    const FarFace face = skyline(8, seed);
    const uint32_t side = face.grid.side();
    const Mesh mesh = far_mesh(face, {{0, 0, 0}, 2, 0, false});
    ASSERT_EQ(mesh.materials.size(), mesh.triangle_count());
    size_t solid = 0;
    for (size_t t = 0; t < mesh.triangle_count(); ++t) {
      std::array<glm::vec2, 3> at;
      for (size_t k = 0; k < 3; ++k) at[k] = mesh.texcoords[mesh.indices[3 * t + k]] * float(side) - 0.5F;
      const glm::vec2 low = glm::min(at[0], glm::min(at[1], at[2])), high = glm::max(at[0], glm::max(at[1], at[2]));
      bool all = true;
      constexpr float kReach = 2;
      for (auto y = std::lround(low.y - kReach); y <= std::lround(high.y + kReach); ++y)
        for (auto x = std::lround(low.x - kReach); x <= std::lround(high.x + kReach); ++x)
          if (x >= 0 && y >= 0 && x < long(side) && y < long(side))
            all = all && face.colors.at(static_cast<uint32_t>(x), static_cast<uint32_t>(y)).a != 0;
      EXPECT_EQ(mesh.materials[t], all ? 0U : 1U) << t;
      solid += all ? 1 : 0;
    }
    EXPECT_GT(solid, 0U);
    EXPECT_LT(solid, mesh.triangle_count());
  }
}

}  // namespace
}  // namespace promenade
