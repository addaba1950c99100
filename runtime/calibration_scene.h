#pragma once
// Hilly ground with a texture: what renderers are timed with.

#include <cstdint>

#include "geometry/mesh.h"

namespace promenade {

/// One of many squares of 20 m that join into hills: 2 cells_per_side^2 triangles, `repeats` times its texture along
/// each side.
Mesh hilly_square(uint32_t column, uint32_t row, uint32_t cells_per_side, float repeats);

/// An opaque picture, side_px x side_px, without two equal neighbours.
Image striped_picture(uint32_t side_px);

}  // namespace promenade
