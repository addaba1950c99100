// What a cell sees past upright solids outside it, its four top edges see: lift the eye to the cell's top, then move it
// along the ray's plan to where the ray leaves the cell, or (when it climbs above the top before that) to where it
// enters: the ray to the same target then runs no lower anywhere outside the cell. [chhugani2003] section 5.1 argues
// likewise for its horizon planes.
//
// An edge is decided in segments. From the middle of a segment, solids eroded by half its length (and by the error of
// what is drawn for them, which also lowers them) hide what the solids hide from all of the segment, however many of
// them work together: a ray from another point of the segment runs within the erosion of the middle's ray, at the same
// heights. Seen past the solids as they are: seen. Neither: the segment is halved.
// Source: the shrinking of occluders for a region of eyes is [chhugani2003] section 5.2's (its [WWS00]).
//
// A cell that reaches into houses is asked as its open parts, one after the other: what none of them sees is hidden.

#include "preprocess/visibility/hiders/horizon.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "preprocess/visibility/azimuth_horizon.h"
#include "preprocess/visibility/error_map.h"
#include "preprocess/visibility/open_parts.h"

namespace promenade {
namespace {

constexpr int kMostHalvings = 6;  // measured: study hiders
constexpr float kSmallestSegmentM = 0.2F;
// Measured: after so many halvings it pays to look whether what is undecided is seen. Bins are coarse, and what a look
// sees is kept for good: more looks are slower, and keep more.
constexpr int kLook = 3;
constexpr size_t kFewTargets = 500;  // more are looked at node by node, but for nodes that fill a wide angle
constexpr uint32_t kWideBins = AzimuthHorizon::kBins / 16;

/// Whether one of two boxes lies above or below the other.
bool share_plan(const Box& a, const Box& b) {
  return a.min.x <= b.max.x && b.min.x <= a.max.x && a.min.y <= b.max.y && b.min.y <= a.max.y;
}

float plan_distance(const Box& a, const Box& b) {
  const glm::vec2 gap =
      glm::max(glm::max(glm::vec2(a.min) - glm::vec2(b.max), glm::vec2(b.min) - glm::vec2(a.max)), glm::vec2(0));
  return std::hypot(gap.x, gap.y);
}

/// Boxes that must be hidden one by one; several belong to a node.
struct Target {
  Box box;
  uint32_t node;  ///< into the front
};

/// A cell's question in work, or that of an open part of it.
class CellWork {
 public:
  CellWork(const HeldParts& parts, const OccluderSet& set, const HiderQuestion& question, std::span<uint8_t> hidden)
      : parts_(parts), set_(set), cell_(question.cell), front_(question.front), hidden_(hidden) {}

  void run(const std::vector<UsableOccluder>& occluders) {
    gather_targets();
    gather_occluders(occluders);
    if (usable_.empty()) return;
    look_from_corners();
    prove_edges();
    for (size_t i = 0; i < front_.size(); ++i)
      if (state_[i] == State::open) hidden_[i] = 1;
  }

 private:
  using Ground = OccluderSet::Ground;
  enum class State : uint8_t { open, seen };
  enum class Fate : uint8_t { unseen, open, seen };
  enum class Slipped : uint8_t { unknown, no, yes };
  using Targets = std::vector<uint32_t>;

  Fate fate_of(const NodePart& part, bool may_slip);
  bool is_slipped_under(size_t usable);
  void gather_targets();
  void gather_occluders(const std::vector<UsableOccluder>& occluders);
  void look_from_corners();
  void prove_edges();
  void prove(const glm::dvec3& from, const glm::dvec3& to, Targets targets, int halvings);
  void fill_horizon(const glm::dvec3& eye, const Targets& targets, float erosion_m);
  /// Of the targets that the horizon was filled for, those that it does not hide.
  Targets not_hidden(const Targets& targets);
  /// Keeps nodes with a target that the horizon does not hide.
  void keep_seen(const Targets& targets) { keep(not_hidden(targets)); }
  void keep(const Targets& targets) {
    for (const uint32_t t : targets) state_[targets_[t].node] = State::seen;
  }
  Targets still_open(const Targets& targets) const {
    Targets open;
    for (const uint32_t t : targets)
      if (state_[targets_[t].node] == State::open) open.push_back(t);
    return open;
  }
  std::array<glm::dvec3, 4> corners() const {
    const glm::dvec3 low(cell_.min), high(cell_.max);
    return {
        glm::dvec3(low.x, low.y, high.z), {high.x, low.y, high.z}, {high.x, high.y, high.z}, {low.x, high.y, high.z}};
  }

