#pragma once
// Textures with their mip levels, ready for sampling.

#include <array>
#include <span>
#include <vector>

#include "geometry/mesh.h"
#include "geometry/result.h"
#include "raster/kernel.h"

namespace promenade {

/// A picture with all its mip levels, in one array. Averaged in linear light, weighted by opacity. Constant once made;
/// any thread may read it.
class MipTexture {
 public:
  /// Refuses a picture without pixels, one whose array does not match its size, and sides over 32768. Of a picture with
  /// a side over largest_side (> 0) only the levels that are not are kept.
  static Result<MipTexture> make(const Image& image, uint32_t largest_side = kMaxSide);
  static constexpr uint32_t kMaxSide = 32768;  ///< its levels fit kMaxMipLevels

  const raster_kernel::Texture& view() const { return view_; }
  uint64_t byte_size() const { return texels_.size() * sizeof(int32_t) + opacity_.size(); }

  MipTexture(MipTexture&&) noexcept = default;  // the view's pointer follows the array
  MipTexture& operator=(MipTexture&&) noexcept = default;
  MipTexture(const MipTexture&) = delete;
  MipTexture& operator=(const MipTexture&) = delete;

  /// A texel on its way to the coarser levels: linear colour and opacity.
  struct Texel {
    std::array<float, 3> color;
    float opacity;
  };

 private:
  MipTexture() = default;
  void store_picture(const Image& image);
  void store_level(uint32_t level, const std::vector<Texel>& from, uint32_t width);

  std::vector<int32_t> texels_;
  std::vector<uint8_t> opacity_;  ///< empty: opaque
  raster_kernel::Texture view_ = {};
};

/// The materials that meshes refer to, with their textures. The textures must outlive it.
class SurfaceTable {
 public:
  /// textures[i] is the owner's texture i; null: missing, the material's plain colour is drawn.
  SurfaceTable(std::span<const Material> materials, std::span<const MipTexture* const> textures);
  std::span<const raster_kernel::Surface> surfaces() const { return surfaces_; }

 private:
  std::vector<raster_kernel::Surface> surfaces_;
};

}  // namespace promenade
