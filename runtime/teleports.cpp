#include "runtime/teleports.h"

#include <algorithm>

namespace promenade {

Teleports teleports_of(std::span<const FrameRow> rows) {
  Teleports found;
  const FrameRow* arrived = nullptr;  // by a teleport after which something is missing still
  uint32_t finished = 0;
  double sum_ms = 0;
  for (size_t i = 1; i < rows.size(); ++i) {
    const FrameRow& row = rows[i];
    if (row.moved_m > kFastestFlightMPerS * (row.t_s - rows[i - 1].t_s)) ++found.count, arrived = &row;
    if (arrived == nullptr || row.nodes_missing > 0 || row.vlod_missing) continue;
    const double ms = (row.t_s - arrived->t_s) * 1e3;
    sum_ms += ms, found.full_ms_max = std::max(found.full_ms_max, ms);
    arrived = nullptr;
    ++finished;
  }
  found.unfinished = found.count - finished;
  found.full_ms_mean = finished > 0 ? sum_ms / finished : 0;
  return found;
}

}  // namespace promenade
