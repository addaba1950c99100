#pragma once
// A forest over the numbers 0 to n - 1, each node before its descendants: what sets of HLOD nodes are coded along.

#include <cstdint>
#include <span>
#include <vector>

#include "geometry/result.h"

namespace promenade {

/// Nodes in preorder: a node's subtree is a run of numbers from its own on.
struct IdForest {
  std::vector<uint32_t> subtree_end;  ///< by node: one more than the last number in its subtree
  uint32_t size() const { return static_cast<uint32_t>(subtree_end.size()); }
  bool is_leaf(uint32_t node) const { return subtree_end[node] == node + 1; }
};

constexpr uint32_t kMaxForestDepth =
    1024;  // bounds what coders keep open on hostile input; a billion triangles make about 20 levels

/// Every subtree within its parent's, none deeper than kMaxForestDepth; else an Error that says which node. Any thread.
Status check(const IdForest& forest);

/// Whether ids are strictly ascending, in the forest, and none is an ancestor of another.
bool is_antichain(const IdForest& forest, std::span<const uint32_t> ids);

}  // namespace promenade
