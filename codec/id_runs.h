#pragma once
// A set of ids as its maximal runs of neighbours.

#include <cstddef>
#include <cstdint>
#include <span>

namespace promenade {

/// Calls visit(first, length) for each maximal run. ids: strictly ascending.
template <class Visit>
void for_each_run(std::span<const uint32_t> ids, Visit visit) {
  for (size_t i = 0; i < ids.size();) {
    size_t end = i + 1;
    while (end < ids.size() && ids[end] == ids[end - 1] + 1) ++end;
    visit(ids[i], static_cast<uint32_t>(end - i));
    i = end;
  }
}

/// The set as (gap, run) pairs: how many ids that can start a run are passed over, and the run's length less one. An id
/// beside a run cannot start the next, or the run would be longer.
template <class Visit>
void for_each_gap_run(std::span<const uint32_t> ids, Visit visit) {
  uint64_t free = 0;
  for_each_run(ids, [&](uint32_t first, uint32_t length) {
    visit(static_cast<uint32_t>(first - free), length - 1);
    free = uint64_t(first) + length + 1;
  });
}

/// Fills a caller's span with runs, and keeps to it and to the ids that there are.
class RunSink {
 public:
  RunSink(std::span<uint32_t> into, uint32_t universe) : into_(into), universe_(universe) {}

  /// gap: ids passed over, as in for_each_gap_run. False: beyond the last id, or more than there is room for.
  bool add(uint64_t gap, uint64_t more) {
    if (gap >= universe_ || more >= into_.size() - count_) return false;
    const uint64_t first = free_ + gap, length = more + 1;
    if (first + length > universe_) return false;
    uint32_t* out = into_.data() + count_;
    auto id = static_cast<uint32_t>(first);
    for (uint64_t i = 0; i < length; ++i) out[i] = id++;
    count_ += length;
    free_ = first + length + 1;
    return true;
  }
  size_t count() const { return count_; }

 private:
  std::span<uint32_t> into_;
  uint64_t universe_;
  uint64_t free_ = 0;  ///< the least id that the next run may begin with
  size_t count_ = 0;
};

}  // namespace promenade
