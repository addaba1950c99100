#include "runtime/soon_marks.h"

namespace promenade {

void SoonMarks::change_to(const std::map<CellId, std::shared_ptr<const Vlod>>& vlods) {
  std::vector<CellId> cells;
  cells.reserve(vlods.size());
  for (const auto& [cell, vlod] : vlods) cells.push_back(cell);
  if (cells == cells_) return;
  cells_ = std::move(cells);
  for (const NodeId id : marked_) mark_[index_of(id)] = 0;
  marked_.clear();
  for (const auto& [cell, vlod] : vlods)
    for (const NodeId id : vlod->nodes) {
      if (mark_[index_of(id)] == 0) marked_.push_back(id);
      mark_[index_of(id)] |= kMember;
      for (NodeId up = model_.tables.nodes[index_of(id)].parent; up != kNoNode;
           up = model_.tables.nodes[index_of(up)].parent) {
        if ((mark_[index_of(up)] & kWay) != 0) break;
        if (mark_[index_of(up)] == 0) marked_.push_back(up);
        mark_[index_of(up)] |= kWay;
      }
    }
}

}  // namespace promenade
