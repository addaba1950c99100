#include "preprocess/visibility/hiders/upright_cell.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "preprocess/visibility/error_map.h"

namespace promenade {
namespace {

/// Whether one of two boxes lies above or below the other.
bool share_plan(const Box& a, const Box& b) {
  return a.min.x <= b.max.x && b.min.x <= a.max.x && a.min.y <= b.max.y && b.min.y <= a.max.y;
}

float plan_distance(const Box& a, const Box& b) {
  const glm::vec2 gap =
      glm::max(glm::max(glm::vec2(a.min) - glm::vec2(b.max), glm::vec2(b.min) - glm::vec2(a.max)), glm::vec2(0));
  return std::hypot(gap.x, gap.y);
}

}  // namespace

/// What rays from the cell may do on their way to a part. Eyes are in the air, so above the ground; what lies below the
/// ground is seen only by rays that slip under it.
UprightCell::Fate UprightCell::fate_of(const NodePart& part, bool may_slip) {
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

void UprightCell::gather_targets() {
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

void UprightCell::gather_occluders(const std::vector<UsableOccluder>& occluders) {
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

bool UprightCell::is_slipped_under(size_t usable) {
  if (lowest_m_ >= set_.ground.slips_top_m) return false;
  Slipped& known = slipped_[usable];
  if (known == Slipped::unknown)
    known = set_.ground.has_slips(cell_, usable_[usable].occluder->box) ? Slipped::yes : Slipped::no;
  return known == Slipped::yes;
}

UprightCell::Targets UprightCell::all_targets() const {
  Targets all(targets_.size());
  std::iota(all.begin(), all.end(), 0U);
  return all;
}

UprightCell::Targets UprightCell::still_open(const Targets& targets) const {
  Targets open;
  for (const uint32_t t : targets)
    if (state_[targets_[t].node] == State::open) open.push_back(t);
  return open;
}

std::vector<UsableOccluder> usable_occluders(const Model& model, const OccluderSet& set,
                                             const HiderQuestion& question) {
  ErrorMap errors(model, question.front);
  std::vector<UsableOccluder> usable;
  usable.reserve(set.occluders.size());
  for (const Occluder& occluder : set.occluders)
    usable.push_back({&occluder, errors.around(occluder.box), plan_distance(occluder.box, question.cell)});
  return usable;
}

}  // namespace promenade
