#include <algorithm>
#include <array>
#include <limits>
#include <numeric>

#include "layout/order_rivals.h"

namespace promenade {
namespace {

constexpr unsigned kBits = 21;  // three of them in a number of 64
using Grid = std::array<uint32_t, 3>;

uint64_t interleaved(const Grid& grid) {
  uint64_t code = 0;
  for (unsigned bit = kBits; bit-- > 0;)
    for (const uint32_t axis : grid) code = code << 1 | (axis >> bit & 1U);
  return code;
}

/// Coordinates to the transposed index along Hilbert's curve, in place.
void to_hilbert(Grid& x) {
  constexpr uint32_t kTop = 1U << (kBits - 1);
  for (uint32_t q = kTop; q > 1; q >>= 1) {
    const uint32_t low = q - 1;
    for (uint32_t& axis : x) {
      if ((axis & q) != 0) {
        x[0] ^= low;
      } else {
        const uint32_t t = (x[0] ^ axis) & low;
        x[0] ^= t, axis ^= t;
      }
    }
  }
  x[1] ^= x[0], x[2] ^= x[1];
  uint32_t t = 0;
  for (uint32_t q = kTop; q > 1; q >>= 1)
    if ((x[2] & q) != 0) t ^= q - 1;
  for (uint32_t& axis : x) axis ^= t;
}

template <class Code>
ColumnOrder order_by(std::span<const glm::vec3> points, const Code& code_of) {
  glm::vec3 low(std::numeric_limits<float>::max()), high(std::numeric_limits<float>::lowest());
  for (const glm::vec3& p : points)
    for (int i = 0; i < 3; ++i) low[i] = std::min(low[i], p[i]), high[i] = std::max(high[i], p[i]);
  std::vector<uint64_t> codes;
  for (const glm::vec3& p : points) {
    Grid grid{};
    for (int i = 0; i < 3; ++i) {
      const double extent = double(high[i]) - low[i];
      const double part = extent > 0 ? (double(p[i]) - low[i]) / extent : 0;
      grid[static_cast<size_t>(i)] = static_cast<uint32_t>(part * ((1U << kBits) - 1));
    }
    codes.push_back(code_of(grid));
  }
  ColumnOrder order(points.size());
  std::iota(order.begin(), order.end(), 0U);
  std::stable_sort(order.begin(), order.end(), [&codes](uint32_t a, uint32_t b) { return codes[a] < codes[b]; });
  return order;
}

}  // namespace

ColumnOrder morton_order(std::span<const glm::vec3> points) { return order_by(points, interleaved); }

ColumnOrder hilbert_order(std::span<const glm::vec3> points) {
  return order_by(points, [](Grid grid) {
    to_hilbert(grid);
    return interleaved(grid);
  });
}

}  // namespace promenade
