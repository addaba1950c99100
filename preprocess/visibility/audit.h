#pragma once
// What a cell sees, found out by looking: the measuring stick for hiders, which knows nothing of how they work.

#include <cstdint>
#include <span>
#include <vector>

#include "geometry/job_monitor.h"
#include "preprocess/visibility/node_meshes.h"
#include "preprocess/visibility/node_parts.h"

namespace promenade {

/// Pictures from points of a cell (EyeFinder's): half of the eyes are on the cell's boundary, half anywhere in it.
struct LookOptions {
  uint64_t seed = 1;
  uint32_t views = 504;       ///< pictures of a cell, about
  uint32_t picture_px = 256;  ///< side of a picture
  bool around = true;         ///< true: six pictures of 90 degrees from each eye; false: one of 60 degrees, anywhere
  /// Besides, narrow pictures of kAimedPx x kAimedPx rays, each at a random triangle of a random hidden node and as
  /// wide as that node: what is small or far away is looked at as closely as what is near.
  uint32_t aimed_views = 0;
  static constexpr uint32_t kAimedPx = 64;
};

/// A ray that ends on a hidden node, explained by nothing.
struct MissedRay {
  glm::dvec3 eye{0}, at{0};  ///< metres, model space
  NodeId node = kNoNode;
};

/// What the pictures of one cell show.
struct Looks {
  uint64_t eyes = 0, views = 0, pixels = 0;
  uint64_t aimed_rays = 0;          ///< of the pixels: those of pictures aimed at hidden nodes
  std::vector<uint64_t> pixels_of;  ///< by item of the front: how many pixels show it
  /// The view with the most pixels of nodes that are hidden (and how many): a picture of it explains a miss.
  RasterView worst;
  uint64_t worst_pixels = 0;
  /// Pixels that show a hidden node only because what is drawn has a crack there: at full detail, the same ray ends
  /// before, on a node that is kept.
  uint64_t crack_pixels = 0;
  /// Pixels whose ray gets to a hidden node at full detail, too, but through a slit narrower than two millimetres, such
  /// as vertices rounded along an edge leave: the parallel rays that get there, too, span less than that along one of
  /// four lines across it.
  uint64_t slit_pixels = 0;
  /// By item of the front: shown at a pixel that neither explains.
  std::vector<uint8_t> truly_seen;
  std::vector<MissedRay> missed;  ///< the first of each such node
  std::vector<MissedRay> slits;   ///< rays through slits
};

/// Draws the front without hiding anything. hidden (may be empty): marks what must not be seen, for `worst`. Eyes: 0
/// when the whole cell is solid. Pure in the seed, the cell and the front; any thread. Errors: reading the model.
Result<Looks> look_from_cell(const NodeMeshes& meshes, const Box& cell, std::span<const NodeId> front,
                             std::span<const uint8_t> hidden, const LookOptions& options);

/// What a chain's answer is worth, held against looks.
struct CellVerdict {
  uint64_t front_triangles = 0, kept_triangles = 0, seen_triangles = 0;
  uint64_t front_nodes = 0, kept_nodes = 0, seen_nodes = 0;
  uint64_t false_hidden_nodes = 0, false_hidden_pixels = 0;  ///< all
  uint64_t missed_nodes = 0, missed_pixels = 0;              ///< of these, what neither crack nor slit explains
  uint64_t slit_pixels = 0;                                  ///< through slits
};
CellVerdict judge(const Model& model, std::span<const NodeId> front, std::span<const uint8_t> hidden,
                  const Looks& looks);

}  // namespace promenade
