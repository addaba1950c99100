#pragma once
// A priority queue of numbered things whose costs change.

#include <bit>
#include <cstdint>
#include <limits>
#include <vector>

namespace promenade {

/// Items 0 to n - 1, each in the queue at most once, cheapest first, ties by number: the same order everywhere.
/// A four-ary heap: shallower, and the children compared lie in one cache line.
class CostQueue {
 public:
  explicit CostQueue(uint32_t items) : place_(items, kAbsent) { heap_.reserve(items); }

  bool empty() const { return heap_.empty(); }
  uint32_t top() const { return static_cast<uint32_t>(heap_.front()); }
  float top_cost() const { return std::bit_cast<float>(static_cast<uint32_t>(heap_.front() >> 32U)); }

  bool has(uint32_t item) const { return place_[item] != kAbsent; }

  /// Puts an item in, or changes its cost. cost >= 0 or infinite; infinite: takes it out.
  void set(uint32_t item, float cost) {
    if (!(cost < std::numeric_limits<float>::infinity())) return remove(item);
    const uint64_t key = uint64_t(std::bit_cast<uint32_t>(cost + 0.0F)) << 32U | item;
    uint32_t at = place_[item];
    if (at == kAbsent) {
      at = static_cast<uint32_t>(heap_.size());
      heap_.push_back(key);
      return rise(at, key);
    }
    if (key < heap_[at])
      rise(at, key);
    else
      sink(at, key);
  }

  void remove(uint32_t item) {
    const uint32_t at = place_[item];
    if (at == kAbsent) return;
    place_[item] = kAbsent;
    const uint64_t last = heap_.back();
    heap_.pop_back();
    if (at == heap_.size()) return;
    if (at > 0 && last < heap_[(at - 1) / 4])
      rise(at, last);
    else
      sink(at, last);
  }

 private:
  static constexpr uint32_t kAbsent = 0xffffffffU;

  void put(uint32_t at, uint64_t key) {
    heap_[at] = key;
    place_[static_cast<uint32_t>(key)] = at;
  }

  void rise(uint32_t at, uint64_t key) {
    for (; at > 0 && key < heap_[(at - 1) / 4]; at = (at - 1) / 4) put(at, heap_[(at - 1) / 4]);
    put(at, key);
  }

  void sink(uint32_t at, uint64_t key) {
    const auto size = static_cast<uint32_t>(heap_.size());
    for (;;) {
      const uint32_t first = at * 4 + 1;
      if (first >= size) break;
      const uint32_t end = first + 4 < size ? first + 4 : size;
      uint32_t least = first;
      for (uint32_t c = first + 1; c < end; ++c)
        if (heap_[c] < heap_[least]) least = c;
      if (key < heap_[least]) break;
      put(at, heap_[least]);
      at = least;
    }
    put(at, key);
  }

  std::vector<uint64_t> heap_;  // cost's bits, item
  std::vector<uint32_t> place_;
};

}  // namespace promenade
