#pragma once
// What stands along a block's kerb: parked cars on the street's side, trees, lamps and furniture on the pavement's.

#include <vector>

#include "datasets/city_plan.h"
#include "datasets/city_prop.h"

namespace promenade {

struct KerbProp {
  PropClass prop = PropClass::lamp;
  uint32_t variant = 0;
  glm::dvec2 at{0};  ///< world
  double yaw_rad = 0, scale = 1;
};

/// detail: as in BlockOptions; more of it, more cars and furniture. Pure.
std::vector<KerbProp> kerb_props(const CityPlan& plan, uint32_t x, uint32_t y, bool tree_lined, double detail);

}  // namespace promenade
