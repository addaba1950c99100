// Policies none, static, feedback, front and vlod: the front that an error asks for, with nearest resident ancestors
// where it is not there.

#include "runtime/selecting.h"

namespace promenade {
namespace {

constexpr uint32_t kNoVisit = 0xffffffffU;

class ByError {
 public:
  explicit ByError(Selecting& selecting, bool moving_only = false) : s_(selecting), moving_only_(moving_only) {}
  void run(std::span<const NodeId> roots);

 private:
  bool ends_paths(NodeId id) const;
  void visit_wanted(NodeId root);

  /// What a cell sees of an object is seen whole then: the eye says how fine it must be.
  bool may_be_seen(NodeId id) const { return moving_only_ || s_.may_be_seen(id); }

  Selecting& s_;
  bool moving_only_;
};

/// Whether the front that the policy asks for, whatever is resident, has the node.
bool ByError::ends_paths(NodeId id) const {
  const NodeRecord& n = s_.node(id);
  if (n.child_count == 0) return true;
  if (s_.vlod != nullptr && !moving_only_)
    return s_.vlod->has(id) || (s_.out.coarser > 1 && s_.fine_enough(id));  // or where memory is short
  if (s_.options.policy == Policy::none) return false;
  if (s_.options.policy == Policy::front && s_.view.cell != nullptr)
    return ends_front(n, *s_.view.cell, *s_.view.bound);
  return s_.fine_enough(id);
}

/// Walks down to the front that the error asks for, whatever is resident; visits parents before children.
void ByError::visit_wanted(NodeId root) {
  const size_t begin = s_.state.visits.size();
  s_.state.visits.push_back({root, kNoVisit, 0, false});
  s_.price(root);
  for (size_t i = begin; i < s_.state.visits.size(); ++i) {
    const NodeId id = s_.state.visits[i].node;
    const bool wanted = ends_paths(id);
    s_.state.visits[i].wanted = wanted;
    if (wanted) continue;
    for (const NodeId child : s_.model.children_of(id)) {
      if (!may_be_seen(child)) continue;
      if (!s_.visible(child)) continue;
      s_.price(child);
      s_.state.visits.push_back({child, static_cast<uint32_t>(i), 0, false});
    }
  }
}

void ByError::run(std::span<const NodeId> roots) {
  s_.state.visits.clear();
  for (const NodeId root : roots) {
    if (s_.visible(root) && s_.may_be_seen(root))
      visit_wanted(root);
    else
      s_.price(root);
  }
  // From the leaves up: a node is covered when it, or visible descendants that cover it, can be drawn.
  std::vector<SelectState::Visit>& visits = s_.state.visits;
  for (size_t i = visits.size(); i-- > 0;) {
    const SelectState::Visit& v = visits[i];
    const bool by_children = !v.wanted && v.uncovered_children == 0;
    if (v.wanted && !s_.resident(v.node)) ++s_.out.nodes_missing;
    if (!by_children && !s_.resident(v.node) && v.parent != kNoVisit) ++visits[v.parent].uncovered_children;
  }
  // From the roots down: draw a node where its children do not cover it. `wanted` then marks what ends a path.
  for (size_t i = 0; i < visits.size(); ++i) {
    SelectState::Visit& v = visits[i];
    if (v.parent != kNoVisit && visits[v.parent].wanted) {
      v.wanted = true;  // an ancestor is drawn
      continue;
    }
    if (v.wanted || v.uncovered_children > 0) {
      s_.out.front.push_back(v.node);
      if (!v.wanted) s_.state.nodes[index_of(v.node)].lacked = s_.state.frame;
      v.wanted = true;
    }
  }
}

}  // namespace

void select_by_error(Selecting& selecting) { ByError(selecting).run(selecting.model.tables.roots); }

double select_moving(Selecting& selecting) {
  const std::vector<NodeId>& front = selecting.out.front;
  const size_t first = front.size();
  ByError(selecting, true).run(selecting.moving_roots());
  double ms = 0;
  for (size_t i = first; i < front.size(); ++i) ms += selecting.ms_of_node(front[i]);
  return ms;
}

}  // namespace promenade
