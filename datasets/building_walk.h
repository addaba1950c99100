#pragma once
// The walk through the building that comes with it.

#include "datasets/building_plan.h"
#include "geometry/path.h"

namespace promenade {

/// From the street through the lobby to every floor, by the auditorium's aisle and the stairs, into a laboratory, the
/// library and some offices. 1.4 m/s, corners rounded, turning on the spot where a room is looked at; the eye 1.65 m
/// above the floor. Pure; any thread.
CameraPath walk_building(const BuildingPlan& plan);

}  // namespace promenade
