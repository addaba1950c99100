#pragma once
// The HLOD tree as sets of its nodes are coded along it.

#include <cstdint>
#include <span>
#include <vector>

#include "codec/id_forest.h"
#include "layout/model.h"

namespace promenade {

/// Nodes by rank, their place in preorder, and back. Siblings keep the order of the tables. Constant: any thread.
struct NodeForest {
  IdForest by_rank;
  std::vector<uint32_t> node_of_rank;
  uint64_t byte_size() const { return (by_rank.subtree_end.size() + node_of_rank.size()) * sizeof(uint32_t); }
};

/// Of sound tables (find_defect). Error: a tree deeper than sets are coded along.
Result<NodeForest> node_forest(const ModelTables& tables);

/// Of nodes without parents.
NodeForest flat_forest(uint32_t nodes);

std::vector<uint32_t> rank_of_node(const NodeForest& forest);

}  // namespace promenade
