#pragma once
// What is made of nodes, kept while memory lasts.

#include <algorithm>
#include <cstdint>
#include <mutex>
#include <unordered_map>
#include <utility>
#include <vector>

#include "geometry/result.h"
#include "layout/model.h"

namespace promenade {

/// Values by node; forgets what was not used for longest. T: cheap to copy, as shared pointers are. Any thread.
template <class T>
class NodeCache {
 public:
  /// bytes: what values may take together while nobody holds them.
  explicit NodeCache(uint64_t bytes) : most_bytes_(bytes) {}

  /// The node's value; make() -> Result<T> makes it when it is not there (two threads may both make it: the first one's
  /// is kept), bytes_of(value) tells what it takes. Errors: make's.
  template <class Make, class BytesOf>
  Result<T> get(NodeId id, const Make& make, const BytesOf& bytes_of) {
    {
      const std::lock_guard lock(mutex_);
      if (const auto found = entries_.find(index_of(id)); found != entries_.end()) {
        found->second.last_use = ++uses_;
        return found->second.value;
      }
    }
    Result<T> made = make();
    if (!made) return made;
    const uint64_t bytes = bytes_of(*made);
    const std::lock_guard lock(mutex_);
    const auto [entry, added] = entries_.try_emplace(index_of(id), Entry{*made, bytes, 0});
    entry->second.last_use = ++uses_;
    if (added) bytes_ += bytes;
    Result<T> value = entry->second.value;
    if (bytes_ > most_bytes_) make_room();
    return value;
  }

 private:
  struct Entry {
    T value;
    uint64_t bytes = 0, last_use = 0;
  };

  /// Forgets the quarter that was not used for longest, so that the scan is rare.
  void make_room() {
    std::vector<std::pair<uint64_t, uint32_t>> by_age;
    by_age.reserve(entries_.size());
    for (const auto& [id, entry] : entries_) by_age.emplace_back(entry.last_use, id);
    std::sort(by_age.begin(), by_age.end());
    for (const auto& [age, id] : by_age) {
      if (bytes_ <= most_bytes_ / 4 * 3) break;
      const auto entry = entries_.find(id);
      bytes_ -= entry->second.bytes;
      entries_.erase(entry);
    }
  }

  uint64_t most_bytes_;
  std::mutex mutex_;  // guards everything below
  std::unordered_map<uint32_t, Entry> entries_;
  uint64_t bytes_ = 0, uses_ = 0;
};

}  // namespace promenade
