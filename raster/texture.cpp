#include "raster/texture.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace promenade {

namespace {

using raster_kernel::kMaxMipLevels;
constexpr uint32_t kMaxTextureSide = MipTexture::kMaxSide;

using Texel = MipTexture::Texel;

const std::array<float, 256>& linear_table() {
  static const std::array<float, 256> table = [] {
    std::array<float, 256> t{};
    for (uint32_t i = 0; i < 256; ++i) t[i] = srgb_to_linear(static_cast<uint8_t>(i));
    return t;
  }();
  return table;
}

/// To the nearest, of what is not negative: lround would be a call a texel.
uint32_t rounded(float value) {
  return static_cast<uint32_t>(value + 0.5F);  // NOLINT(bugprone-incorrect-roundings)
}

uint32_t root(float linear) { return rounded(std::sqrt(std::min(linear, 1.0F)) * 1023.0F); }

const std::array<uint32_t, 256>& root_table() {
  static const std::array<uint32_t, 256> table = [] {
    std::array<uint32_t, 256> t{};
    for (uint32_t i = 0; i < 256; ++i) t[i] = root(linear_table()[i]);
    return t;
  }();
  return table;
}

/// The mean of four texels: colours by their opacity, so that what is not there does not bleed.
Texel mean(const std::array<Texel, 4>& texels) {
  Texel out = {};
  float weight = 0;
  for (const Texel& t : texels) {
    const float w = t.opacity + 1.0F / 4096;  // never 0: a clear texel among clear ones keeps its colour
    weight += w, out.opacity += t.opacity * 0.25F;
    for (size_t c = 0; c < 3; ++c) out.color[c] += t.color[c] * w;
  }
  for (float& c : out.color) c /= weight;
  return out;
}

/// The same where all are opaque.
Texel opaque_mean(const std::array<Texel, 4>& t) {
  Texel out = {};
  for (size_t c = 0; c < 3; ++c)
    out.color[c] = ((t[0].color[c] + t[1].color[c]) + (t[2].color[c] + t[3].color[c])) * 0.25F;
  out.opacity = 1;
  return out;
}

/// The next level. texel(i): of the one before, row by row.
template <class From>
std::vector<Texel> halved(const From& texel, uint32_t width, uint32_t height, bool opaque) {
  const uint32_t w = std::max(1U, width / 2), h = std::max(1U, height / 2);
  std::vector<Texel> to(size_t(w) * h);
  for (uint32_t y = 0; y < h; ++y) {
    const size_t a = size_t(std::min(2 * y, height - 1)) * width, b = size_t(std::min(2 * y + 1, height - 1)) * width;
    for (uint32_t x = 0; x < w; ++x) {
      const uint32_t l = std::min(2 * x, width - 1), r = std::min(2 * x + 1, width - 1);
      const std::array<Texel, 4> four = {texel(a + l), texel(a + r), texel(b + l), texel(b + r)};
      to[size_t(y) * w + x] = opaque ? opaque_mean(four) : mean(four);
    }
  }
  return to;
}

}  // namespace

void MipTexture::store_level(uint32_t level, const std::vector<Texel>& from, uint32_t width) {
  size_t to = view_.level_offset[level];
  for (size_t row = 0; row < from.size(); row += width) {
    for (uint32_t x = 0; x <= width; ++x, ++to) {
      const Texel& t = from[row + (x == width ? 0 : x)];
      texels_[to] = static_cast<int32_t>(root(t.color[0]) | root(t.color[1]) << 10 | root(t.color[2]) << 20);
      if (!opacity_.empty()) opacity_[to] = static_cast<uint8_t>(rounded(t.opacity * 255.0F));
    }
  }
}

void MipTexture::store_picture(const Image& image) {
  const std::array<uint32_t, 256>& roots = root_table();
  size_t to = 0;
  for (size_t row = 0; row < image.pixels.size(); row += image.width) {
    for (uint32_t x = 0; x <= image.width; ++x, ++to) {
      const glm::u8vec4& p = image.pixels[row + (x == image.width ? 0 : x)];
      texels_[to] = static_cast<int32_t>(roots[p.r] | roots[p.g] << 10 | roots[p.b] << 20);
      if (!opacity_.empty()) opacity_[to] = p.a;
    }
  }
}

Result<MipTexture> MipTexture::make(const Image& image, uint32_t largest_side) {
  if (image.width == 0 || image.height == 0 || image.width > kMaxTextureSide || image.height > kMaxTextureSide)
    return Error{"texture of " + std::to_string(image.width) + " x " + std::to_string(image.height) +
                 " pixels: sides must be 1 to " + std::to_string(kMaxTextureSide)};
  if (image.pixels.size() != size_t(image.width) * image.height)
    return Error{"texture of " + std::to_string(image.width) + " x " + std::to_string(image.height) + " has " +
                 std::to_string(image.pixels.size()) + " pixels"};
  MipTexture t;
  uint32_t left_out = 0;  // of the finest levels
  while (std::max(image.width, image.height) >> left_out > std::max(1U, largest_side)) ++left_out;
  t.view_.width = std::max(1U, image.width >> left_out), t.view_.height = std::max(1U, image.height >> left_out);
  size_t total = 0;
  for (uint32_t w = t.view_.width, h = t.view_.height; t.view_.levels < kMaxMipLevels;
       w = std::max(1U, w / 2), h = std::max(1U, h / 2)) {
    t.view_.level_width[t.view_.levels] = static_cast<float>(w);
    t.view_.level_height[t.view_.levels] = static_cast<float>(h);
    t.view_.level_offset[t.view_.levels++] = static_cast<uint32_t>(total);
    total += size_t(w + 1) * h;
    if (w == 1 && h == 1) break;
  }
  const bool clear =
      std::any_of(image.pixels.begin(), image.pixels.end(), [](const glm::u8vec4& p) { return p.a != 255; });
  t.texels_.resize(total);
  if (clear) t.opacity_.resize(total);
  if (left_out == 0) t.store_picture(image);
  const std::array<float, 256>& linear = linear_table();
  std::vector<Texel> level;
  for (uint32_t l = 1; l < t.view_.levels + left_out; ++l) {
    const uint32_t width = std::max(1U, image.width >> (l - 1)), height = std::max(1U, image.height >> (l - 1));
    if (l == 1) {
      const auto texel = [&](size_t i) {
        const glm::u8vec4& p = image.pixels[i];
        return Texel{{linear[p.r], linear[p.g], linear[p.b]}, static_cast<float>(p.a) / 255.0F};
      };
      level = halved(texel, width, height, !clear);
    } else {
      level = halved([&](size_t i) { return level[i]; }, width, height, !clear);
    }
    if (l >= left_out) t.store_level(l - left_out, level, std::max(1U, image.width >> l));
  }
  t.view_.texels = t.texels_.data();
  t.view_.opacity = clear ? t.opacity_.data() : nullptr;
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
