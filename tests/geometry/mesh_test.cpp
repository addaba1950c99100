#include "geometry/mesh.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/ext/matrix_transform.hpp>
#include <glm/geometric.hpp>
#include <limits>

#include "geometry/cone.h"

namespace promenade {
namespace {

/// One triangle in the plane z = 0 that faces up.
Mesh triangle_facing_up() {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.indices = {0, 1, 2};
  return mesh;
}

TEST(FindDefect, names_what_is_wrong) {
  EXPECT_EQ(find_defect(triangle_facing_up()), "");
  Mesh bad = triangle_facing_up();
  bad.indices[1] = 3;
  EXPECT_EQ(find_defect(bad), "index 1 is 3, but there are 3 vertices");
  bad = triangle_facing_up();
  bad.positions[2].y = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(find_defect(bad), "position 2 is not finite");
  bad = triangle_facing_up();
  bad.normals.resize(2);
  EXPECT_NE(find_defect(bad), "");
}

TEST(Transformed, mirroring_keeps_the_front_in_front) {
  const Mesh mirrored = transformed(triangle_facing_up(), glm::scale(glm::dmat4(1), glm::dvec3(-1, 1, 1)));
  EXPECT_GT(triangle_cross(mirrored, 0).z, 0);
  Mesh with_normals = triangle_facing_up();
  with_normals.normals.assign(3, glm::vec3(0, 0, 1));
  EXPECT_GT(transformed(with_normals, glm::scale(glm::dmat4(1), glm::dvec3(-1, 1, 1))).normals[0].z, 0.99F);
  // Mirrored in z the triangle's front is below, and so is its normal.
  const Mesh upside_down = transformed(with_normals, glm::scale(glm::dmat4(1), glm::dvec3(1, 1, -1)));
  EXPECT_LT(triangle_cross(upside_down, 0).z, 0);
  EXPECT_LT(upside_down.normals[0].z, -0.99F);
}

TEST(Append, fills_what_one_side_lacks) {
  Mesh a = triangle_facing_up();
  Mesh b = triangle_facing_up();
  b.normals.assign(3, glm::vec3(1, 0, 0));
  b.colors.assign(3, glm::u8vec4(9, 9, 9, 255));
  b.materials = {5};
  append(a, b);
  EXPECT_EQ(find_defect(a), "");
  EXPECT_EQ(a.triangle_count(), 2U);
  EXPECT_EQ(a.normals[0], glm::vec3(0)) << "the triangle's own";
  EXPECT_EQ(a.colors[0], glm::u8vec4(255));
  EXPECT_EQ(a.material_of(0), 0U);
  EXPECT_EQ(a.material_of(1), 5U);
  Mesh c = triangle_facing_up();
  append(a, c);
  EXPECT_EQ(find_defect(a), "");
  EXPECT_EQ(a.material_of(2), 0U);
}

TEST(Submesh, takes_only_the_vertices_used) {
  Mesh mesh = triangle_facing_up();
  append(mesh, triangle_facing_up());
  const Mesh part = submesh(mesh, {1});
  EXPECT_EQ(part.vertex_count(), 3U);
  EXPECT_EQ(find_defect(part), "");
}

TEST(Srgb, round_trips_every_byte) {
  for (int i = 0; i < 256; ++i) EXPECT_EQ(linear_to_srgb(srgb_to_linear(static_cast<uint8_t>(i))), i);
}

TEST(Srgb, bytes_are_what_the_standards_powers_round_to) {
  const auto by_powers = [](float light) {
    const double v = std::clamp(double(light), 0.0, 1.0);
    const double s = v <= 0.0031308 ? v * 12.92 : 1.055 * std::pow(v, 1.0 / 2.4) - 0.055;
    return static_cast<int>(std::lround(s * 255.0));
  };
  for (int i = -10; i <= 100010; ++i) {
    const float light = float(i) / 100000;
    ASSERT_EQ(int(linear_to_srgb(light)), by_powers(light)) << light;
  }
  for (int byte = 0; byte < 255; ++byte) {  // about where one byte goes over into the next
    const double s = (byte + 0.5) / 255;
    auto light = static_cast<float>(s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4));
    for (int i = 0; i < 4; ++i) light = std::nextafter(light, 0.0F);
    for (int i = 0; i < 8; ++i, light = std::nextafter(light, 1.0F))
      ASSERT_EQ(int(linear_to_srgb(light)), by_powers(light)) << light;
  }
}

TEST(NormalCone, faces_away_only_from_eyes_behind_every_triangle) {
  const Mesh mesh = triangle_facing_up();
  const NormalCone cone = normal_cone(mesh);
  EXPECT_NEAR(cone.cos_angle, 1, 1e-4);
  EXPECT_TRUE(faces_away(cone, bounds(mesh), {0.3F, 0.3F, -5}));
  EXPECT_FALSE(faces_away(cone, bounds(mesh), {0.3F, 0.3F, 5}));
  EXPECT_FALSE(faces_away(cone, bounds(mesh), {5, 0.3F, -0.01F}));
  EXPECT_FALSE(faces_away(NormalCone{}, bounds(mesh), {0.3F, 0.3F, -5}));
}

TEST(MergedCone, contains_both) {
  const NormalCone a{{1, 0, 0}, std::cos(0.2F)}, b{glm::normalize(glm::vec3(1, 1, 0)), std::cos(0.1F)};
  const NormalCone m = merged(a, b);
  const float angle = std::acos(m.cos_angle);
  EXPECT_LE(std::acos(glm::dot(m.axis, a.axis)) + 0.2F, angle + 1e-3F);
  EXPECT_LE(std::acos(glm::dot(m.axis, b.axis)) + 0.1F, angle + 1e-3F);
  EXPECT_EQ(merged(NormalCone{}, a).cos_angle, -1);
}

}  // namespace
}  // namespace promenade
