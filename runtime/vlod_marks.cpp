#include "runtime/vlod_marks.h"

namespace promenade {

void VlodMarks::enter(NodeId id) {
  below_[index_of(id)] |= kMember;
  for (NodeId up = model_.tables.nodes[index_of(id)].parent; up != kNoNode;
       up = model_.tables.nodes[index_of(up)].parent)
    ++below_[index_of(up)];
}

void VlodMarks::leave(NodeId id) {
  below_[index_of(id)] &= ~kMember;
  for (NodeId up = model_.tables.nodes[index_of(id)].parent; up != kNoNode;
       up = model_.tables.nodes[index_of(up)].parent)
    --below_[index_of(up)];
}

VlodMarks::Change VlodMarks::change_to(std::span<const NodeId> nodes) {
  Change change;
  auto old = nodes_.cbegin();
  auto fresh = nodes.begin();
  while (old != nodes_.cend() || fresh != nodes.end()) {
    if (fresh == nodes.end() || (old != nodes_.cend() && *old < *fresh)) {
      leave(*old++);
      ++change.left;
    } else if (old == nodes_.cend() || *fresh < *old) {
      enter(*fresh++);
      ++change.entered;
    } else {
      ++old, ++fresh;
    }
  }
  nodes_.assign(nodes.begin(), nodes.end());
  return change;
}

}  // namespace promenade
