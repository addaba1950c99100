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

TEST(FarMesh, split_at_holes_is_the_same_surface_and_mostly_without_holes) {
  for (uint64_t seed = 1; seed < 6; ++seed) {
    const FarFace whole = skyline(8, seed);
    FarFace split = whole;
    split_at_holes(split);
    EXPECT_LE(far_triangles(split), split_triangles_bound(far_triangles(whole), whole.grid));
    std::vector<uint8_t> kept = split.kept;
    EXPECT_FALSE(close_halvings(split.grid, kept)) << "no triangle meets another's edge in its middle";
    const uint32_t side = whole.grid.side();
    for (uint32_t i = 0; i < split.grid.vertices(); ++i) {
      if (whole.kept[i] != 0) {
        EXPECT_EQ(split.depth[i], whole.depth[i]);
      }
      // The corners lie on one plane, so all that is between them does.
      if (split.kept[i] != 0) {
        EXPECT_NEAR(split.depth[i], 20000 + 32.0 * (i % side) + 16.0 * (i / side), 2);
      }
    }
    const Mesh mesh = far_mesh(split, {{0, 0, 0}, 2, 0, false});
    ASSERT_EQ(mesh.materials.size(), mesh.triangle_count());
    double solid_px = 0, holed_px = 0;
    for (size_t t = 0; t < mesh.triangle_count(); ++t) {
      std::array<glm::vec2, 3> at;
      for (size_t k = 0; k < 3; ++k) at[k] = mesh.texcoords[mesh.indices[3 * t + k]] * float(side) - 0.5F;
      const glm::vec2 e1 = at[1] - at[0], e2 = at[2] - at[0];
      (mesh.materials[t] == 0 ? solid_px : holed_px) += double(std::abs(e1.x * e2.y - e1.y * e2.x)) / 2;
      if (mesh.materials[t] != 0) continue;
      const glm::vec2 low = glm::min(at[0], glm::min(at[1], at[2])), high = glm::max(at[0], glm::max(at[1], at[2]));
      for (auto y = static_cast<uint32_t>(low.y); y <= static_cast<uint32_t>(high.y); ++y)
        for (auto x = static_cast<uint32_t>(low.x); x <= static_cast<uint32_t>(high.x); ++x)
          ASSERT_EQ(split.colors.at(x, y).a, 255) << "at " << x << ", " << y;
    }
    EXPECT_GT(solid_px, 3 * holed_px);
  }
}

TEST(FarMesh, split_at_holes_keeps_the_same_vertices_along_every_border) {
  FarFace full = skyline(7, 1), empty = full, some = full;
  for (glm::u8vec4& p : full.colors.pixels) p.a = 255;
  for (glm::u8vec4& p : empty.colors.pixels) p.a = 0;
  for (FarFace* face : {&full, &empty, &some}) split_at_holes(*face);
  const uint32_t side = full.grid.side();
  for (uint32_t i = 0; i < full.grid.vertices(); ++i) {
    if (i % side != 0 && i % side != side - 1 && i / side != 0 && i / side != side - 1) continue;
    EXPECT_EQ(full.kept[i], some.kept[i]);
    EXPECT_EQ(full.kept[i], empty.kept[i]);
    if (full.kept[i] != 0) {
      EXPECT_EQ(full.depth[i], some.depth[i]);
    }
  }
  for (const uint32_t material : far_mesh(full, {{0, 0, 0}, 2, 0, false}).materials) EXPECT_EQ(material, 0U);
}

}  // namespace
}  // namespace promenade
