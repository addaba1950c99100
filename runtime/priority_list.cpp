#include "runtime/priority_list.h"

#include <algorithm>

namespace promenade {

PriorityList::PriorityList(uint32_t node_count) : entries_(node_count) {}

bool PriorityList::above(NodeId a, NodeId b) const {
  const Entry &x = entry(a), &y = entry(b);
  return x.priority != y.priority ? x.priority > y.priority : x.turn < y.turn;
}

void PriorityList::unlink(NodeId id) {
  Entry& e = entry(id);
  if (cached_ == id) cached_ = e.next;
  if (finger_ == id) finger_ = kNoNode;
  (e.previous == kNoNode ? head_ : entry(e.previous).next) = e.next;
  (e.next == kNoNode ? tail_ : entry(e.next).previous) = e.previous;
  --size_;
}

/// next kNoNode: at the end.
void PriorityList::link_before(NodeId id, NodeId next) {
  Entry& e = entry(id);
  e.next = next;
  e.previous = next == kNoNode ? tail_ : entry(next).previous;
  (e.previous == kNoNode ? head_ : entry(e.previous).next) = id;
  (next == kNoNode ? tail_ : entry(next).previous) = id;
  ++size_;
}

void PriorityList::notice_unloaded(NodeId id) {
  if (!entry(id).loaded && (cached_ == kNoNode || above(id, cached_))) cached_ = id;
}

void PriorityList::insert(NodeId id, float priority) {
  NodeId next = kNoNode;  // what it goes in front of
  if (finger_ != kNoNode && entry(finger_).priority >= priority) {
    next = entry(finger_).next;
    for (; next != kNoNode && entry(next).priority >= priority; next = entry(next).next) ++steps_;
  } else {
    for (NodeId last = tail_; last != kNoNode && entry(last).priority < priority; last = entry(last).previous, ++steps_)
      next = last;
  }
  Entry& e = entry(id);
  e = Entry{};
  e.listed = true;
  e.priority = priority;
  e.turn = ++turns_;
  link_before(id, next);
  finger_ = id;
  notice_unloaded(id);
}

void PriorityList::move(NodeId id, float priority) {
  Entry& e = entry(id);
  NodeId next = e.next;
  if (priority > e.priority) {
    for (NodeId p = e.previous; p != kNoNode && entry(p).priority < priority; p = entry(p).previous, ++steps_) next = p;
  } else {
    for (; next != kNoNode && entry(next).priority >= priority; next = entry(next).next) ++steps_;
  }
  unlink(id);
  e.priority = priority;
  e.turn = ++turns_;
  link_before(id, next);
  notice_unloaded(id);
}

void PriorityList::update(NodeId id, float priority) {
  const Entry& e = entry(id);
  if (!e.listed)
    insert(id, priority);
  else if (e.priority != priority)
    move(id, priority);
}

void PriorityList::update(std::span<const PriorityUpdate> updates) {
  // Measured (bench_runtime): a step costs about as much as a comparison of a sort, of which there are n log n.
  const uint64_t limit = steps_ + 32 * (uint64_t(size_) + updates.size());
  std::vector<PriorityUpdate> fresh;
  size_t done = 0;
  for (; done < updates.size() && steps_ < limit; ++done) {
    const PriorityUpdate& u = updates[done];
    if (!entry(u.node).listed)
      fresh.push_back(u);
    else if (entry(u.node).priority != u.priority)
      move(u.node, u.priority);
  }
  // Most important first, so that each new one starts where the last one went in.
  std::stable_sort(fresh.begin(), fresh.end(),
                   [](const PriorityUpdate& a, const PriorityUpdate& b) { return a.priority > b.priority; });
  finger_ = kNoNode;
  for (const PriorityUpdate& u : fresh) update(u.node, u.priority);
  if (done == updates.size()) return;
  for (const PriorityUpdate& u : updates.subspan(done)) {
    Entry& e = entry(u.node);
    if (!e.listed) {
      e = Entry{};
      e.listed = true;
      link_before(u.node, kNoNode);
    }
    e.priority = u.priority;
    e.turn = ++turns_;
  }
  sort_all();
}

void PriorityList::sort_all() {
  scratch_.clear();
  for (NodeId id = head_; id != kNoNode; id = entry(id).next) scratch_.push_back(id);
  std::sort(scratch_.begin(), scratch_.end(), [this](NodeId a, NodeId b) { return above(a, b); });
  head_ = tail_ = cached_ = finger_ = kNoNode;
  size_ = 0;
  for (const NodeId id : scratch_) link_before(id, kNoNode);
  cached_ = head_;
}

void PriorityList::erase(NodeId id) {
  if (!entry(id).listed) return;
  unlink(id);
  entry(id) = Entry{};
}

void PriorityList::set_loaded(NodeId id, bool loaded) {
  entry(id).loaded = loaded;
  notice_unloaded(id);
}

NodeId PriorityList::next_unloaded() {
  for (; cached_ != kNoNode && entry(cached_).loaded; cached_ = entry(cached_).next) ++steps_;
  return cached_;
}

}  // namespace promenade
