#pragma once
// Where a side of a far picture shows something.

#include <algorithm>
#include <cstdint>
#include <vector>

#include "codec/far_face.h"

namespace promenade {

/// How many pixels of a face show something, in any rectangle. Vertices by their index in its grid.
class FarCoverage {
 public:
  explicit FarCoverage(const FarFace& face)
      : grid_(face.grid), sums_(size_t(grid_.side() + 1) * (grid_.side() + 1), 0) {
    const uint32_t side = grid_.side();
    for (uint32_t y = 0; y < side; ++y)
      for (uint32_t x = 0; x < side; ++x)
        sum(x + 1, y + 1) = sum(x, y + 1) + sum(x + 1, y) - sum(x, y) + (face.colors.at(x, y).a != 0 ? 1U : 0U);
  }

  /// Within the triangle's rectangle and a pixel around it: filtering reaches that far.
  bool any(uint32_t a, uint32_t b, uint32_t c) const { return count(a, b, c).there != 0; }
  /// The same, all of them. `reach` pixels around: coarser pictures of the face have filters that reach farther.
  bool all(uint32_t a, uint32_t b, uint32_t c, uint32_t reach) const {
    const Count found = count(a, b, c, reach);
    return found.there == found.pixels;
  }

 private:
  struct Count {
    uint32_t there = 0, pixels = 0;
  };
  Count count(uint32_t a, uint32_t b, uint32_t c, uint32_t reach = 1) const {
    const uint32_t side = grid_.side();
    const auto [x0, x1] = std::minmax({a % side, b % side, c % side});
    const auto [y0, y1] = std::minmax({a / side, b / side, c / side});
    const uint32_t left = x0 > reach ? x0 - reach : 0, top = y0 > reach ? y0 - reach : 0;
    const uint32_t right = std::min(x1 + reach + 1, side), bottom = std::min(y1 + reach + 1, side);
    return {sum(right, bottom) + sum(left, top) - sum(left, bottom) - sum(right, top), (right - left) * (bottom - top)};
  }

  uint32_t& sum(uint32_t x, uint32_t y) { return sums_[size_t(y) * (grid_.side() + 1) + x]; }
  uint32_t sum(uint32_t x, uint32_t y) const { return sums_[size_t(y) * (grid_.side() + 1) + x]; }

  HalvedGrid grid_;
  std::vector<uint32_t> sums_;
};

}  // namespace promenade
