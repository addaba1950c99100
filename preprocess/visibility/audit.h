#pragma once
// What a cell sees, found out by looking: the measuring stick for hiders, which knows nothing of how they work.

#include <cstdint>
#include <span>
#include <vector>

#include "geometry/job_monitor.h"
#include "preprocess/visibility/node_meshes.h"
#include "preprocess/visibility/node_parts.h"

namespace promenade {

/// Pictures from points of a cell. Half of the eyes are on the cell's boundary, half anywhere in it; none inside
/// something solid: an eye that looks at the backs of one-sided surfaces in most directions stands where nobody stands,
/// and another is drawn.
struct LookOptions {
  uint64_t seed = 1;
  uint32_t views = 504;       ///< pictures of a cell, about
  uint32_t picture_px = 256;  ///< side of a picture
  bool around = true;         ///< true: six pictures of 90 degrees from each eye; false: one of 60 degrees, anywhere
};

/// What the pictures of one cell show.
struct Looks {
  uint64_t eyes = 0, views = 0, pixels = 0;
  std::vector<uint64_t> pixels_of;  ///< by item of the front: how many pixels show it
  /// The view with the most pixels of nodes that are hidden (and how many): a picture of it explains a miss.
  RasterView worst;
  uint64_t worst_pixels = 0;
};

/// Draws the front without hiding anything. hidden (may be empty): marks what must not be seen, for `worst`. Eyes: 0
/// when the whole cell is solid. Pure in the seed, the cell and the front; any thread. Errors: reading the model.
Result<Looks> look_from_cell(const NodeMeshes& meshes, const Box& cell, std::span<const NodeId> front,
                             std::span<const uint8_t> hidden, const LookOptions& options);

/// What a chain's answer is worth, held against looks.
struct CellVerdict {
  uint64_t front_triangles = 0, kept_triangles = 0, seen_triangles = 0;
  uint64_t front_nodes = 0, kept_nodes = 0, seen_nodes = 0;
  uint64_t false_hidden_nodes = 0, false_hidden_pixels = 0;
};
CellVerdict judge(const Model& model, std::span<const NodeId> front, std::span<const uint8_t> hidden,
                  const Looks& looks);

}  // namespace promenade
