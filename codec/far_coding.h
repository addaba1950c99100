#pragma once
// The decisions of a far picture's side, as encoder and decoder of its parts share them. Not for others.

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>

#include "codec/range_coder.h"
#include "geometry/halved_grid.h"

namespace promenade::far_coding {

/// Contexts of all decisions of a face. Encoder and decoder go through the same ones.
struct Models {
  static constexpr size_t kLevels = HalvedGrid::kMostLevels * 2 + 2;
  static constexpr size_t kDepthBits = 17;  // of a difference, and one for 0
  std::array<BitModel, 512> there;
  std::array<std::array<BitModel, 2>, kLevels> kept;
  std::array<std::array<BitModel, kDepthBits + 1>, kLevels> magnitude;
  std::array<BitModel, kLevels> sign;
  std::array<std::array<BitModel, 4>, kDepthBits + 1> mantissa;  ///< its highest bits; those below share the last
};

/// Both ends of the coder have put(model, bit) in common: a decoder's returns what it reads and ignores the bit.
struct Putter {
  RangeEncoder& coder;
  uint32_t operator()(BitModel& model, uint32_t bit) { return coder.put(model, bit), bit; }
};
struct Getter {
  RangeDecoder& coder;
  uint32_t operator()(BitModel& model, uint32_t) { return coder.get(model); }
};

/// A difference: how many bits it has, its sign, the bits below the highest.
template <class Coder>
int32_t code_difference(Coder& code, Models& models, size_t level, int32_t difference) {
  const auto magnitude = static_cast<uint32_t>(difference < 0 ? -difference : difference);
  const auto bits = static_cast<uint32_t>(std::bit_width(magnitude));
  uint32_t n = 0;
  while (n < Models::kDepthBits && code(models.magnitude[level][n], n < bits ? 1U : 0U) != 0) ++n;
  if (n == 0) return 0;
  const bool negative = code(models.sign[level], difference < 0 ? 1U : 0U) != 0;
  uint32_t value = 1;
  for (uint32_t i = 1; i < n; ++i)
    value = value << 1 | code(models.mantissa[n][std::min(i - 1, 3U)], magnitude >> (n - 1 - i) & 1U);
  return negative ? -static_cast<int32_t>(value) : static_cast<int32_t>(value);
}

}  // namespace promenade::far_coding
