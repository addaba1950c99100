#pragma once
// Drawing meshes with their instances as they are, without levels of detail: the reference for every comparison.

#include <functional>
#include <span>
#include <vector>

#include "geometry/mesh.h"
#include "geometry/result.h"
#include "runtime/renderer.h"

namespace promenade {

/// A mesh of a source placed in model space (world less origin, subtracted in double).
struct PlacedMesh {
  uint32_t mesh = 0;
  NodeId id = kNoNode;  ///< what read_nodes() reports
  glm::mat4 model_from_mesh{1.0F};
};

/// Meshes in a renderer, and where they stand. Meshes are uploaded once, whatever the number of instances.
class BruteForceScene {
 public:
  explicit BruteForceScene(Renderer& renderer) : renderer_(&renderer) {}
  BruteForceScene(BruteForceScene&&) noexcept;
  BruteForceScene& operator=(BruteForceScene&&) noexcept;
  ~BruteForceScene();

  /// Adds a part of a source: its materials' textures index `textures` (an image without pixels: drawn in the plain
  /// colour). May be called for part after part; meshes and pictures need not live on.
  Status add(std::span<const Mesh> meshes, std::span<const Material> materials, std::span<const Image> textures,
             std::span<const PlacedMesh> placed);

  /// Draws everything in the frustum, nearest first.
  Status draw(const FrameView& view);
  uint64_t nodes_drawn() const { return items_.size(); }
  const Box& box() const { return box_; }

 private:
  struct Instance {
    DrawItem item;
    Box box;
  };
  void clear();

  Renderer* renderer_;
  std::vector<MeshHandle> meshes_;
  std::vector<TextureHandle> textures_;
  std::vector<Instance> instances_;
  std::vector<DrawItem> items_;
  Box box_;
};

}  // namespace promenade
