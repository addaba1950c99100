#pragma once
// The loader's queue: nodes by priority.

#include <cstdint>
#include <span>
#include <vector>

#include "geometry/node_id.h"

namespace promenade {

struct PriorityUpdate {
  NodeId node = kNoNode;
  float priority = 0;  ///< >= 0; larger matters more
};

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
  uint64_t byte_size() const { return entries_.capacity() * sizeof(Entry) + scratch_.capacity() * sizeof(NodeId); }

  /// Inserts, or moves, the node: behind all of equal priority (where it is, if its own has not changed).
  void update(NodeId id, float priority);
  /// All of them. When the order changed so much that stepping would take long (the eye has jumped), sorts instead.
  void update(std::span<const PriorityUpdate> updates);
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
    uint64_t turn = 0;  ///< when it came to its place: order among equals
    float priority = 0;
    NodeId previous = kNoNode, next = kNoNode;
    bool listed = false, loaded = false;
  };
  Entry& entry(NodeId id) { return entries_[index_of(id)]; }
  const Entry& entry(NodeId id) const { return entries_[index_of(id)]; }
  bool above(NodeId a, NodeId b) const;
  void unlink(NodeId id);
  void link_before(NodeId id, NodeId next);
  void insert(NodeId id, float priority);
  void move(NodeId id, float priority);
  void notice_unloaded(NodeId id);
  void sort_all();

  std::vector<Entry> entries_;
  NodeId head_ = kNoNode, tail_ = kNoNode;
  uint32_t size_ = 0;
  uint64_t steps_ = 0;
  uint64_t turns_ = 0;
  /// Every entry above this one is loaded; kNoNode: every entry is.
  NodeId cached_ = kNoNode;
  /// Where the last insertion went: the next, if it is less important, need not walk from the end.
  NodeId finger_ = kNoNode;
  std::vector<NodeId> scratch_;
};

}  // namespace promenade
