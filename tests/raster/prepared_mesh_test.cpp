// What a prepared mesh holds of the mesh as given: less room, the same picture.

#include "raster/prepared_mesh.h"

#include <gtest/gtest.h>

#include <cmath>

#include "raster/shade.h"
#include "scenes.h"

namespace promenade {
namespace {

using namespace test_scenes;  // NOLINT(google-build-using-namespace)

Image picture(const RasterView& view, const std::vector<RasterItem>& items, const ShadeOptions& shading) {
  VisibilityBuffer buffer;
  EXPECT_TRUE(buffer.draw(view, items).ok());
  Image image;
  shade(buffer, shading, image);
  return image;
}

/// A square across the view along +y at y = 4, cut into 2 x side x side triangles whose corners are their own.
Mesh tiled_square(uint32_t side) {
  Mesh mesh;
  const auto at = [side](uint32_t x, uint32_t z) {
    return glm::vec3(4.0F * float(x) / float(side) - 2, 4, 4.0F * float(z) / float(side) - 2);
  };
  for (uint32_t z = 0; z < side; ++z)
    for (uint32_t x = 0; x < side; ++x) {
      add_triangle(mesh, at(x, z), at(x + 1, z), at(x + 1, z + 1));
      add_triangle(mesh, at(x, z), at(x + 1, z + 1), at(x, z + 1));
    }
  return mesh;
}

TEST(PreparedMesh, normals_light_as_the_given_ones) {
  std::vector<glm::vec3> normals = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  Random random(3);
  while (normals.size() < 200) normals.push_back(glm::normalize(random.point(1)));
  const std::vector<Material> materials(1);
  ShadeOptions light;
  light.threads = 1, light.sky = false;
  light.sky_ambient = light.ground_ambient = glm::vec3(0), light.sun = glm::vec3(1);
  for (const glm::vec3& normal : normals) {
    Mesh mesh = tiled_square(1);
    mesh.normals.assign(mesh.vertex_count(), normal);
    const PreparedMesh prepared = *prepare(mesh, materials);
    light.to_sun = glm::normalize(normal + 0.7F * random.point(1));
    const Image image = picture(perspective_view(along_y(8), glm::dvec3(0)), {{&prepared, 0, nullptr, {}}}, light);
    EXPECT_NEAR(image.at(3, 5).g, linear_to_srgb(std::max(0.0F, glm::dot(normal, light.to_sun))), 1)
        << normal.x << ", " << normal.y << ", " << normal.z;
  }
}

TEST(PreparedMesh, vertices_without_a_normal_take_the_triangle_s) {
  Mesh bare = tiled_square(2), zero = bare;
  zero.normals.assign(zero.vertex_count(), glm::vec3(0));
  const std::vector<Material> materials(1);
  const PreparedMesh a = *prepare(bare, materials), b = *prepare(zero, materials);
  const RasterView view = perspective_view(along_y(16), glm::dvec3(0));
  EXPECT_EQ(picture(view, {{&a, 0, nullptr, {}}}, {}).pixels, picture(view, {{&b, 0, nullptr, {}}}, {}).pixels);
}

/// More triangles than two bytes can number, against the same in pieces of few.
TEST(PreparedMesh, large_meshes_show_what_their_pieces_do) {
  constexpr uint32_t kSide = 200, kPieces = 8;
  Mesh whole = tiled_square(kSide);
  whole.materials.resize(whole.triangle_count());
  Random random(5);
  for (size_t v = 0; v < whole.vertex_count(); ++v) {
    whole.colors.emplace_back(random.below(256), random.below(256), random.below(256), 255);
    whole.normals.push_back(glm::normalize(random.point(1)));
  }
  std::vector<Material> materials(70'000);
  for (Material& material : materials) material.color = {random.below(256), random.below(256), 255, 255};
  for (uint32_t& m : whole.materials) m = random.below(static_cast<uint32_t>(materials.size()));
  const SurfaceTable surfaces(materials, {});
  std::vector<PreparedMesh> pieces;
  for (uint32_t i = 0; i < kPieces; ++i) {
    std::vector<uint32_t> triangles;
    for (uint32_t t = i; t < whole.triangle_count(); t += kPieces) triangles.push_back(t);
    pieces.push_back(*prepare(submesh(whole, triangles), materials));
  }
  std::vector<RasterItem> items;
  for (uint32_t i = 0; i < kPieces; ++i) items.push_back({&pieces[i], i, &surfaces, {}});
  const PreparedMesh prepared = *prepare(whole, materials);
  const RasterView view = perspective_view(along_y(300), glm::dvec3(0));
  const Image image = picture(view, {{&prepared, 0, &surfaces, {}}}, {});
  EXPECT_EQ(image.pixels, picture(view, items, {}).pixels);

  VisibilityBuffer buffer;
  ASSERT_TRUE(buffer.draw(view, std::vector<RasterItem>{{&prepared, 0, &surfaces, {}}}).ok());
  EXPECT_GT(buffer.stats().triangles_drawn, 0x10000U);
}

TEST(PreparedMesh, takes_no_more_than_the_bound_and_half_of_what_copies_would) {
  Mesh mesh = bumpy_sphere({0, 0, 0}, 1, 31, 2);
  mesh.texcoords.clear();
  mesh.colors.assign(mesh.vertex_count(), glm::u8vec4(255));
  mesh.materials.assign(mesh.triangle_count(), 0);
  const PreparedMesh prepared = *prepare(mesh, std::vector<Material>(1));
  PrepareOptions bare;
  bare.attributes = false;
  const uint64_t geometry = prepare(mesh, std::vector<Material>(1), bare)->byte_size();
  EXPECT_LE(prepared.byte_size(), prepared_bytes_bound(mesh.vertex_count(), mesh.triangle_count()));
  EXPECT_LT(2 * (prepared.byte_size() - geometry), byte_size(mesh));
}

}  // namespace
}  // namespace promenade
