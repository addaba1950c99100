#pragma once
// Solid boxes that hide something from a whole cell, and the point from which they stand for that.
// Source: [chhugani2003] section 5.2.

#include <span>
#include <vector>

#include "preprocess/visibility/box_shadow.h"

namespace promenade {

/// A box that hides something from the whole cell.
struct ShrunkOccluder {
  BoxShadow shadow;
  uint32_t face;  ///< of a cube about the cell, as BoxView numbers them: the side on which the box is
  double u, v;    ///< where on that face its middle is, in [-1, 1] or beyond
  double cross;   ///< of its shadow's cone, 1 before the point
  double front;   ///< where along the face's axis the box begins
};

/// Of solid boxes, in their order, those that are apart from the cell and whose shadow does not end behind them.
std::vector<ShrunkOccluder> shrunk_occluders(const Box& cell, std::span<const Box> solids);

/// The point for a picture of occluders together: all of them may be seen from it. The cell's middle without
/// any. `world` holds the model.
glm::dvec3 projection_point(const Box& cell, const Box& world, std::span<const ShrunkOccluder* const> occluders);

}  // namespace promenade
