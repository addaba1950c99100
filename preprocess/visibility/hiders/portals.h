#pragma once
#include <memory>

#include "preprocess/visibility/hider.h"
#include "preprocess/visibility/node_parts.h"
#include "preprocess/visibility/rooms.h"

namespace promenade {

struct PortalsOptions {
  /// Beams kept apart in a room, per sector of directions: beyond, the two that are most alike become one, so that
  /// plans with many ways through them end in time. More: tighter, slower.
  size_t most_beams = 6;
};

/// Hides what no line from the cell reaches through the openings of axial walls. For buildings. All references must
/// outlive it.
std::unique_ptr<Hider> make_portals_hider(const Model& model, const NodeParts& parts, const Rooms& rooms,
                                          const PortalsOptions& options = {});

}  // namespace promenade
