#include "codec/far_delta.h"

#include <algorithm>
#include <cstdlib>
#include <limits>

namespace promenade::far_coding {
namespace {

/// Of a colour's steps.
constexpr uint32_t kColorStep = 4;
/// What one colour and a shift of a pixel cost, in the unit of `roughness`: measured, the sum of bytes is flat around.
constexpr uint32_t kColorCost = 150, kShiftCost = 12;

/// Brightness with a border as wide as shifts reach, its outermost pixels repeated.
class Luma {
 public:
  Luma(const Image& image, uint32_t border) : border_(border), width_(image.width + 2 * border) {
    // Blocks at the right and the lower rim reach beyond the picture.
    const uint32_t height = image.height + 2 * border + kBlockPx;
    width_ += kBlockPx;
    values_.resize(size_t(width_) * height);
    for (uint32_t y = 0; y < height; ++y)
      for (uint32_t x = 0; x < width_; ++x) {
        const uint32_t from_x = std::min(std::max(x, border) - border, image.width - 1);
        const uint32_t from_y = std::min(std::max(y, border) - border, image.height - 1);
        const glm::u8vec4& p = image.at(from_x, from_y);
        values_[size_t(y) * width_ + x] = static_cast<uint8_t>((77 * p.r + 150 * p.g + 29 * p.b) >> 8);
      }
  }
  const uint8_t* at(int64_t x, int64_t y) const {
    return values_.data() + (y + border_) * int64_t(width_) + x + border_;
  }
  size_t stride() const { return width_; }

