#pragma once
// A hash set of things that lie in an array and are known by their place in it.

#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace promenade {

inline uint64_t mixed_bits(uint64_t x) {
  x = (x ^ (x >> 32)) * 0xd6e8feb86659fd93U;
  x = (x ^ (x >> 32)) * 0xd6e8feb86659fd93U;
  return x ^ (x >> 32);
}

/// Four bytes a slot; equality and hash are the caller's, who holds the things. Indices stay below 2^32 - 1.
class IndexTable {
 public:
  explicit IndexTable(size_t expected) { slots_.assign(std::bit_ceil(expected + expected / 2 + 16), kNone); }

  /// The equal thing that was there before, or `index` itself, which is there now.
  template <class Hash, class Equal>
  uint32_t find_or_add(uint32_t index, Hash hash, Equal equal) {
    if (used_ + 1 > slots_.size() / 8 * 7) grow(hash);
    size_t at = hash(index) & (slots_.size() - 1);
    for (; slots_[at] != kNone; at = (at + 1) & (slots_.size() - 1))
      if (equal(slots_[at], index)) return slots_[at];
    slots_[at] = index;
    ++used_;
    return index;
  }

 private:
  static constexpr uint32_t kNone = 0xffffffffU;

  template <class Hash>
  void grow(Hash hash) {
    std::vector<uint32_t> old(slots_.size() * 2, kNone);
    old.swap(slots_);
    for (const uint32_t index : old) {
      if (index == kNone) continue;
      size_t at = hash(index) & (slots_.size() - 1);
      while (slots_[at] != kNone) at = (at + 1) & (slots_.size() - 1);
      slots_[at] = index;
    }
  }

  std::vector<uint32_t> slots_;
  size_t used_ = 0;
};

}  // namespace promenade
