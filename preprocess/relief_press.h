#pragma once
// Reliefs pressed flat while a surface is simplified.

#include <vector>

#include "preprocess/collapse.h"
#include "preprocess/patches.h"
#include "preprocess/relief.h"

namespace promenade {

/// Presses reliefs onto planes in their middles: what a wall and its windows are off by then is half of how far the one
/// lies behind the other, and collapses that cost no more than that make one face of them. What led straight from the
/// one to the other goes at once. Places on the node's border stay.
class ReliefPress {
 public:
  /// All outlive the press. patches: copies of what is painted on a relief go with it.
  ReliefPress(WorkMesh& work, Collapser& collapser, const BorderLines& borders, std::vector<Relief> reliefs,
              const std::vector<Patch>& patches);

  uint32_t count() const { return static_cast<uint32_t>(reliefs_.size()); }
  /// What pressing would cost at first sight, in metres.
  float first_cost(uint32_t relief) const { return reliefs_[relief].depth_m() / 2; }

  /// Presses what is left of a relief of one part, if it costs no more than the limit: the largest distance at which
  /// that leaves a point of the source from the triangle that it is on. Returns the cost, or less, over the limit,
  /// where nothing has moved; infinite where there is nothing to press.
  float press(uint32_t relief, float limit_m);
  /// Places that have, or had, triangles which the last press has changed; valid until the next one.
  const std::vector<uint32_t>& changed() const { return changed_; }

 private:
  void gather_places(const Relief& relief);
  bool is_flat(const Relief& relief) const;
  void gather_points();
  void merge_places(const Relief& relief);
  void gather_changed();

  WorkMesh& work_;
  Collapser& collapser_;
  const BorderLines& borders_;
  std::vector<Relief> reliefs_;
  std::vector<uint32_t> places_, changed_;
  std::vector<uint32_t> press_of_place_;  // of each place: the last press that it was among places_ of
  uint32_t press_ = 0;
  std::vector<glm::vec3> points_, to_;
};

}  // namespace promenade
