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

#include "preprocess/visibility/hiders/horizon.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "preprocess/visibility/azimuth_horizon.h"
#include "preprocess/visibility/hiders/upright_cell.h"

namespace promenade {
namespace {

constexpr int kMostHalvings = 6;  // measured: study hiders
constexpr float kSmallestSegmentM = 0.2F;
// Measured: after so many halvings it pays to look whether what is undecided is seen. Bins are coarse, and what a look
// sees is kept for good: more looks are slower, and keep more.
constexpr int kLook = 3;
constexpr size_t kFewTargets = 500;  // more are looked at node by node, but for nodes that fill a wide angle
constexpr uint32_t kWideBins = AzimuthHorizon::kBins / 16;

class CellWork : UprightCell {
 public:
  using UprightCell::UprightCell;

  void run(const std::vector<UsableOccluder>& occluders) {
    gather_targets();
    gather_occluders(occluders);
    if (usable_.empty()) return;
    look_from_corners();
    prove_edges();
    hide_open();
  }

 private:
  void look_from_corners();
  void prove_edges();
  void prove(const glm::dvec3& from, const glm::dvec3& to, Targets targets, int halvings);
  void fill_horizon(const glm::dvec3& eye, const Targets& targets, float erosion_m);
  /// Of the targets that the horizon was filled for, those that it does not hide.
  Targets not_hidden(const Targets& targets);
  /// Keeps nodes with a target that the horizon does not hide.
  void keep_seen(const Targets& targets) { keep(not_hidden(targets)); }
  std::array<glm::dvec3, 4> corners() const {
    const glm::dvec3 low(cell_.min), high(cell_.max);
    return {
        glm::dvec3(low.x, low.y, high.z), {high.x, low.y, high.z}, {high.x, high.y, high.z}, {low.x, high.y, high.z}};
  }

  AzimuthHorizon horizon_;
  std::vector<BoxInView> views_;  ///< of the targets that it was filled for; empty: these are many
};

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
  Targets open = all_targets();
  for (const glm::dvec3& eye : corners()) {
    fill_horizon(eye, open, 0);
    keep_seen(open);
    open = still_open(open);
  }
}

void CellWork::prove_edges() {
  const Targets all = all_targets();
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

}  // namespace

std::unique_ptr<Hider> make_horizon_hider(const Model& model, const NodeParts& parts, const OccluderSet& occluders) {
  return std::make_unique<UprightHider<CellWork>>("horizon", model, parts, occluders);
}

}  // namespace promenade
