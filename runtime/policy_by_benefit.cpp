// Policy cost_benefit: the front of the most benefit whose cost fits into the target time. Source: [funkhouser1993]
// section 4.2.3, generalised from chains of levels of objects to the tree: one step finer replaces a node by its
// visible children, one step coarser the children by it, and a step's value is the benefit that it gains over the time
// that it takes. Starting from the front of the frame before, the best step finer and the worst ones coarser are taken
// in turn until they undo each other.

#include <algorithm>
#include <cmath>
#include <queue>

#include "runtime/benefit.h"
#include "runtime/selecting.h"

namespace promenade {
namespace {

constexpr uint32_t kNone = 0xffffffffU;

class ByBenefit {
 public:
  explicit ByBenefit(Selecting& selecting)
      : s_(selecting), benefit_(selecting.model, selecting.sight, selecting.view, selecting.options) {}
  void run();

 private:
  enum class Place : uint8_t { outside, front, refined };
  struct Entry {
    NodeId node;
    uint32_t parent;           ///< entry
    uint32_t first_child = 0;  ///< entries of the visible children, contiguous; 0: not looked at yet
    uint32_t children = 0;
    uint32_t refined_children = 0;
    uint32_t missing = 0;  ///< of the visible children
    uint32_t version = 0;  ///< of what the queues say about it
    Place place = Place::outside;
    bool seen_whole = false;
    bool may_refine = false;  ///< all visible children are there, and more detail is wanted
    double ms = 0, benefit = 0;
    double step_ms = 0, step_benefit = 0;  ///< what one step finer changes
    double value() const {
      if (step_ms > 0) return step_benefit / step_ms;
      return step_benefit >= 0 ? 1e30 : -1e30;
    }
  };
  struct Queued {
    double value;
    uint32_t entry, version;
    bool operator<(const Queued& other) const {
      return value != other.value ? value < other.value : entry > other.entry;
    }
  };

  uint32_t add(NodeId id, uint32_t parent, bool seen_whole);
  void look_at_children(uint32_t entry);
  void start_from_last_front();
  void refine(uint32_t entry);
  void coarsen(uint32_t entry);
  void queue(uint32_t entry);
  uint32_t best_finer();
  uint32_t worst_coarser();

