#pragma once
// Nodes' meshes ready for the rasteriser, read when first wanted and kept while memory lasts. Objects that move stand
// where they do at time 0.

#include <memory>
#include <vector>

#include "layout/model_io.h"
#include "preprocess/node_cache.h"
#include "raster/visibility.h"

namespace promenade {

/// The model must outlive it. Any thread.
class NodeMeshes {
 public:
  /// cache_bytes: what prepared meshes may take while nobody holds them. Reads the pictures of surfaces with holes
  /// (AlphaMode::mask, blend): what is seen through them depends on those. Errors: reading the model.
  static Result<std::unique_ptr<NodeMeshes>> make(const ModelReader& model, uint64_t cache_bytes);

  Result<std::shared_ptr<const PreparedMesh>> get(NodeId id) const;

  const ModelReader& model() const { return model_; }
  const SurfaceTable& surfaces() const { return *surfaces_; }

 private:
  NodeMeshes(const ModelReader& model, uint64_t cache_bytes) : model_(model), meshes_(cache_bytes) {}
  Status read_holes();
  Result<PreparedMesh> prepare_node(NodeId id) const;

  const ModelReader& model_;
  std::vector<glm::dmat4> moving_;  ///< by object
  std::vector<std::unique_ptr<MipTexture>> textures_;
  std::unique_ptr<SurfaceTable> surfaces_;
  mutable NodeCache<std::shared_ptr<const PreparedMesh>> meshes_;
};

/// A set of nodes held for drawing: draw_items() name them by id.
struct HeldNodes {
  std::vector<std::shared_ptr<const PreparedMesh>> meshes;
  std::vector<RasterItem> items;  ///< in the order asked for
};
Result<HeldNodes> hold_nodes(const NodeMeshes& meshes, std::span<const NodeId> nodes);

}  // namespace promenade