  const HeldParts& parts_;
  const OccluderSet& set_;
  const Box cell_;
  std::span<const NodeId> front_;
  std::span<uint8_t> hidden_;
  std::vector<State> state_;
  std::vector<Target> targets_;         ///< by node
  std::vector<Box> boxes_;              ///< of a node's targets together
  float eyes_from_m_ = 0;               ///< no eye is lower
  float lowest_m_ = 0;                  ///< no ray that matters goes below
  std::vector<UsableOccluder> usable_;  ///< nearest first
  std::vector<Slipped> slipped_;        ///< by usable one: whether rays may run beneath it
  AzimuthHorizon horizon_;
  std::vector<BoxInView> views_;  ///< of the targets that it was filled for; empty: these are many
};

/// What rays from the cell may do on their way to a part. Eyes are in the air, so above the ground; what lies below the
/// ground is seen only by rays that slip under it.
CellWork::Fate CellWork::fate_of(const NodePart& part, bool may_slip) {
  if (faces_away_from_cell(part.cone, part.box, cell_)) return Fate::unseen;
  const Ground& ground = set_.ground;
  const float solid = ground.solid_below(part.box);
  float lowest = part.box.min.z;
  if (lowest < solid && !(may_slip && ground.has_slips(cell_, part.box))) {
    if (part.box.max.z < solid) return Fate::unseen;
    lowest = solid;
  }
  if (share_plan(part.box, cell_)) return Fate::seen;
  lowest_m_ = std::min(lowest_m_, lowest);
  return Fate::open;
}

/// The parts of each node that must be hidden for it to be. A node with a part above, below or around the cell is seen.
void CellWork::gather_targets() {
  state_.assign(front_.size(), State::open);
  boxes_.assign(front_.size(), Box());
  eyes_from_m_ = std::max(cell_.min.z, std::min(set_.ground.solid_below(cell_), cell_.max.z));
  lowest_m_ = eyes_from_m_;
  for (uint32_t i = 0; i < front_.size(); ++i) {
    if (hidden_[i] != 0) {
      state_[i] = State::seen;  // nothing to prove; what is set already stays
      continue;
    }
    const size_t first = targets_.size();
    Box whole;
    for (const NodePart& part : parts_.of(i)) whole.add(part.box);
    const bool may_slip = set_.ground.has_slips(cell_, whole);
    for (const NodePart& part : parts_.of(i)) {
      const Fate fate = fate_of(part, may_slip);
      if (fate == Fate::open) targets_.push_back({part.box, i}), boxes_[i].add(part.box);
      if (fate != Fate::seen) continue;
      state_[i] = State::seen;
      targets_.resize(first);
      break;
    }
  }
}

void CellWork::gather_occluders(const std::vector<UsableOccluder>& occluders) {
  usable_.reserve(occluders.size());
  for (const UsableOccluder& each : occluders) {
    const Occluder& occluder = *each.occluder;
    if (occluder.base_m > lowest_m_) continue;
    usable_.push_back({&occluder, each.error_m, plan_distance(occluder.box, cell_)});
  }
  std::stable_sort(usable_.begin(), usable_.end(),
                   [](const UsableOccluder& a, const UsableOccluder& b) { return a.distance_m < b.distance_m; });
  slipped_.assign(usable_.size(), Slipped::unknown);
}

/// A ray may be under an occluder that goes all the way down when it slipped under the ground before. Asked of those
/// alone that would hide something: most of a city's never would.
bool CellWork::is_slipped_under(size_t usable) {
  if (lowest_m_ >= set_.ground.slips_top_m) return false;
  Slipped& known = slipped_[usable];
  if (known == Slipped::unknown)
    known = set_.ground.has_slips(cell_, usable_[usable].occluder->box) ? Slipped::yes : Slipped::no;
  return known == Slipped::yes;
}

void CellWork::fill_horizon(const glm::dvec3& eye, const Targets& targets, float erosion_m) {
  horizon_.reset(eye);
  horizon_.want_none();
  const bool few = targets.size() < kFewTargets;
  views_.clear();
  for (size_t i = 0; i < targets.size();) {
    const uint32_t node = targets_[targets[i]].node;
    BoxInView whole;
    if (!few) whole = horizon_.view_of(boxes_[node]);
    const bool as_one = !few && whole.bins < kWideBins;
    if (as_one) horizon_.want(whole);
    for (; i < targets.size() && targets_[targets[i]].node == node; ++i) {
      if (as_one) continue;
      const BoxInView view = horizon_.view_of(targets_[targets[i]].box);
      horizon_.want(view);
      if (few) views_.push_back(view);
    }
  }
  horizon_.wants_complete();
  for (size_t i = 0; i < usable_.size(); ++i) {
    const UsableOccluder& usable = usable_[i];
    const ErodedLoops loops = eroded_loops(set_, usable, erosion_m);
    if (loops.loops.empty() || !horizon_.worth_adding(usable.occluder->box) || is_slipped_under(i)) continue;
    // A ray beside the middle's meets the solid within that of where the middle's ray meets the loop: outside the cell.
    const Box clear = cell_.grown(erosion_m + usable.error_m);
    for (const OccluderLoop& loop : loops.loops) {
      if (loop.is_hole) continue;  // the outline around it hides as much, and more
      const float top_m = loop.top_m - usable.error_m;
      if (loops.loops.size() == 1 || horizon_.worth_adding({{loop.low, top_m}, {loop.high, top_m}}))
        horizon_.add(set_.points_of(loop), top_m, clear);
    }
  }
}

/// Few by their views; of many, nodes first, their parts only where that does not do.
CellWork::Targets CellWork::not_hidden(const Targets& targets) {
  Targets left;
  const bool few = views_.size() == targets.size();
  for (size_t i = 0; i < targets.size();) {
    const uint32_t node = targets_[targets[i]].node;
    const bool hidden = !few && horizon_.hides(horizon_.view_of(boxes_[node]));
    for (; i < targets.size() && targets_[targets[i]].node == node; ++i)
      if (!hidden && !horizon_.hides(few ? views_[i] : horizon_.view_of(targets_[targets[i]].box)))
        left.push_back(targets[i]);
  }
  return left;
}

/// Most of what is seen is seen from a corner.
void CellWork::look_from_corners() {
  Targets open(targets_.size());
  std::iota(open.begin(), open.end(), 0U);
  for (const glm::dvec3& eye : corners()) {
    fill_horizon(eye, open, 0);
    keep_seen(open);
    open = still_open(open);
  }
}

void CellWork::prove_edges() {
  Targets all(targets_.size());
  std::iota(all.begin(), all.end(), 0U);
  const auto corner = corners();
  for (size_t i = 0; i < 4; ++i) prove(corner[i], corner[(i + 1) % 4], still_open(all), 0);
}

void CellWork::prove(const glm::dvec3& from, const glm::dvec3& to, Targets targets, int halvings) {
  targets = still_open(targets);
  if (targets.empty()) return;
  const glm::dvec3 middle = (from + to) * 0.5;
  const auto half = static_cast<float>(glm::length(to - from) * 0.5 * (1 + 1e-6));
  fill_horizon(middle, targets, half);
  targets = not_hidden(targets);
  if (targets.empty()) return;
  if (halvings == kMostHalvings || 2 * half <= kSmallestSegmentM) return keep(targets);
  if (halvings == kLook) {
    fill_horizon(middle, targets, 0);
    keep_seen(targets);
    targets = still_open(targets);
  }
  prove(from, middle, targets, halvings + 1);
  prove(middle, to, targets, halvings + 1);
}

class HorizonHider : public Hider {
 public:
  HorizonHider(const Model& model, const NodeParts& parts, const OccluderSet& occluders)
      : model_(model), parts_(parts), occluders_(occluders) {}

