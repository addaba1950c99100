#include "codec/id_forest.h"

#include <fmt/format.h>

namespace promenade {

Status check(const IdForest& forest) {
  std::vector<uint32_t> open;  // ends of the subtrees around a node, the innermost last
  for (uint32_t node = 0; node < forest.size(); ++node) {
    while (!open.empty() && open.back() == node) open.pop_back();
    const uint32_t end = forest.subtree_end[node], limit = open.empty() ? forest.size() : open.back();
    if (end <= node || end > limit)
      return Error{
          fmt::format("node {}: its subtree ends at {}, which is not in {} to {}", node, end, node + 1, limit)};
    open.push_back(end);
    if (open.size() > kMaxForestDepth)
      return Error{fmt::format("node {}: is deeper than {} levels", node, kMaxForestDepth)};
  }
  return Done{};
}

bool is_antichain(const IdForest& forest, std::span<const uint32_t> ids) {
  uint32_t free = 0;
  for (const uint32_t id : ids) {
    if (id < free || id >= forest.size()) return false;
    free = forest.subtree_end[id];
  }
  return true;
}

}  // namespace promenade