  Selecting& s_;
  const Benefit benefit_;
  std::vector<Entry> entries_;
  std::priority_queue<Queued> finer_, coarser_;  ///< coarser_ by the negated value
  double ms_ = 0;
};

uint32_t ByBenefit::add(NodeId id, uint32_t parent, bool seen_whole) {
  Entry entry{.node = id, .parent = parent};
  entry.seen_whole = seen_whole || (s_.vlod != nullptr && s_.vlod->has(id));
  entry.ms = s_.ms_of_node(id);
  const SelectState::Node& kept = s_.state.nodes[index_of(id)];
  entry.benefit = benefit_.of(id, kept.drawn != 0 && kept.drawn + 1 == s_.state.frame);
  entries_.push_back(entry);
  return static_cast<uint32_t>(entries_.size() - 1);
}

/// Prices the children, and says what it takes to show them in the node's place.
void ByBenefit::look_at_children(uint32_t at) {
  if (entries_[at].first_child != 0) return;
  const NodeId id = entries_[at].node;
  const bool seen_whole = entries_[at].seen_whole;
  const auto first = static_cast<uint32_t>(entries_.size());
  uint32_t missing = 0;
  double ms = 0, benefit = 0;
  for (const NodeId child : s_.model.children_of(id)) {
    if (!seen_whole && !s_.may_be_seen(child)) continue;
    s_.price(child);
    if (!s_.visible(child)) continue;
    if (!s_.resident(child)) ++missing;
    const uint32_t entry = add(child, at, seen_whole);
    ms += entries_[entry].ms;
    benefit += entries_[entry].benefit;
  }
  Entry& entry = entries_[at];
  entry.first_child = first;
  entry.children = static_cast<uint32_t>(entries_.size()) - first;
  entry.missing = missing;
  entry.may_refine = missing == 0;
  entry.step_ms = ms - entry.ms;
  entry.step_benefit = benefit - entry.benefit;
}

/// Puts what may be done next with an entry into the queues; what they said before no longer holds.
void ByBenefit::queue(uint32_t at) {
  Entry& entry = entries_[at];
  ++entry.version;
  if (entry.place == Place::front) {
    if (s_.node(entry.node).child_count == 0 || s_.fine_enough(entry.node)) return;
    look_at_children(at);
    if (entries_[at].may_refine) finer_.push({entries_[at].value(), at, entries_[at].version});
  } else if (entry.place == Place::refined && entry.refined_children == 0) {
    coarser_.push({-entry.value(), at, entry.version});
  }
}

void ByBenefit::refine(uint32_t at) {
  entries_[at].place = Place::refined;
  ms_ += entries_[at].step_ms;
  if (entries_[at].parent != kNone) {
    ++entries_[entries_[at].parent].refined_children;
    queue(entries_[at].parent);
  }
  const uint32_t first = entries_[at].first_child, end = first + entries_[at].children;
  for (uint32_t child = first; child < end; ++child) {
    entries_[child].place = Place::front;
    queue(child);
  }
  queue(at);
}

void ByBenefit::coarsen(uint32_t at) {
  entries_[at].place = Place::front;
  ms_ -= entries_[at].step_ms;
  const uint32_t first = entries_[at].first_child, end = first + entries_[at].children;
  for (uint32_t child = first; child < end; ++child) {
    entries_[child].place = Place::outside;
    ++entries_[child].version;
  }
  if (entries_[at].parent != kNone) {
    --entries_[entries_[at].parent].refined_children;
    queue(entries_[at].parent);
  }
  queue(at);
}

uint32_t ByBenefit::best_finer() {
  while (!finer_.empty()) {
    const Queued top = finer_.top();
    if (entries_[top.entry].version == top.version) return top.entry;
    finer_.pop();
  }
  return kNone;
}

uint32_t ByBenefit::worst_coarser() {
  while (!coarser_.empty()) {
    const Queued top = coarser_.top();
    if (entries_[top.entry].version == top.version) return top.entry;
    coarser_.pop();
  }
  return kNone;
}

/// Roots in view, refined where the last frame's front was finer; what has come into view starts as it is met.
void ByBenefit::start_from_last_front() {
  std::vector<uint32_t> stack;
  for (const NodeId root : s_.model.tables.roots) {
    s_.price(root);
    if (!s_.visible(root) || !s_.may_be_seen(root)) continue;
    const uint32_t entry = add(root, kNone, s_.vlod == nullptr);
    entries_[entry].place = Place::front;
    ms_ += entries_[entry].ms;
    stack.push_back(entry);
  }
  // An entry's first child is never entry 0: a root stands there.
  for (size_t i = 0; i < stack.size(); ++i) {
    const uint32_t at = stack[i];
    const NodeId id = entries_[at].node;
    const SelectState::Node& kept = s_.state.nodes[index_of(id)];
    const bool was_finer = kept.refined != 0 && kept.refined + 1 == s_.state.frame;
    if (!was_finer || s_.node(id).child_count == 0 || s_.fine_enough(id)) continue;
    look_at_children(at);
    if (!entries_[at].may_refine) continue;
    entries_[at].place = Place::refined;
    ms_ += entries_[at].step_ms;
    if (entries_[at].parent != kNone) ++entries_[entries_[at].parent].refined_children;
    for (uint32_t child = entries_[at].first_child; child < entries_[at].first_child + entries_[at].children; ++child) {
      entries_[child].place = Place::front;
      stack.push_back(child);
    }
  }
  for (const uint32_t at : stack) queue(at);
}

void ByBenefit::run() {
  start_from_last_front();
  const double picture_ms = s_.state.costs ? s_.state.costs->estimate_ms(s_.out.load) : s_.state.overhead_ms;
  const double target_ms = s_.options.time.target_ms;
  // Where the picture alone takes the whole target, levels of detail save little: they share a quarter at least.
  const double budget_ms = std::max(target_ms - picture_ms - s_.view.reserved_ms, target_ms / 4);
  while (true) {
    uint32_t refined = kNone;
    if (ms_ <= budget_ms) {
      refined = best_finer();
      if (refined == kNone) break;
      refine(refined);
      ++s_.out.optimisation_steps;
    }
    bool undone = false;
    while (ms_ > budget_ms && !undone) {
      const uint32_t worst = worst_coarser();
      if (worst == kNone) break;
      coarsen(worst);
      ++s_.out.optimisation_steps;
      undone = worst == refined;
    }
    if (undone || ms_ > budget_ms) break;
  }
  for (const Entry& entry : entries_) {
    if (entry.place != Place::front) continue;
    s_.out.front.push_back(entry.node);
    if (entry.may_refine) ++s_.out.loaded_rejected;
    // There would have been time for them.
    if (entry.missing == 0 || ms_ + entry.step_ms > budget_ms) continue;
    s_.out.nodes_missing += entry.missing;
    s_.state.nodes[index_of(entry.node)].lacked = s_.state.frame;
  }
}

}  // namespace

void select_by_benefit(Selecting& selecting) { ByBenefit(selecting).run(); }

}  // namespace promenade
