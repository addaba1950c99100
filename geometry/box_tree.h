#pragma once
// Boxes that do not change, found by place.

#include <cstdint>
#include <span>
#include <vector>

#include "geometry/box.h"

namespace promenade {

/// A tree over boxes, each known by its number. Asking is for any number of threads at once.
class BoxTree {
 public:
  BoxTree() = default;
  /// n log n. None of the boxes may be empty; fewer than 2^32.
  explicit BoxTree(std::span<const Box> boxes);

  /// Calls visit(number) for every box that overlaps one, touching included, in no order that means anything.
  template <class Visit>
  void for_each_near(const Box& near, const Visit& visit) const {
    for (uint32_t at = 0; at < nodes_.size();) {
      const Node& node = nodes_[at];
      if (!node.box.overlaps(near)) {
        at = node.next;
        continue;
      }
      for (uint32_t i = node.first; i < node.first + node.count; ++i)
        if (entries_[i].box.overlaps(near)) visit(entries_[i].number);
      ++at;
    }
  }

 private:
  struct Entry {
    Box box;
    uint32_t number;
  };
  /// In preorder: a node's children follow it.
  struct Node {
    Box box;
    uint32_t next;          ///< behind its subtree
    uint32_t first, count;  ///< of its own entries: none where it has children
  };
  void divide(uint32_t first, uint32_t last);

  std::vector<Entry> entries_;
  std::vector<Node> nodes_;
};

}  // namespace promenade
