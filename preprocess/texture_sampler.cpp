#include "preprocess/texture_sampler.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <glm/common.hpp>

namespace promenade {
namespace {

// Clear texels weigh a little too, so that their colour survives where there is nothing else.
constexpr float kClearWeight = 1e-3F;
constexpr float kNotComputed = -1;

Light light_of(const glm::vec4& weighted) {
  const glm::vec3 light = glm::vec3(weighted) / weighted.a;
  return {light, std::clamp(weighted.a - kClearWeight, 0.0F, 1.0F)};
}

Light linear(const glm::u8vec4& c) {
  return {srgb_to_linear(c.r), srgb_to_linear(c.g), srgb_to_linear(c.b), float(c.a) / 255.0F};
}

/// Brings a coordinate near [0, 1] without changing what it shows, so that texel numbers stay small.
float reduced(float coordinate, Wrap wrap) {
  switch (wrap) {
    case Wrap::repeat:
      return coordinate - std::floor(coordinate);
    case Wrap::mirror:
      return coordinate - 2 * std::floor(coordinate / 2);
    case Wrap::clamp:
    default:
      return std::clamp(coordinate, 0.0F, 1.0F);
  }
}

/// The texel that shows at number i of an endless row.
uint32_t wrapped(int64_t i, uint32_t size, Wrap wrap) {
  const auto n = static_cast<int64_t>(size);
  if (wrap == Wrap::clamp) return static_cast<uint32_t>(std::clamp(i, int64_t(0), n - 1));
  const int64_t period = wrap == Wrap::mirror ? 2 * n : n;
  const int64_t in_period = ((i % period) + period) % period;
  return static_cast<uint32_t>(in_period < n ? in_period : period - 1 - in_period);
}

}  // namespace

FilteredTexture::FilteredTexture(const Image& image, const Material& material)
    : image_(image),
      wrap_u_(material.wrap_u),
      wrap_v_(material.wrap_v),
      alpha_(material.alpha),
      // The product of the picture's and the material's opacity is what the cut-off is compared with.
      cutoff_(float(material.alpha_cutoff) / std::max(float(material.color.a) / 255.0F, 1e-6F)) {
  for (uint32_t w = image.width, h = image.height;; w = std::max(1U, w / 2), h = std::max(1U, h / 2)) {
    levels_.push_back({w, h, {}});
    if (w == 1 && h == 1) break;
  }
}

glm::vec4 FilteredTexture::source_texel(uint32_t x, uint32_t y) const {
  Light light = linear(image_.at(x, y));
  if (alpha_ == AlphaMode::opaque) light.a = 1;
  if (alpha_ == AlphaMode::mask) light.a = float(image_.at(x, y).a) >= cutoff_ ? 1.0F : 0.0F;
  const float weight = light.a + kClearWeight;
  return {glm::vec3(light) * weight, weight};
}

glm::vec4 FilteredTexture::averaged(const Level& level, uint32_t x, uint32_t y) const {
  const auto bound = [](uint32_t i, uint32_t source, uint32_t size) {
    return static_cast<uint32_t>(uint64_t(i) * source / size);
  };
  const uint32_t x_end = bound(x + 1, image_.width, level.width), y_end = bound(y + 1, image_.height, level.height);
  glm::vec4 sum(0);
  float count = 0;
  for (uint32_t sy = bound(y, image_.height, level.height); sy < y_end; ++sy)
    for (uint32_t sx = bound(x, image_.width, level.width); sx < x_end; ++sx) {
      sum += source_texel(sx, sy);
      count += 1;
    }
  return sum / count;
}

glm::vec4 FilteredTexture::texel(size_t index, uint32_t x, uint32_t y) {
  if (index == 0) return source_texel(x, y);
  Level& level = levels_[index];
  if (level.texels.empty()) level.texels.assign(size_t(level.width) * level.height, glm::vec4(kNotComputed));
  glm::vec4& stored = level.texels[size_t(y) * level.width + x];
  if (stored.a < 0) stored = averaged(level, x, y);
  return stored;
}

Light FilteredTexture::at(const glm::vec2& texcoord, float footprint_px) {
  const float steps = std::floor(std::log2(std::max(footprint_px, 1.0F)) + 0.5F);
  const size_t index = std::min(static_cast<size_t>(std::min(steps, 64.0F)), levels_.size() - 1);
  const Level& level = levels_[index];
  const float u = reduced(texcoord.x, wrap_u_) * float(level.width) - 0.5F;
  const float v = reduced(texcoord.y, wrap_v_) * float(level.height) - 0.5F;
  const auto left = static_cast<int64_t>(std::floor(u)), top = static_cast<int64_t>(std::floor(v));
  const float right_share = u - std::floor(u), bottom_share = v - std::floor(v);
  const uint32_t x0 = wrapped(left, level.width, wrap_u_), x1 = wrapped(left + 1, level.width, wrap_u_);
  const uint32_t y0 = wrapped(top, level.height, wrap_v_), y1 = wrapped(top + 1, level.height, wrap_v_);
  const glm::vec4 upper = glm::mix(texel(index, x0, y0), texel(index, x1, y0), right_share);
  const glm::vec4 lower = glm::mix(texel(index, x0, y1), texel(index, x1, y1), right_share);
  return light_of(glm::mix(upper, lower, bottom_share));
}

FilteredTexture* MaterialSampler::texture_of(uint32_t material) {
  const auto known = textures_.find(material);
  if (known != textures_.end()) return known->second ? &*known->second : nullptr;
  std::optional<FilteredTexture>& texture = textures_[material];
  const Material& m = materials_[material];
  const Image* image = m.texture == kNoTexture ? nullptr : picture_(m.texture);
  if (image == nullptr || image->width == 0 || image->height == 0) return nullptr;
  texture.emplace(*image, m);
  return &*texture;
}

Light MaterialSampler::at(uint32_t material, const glm::vec2& texcoord, float footprint_uv) {
  const Material& m = materials_[material];
  Light light = linear(m.color);
  if (m.alpha == AlphaMode::opaque) light.a = 1;
  FilteredTexture* texture = texture_of(material);
  if (texture == nullptr) {
    if (m.alpha == AlphaMode::mask) light.a = m.color.a >= m.alpha_cutoff ? 1.0F : 0.0F;
    return light;
  }
  const Light sampled = texture->at(texcoord, footprint_uv * texture->side_px());
  if (m.alpha == AlphaMode::mask) return {glm::vec3(light) * glm::vec3(sampled), sampled.a};
  return light * sampled;
}

}  // namespace promenade
