#pragma once
// A vLOD on the tree: which nodes it has, and which are on the way from the roots to them.

#include <cstdint>
#include <span>
#include <vector>

#include "layout/model.h"

namespace promenade {

/// Kept up to date by differences: a step into the next cell costs what changes, times the tree's depth. One thread.
class VlodMarks {
 public:
  /// model must outlive it.
  explicit VlodMarks(const Model& model) : model_(model), below_(model.tables.nodes.size(), 0) {}

  /// What came and went.
  struct Change {
    uint64_t entered = 0, left = 0;  ///< nodes
  };
  /// nodes: ascending. None of them is another's ancestor.
  Change change_to(std::span<const NodeId> nodes);

  std::span<const NodeId> nodes() const { return nodes_; }
  bool has(NodeId id) const { return (below_[index_of(id)] & kMember) != 0; }
  /// Whether the vLOD has the node or something below it: whether anything of the node can be seen.
  bool leads_to_some(NodeId id) const { return below_[index_of(id)] != 0; }
  uint64_t byte_size() const { return below_.capacity() * sizeof(uint32_t) + nodes_.capacity() * sizeof(NodeId); }

 private:
  static constexpr uint32_t kMember = 0x80000000U;
  void enter(NodeId id);
  void leave(NodeId id);

  const Model& model_;
  std::vector<uint32_t> below_;  ///< by node: how many of the vLOD's are below it; kMember: it is one itself
  std::vector<NodeId> nodes_;
};

}  // namespace promenade
