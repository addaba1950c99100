#pragma once
// Furnishes the plan's rooms: a generator for each kind of room puts instances of the catalogue's items into it.

#include <string>
#include <vector>

#include "datasets/building_plan.h"
#include "datasets/furniture.h"

namespace promenade {

/// One object: an instance of a catalogue item.
struct Placement {
  uint32_t item = 0;
  glm::dmat4 world_from_item{1};
  std::string name;
};

/// density in [0, 1]: from 1 down to 0.5 the small loose things (books, pencils, cups ...) go, from there to 0 room
/// after room stays empty; doors, windows and lights stay. What a walk needs free stays free: corridors within 0.9 m of
/// their middle, 1.3 m in front of every door, the lane along a room's left wall (seen from a door at the left). Pure;
/// any thread.
std::vector<Placement> furnish_building(const BuildingPlan& plan, const FurnitureCatalogue& catalogue, uint64_t seed,
                                        double density);

}  // namespace promenade
