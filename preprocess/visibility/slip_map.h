#pragma once
// Squares of the ground with something in them, by the way that a ray goes there: a bit each, and counts of them by
// blocks, so that a city of kilometres takes less than a byte a square.

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace promenade {

/// Filled by one thread, then asked by any.
class SlipMap {
 public:
  static constexpr size_t kWays = 4;  ///< towards +x, -x, +y, -y

  SlipMap() = default;
  SlipMap(uint32_t nx, uint32_t ny);
  void add(size_t way, size_t x, size_t y);
  /// After the last add().
  void complete();

  /// Whether no square from x0, y0 to before x1, y1 has something. Always right where it says so, and where neither
  /// side is longer than eight squares.
  bool surely_none(size_t way, size_t x0, size_t y0, size_t x1, size_t y1) const;

  bool operator==(const SlipMap&) const = default;

 private:
  static constexpr size_t kSide = 8;  // squares a side of a block, whose squares fill a word
  struct Way {
    std::vector<uint64_t> blocks;  ///< x fastest, and so are the bits of each
    std::vector<uint32_t> sums;    ///< summed areas of blocks with something: one more row and column than blocks
    bool operator==(const Way&) const = default;
  };
  size_t blocks_x_ = 0, blocks_y_ = 0;
  std::array<Way, kWays> ways_;
};

}  // namespace promenade