 private:
  uint32_t border_, width_;
  std::vector<uint8_t> values_;
};

uint32_t absolute_difference(const uint8_t* a, size_t a_stride, const uint8_t* b, size_t b_stride) {
  uint32_t sum = 0;
  for (uint32_t y = 0; y < kBlockPx; ++y, a += a_stride, b += b_stride)
    for (uint32_t x = 0; x < kBlockPx; ++x) sum += static_cast<uint32_t>(std::abs(int32_t(a[x]) - int32_t(b[x])));
  return sum;
}

/// About what a block's differences cost to code: the magnitudes of their Hadamard transform, 8 x 8, the first of each
/// (the mean) for a quarter. b may be null: nothing is subtracted.
uint32_t roughness(const uint8_t* a, size_t a_stride, const uint8_t* b, size_t b_stride) {
  uint32_t sum = 0;
  for (uint32_t part = 0; part < 4; ++part) {
    const uint32_t left = part % 2 * 8, top = part / 2 * 8;
    std::array<std::array<int32_t, 8>, 8> m;
    for (uint32_t y = 0; y < 8; ++y)
      for (uint32_t x = 0; x < 8; ++x) {
        const size_t column = left + x, row = top + y;
        m[y][x] = int32_t(a[row * a_stride + column]) - (b != nullptr ? int32_t(b[row * b_stride + column]) : 0);
      }
    for (uint32_t half = 1; half < 8; half *= 2)
      for (uint32_t i = 0; i < 8; ++i)
        if ((i & half) == 0)
          for (uint32_t k = 0; k < 8; ++k) {
            const int32_t p = m[i][k], q = m[i | half][k];
            m[i][k] = p + q, m[i | half][k] = p - q;
          }
    for (uint32_t half = 1; half < 8; half *= 2)
      for (uint32_t k = 0; k < 8; ++k)
        for (uint32_t i = 0; i < 8; ++i)
          if ((i & half) == 0) {
            const int32_t p = m[k][i], q = m[k][i | half];
            m[k][i] = p + q, m[k][i | half] = p - q;
          }
    for (const auto& row : m)
      for (const int32_t value : row) sum += static_cast<uint32_t>(std::abs(value));
    const auto mean = static_cast<uint32_t>(std::abs(m[0][0]));
    sum -= b != nullptr ? mean / 4 * 3 : mean;
  }
  return sum / 8;
}

uint32_t shift_cost(const Block& b, const Block& last) {
  return kShiftCost *
         static_cast<uint32_t>(std::min(4, std::abs(b.dx - last.dx)) + std::min(4, std::abs(b.dy - last.dy)));
}

/// Something is in the block, or beside it: filters reach that far.
bool matters(const Image& colors, uint32_t left, uint32_t top) {
  const uint32_t x0 = left > 0 ? left - 1 : 0, y0 = top > 0 ? top - 1 : 0;
  for (uint32_t y = y0; y < std::min(top + kBlockPx + 1, colors.height); ++y)
    for (uint32_t x = x0; x < std::min(left + kBlockPx + 1, colors.width); ++x)
      if (colors.at(x, y).a != 0) return true;
  return false;
}

std::array<uint8_t, 3> mean_color(const Image& colors, uint32_t left, uint32_t top) {
  std::array<uint32_t, 3> sum{};
  uint32_t count = 0;
  for (uint32_t y = top; y < std::min(top + kBlockPx, colors.height); ++y)
    for (uint32_t x = left; x < std::min(left + kBlockPx, colors.width); ++x, ++count) {
      const glm::u8vec4& p = colors.at(x, y);
      sum[0] += p.r, sum[1] += p.g, sum[2] += p.b;
    }
  std::array<uint8_t, 3> mean{};
  for (size_t c = 0; c < 3; ++c) mean[c] = static_cast<uint8_t>(sum[c] / count / kColorStep);
  return mean;
}

}  // namespace

std::vector<Block> choose_blocks(const Image& colors, const Image& foretold, bool shifts) {
  const int32_t reach = shifts ? kMostShiftPx : 0;
  const Luma wanted(colors, 0), there(foretold, kMostShiftPx);
  const uint32_t across = blocks_across(colors.width);
  std::vector<Block> blocks(size_t(across) * across);
  Block last;
  for (size_t i = 0; i < blocks.size(); ++i) {
    const uint32_t left = static_cast<uint32_t>(i % across) * kBlockPx;
    const uint32_t top = static_cast<uint32_t>(i / across) * kBlockPx;
    Block& b = blocks[i];
    b.dx = last.dx, b.dy = last.dy;
    if (!matters(colors, left, top)) continue;
    const uint8_t* a = wanted.at(left, top);
    const auto cost_at = [&](const Block& block) {
      return roughness(a, wanted.stride(), there.at(int64_t(left) + block.dx, int64_t(top) + block.dy),
                       there.stride()) +
             shift_cost(block, last);
    };
    Block moved;
    uint32_t least = std::numeric_limits<uint32_t>::max();
    for (int32_t dy = -reach; dy <= reach; ++dy)
      for (int32_t dx = -reach; dx <= reach; ++dx) {
        Block tried;
        tried.dx = dx, tried.dy = dy;
        const uint32_t sum =
            absolute_difference(a, wanted.stride(), there.at(int64_t(left) + dx, int64_t(top) + dy), there.stride()) +
            shift_cost(tried, last);
        if (sum < least) least = sum, moved = tried;
      }
    Block straight;
    uint32_t cost = cost_at(b);
    for (const Block& tried : {straight, moved})
      if (const uint32_t c = cost_at(tried); c < cost) cost = c, b.dx = tried.dx, b.dy = tried.dy;
    if (roughness(a, wanted.stride(), nullptr, 0) + kColorCost < cost) {
      b = {};
      b.foretold = false, b.color = mean_color(colors, left, top);
    } else {
      last.dx = b.dx, last.dy = b.dy;
    }
  }
  return blocks;
}

Image base_of(const std::vector<Block>& blocks, const Image& foretold) {
  const uint32_t side = foretold.width, across = blocks_across(side);
  const auto most = static_cast<int32_t>(side) - 1;
  Image base{side, side, std::vector<glm::u8vec4>(foretold.pixels.size())};
  for (uint32_t y = 0; y < side; ++y)
    for (uint32_t x = 0; x < side; ++x) {
      const Block& b = blocks[size_t(y / kBlockPx) * across + x / kBlockPx];
      if (b.foretold) {
        const int32_t from_x = std::clamp(static_cast<int32_t>(x) + b.dx, 0, most);
        const int32_t from_y = std::clamp(static_cast<int32_t>(y) + b.dy, 0, most);
        base.at(x, y) = foretold.at(static_cast<uint32_t>(from_x), static_cast<uint32_t>(from_y));
      } else {
        const auto value = [&](size_t c) { return static_cast<uint8_t>(b.color[c] * kColorStep + kColorStep / 2); };
        base.at(x, y) = {value(0), value(1), value(2), 255};
      }
    }
  return base;
}

void flatten_empty_blocks(const Image& there, Image& colors) {
  const uint32_t across = blocks_across(colors.width);
  glm::u8vec4 flat(128, 128, 128, 255);
  for (uint32_t row = 0; row < across; ++row)
    for (uint32_t column = 0; column < across; ++column) {
      const uint32_t left = column * kBlockPx, top = row * kBlockPx;
      if (matters(there, left, top)) {
        const std::array<uint8_t, 3> mean = mean_color(colors, left, top);
        for (int c = 0; c < 3; ++c) flat[c] = static_cast<uint8_t>(mean[static_cast<size_t>(c)] * kColorStep);
        continue;
      }
      for (uint32_t y = top; y < std::min(top + kBlockPx, colors.height); ++y)
        for (uint32_t x = left; x < std::min(left + kBlockPx, colors.width); ++x) colors.at(x, y) = flat;
    }
}

Image differences(const Image& colors, const Image& base) {
  Image out{colors.width, colors.height, std::vector<glm::u8vec4>(colors.pixels.size(), {128, 128, 128, 255})};
  const uint32_t across = blocks_across(colors.width);
  for (uint32_t row = 0; row < across; ++row)
    for (uint32_t column = 0; column < across; ++column) {
      const uint32_t left = column * kBlockPx, top = row * kBlockPx;
      if (!matters(colors, left, top)) continue;
      for (uint32_t y = top; y < std::min(top + kBlockPx, colors.height); ++y)
        for (uint32_t x = left; x < std::min(left + kBlockPx, colors.width); ++x) {
          const glm::u8vec4 &is = colors.at(x, y), &was = base.at(x, y);
          for (int c = 0; c < 3; ++c)
            out.at(x, y)[c] = static_cast<uint8_t>(std::clamp(int32_t(is[c]) - was[c] + 128, 0, 255));
        }
    }
  return out;
}

void add_differences(const Image& differences, Image& base) {
  for (size_t i = 0; i < base.pixels.size(); ++i) {
    const glm::u8vec4& d = differences.pixels[i];
    glm::u8vec4& p = base.pixels[i];
    for (int c = 0; c < 3; ++c) p[c] = static_cast<uint8_t>(std::clamp(int32_t(p[c]) + d[c] - 128, 0, 255));
    p.a = d.a;
  }
}

}  // namespace promenade::far_coding
