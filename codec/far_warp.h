#pragma once
// What a cell's far picture shows, foretold from a neighbour's.

#include "codec/far_face.h"

namespace promenade {

/// The side as the reference shows it: colours, between pixels linear; opacity 255 where the reference has something.
/// What it does not see is black without opacity. face: its grid, `kept` and `depth` are used; side: as cube_side.
/// Machines may differ by rounding. Any thread.
Image foretell(const FarFace& face, uint32_t side, const FarReference& reference, FarForetelling how);

}  // namespace promenade
