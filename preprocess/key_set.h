#pragma once
// Scrambled numbers, and a set of them.

#include <cstddef>
#include <cstdint>
#include <vector>

namespace promenade {

/// splitmix64's finisher: a fixed scramble of a number.
inline uint64_t scramble(uint64_t z) {
  z += 0x9e3779b97f4a7c15ULL;
  z = (z ^ (z >> 30U)) * 0xbf58476d1ce4e5b9ULL;
  z = (z ^ (z >> 27U)) * 0x94d049bb133111ebULL;
  return z ^ (z >> 31U);
}

/// Scrambled keys that have been seen, in one array.
class KeySet {
 public:
  /// Whether the key is new. 0 counts as 1.
  bool insert(uint64_t key) {
    if (key == 0) key = 1;
    if (2 * (count_ + 1) > slots_.size()) grow();
    uint64_t& slot = slot_of(key);
    if (slot == key) return false;
    slot = key;
    ++count_;
    return true;
  }

 private:
  static constexpr size_t kFewest = 256;

  uint64_t& slot_of(uint64_t key) {
    size_t slot = key & (slots_.size() - 1);
    while (slots_[slot] != 0 && slots_[slot] != key) slot = (slot + 1) & (slots_.size() - 1);
    return slots_[slot];
  }

  void grow() {
    std::vector<uint64_t> old(slots_.empty() ? kFewest : slots_.size() * 2);
    old.swap(slots_);
    for (const uint64_t key : old)
      if (key != 0) slot_of(key) = key;
  }

  std::vector<uint64_t> slots_;  // open addressing; 0: free
  size_t count_ = 0;
};

}  // namespace promenade
