#pragma once
#include <memory>

#include "preprocess/visibility/hider.h"
#include "preprocess/visibility/room_parts.h"

namespace promenade {

struct PortalsOptions {
  /// Beams kept apart in a room, per sector of directions: beyond, the two that are most alike become one, so that
  /// plans with many ways through them end in time. More: tighter, slower.
  size_t most_beams = 3;  // measured: 2 to 40 hide the same in a furnished building
  /// Comparisons of beams for one cell, some hundred nanoseconds each: beyond, all that is undecided stays. Cells of a
  /// furnished building of two floors take fewer; those of cms_detector, where little is hidden, would take many more.
  uint64_t most_steps = 2'000'000;
};

/// Hides what no line from the cell reaches through the openings of axial walls. For buildings. All references must
/// outlive it.
std::unique_ptr<Hider> make_portals_hider(const Model& model, const Rooms& rooms, const RoomParts& parts,
                                          const PortalsOptions& options = {});

}  // namespace promenade
