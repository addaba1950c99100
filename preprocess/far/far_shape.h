#pragma once
// From pictures with depths to the faces of a far picture: as few triangles as keep the parallax within a bound.

#include <array>
#include <optional>
#include <vector>

#include "codec/far_face.h"
#include "layout/far.h"

namespace promenade {

/// A side as it was drawn; nothing: nothing is seen there.
struct DrawnSide {
  Image colors;                ///< opacity 0: nothing is there
  std::vector<float> depth_m;  ///< along the side's axis; infinity: nothing
};

struct ShapedFar {
  std::array<std::optional<FarFace>, 6> faces;
  /// No pixel's point is seen farther from where it is drawn, from anywhere in the cell: pixel by pixel, of the
  /// triangles as they are stored and drawn.
  double parallax_rad = 0;
};

/// tables: bound, box, cell, levels and whether there are depths. Faces share the vertices along their common edges:
/// seen from anywhere there is no crack between them. Deterministic. Any thread.
ShapedFar shape_far(const FarTables& tables, std::array<std::optional<DrawnSide>, 6> sides);

}  // namespace promenade
