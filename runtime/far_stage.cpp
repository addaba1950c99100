#include "runtime/far_stage.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <glm/geometric.hpp>

#include "codec/far_mesh.h"

namespace promenade {
namespace {

/// What a surface that faces the sun gets.
glm::vec3 light_facing_the_sun(const Lighting& lighting) {
  const glm::vec3 n = glm::normalize(lighting.to_sun);
  return lighting.sun + glm::mix(lighting.ground_ambient, lighting.sky_ambient, 0.5F + 0.5F * n.z);
}

/// Lit colours to those that give them under the light.
void unlight(Image& colors, const glm::vec3& light) {
  std::array<std::array<uint8_t, 256>, 3> table{};
  for (int c = 0; c < 3; ++c)
    for (size_t i = 0; i < 256; ++i)
      table[static_cast<size_t>(c)][i] =
          linear_to_srgb(std::min(1.0F, srgb_to_linear(static_cast<uint8_t>(i)) / light[c]));
  for (glm::u8vec4& p : colors.pixels) p = {table[0][p.r], table[1][p.g], table[2][p.b], p.a};
}

Material far_material() {
  Material material;
  material.texture = 0;
  material.wrap_u = material.wrap_v = Wrap::clamp;
  material.alpha = AlphaMode::mask;
  material.two_sided = true;  // what stretches between near and far may turn its back on an eye aside
  return material;
}

}  // namespace

Result<StagedFarSide> stage_far_side(const ModelSource& source, const Renderer& renderer, FarCellId cell,
                                     uint32_t face) {
  const FarTables& tables = *source.far();
  const Result<std::vector<std::byte>> bytes = source.read_far_face(face);
  if (!bytes) return bytes.error();
  Result<FarFace> decoded = decode_far_face(*bytes);
  if (!decoded) return Error{fmt::format("far face {}: {}", face, decoded.error().message)};
  if (decoded->grid.levels != tables.face_levels)
    return Error{
        fmt::format("far face {}: {} levels, the model's have {}", face, decoded->grid.levels, tables.face_levels)};
  const FarPlace place{cell_box(tables, cell).center(), tables.box_m, tables.faces[face].side, tables.has_depth};
  Mesh mesh = far_mesh(*decoded, place);
  if (mesh.triangle_count() > tables.faces[face].triangles)
    return Error{fmt::format("far face {}: {} triangles, {} are due", face, mesh.triangle_count(),
                             tables.faces[face].triangles)};
  const Lighting lighting;
  mesh.normals.assign(mesh.vertex_count(), glm::normalize(lighting.to_sun));
  unlight(decoded->colors, light_facing_the_sun(lighting));
  const Material material = far_material();
  StagedFarSide staged;
  staged.triangles = mesh.triangle_count();
  staged.bytes_read = bytes->size();
  staged.mesh = renderer.stage_mesh(mesh, std::span(&material, 1));
  staged.texture = renderer.stage_texture(decoded->colors);
  return staged;
}

FarSideBytes far_side_bytes(const ModelSource& source, const Renderer& renderer, uint32_t face) {
  const FarTables& tables = *source.far();
  const HalvedGrid grid{tables.face_levels};
  const uint64_t triangles = tables.faces[face].triangles, vertices = std::min(3 * triangles, grid.vertices());
  // Picture, kept, depth, numbers, sums; the mesh; the mip maps under way.
  constexpr uint64_t kDecodedVertex = 4 + 1 + 2 + 4 + 4 + 20, kMeshVertex = 64, kMeshTriangle = 16;
  return {renderer.texture_bytes_bound(grid.side(), grid.side()) + renderer.mesh_bytes_bound(vertices, triangles),
          grid.vertices() * kDecodedVertex + vertices * kMeshVertex + triangles * kMeshTriangle +
              tables.faces[face].stored_bytes};
}

}  // namespace promenade
