#pragma once
// A k-d tree along a building's walls, floors and ceilings.

#include <cstdint>
#include <vector>

#include "geometry/job_monitor.h"
#include "layout/model_io.h"
#include "preprocess/visibility/view_cells.h"

namespace promenade {

/// Surface that is perpendicular to an axis: all of it that lies in one plane and in one tile of that plane.
struct AxialPatch {
  uint32_t axis = 0;   ///< 0, 1, 2
  float at_m = 0;      ///< along the axis
  Box extent;          ///< flat
  double area_m2 = 0;  ///< of both sides
};

/// The axial surface of a model's leaves, by axis and place; fine tessellation is gathered in tiles. Reads every leaf's
/// mesh, several at once; the same for any number of threads. Errors: reading the model, cancellation.
Result<std::vector<AxialPatch>> find_axial_patches(const ModelReader& reader, JobMonitor& monitor);

struct WallSplitOptions {
  /// A plane splits a box when this part of the box's cross-section is surface. Less: furniture splits rooms; more:
  /// walls with many doors do not.
  double least_cover = 0.4;
  float thinnest_m = 0.04F;  ///< no part is thinner: walls are, their paint is not
  /// Empty space beside the surfaces in a box is cut off where it is more than this part of the box's length: the air
  /// around a house, in which its walls would cover little.
  double least_margin = 0.05;
  int deepest = 48;  ///< halvings
  /// Boxes thinner than this are cut also where surfaces go through them from side to side, however short: at the
  /// sides of doors, windows and shafts. 0: not.
  float thin_m = 0;
};

/// Splits a leaf of the plan, and its parts, at the plane that is covered most; where none is covered enough, where the
/// surfaces in it end; until neither is left. Returns the leaves below. Source: [funkhouser1993] section 3.2.1: "along
/// the major opaque elements in the model".
std::vector<uint32_t> split_along_walls(CellPlan& plan, uint32_t leaf, const std::vector<AxialPatch>& patches,
                                        const WallSplitOptions& options);

}  // namespace promenade
