#pragma once
#include <memory>

#include "preprocess/visibility/hider.h"
#include "preprocess/visibility/node_meshes.h"

namespace promenade {

struct SampledOptions {
  uint32_t points_a_side = 5;  ///< of a grid of eyes over the closed cell: its corners and faces are sampled too
  uint32_t picture_px = 256;   ///< side of a face of the cube of pictures about an eye
};

/// Hides what no eye of a grid sees: not conservative, a measuring stick. meshes must outlive it.
std::unique_ptr<Hider> make_sampled_hider(const NodeMeshes& meshes, const SampledOptions& options = {});

/// Sets seen[i] to 1 for each item that an eye sees in any direction, in six pictures of
/// picture_px squared. buffer: reused. Any thread with its own buffer.
Status look_around(const glm::dvec3& eye, std::span<const RasterItem> items, uint32_t picture_px,
                   VisibilityBuffer& buffer, std::span<uint8_t> seen);

}  // namespace promenade
