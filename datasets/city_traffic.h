#pragma once
// Cars that drive around blocks, as animated objects.

#include <vector>

#include "datasets/city_plan.h"
#include "datasets/city_prop.h"
#include "datasets/glb_writer.h"

namespace promenade {

struct MovingCar {
  PropKind kind;
  NodeMotion motion;
};

/// So many cars, each clockwise around a block of its own as long as there are enough, keeping to the right, with soft
/// corners; then it begins again where it began. level: of detail. Pure; any thread.
std::vector<MovingCar> traffic_of(const CityPlan& plan, uint32_t count, int level);

}  // namespace promenade
