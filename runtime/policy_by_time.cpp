// Policies time_slices, lakhia and vlod_time_slices. Source: [lakhia2004] section 4.2.

#include <algorithm>
#include <cmath>

#include "runtime/selecting.h"

namespace promenade {
namespace {

/// Of shareTime that levels of detail get at least, however long the picture itself takes: coarser ones save little
/// then.
constexpr double kLeastPart = 4;
/// Of the picture's own time that levels get at least: where it takes longer than the target, on a slow or busy
/// machine, a handful of coarse nodes would save less than this part of the frame.
constexpr double kLeastOfPicture = 0.25;

class ByTime {
 public:
  explicit ByTime(Selecting& selecting) : s_(selecting) {}
  void run();

 private:
  struct Slice {
    NodeId node;
    double ms;
    bool seen_whole;  ///< the vLOD has it or an ancestor: all that is below may be seen
  };
  /// A sibling set priced and counted: what [lakhia2004] decides on.
  struct Siblings {
    std::vector<Slice> visible;
    uint32_t visible_missing = 0, missing = 0;
    double needed_ms = 0;
    int64_t cumulative_hysteresis = 0;
  };
  void price_siblings(std::span<const NodeId> ids, double share_ms, bool seen_whole, Siblings& siblings);
  void update_hysteresis(NodeId id, double slice_ms, double needed_ms);
  bool time_allows(const Siblings& siblings, double share_ms) const;
  double share_of_roots_ms() const;

  Selecting& s_;
  double moving_ms_ = 0;
};

void ByTime::update_hysteresis(NodeId id, double slice_ms, double needed_ms) {
  const TimeSliceOptions& time = s_.options.time;
  SelectState::Node& kept = s_.state.nodes[index_of(id)];
  const double urgency = (slice_ms - needed_ms) / std::max(needed_ms, 1e-9);
  // The paper does not say where a counter starts. Started at 0, everything resident would be refined until the
  // counters have fallen: start on the side of the first verdict.
  double hysteresis = kept.visited == 0 && urgency < 0 ? -time.hysteresis_switch : double(kept.hysteresis) + urgency;
  hysteresis = std::clamp(hysteresis, -time.hysteresis_limit, time.hysteresis_limit);
  kept.hysteresis = static_cast<float>(hysteresis);
  kept.visited = s_.state.frame;
}

/// Equation 4.1 for all visible siblings; of the others those that may be seen from the cell are priced only.
void ByTime::price_siblings(std::span<const NodeId> ids, double share_ms, bool seen_whole, Siblings& siblings) {
  const TimeSliceOptions& time = s_.options.time;
  siblings.visible.clear();
  siblings.missing = siblings.visible_missing = 0;
  siblings.needed_ms = 0;
  siblings.cumulative_hysteresis = 0;
  double sum = 0;
  for (const NodeId id : ids) {
    if (!seen_whole && !s_.may_be_seen(id)) continue;
    const float priority = s_.price(id);
    const bool is_missing = !s_.resident(id);
    siblings.missing += is_missing ? 1 : 0;
    if (!s_.visible(id)) continue;
    siblings.visible_missing += is_missing ? 1 : 0;
    siblings.visible.push_back({id, double(priority), seen_whole || (s_.vlod != nullptr && s_.vlod->has(id))});
    sum += double(priority);
  }
  for (Slice& slice : siblings.visible) {
    const double even = 1.0 / double(siblings.visible.size());
    slice.ms = share_ms * (sum > 0 ? slice.ms / sum : even);
    const double needed_ms = s_.ms_of_node(slice.node);
    siblings.needed_ms += needed_ms;
    update_hysteresis(slice.node, slice.ms, needed_ms);
    siblings.cumulative_hysteresis += static_cast<int64_t>(
        std::trunc(double(s_.state.nodes[index_of(slice.node)].hysteresis) / time.hysteresis_switch));
  }
}

bool ByTime::time_allows(const Siblings& siblings, double share_ms) const {
  return s_.options.time.hysteresis ? siblings.cumulative_hysteresis >= 0 : share_ms > siblings.needed_ms;
}

/// With a cost model the picture's own time and what is spoken for are no levels' to share.
double ByTime::share_of_roots_ms() const {
  const double share_ms = s_.state.share_ms;
  const double picture_ms = s_.state.costs ? s_.state.costs->estimate_ms(s_.out.load) : 0;
  return std::max(
      {share_ms - picture_ms - s_.view.reserved_ms - moving_ms_, share_ms / kLeastPart, picture_ms * kLeastOfPicture});
}

void ByTime::run() {
  const bool bounded = s_.options.policy != Policy::lakhia;
  moving_ms_ = select_moving(s_);
  Siblings siblings;
  price_siblings(s_.still_roots(), share_of_roots_ms(), s_.vlod == nullptr, siblings);
  std::vector<Slice> queue = siblings.visible;
  for (size_t i = 0; i < queue.size(); ++i) {
    const Slice at = queue[i];
    const NodeRecord& n = s_.node(at.node);
    if (n.child_count == 0 || (bounded && s_.fine_enough(at.node))) {
      s_.out.front.push_back(at.node);
      continue;
    }
    price_siblings(s_.model.children_of(at.node), at.ms, at.seen_whole, siblings);
    const uint32_t lacking = s_.options.time.all_children_resident ? siblings.missing : siblings.visible_missing;
    const bool allowed = time_allows(siblings, at.ms);
    if (allowed && lacking == 0) {
      // No child visible: the culling of the parent was the coarser of the two, and nothing is drawn.
      queue.insert(queue.end(), siblings.visible.begin(), siblings.visible.end());
      continue;
    }
    s_.out.front.push_back(at.node);
    if (allowed) {
      s_.out.nodes_missing += lacking;
      s_.state.nodes[index_of(at.node)].lacked = s_.state.frame;
    } else if (lacking == 0) {
      ++s_.out.loaded_rejected;
    }
  }
}

}  // namespace

void select_by_time(Selecting& selecting) { ByTime(selecting).run(); }

}  // namespace promenade
