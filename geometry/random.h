#pragma once
// Random numbers that are the same everywhere: integers only underneath, seeded by what they are for.

#include <cstdint>
#include <initializer_list>

namespace promenade {

/// A stream of random numbers. Streams with different tags are independent, so that what one part of a program draws
/// never moves what another one gets. Source: Steele, Lea, Flood, "Fast splittable pseudorandom number generators",
/// 2014 (SplitMix64).
class Random {
 public:
  explicit Random(uint64_t seed, std::initializer_list<uint64_t> tags = {}) : state_(mix(seed + kStep)) {
    for (const uint64_t tag : tags) state_ = mix(state_ ^ mix(tag + kStep));
  }

  /// A stream of its own for one part; does not advance this one.
  Random fork(uint64_t tag) const { return Random(state_, {tag}); }

  uint64_t next() { return mix(state_ += kStep); }
  /// [0, 1)
  double unit() { return static_cast<double>(next() >> 11) * 0x1p-53; }
  double range(double low, double high) { return low + (high - low) * unit(); }
  float range(float low, float high) { return low + (high - low) * static_cast<float>(unit()); }
  /// [0, count); count > 0. The bias is below count / 2^32.
  uint32_t below(uint32_t count) { return static_cast<uint32_t>(((next() >> 32) * count) >> 32); }
  /// Both ends included.
  int between(int low, int high) { return low + static_cast<int>(below(static_cast<uint32_t>(high - low + 1))); }
  bool chance(double probability) { return unit() < probability; }

 private:
  static constexpr uint64_t kStep = 0x9e3779b97f4a7c15;
  static constexpr uint64_t mix(uint64_t z) {
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9;
    z = (z ^ (z >> 27)) * 0x94d049bb133111eb;
    return z ^ (z >> 31);
  }
  uint64_t state_;
};

}  // namespace promenade
