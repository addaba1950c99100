#pragma once
// Camera paths through the city that touch nothing.

#include "datasets/city_plan.h"
#include "geometry/path.h"

namespace promenade {

/// On the pavement around some blocks, over crossings and around corners: 1.4 m/s, eye 1.7 m above it.
CameraPath walk_through(const CityPlan& plan);
/// Along a street in the right lane: 100 km/h, eye 1.4 m above it.
CameraPath drive_through(const CityPlan& plan);
/// Across the city at 1.5 times its greatest height, looking 25 degrees down.
CameraPath fly_over(const CityPlan& plan);

}  // namespace promenade
