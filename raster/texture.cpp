#include "raster/texture.h"

#include <algorithm>
#include <array>

namespace promenade {

namespace {

using raster_kernel::kMaxMipLevels;
constexpr uint32_t kMaxTextureSide = 32768;  // its levels fit kMaxMipLevels

uint32_t packed(const glm::u8vec4& c) {
  return uint32_t(c.r) | uint32_t(c.g) << 8 | uint32_t(c.b) << 16 | uint32_t(c.a) << 24;
}

const std::array<float, 256>& linear_table() {
  static const std::array<float, 256> table = [] {
    std::array<float, 256> t{};
    for (uint32_t i = 0; i < 256; ++i) t[i] = srgb_to_linear(static_cast<uint8_t>(i));
    return t;
  }();
  return table;
}

/// sRGB of a linear value by a table of its first 12 bits.
uint8_t quick_srgb(float value) {
  static const std::array<uint8_t, 4097> table = [] {
    std::array<uint8_t, 4097> t{};
    for (uint32_t i = 0; i <= 4096; ++i) t[i] = linear_to_srgb(static_cast<float>(i) / 4096.0F);
    return t;
  }();
  return table[static_cast<size_t>(std::clamp(value, 0.0F, 1.0F) * 4096.0F + 0.5F)];
}

/// The mean of four texels: colours by their opacity, so that what is not there does not bleed.
uint32_t mean(const std::array<uint32_t, 4>& texels) {
  const std::array<float, 256>& linear = linear_table();
  if (texels[0] == texels[1] && texels[0] == texels[2] && texels[0] == texels[3]) return texels[0];
  std::array<float, 3> sum{};
  float weight = 0;
  uint32_t opacity = 0;
  for (const uint32_t t : texels) {
    const float w = static_cast<float>(t >> 24) + 1.0F / 64;  // never 0: a clear texel among clear ones keeps its colour
    opacity += t >> 24, weight += w;
    for (uint32_t c = 0; c < 3; ++c) sum[c] += linear[t >> (8 * c) & 255U] * w;
  }
  uint32_t out = (opacity + 2) / 4 << 24;
  for (uint32_t c = 0; c < 3; ++c) out |= uint32_t(quick_srgb(sum[c] / weight)) << (8 * c);
  return out;
}

void halve(const uint32_t* from, uint32_t width, uint32_t height, uint32_t* to) {
  const uint32_t w = std::max(1U, width / 2), h = std::max(1U, height / 2);
  for (uint32_t y = 0; y < h; ++y) {
    const uint32_t* a = from + size_t(std::min(2 * y, height - 1)) * width;
    const uint32_t* b = from + size_t(std::min(2 * y + 1, height - 1)) * width;
    for (uint32_t x = 0; x < w; ++x) {
      const uint32_t l = std::min(2 * x, width - 1), r = std::min(2 * x + 1, width - 1);
      to[size_t(y) * w + x] = mean({a[l], a[r], b[l], b[r]});
    }
  }
}

}  // namespace

Result<MipTexture> MipTexture::make(const Image& image) {
  if (image.width == 0 || image.height == 0 || image.width > kMaxTextureSide || image.height > kMaxTextureSide)
    return Error{"texture of " + std::to_string(image.width) + " x " + std::to_string(image.height) +
                 " pixels: sides must be 1 to " + std::to_string(kMaxTextureSide)};
  if (image.pixels.size() != size_t(image.width) * image.height)
    return Error{"texture of " + std::to_string(image.width) + " x " + std::to_string(image.height) + " has " +
                 std::to_string(image.pixels.size()) + " pixels"};
  MipTexture t;
  t.view_.width = image.width, t.view_.height = image.height;
  size_t total = 0;
  for (uint32_t w = image.width, h = image.height; t.view_.levels < kMaxMipLevels; w = std::max(1U, w / 2), h = std::max(1U, h / 2)) {
    t.view_.level_offset[t.view_.levels++] = static_cast<uint32_t>(total);
    total += size_t(w) * h;
    if (w == 1 && h == 1) break;
  }
  t.texels_.resize(total);
  std::transform(image.pixels.begin(), image.pixels.end(), t.texels_.begin(), packed);
  for (uint32_t level = 1; level < t.view_.levels; ++level)
    halve(&t.texels_[t.view_.level_offset[level - 1]], std::max(1U, image.width >> (level - 1)),
          std::max(1U, image.height >> (level - 1)), &t.texels_[t.view_.level_offset[level]]);
  t.view_.texels = t.texels_.data();
  return t;
}

SurfaceTable::SurfaceTable(std::span<const Material> materials, std::span<const MipTexture* const> textures) {
  surfaces_.reserve(materials.size());
  for (const Material& m : materials) {
    raster_kernel::Surface s = {};
    const MipTexture* texture = m.texture < textures.size() ? textures[m.texture] : nullptr;
    s.texture = texture == nullptr ? nullptr : &texture->view();
    for (int c = 0; c < 3; ++c) s.color[c] = srgb_to_linear(m.color[c]);
    s.color[3] = static_cast<float>(m.color.a) / 255.0F;
    s.wrap_u = static_cast<uint8_t>(m.wrap_u), s.wrap_v = static_cast<uint8_t>(m.wrap_v);
    s.alpha = static_cast<uint8_t>(m.alpha);
    s.alpha_cutoff = static_cast<float>(m.alpha_cutoff) / 255.0F;
    surfaces_.push_back(s);
  }
}

}  // namespace promenade
