#pragma once
// How soon a flight shows everything after a jump.

#include <span>

#include "runtime/session.h"

namespace promenade {

/// Jumps to places that nobody flies to: the first picture is the next frame's, coarse where nothing finer is resident.
struct Teleports {
  uint32_t count = 0;
  uint32_t unfinished = 0;  ///< of these: nodes were missing until the next one, or the flight's end
  /// Path time from the first frame there until one in which nothing that its policy chose was missing, of the others.
  double full_ms_mean = 0, full_ms_max = 0;
};

/// Moves faster than kFastestFlightMPerS. rows: ascending in t_s. Pure.
Teleports teleports_of(std::span<const FrameRow> rows);

}  // namespace promenade
