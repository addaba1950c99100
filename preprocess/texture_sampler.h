#pragma once
// What a material looks like at a point, averaged over a patch of its texture.

#include <cmath>
#include <cstdint>
#include <functional>
#include <glm/vec2.hpp>
#include <glm/vec4.hpp>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "geometry/mesh.h"

namespace promenade {

/// Linear light and opacity, each in [0, 1]; the light is not multiplied by the opacity.
using Light = glm::vec4;

/// A texture at coarser and coarser resolutions, each texel computed when it is first asked for: a node sees little of
/// a large picture. Cut-outs become coverage: a texel's share that is there. One thread.
class FilteredTexture {
 public:
  /// The picture must stay. material: for wrapping and cut-out.
  FilteredTexture(const Image& image, const Material& material);

  /// footprint_px: side of the patch to average, in texels of the picture.
  Light at(const glm::vec2& texcoord, float footprint_px);

  /// Side of a square picture with as many texels.
  float side_px() const { return std::sqrt(float(image_.width) * float(image_.height)); }

 private:
  struct Level {
    uint32_t width = 0, height = 0;
    std::vector<glm::vec4> texels;  // light times weight, weight; < 0: not computed yet
  };
  glm::vec4 texel(size_t level, uint32_t x, uint32_t y);
  glm::vec4 source_texel(uint32_t x, uint32_t y) const;
  glm::vec4 averaged(const Level& level, uint32_t x, uint32_t y) const;

  const Image& image_;
  Wrap wrap_u_, wrap_v_;
  AlphaMode alpha_;
  float cutoff_;  // of the picture's own opacity
  std::vector<Level> levels_;
};

/// Filtered textures of a mesh's materials, opened on first use. One thread.
class MaterialSampler {
 public:
  MaterialSampler(std::span<const Material> materials, const std::function<const Image*(uint32_t)>& picture)
      : materials_(materials), picture_(picture) {}

  /// The material's colour times its texture's at the point; footprint_uv: the patch's side in texture coordinates.
  Light at(uint32_t material, const glm::vec2& texcoord, float footprint_uv);
  AlphaMode alpha_of(uint32_t material) const { return materials_[material].alpha; }

 private:
  FilteredTexture* texture_of(uint32_t material);

  std::span<const Material> materials_;
  const std::function<const Image*(uint32_t)>& picture_;
  std::map<uint32_t, std::optional<FilteredTexture>> textures_;  // by material; empty: none, or missing
};

}  // namespace promenade
