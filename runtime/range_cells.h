#pragma once
// Where the eye may soon be: cells by the time that it takes to get there. Source: [funkhouser1993]
// sections 5.2.1, 5.2.2.

#include <optional>
#include <string_view>
#include <vector>

#include "layout/cells.h"

namespace promenade {

/// Which cells ahead count, [funkhouser1993]'s range cull algorithms.
enum class RangeCull : uint8_t {
  any,        ///< all that can be reached
  plane,      ///< what is not wholly behind the eye, across its direction of movement
  direction,  ///< what the line of movement meets
};
/// "any", "plane", "direction".
std::string_view name_of(RangeCull cull);
std::optional<RangeCull> range_cull_named(std::string_view name);

struct RangeOptions {
  double horizon_s = 1;        ///< how far ahead one looks; longer: more to read, less that comes as a surprise
  double least_speed_m = 1.4;  ///< a standing eye may start walking, metres a second
  RangeCull cull = RangeCull::plane;
  uint32_t most_cells = 24;  ///< the first that can be reached
};

struct RangeCell {
  CellId cell = kNoCell;
  double seconds = 0;  ///< until the eye can be in it
};

/// Cells other than the eye's own that it can be in within the horizon, soonest first, by Dijkstra's search over
/// shared faces with open parts; a wall without a portal stops the way through, as a person. eye, velocity: metres,
/// model space. Pure; any thread.
std::vector<RangeCell> range_cells(const CellTables& tables, CellId cell, const glm::dvec3& eye,
                                   const glm::dvec3& velocity_m_per_s, const RangeOptions& options);

}  // namespace promenade
