#include "geometry/box_tree.h"

#include <algorithm>

namespace promenade {
namespace {

constexpr uint32_t kMostEntries = 8;  // of a node without children

}  // namespace

BoxTree::BoxTree(std::span<const Box> boxes) {
  entries_.reserve(boxes.size());
  for (uint32_t i = 0; i < boxes.size(); ++i) entries_.push_back({boxes[i], i});
  if (!boxes.empty()) divide(0, static_cast<uint32_t>(boxes.size()));
}

/// By half along the axis on which the centers differ most: the tree is as deep as the logarithm of their number.
void BoxTree::divide(uint32_t first, uint32_t last) {
  const auto node = static_cast<uint32_t>(nodes_.size());
  Box all, centers;
  for (uint32_t i = first; i < last; ++i) all.add(entries_[i].box), centers.add(entries_[i].box.center());
  const bool whole = last - first <= kMostEntries;
  nodes_.push_back({all, 0, first, whole ? last - first : 0});
  if (!whole) {
    const int axis = centers.longest_axis();
    const uint32_t middle = first + (last - first) / 2;
    const auto begin = entries_.begin();
    std::nth_element(begin + first, begin + middle, begin + last, [axis](const Entry& a, const Entry& b) {
      return std::pair(a.box.center()[axis], a.number) < std::pair(b.box.center()[axis], b.number);
    });
    divide(first, middle);
    divide(middle, last);
  }
  nodes_[node].next = static_cast<uint32_t>(nodes_.size());
}

}  // namespace promenade
