#pragma once
// What is far, lit and textured, as pictures of the sides of a box.

#include <memory>
#include <mutex>
#include <optional>
#include <unordered_map>
#include <vector>

#include "layout/model_io.h"
#include "preprocess/node_cache.h"
#include "raster/shade.h"

namespace promenade {

/// Meshes and textures of a model's nodes, read when first wanted and kept while memory lasts. The model must outlive
/// it. Any thread.
class FarScene {
 public:
  /// cache_bytes: what they may take while nobody holds them.
  FarScene(const ModelReader& model, uint64_t cache_bytes) : model_(model), nodes_(cache_bytes) {}

  /// A node held for drawing.
  struct Held {
    std::shared_ptr<const PreparedMesh> mesh;
    std::vector<std::pair<uint32_t, std::shared_ptr<const MipTexture>>> textures;
  };
  Result<Held> get(NodeId id) const;
  const ModelReader& model() const { return model_; }

 private:
  Result<Held> read(NodeId id) const;
  Result<std::shared_ptr<const MipTexture>> texture(uint32_t index) const;

  const ModelReader& model_;
  mutable NodeCache<Held> nodes_;
  mutable std::mutex mutex_;  // guards textures_
  mutable std::unordered_map<uint32_t, std::weak_ptr<const MipTexture>> textures_;
};

/// What of a model a picture shows.
struct FarReach {
  glm::dvec3 centre{0};        ///< whence
  double box_m = 0;            ///< length of the box around it beyond which things are shown
  std::optional<DBox> within;  ///< nothing outside it is; nullopt: all
};

/// What is seen from one place of everything outside a box around it. One thread.
class FarView {
 public:
  /// Takes the coarsest front whose error is at most half a texel. levels: of the faces' grids. Errors: reading the
  /// model.
  static Result<FarView> make(const FarScene& scene, const FarReach& reach, uint32_t levels);

  /// Draws a side: colours (opacity 255 where something is, 0 elsewhere), and depths in metres along the side's axis,
  /// infinity where nothing is. Returns whether anything is.
  Result<bool> draw(uint32_t side, Image& colors, std::vector<float>& depth_m);

 private:
  FarView() = default;
  void cut_off(uint32_t side, std::vector<float>& depth_m) const;
  FarReach reach_;
  uint32_t levels_ = 0;
  std::vector<FarScene::Held> held_;
  std::vector<RasterItem> items_;
  std::unique_ptr<SurfaceTable> surfaces_;
  VisibilityBuffer buffer_;
  Image plain_;
};

}  // namespace promenade
