#pragma once
// Nodes' meshes ready for the rasteriser, read when first wanted and kept while memory lasts. Objects that move stand
// where they do at time 0.

#include <memory>
#include <mutex>
#include <unordered_map>
#include <vector>

#include "layout/model_io.h"
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
  struct Entry {
    std::shared_ptr<const PreparedMesh> mesh;
    uint64_t last_use = 0;
  };
  NodeMeshes(const ModelReader& model, uint64_t cache_bytes) : model_(model), cache_bytes_(cache_bytes) {}
  Status read_holes();
  Result<PreparedMesh> prepare_node(NodeId id) const;
  void make_room() const;

  const ModelReader& model_;
  uint64_t cache_bytes_;
  std::vector<glm::dmat4> moving_;  ///< by object
  std::vector<std::unique_ptr<MipTexture>> textures_;
  std::unique_ptr<SurfaceTable> surfaces_;

  mutable std::mutex mutex_;  // guards everything below
  mutable std::unordered_map<uint32_t, Entry> entries_;
  mutable uint64_t bytes_ = 0, uses_ = 0;
};

/// A set of nodes held for drawing: draw_items() name them by id.
struct HeldNodes {
  std::vector<std::shared_ptr<const PreparedMesh>> meshes;
  std::vector<RasterItem> items;  ///< in the order asked for
};
Result<HeldNodes> hold_nodes(const NodeMeshes& meshes, std::span<const NodeId> nodes);

}  // namespace promenade
