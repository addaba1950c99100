#include "runtime/far_stage.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <glm/geometric.hpp>

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

/// A side alone, or with what it is told against.
Result<FarFace> decode_side(const ModelSource& source, FarCellId cell, uint32_t face, std::span<const std::byte> bytes,
                            FarKey& key) {
  const FarTables& tables = *source.far();
  const std::optional<std::array<int8_t, 3>> places = reference_of_far_face(bytes);
  if (!places) return decode_far_face(bytes);
  const glm::ivec3 steps((*places)[0], (*places)[1], (*places)[2]);
  const FarGridPlace own = grid_place_of(tables, tables.cells[index_of(cell)].place);
  const glm::ivec3 at = glm::ivec3(own.at) + steps;
  for (int i = 0; i < 3; ++i)
    if (at[i] < 0 || at[i] >= static_cast<int64_t>(own.grid.counts[i]))
      return Error{"told against a cell beside the grid"};
  const uint64_t place = own.grid.first_place + uint64_t(at.x) +
                         own.grid.counts.x * (uint64_t(at.y) + uint64_t(own.grid.counts.y) * uint64_t(at.z));
  const Result<const FarReference*> reference = key.at(source, place);
  if (!reference) return reference.error();
  FarReference placed = **reference;
  placed.offset = offset_from_reference(*places, own.grid.cell_m, own.grid.box_m);
  return decode_far_face(bytes, tables.faces[face].side, &placed);
}

/// Of what is without holes, and of the rest: as far_mesh numbers them.
std::array<Material, 2> far_materials() {
  Material solid;
  solid.texture = 0;
  solid.wrap_u = solid.wrap_v = Wrap::clamp;
  solid.two_sided = true;  // what stretches between near and far may turn its back on an eye aside
  Material holed = solid;
  holed.alpha = AlphaMode::mask;
  return {solid, holed};
}

}  // namespace

Result<const FarReference*> FarKey::at(const ModelSource& source, uint64_t place) {
  if (place_ == place) return &reference_;
  place_.reset(), reference_ = {}, sides_ = {};
  const FarTables& tables = *source.far();
  const std::optional<FarCellId> cell = far_cell_of_place(tables, place);
  if (!cell) return Error{fmt::format("far cell at place {}: told against one that is not there", place)};
  const FarCellRecord& record = tables.cells[index_of(*cell)];
  for (uint32_t face = record.first_face; face < record.first_face + record.face_count; ++face) {
    const Result<std::vector<std::byte>> bytes = source.read_far_face(face);
    if (!bytes) return bytes.error();
    Result<FarFace> decoded = decode_far_face(*bytes);
    if (!decoded) return Error{fmt::format("far face {}: {}", face, decoded.error().message)};
    // Of a reference only colours are looked at.
    decoded->kept = {}, decoded->depth = {};
    std::optional<FarFace>& side = sides_[tables.faces[face].side];
    side = std::move(*decoded);
    reference_.sides[tables.faces[face].side] = &*side;
  }
  place_ = place;
  return &reference_;
}

uint64_t FarKey::byte_size(const FarTables& tables) {
  uint32_t most = 0;
  for (const FarCellRecord& cell : tables.cells) most = std::max(most, cell.face_count);
  return most * HalvedGrid{tables.face_levels}.vertices() * sizeof(glm::u8vec4);
}

FarPlace place_of_far_side(const FarTables& tables, FarCellId cell, uint32_t face) {
  const FarShell shell = grid_place_of(tables, tables.cells[index_of(cell)].place).grid;
  return {cell_box(tables, cell).center(), shell.box_m, tables.faces[face].side, tables.has_depth};
}

Result<FarFace> read_far_side(const ModelSource& source, FarCellId cell, uint32_t face, FarKey& key) {
  const FarTables& tables = *source.far();
  const Result<std::vector<std::byte>> bytes = source.read_far_face(face);
  if (!bytes) return bytes.error();
  Result<FarFace> decoded = decode_side(source, cell, face, *bytes, key);
  if (!decoded) return Error{fmt::format("far face {}: {}", face, decoded.error().message)};
  if (decoded->grid.levels != tables.face_levels)
    return Error{
        fmt::format("far face {}: {} levels, the model's have {}", face, decoded->grid.levels, tables.face_levels)};
  return decoded;
}

Result<StagedFarSide> stage_far_side(const ModelSource& source, const Renderer& renderer, FarCellId cell, uint32_t face,
                                     FarKey& key) {
  const FarTables& tables = *source.far();
  Result<FarFace> decoded = read_far_side(source, cell, face, key);
  if (!decoded) return decoded.error();
  const FarPlace place = place_of_far_side(tables, cell, face);
  if (const uint32_t triangles = far_triangles(*decoded); triangles > tables.faces[face].triangles)
    return Error{fmt::format("far face {}: {} triangles, {} are due", face, triangles, tables.faces[face].triangles)};
  Mesh mesh = far_mesh(*decoded, place);
  const Lighting lighting;
  mesh.normals.assign(mesh.vertex_count(), glm::normalize(lighting.to_sun));
  unlight(decoded->colors, light_facing_the_sun(lighting));
  const std::array<Material, 2> materials = far_materials();
  StagedFarSide staged;
  staged.triangles = mesh.triangle_count();
  staged.bytes_read = tables.faces[face].stored_bytes;
  staged.mesh = renderer.stage_mesh(mesh, materials);
  staged.texture = renderer.stage_texture(decoded->colors);
  return staged;
}

FarSideBytes far_side_bytes(const ModelSource& source, const Renderer& renderer, uint32_t face) {
  const FarTables& tables = *source.far();
  const HalvedGrid grid{tables.face_levels};
  const uint64_t triangles = tables.faces[face].triangles, vertices = std::min(3 * triangles, grid.vertices());
  // Picture, kept, depth, numbers, sums; what is foretold and its blocks; the mesh; the mip maps under way.
  constexpr uint64_t kDecodedVertex = 4 + 1 + 2 + 4 + 4 + 8 + 20, kMeshVertex = 64, kMeshTriangle = 16;
  return {renderer.texture_bytes_bound(grid.side(), grid.side()) + renderer.mesh_bytes_bound(vertices, triangles),
          grid.vertices() * kDecodedVertex + vertices * kMeshVertex + triangles * kMeshTriangle +
              tables.faces[face].stored_bytes};
}

}  // namespace promenade
