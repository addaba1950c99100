#include "runtime/decode_part.h"

#include <fmt/format.h>

#include <algorithm>

namespace promenade {
namespace {

Status check_mesh(const Model& model, NodeId node, const Mesh& mesh) {
  const NodeRecord& record = model.tables.nodes[index_of(node)];
  if (mesh.vertex_count() > record.vertices || mesh.triangle_count() > record.triangles)
    return Error{
        fmt::format("node {}: {} vertices and {} triangles decoded, the tables say {} and {}; build the model again",
                    index_of(node), mesh.vertex_count(), mesh.triangle_count(), record.vertices, record.triangles)};
  const std::span<const uint32_t> listed = model.textures_of(node);
  uint32_t last = kNoTexture;
  for (size_t i = 0; i < mesh.triangle_count(); ++i) {
    const uint32_t material = mesh.material_of(i);
    if (material == last) continue;
    last = material;
    if (material >= model.tables.materials.size())
      return Error{fmt::format("node {}: triangle {} has material {}, there are {}; build the model again",
                               index_of(node), i, material, model.tables.materials.size())};
    const uint32_t texture = model.tables.materials[material].texture;
    if (texture != kNoTexture && !mesh.texcoords.empty() &&
        std::find(listed.begin(), listed.end(), texture) == listed.end())
      return Error{
          fmt::format("node {}: triangle {} uses texture {}, which the node does not list; build the model again",
                      index_of(node), i, texture)};
  }
  return Done{};
}

}  // namespace

uint64_t decoded_bytes_bound(const NodeRecord& node) {
  constexpr uint64_t kVertexBytes = sizeof(glm::vec3) * 2 + sizeof(glm::vec2) + sizeof(glm::u8vec4);
  // Corners and material, and what sorting them by material takes.
  constexpr uint64_t kTriangleBytes = 6 * sizeof(uint32_t);
  return node.vertices * kVertexBytes + node.triangles * kTriangleBytes;
}

uint64_t decoded_bytes_bound(const TextureRecord& texture) {
  return uint64_t(texture.width) * texture.height * sizeof(glm::u8vec4);
}

Status decode_part(const ModelSource& source, const Renderer& renderer, NodeId node, uint32_t texture,
                   const TextureLimit& limit, std::span<const std::byte> stored, StagedPart& staged) {
  const Model& model = source.model();
  if (texture == kNoTexture) {
    const Result<Mesh> mesh = source.decode_mesh(node, stored);
    if (!mesh) return mesh.error();
    PROMENADE_TRY(check_mesh(model, node, *mesh));
    staged.mesh = renderer.stage_mesh(*mesh, model.tables.materials);
    return Done{};
  }
  const Result<Image> image = source.decode_texture(texture, stored);
  if (!image) return image.error();
  const TextureRecord& record = model.tables.textures[texture];
  if (image->width > record.width || image->height > record.height)
    return Error{fmt::format("texture {}: {} x {} pixels decoded, the tables say {} x {}; build the model again",
                             texture, image->width, image->height, record.width, record.height)};
  staged.texture = renderer.stage_texture(*image, limit.of(record));
  return Done{};
}

}  // namespace promenade
