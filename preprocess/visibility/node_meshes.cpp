#include "preprocess/visibility/node_meshes.h"

#include <algorithm>

namespace promenade {

Result<std::unique_ptr<NodeMeshes>> NodeMeshes::make(const ModelReader& model, uint64_t cache_bytes) {
  std::unique_ptr<NodeMeshes> meshes(new NodeMeshes(model, cache_bytes));
  meshes->moving_ = model_from_objects(model.model(), 0);
  PROMENADE_TRY(meshes->read_holes());
  return meshes;
}

Status NodeMeshes::read_holes() {
  const ModelTables& tables = model_.model().tables;
  textures_.resize(tables.textures.size());
  for (const Material& material : tables.materials) {
    const uint32_t texture = material.texture;
    if (material.alpha == AlphaMode::opaque || texture == kNoTexture || textures_[texture]) continue;
    const Result<Image> image = model_.read_texture(texture);
    if (!image) return image.error();
    Result<MipTexture> mips = MipTexture::make(*image);
    if (!mips) return mips.error();
    textures_[texture] = std::make_unique<MipTexture>(std::move(*mips));
  }
  std::vector<const MipTexture*> pointers;
  for (const auto& texture : textures_) pointers.push_back(texture.get());
  surfaces_ = std::make_unique<SurfaceTable>(tables.materials, pointers);
  return Done{};
}

Result<PreparedMesh> NodeMeshes::prepare_node(NodeId id) const {
  Result<Mesh> mesh = model_.read_mesh(id);
  if (!mesh) return mesh.error();
  const Model& model = model_.model();
  if (model.is_moving(id))
    mesh = transformed(*mesh, moving_[model.objects.moving_nodes[index_of(id) - model.first_moving_node()].object]);
  const std::vector<Material>& materials = model.tables.materials;
  PrepareOptions options;
  options.attributes = false;
  for (size_t t = 0; t < mesh->triangle_count() && !options.attributes; ++t)
    options.attributes = materials[mesh->material_of(t)].alpha != AlphaMode::opaque;
  return prepare(*mesh, materials, options);
}

Result<std::shared_ptr<const PreparedMesh>> NodeMeshes::get(NodeId id) const {
  using Held = std::shared_ptr<const PreparedMesh>;
  const auto make = [&]() -> Result<Held> {
    Result<PreparedMesh> made = prepare_node(id);
    if (!made) return made.error();
    return Held(std::make_shared<const PreparedMesh>(std::move(*made)));
  };
  return meshes_.get(id, make, [](const Held& mesh) { return mesh->byte_size(); });
}

Result<HeldNodes> hold_nodes(const NodeMeshes& meshes, std::span<const NodeId> nodes) {
  HeldNodes held;
  held.meshes.reserve(nodes.size()), held.items.reserve(nodes.size());
  for (const NodeId id : nodes) {
    Result<std::shared_ptr<const PreparedMesh>> mesh = meshes.get(id);
    if (!mesh) return mesh.error();
    held.items.push_back({mesh->get(), index_of(id), &meshes.surfaces(), {}});
    held.meshes.push_back(std::move(*mesh));
  }
  return held;
}

}  // namespace promenade
