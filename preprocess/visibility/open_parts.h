#pragma once
// Where in a cell somebody may stand: nobody does inside a house. A cell that reaches into houses is asked as its open
// parts, which are smaller, and between which and the rest of the world those houses' walls stand.

#include <vector>

#include "preprocess/visibility/occluders.h"

namespace promenade {

/// An occluder as a cell may use it: what is drawn for it lies within error_m of the source.
struct UsableOccluder {
  const Occluder* occluder;
  float error_m;
  float distance_m;  ///< of its plan from the cell's
};

/// The loops of an occluder that lie at least erosion_m within what is drawn for it; none: it is too small.
struct ErodedLoops {
  std::span<const OccluderLoop> loops;
  float erosion_m;  ///< how far they do lie within what is solid in the source
};
ErodedLoops eroded_loops(const OccluderSet& set, const UsableOccluder& usable, float erosion_m);

/// Boxes that together hold every point of the cell that is in no occluder, each as high as the cell; one, the cell
/// itself, where no occluder fills a part of its plan from its bottom to its top, or all of it. They may overlap. A few
/// at most. Metres, model space. Pure; any thread.
std::vector<Box> open_parts(const Box& cell, const OccluderSet& set, const std::vector<UsableOccluder>& usable);

}  // namespace promenade
