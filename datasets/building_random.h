#pragma once
// The generators' own random numbers: integer arithmetic, so that a seed means the same bytes everywhere.

#include <cstdint>

namespace promenade {

/// SplitMix64 (Steele, Lea, Flood 2014): small, any seed is good. One thread.
class BuildingRandom {
 public:
  explicit BuildingRandom(uint64_t seed) : state_(seed) {}

  uint64_t next() {
    state_ += 0x9e3779b97f4a7c15ULL;
    uint64_t z = state_;
    z = (z ^ (z >> 30U)) * 0xbf58476d1ce4e5b9ULL;
    z = (z ^ (z >> 27U)) * 0x94d049bb133111ebULL;
    return z ^ (z >> 31U);
  }
  /// [0, 1), 53 bits.
  double unit() { return static_cast<double>(next() >> 11U) * 0x1p-53; }
  double between(double low, double high) { return low + (high - low) * unit(); }
  /// [0, count); count > 0. The bias of the remainder is below 2^-32 for any count used here.
  uint32_t below(uint32_t count) { return static_cast<uint32_t>((next() >> 32U) % count); }
  bool chance(double probability) { return unit() < probability; }

 private:
  uint64_t state_;
};

}  // namespace promenade
