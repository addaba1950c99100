#include "layout/node_forest.h"

#include <algorithm>
#include <numeric>

namespace promenade {

Result<NodeForest> node_forest(const ModelTables& tables) {
  NodeForest forest;
  const size_t count = tables.nodes.size();
  forest.node_of_rank.reserve(count);
  // A stack of nodes to visit: their siblings wait below them.
  std::vector<uint32_t> waiting;
  for (const NodeId root : tables.roots) waiting.push_back(index_of(root));
  std::reverse(waiting.begin(), waiting.end());
  while (!waiting.empty()) {
    const uint32_t id = waiting.back();
    waiting.pop_back();
    forest.node_of_rank.push_back(id);
    const NodeRecord& node = tables.nodes[id];
    for (uint32_t i = node.child_count; i-- > 0;) waiting.push_back(index_of(tables.children[node.first_child + i]));
  }
  // Descendants stand behind their ancestors, so that from the last on every subtree's size is known when it is needed.
  std::vector<uint32_t> sizes(count, 1);
  forest.by_rank.subtree_end.resize(count);
  for (size_t rank = count; rank-- > 0;) {
    const uint32_t id = forest.node_of_rank[rank];
    forest.by_rank.subtree_end[rank] = static_cast<uint32_t>(rank) + sizes[id];
    if (const NodeId parent = tables.nodes[id].parent; parent != kNoNode) sizes[index_of(parent)] += sizes[id];
  }
  PROMENADE_TRY(check(forest.by_rank));
  return forest;
}

NodeForest flat_forest(uint32_t nodes) {
  NodeForest forest;
  forest.node_of_rank.resize(nodes);
  std::iota(forest.node_of_rank.begin(), forest.node_of_rank.end(), 0U);
  forest.by_rank.subtree_end.resize(nodes);
  std::iota(forest.by_rank.subtree_end.begin(), forest.by_rank.subtree_end.end(), 1U);
  return forest;
}

std::vector<uint32_t> rank_of_node(const NodeForest& forest) {
  std::vector<uint32_t> ranks(forest.node_of_rank.size());
  for (size_t rank = 0; rank < ranks.size(); ++rank) ranks[forest.node_of_rank[rank]] = static_cast<uint32_t>(rank);
  return ranks;
}

}  // namespace promenade
