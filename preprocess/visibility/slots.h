#pragma once
// Space between walls that is too narrow for anybody to pass.

#include <cstdint>
#include <vector>

#include "preprocess/visibility/rooms.h"

namespace promenade {

/// By room: 1 where nobody fits: along some axis it ends, with the rooms that it is open to both ways, before it is
/// least_m long. A face is open where an opening is as wide as that along both its sides, or half of it is: what is
/// open one way only is a surface's back. Pure.
std::vector<uint8_t> find_slots(const Rooms& rooms, float least_m);

}  // namespace promenade
