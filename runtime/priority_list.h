#pragma once
// The loader's queue: nodes by priority.

#include <cstdint>
#include <vector>

#include "geometry/node_id.h"

namespace promenade {

/// A doubly-linked list of nodes in decreasing order of priority, found by id through an array, with the most important
/// unloaded node cached. Insertion goes in from the end, an update walks from where the node is, and the cache moves
/// only when something passes it: all O(1) on average under temporal coherence, O(N) at worst.
/// Not thread-safe. Source: [lakhia2004] section 4.3, "Priority Queue Implementation".
class PriorityList {
 public:
  explicit PriorityList(uint32_t node_count);

  bool contains(NodeId id) const { return entry(id).listed; }
  float priority(NodeId id) const { return entry(id).priority; }
  bool loaded(NodeId id) const { return entry(id).loaded; }
  uint32_t size() const { return size_; }
  uint64_t byte_size() const { return entries_.capacity() * sizeof(Entry); }

  /// Inserts, or moves, the node. Among equals the one that came there first stays first.
  void update(NodeId id, float priority);
  void erase(NodeId id);
  /// Loaded nodes are passed over by next_unloaded(). The node must be in the list.
  void set_loaded(NodeId id, bool loaded);

  /// The most important node that is not loaded; kNoNode: none.
  NodeId next_unloaded();
  /// Ends and steps, for eviction (from the back) and tests; kNoNode past either end.
  NodeId front() const { return head_; }
  NodeId back() const { return tail_; }
  NodeId before(NodeId id) const { return entry(id).previous; }
  NodeId after(NodeId id) const { return entry(id).next; }

  /// Entries stepped over since construction, for checking the amortised cost.
  uint64_t steps() const { return steps_; }

 private:
  struct Entry {
    float priority = 0;
    NodeId previous = kNoNode, next = kNoNode;
    bool listed = false, loaded = false;
  };
  Entry& entry(NodeId id) { return entries_[index_of(id)]; }
  const Entry& entry(NodeId id) const { return entries_[index_of(id)]; }
  void unlink(NodeId id);
  void link_before(NodeId id, NodeId next);

  std::vector<Entry> entries_;
  NodeId head_ = kNoNode, tail_ = kNoNode;
  uint32_t size_ = 0;
  uint64_t steps_ = 0;
  /// Every entry above `scan_from_` is loaded; kNoNode with scan_known_: everything is.
  NodeId scan_from_ = kNoNode;
  bool scan_known_ = true;
};

}  // namespace promenade
