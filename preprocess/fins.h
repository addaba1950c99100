#pragma once
// Fins: strips along a node's borders that close what opens between it and a neighbour of another level.

#include <cstdint>
#include <functional>
#include <vector>

#include "preprocess/border.h"

namespace promenade {

struct FinOptions {
  float leaf_step_m = 0;  ///< of the grid that all borders lie on
  /// A triangle's material as its fin has it: seen from both sides. Unset: the same.
  std::function<uint32_t(uint32_t material)> fin_material;
};

/// Sets strips along edges of the border that pass by points of the source's line: as far above, below and beyond the
/// edge as these are and half as far again, so that whatever points a finer neighbour has kept, its border meets the
/// strips. Edges that pass by nothing, or along a straight line, need none. Fins look like the triangle that they stand
/// on and are lit like the surface. Two triangles an edge, four where what it passes by lies both beyond it and above
/// or below. Returns, for each vertex, whether it is on the border or a fin's: those must be stored exactly; empty
/// where there is no border. Pure; any thread.
std::vector<uint8_t> add_fins(Mesh& mesh, const Border& border, const FinOptions& options);

}  // namespace promenade
