#include "layout/walk_cost.h"

#include <algorithm>
#include <iterator>

namespace promenade {
namespace {

/// The nodes in memory, by place.
class Residents {
 public:
  Residents(const NodeLayout& layout, uint64_t memory_bytes)
      : layout_(layout), memory_bytes_(memory_bytes), nodes_(layout.nodes()) {}

  bool has(uint32_t place) const { return nodes_[place].resident; }
  uint64_t useful_bytes() const { return useful_bytes_; }

  void add(uint32_t place) {
    Node& node = nodes_[place];
    if (node.resident) return;
    node = {true, false, now_};
    held_bytes_ += layout_.bytes_of(place);
  }
  void use(uint32_t place) {
    Node& node = nodes_[place];
    if (!node.used) useful_bytes_ += layout_.bytes_of(place);
    node.used = true, node.last = now_;
  }
  /// Ends a visit that wanted these: room is made, they stay.
  void end_visit(std::span<const uint32_t> wanted) {
    if (held_bytes_ > memory_bytes_) {
      std::vector<uint32_t> others;
      for (uint32_t place = 0; place < nodes_.size(); ++place)
        if (nodes_[place].resident && !std::binary_search(wanted.begin(), wanted.end(), place)) others.push_back(place);
      std::stable_sort(others.begin(), others.end(),
                       [this](uint32_t a, uint32_t b) { return nodes_[a].last < nodes_[b].last; });
      for (size_t i = 0; i < others.size() && held_bytes_ > memory_bytes_; ++i) {
        nodes_[others[i]].resident = false;
        held_bytes_ -= layout_.bytes_of(others[i]);
      }
    }
    ++now_;
  }

 private:
  struct Node {
    bool resident = false, used = false;
    uint64_t last = 0;  ///< visit that wanted or read it
  };
  const NodeLayout& layout_;
  uint64_t memory_bytes_;
  std::vector<Node> nodes_;
  uint64_t held_bytes_ = 0, useful_bytes_ = 0, now_ = 0;
};

/// Reads what is missing; with it comes what lies between.
ReadPlan visit(const NodeLayout& layout, std::span<const uint32_t> wanted, const WalkOptions& options,
               Residents& residents) {
  std::vector<uint32_t> missing;
  std::copy_if(wanted.begin(), wanted.end(), std::back_inserter(missing),
               [&](uint32_t place) { return !residents.has(place); });
  const std::vector<Extent> extents = layout.extents(missing);
  for (const Extent& read : merge_reads(extents, options.profile, options.least_useful)) {
    const NodeLayout::Places places = layout.whole_in(read);
    for (uint32_t place = places.first; place < places.last; ++place) residents.add(place);
  }
  for (const uint32_t place : wanted) residents.add(place), residents.use(place);
  residents.end_visit(wanted);
  return plan_reads(extents, options.profile, options.least_useful);
}

}  // namespace

WalkCost walk_cost(const NodeLayout& layout, std::span<const std::vector<uint32_t>> wanted,
                   const WalkOptions& options) {
  WalkCost cost;
  Residents residents(layout, options.memory_bytes);
  for (size_t i = 0; i < wanted.size(); ++i)
    (i == 0 ? cost.start : cost.steps).add(visit(layout, wanted[i], options, residents));
  cost.taken = wanted.empty() ? 0 : wanted.size() - 1;
  const uint64_t bytes = cost.start.bytes + cost.steps.bytes;
  if (bytes > 0) cost.useful_share = static_cast<double>(residents.useful_bytes()) / static_cast<double>(bytes);
  return cost;
}

}  // namespace promenade
