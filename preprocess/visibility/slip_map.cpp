#include "preprocess/visibility/slip_map.h"

#include <algorithm>

namespace promenade {

SlipMap::SlipMap(uint32_t nx, uint32_t ny) : blocks_x_((nx + kSide - 1) / kSide), blocks_y_((ny + kSide - 1) / kSide) {
  for (Way& way : ways_) way.blocks.assign(blocks_x_ * blocks_y_, 0);
}

void SlipMap::add(size_t way, size_t x, size_t y) {
  ways_[way].blocks[y / kSide * blocks_x_ + x / kSide] |= uint64_t(1) << (y % kSide * kSide + x % kSide);
}

void SlipMap::complete() {
  const size_t row = blocks_x_ + 1;
  for (Way& way : ways_) {
    way.sums.assign(row * (blocks_y_ + 1), 0);
    for (size_t y = 1; y <= blocks_y_; ++y)
      for (size_t x = 1; x <= blocks_x_; ++x)
        way.sums[y * row + x] = way.sums[(y - 1) * row + x] + way.sums[y * row + x - 1] -
                                way.sums[(y - 1) * row + x - 1] +
                                (way.blocks[(y - 1) * blocks_x_ + x - 1] != 0 ? 1 : 0);
  }
}

bool SlipMap::surely_none(size_t way, size_t x0, size_t y0, size_t x1, size_t y1) const {
  const Way& of_way = ways_[way];
  const size_t row = blocks_x_ + 1;
  const size_t bx0 = x0 / kSide, by0 = y0 / kSide, bx1 = (x1 + kSide - 1) / kSide, by1 = (y1 + kSide - 1) / kSide;
  const std::vector<uint32_t>& sums = of_way.sums;
  if (sums[by1 * row + bx1] + sums[by0 * row + bx0] == sums[by0 * row + bx1] + sums[by1 * row + bx0]) return true;
  if (x1 - x0 > kSide || y1 - y0 > kSide) return false;
  for (size_t by = by0; by < by1; ++by)
    for (size_t bx = bx0; bx < bx1; ++bx) {
      const uint64_t block = of_way.blocks[by * blocks_x_ + bx];
      if (block == 0) continue;
      for (size_t y = std::max(y0, by * kSide); y < std::min(y1, (by + 1) * kSide); ++y)
        for (size_t x = std::max(x0, bx * kSide); x < std::min(x1, (bx + 1) * kSide); ++x)
          if ((block >> (y % kSide * kSide + x % kSide) & 1U) != 0) return false;
    }
  return true;
}

}  // namespace promenade