  std::string_view name() const override { return "horizon"; }

  Status hide(const HiderQuestion& question, std::span<uint8_t> hidden) const override {
    const Result<HeldParts> held = parts_.hold(question.front, hidden);
    if (!held) return held.error();
    const std::vector<UsableOccluder> usable = usable_in(question);
    std::vector<uint8_t> settled(hidden.begin(), hidden.end()), seen(hidden.size(), 0);
    for (const Box& part : open_parts(question.cell, occluders_, usable)) {
      std::vector<uint8_t> hidden_there = settled;
      CellWork(*held, occluders_, {part, question.front}, hidden_there).run(usable);
      for (size_t i = 0; i < hidden.size(); ++i)
        if (hidden_there[i] == 0) settled[i] = seen[i] = 1;
    }
    for (size_t i = 0; i < hidden.size(); ++i)
      if (seen[i] == 0) hidden[i] = 1;
    return Done{};
  }

 private:
  std::vector<UsableOccluder> usable_in(const HiderQuestion& question) const {
    ErrorMap errors(model_, question.front);
    std::vector<UsableOccluder> usable;
    usable.reserve(occluders_.occluders.size());
    for (const Occluder& occluder : occluders_.occluders)
      usable.push_back({&occluder, errors.around(occluder.box), plan_distance(occluder.box, question.cell)});
    return usable;
  }

  const Model& model_;
  const NodeParts& parts_;
  const OccluderSet& occluders_;
};

}  // namespace

std::unique_ptr<Hider> make_horizon_hider(const Model& model, const NodeParts& parts, const OccluderSet& occluders) {
  return std::make_unique<HorizonHider>(model, parts, occluders);
}

}  // namespace promenade
