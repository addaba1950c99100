#include "codec/open_edges.h"

namespace promenade {
namespace {

constexpr int kLookAt = 16;  // bounds the search on hostile input; few places have more edges

}  // namespace

uint32_t OpenEdges::latest(uint32_t& first, uint32_t Entry::*next) {
  while (first != kNone && !entries_[first].is_open) first = entries_[first].*next;
  return first;
}

bool OpenEdges::close_between(uint32_t from, uint32_t to) {
  uint32_t* at = &first_from_[from];
  for (int looked = 0; *at != kNone && looked < kLookAt;) {
    Entry& entry = entries_[*at];
    if (!entry.is_open) {
      *at = entry.next_from;
      continue;
    }
    if (place_of_[entry.edge.to] == to) {
      entry.is_open = false;
      return true;
    }
    ++looked;
    at = &entry.next_from;
  }
  return false;
}

void OpenEdges::add(const OpenEdge& edge) {
  const uint32_t from = place_of_[edge.from], to = place_of_[edge.to];
  const auto index = static_cast<uint32_t>(entries_.size());
  entries_.push_back({edge, first_from_[from], first_to_[to]});
  first_from_[from] = first_to_[to] = index;
  stack_.push_back(index);
}

void OpenEdges::add_or_close(const OpenEdge& edge) {
  if (!close_between(place_of_[edge.to], place_of_[edge.from])) add(edge);
}

bool OpenEdges::take(OpenEdge& edge) {
  while (!stack_.empty()) {
    Entry& entry = entries_[stack_.back()];
    stack_.pop_back();
    if (!entry.is_open) continue;
    entry.is_open = false;
    edge = entry.edge;
    return true;
  }
  return false;
}

void OpenEdges::close_all() {
  for (const uint32_t index : stack_) entries_[index].is_open = false;
  stack_.clear();
}

}  // namespace promenade
