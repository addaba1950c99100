#pragma once
// What will be seen from the cells that the eye may soon be in, marked on the tree.

#include <map>
#include <memory>

#include "layout/cells_io.h"
#include "layout/model.h"

namespace promenade {

/// The union of some vLODs: their nodes, and those on the way from the roots. One thread.
class SoonMarks {
 public:
  /// model must outlive it.
  explicit SoonMarks(const Model& model) : model_(model), mark_(model.tables.nodes.size(), 0) {}

  /// Keeps what these have in common with the ones before as it is: nothing is done when nothing changes.
  void change_to(const std::map<CellId, std::shared_ptr<const Vlod>>& vlods);
  bool has(NodeId id) const { return (mark_[index_of(id)] & kMember) != 0; }
  bool leads_to_some(NodeId id) const { return mark_[index_of(id)] != 0; }
  /// Whether some set has a node below it; another one may have the node itself.
  bool leads_below(NodeId id) const { return (mark_[index_of(id)] & kWay) != 0; }

 private:
  static constexpr uint8_t kMember = 2, kWay = 1;
  const Model& model_;
  std::vector<uint8_t> mark_;  ///< by node
  std::vector<NodeId> marked_;
  std::vector<CellId> cells_;  ///< whose vLODs are marked
};

}  // namespace promenade
