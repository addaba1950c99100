#pragma once
// Polygons of a plan: united, and with their borders moved inwards.

#include <glm/vec2.hpp>
#include <span>
#include <vector>

namespace promenade {

/// Closed: from the last point back to the first. Outlines go counter-clockwise, holes in them clockwise.
using PlanLoop = std::vector<glm::dvec2>;
using PlanLoops = std::vector<PlanLoop>;

/// Coordinates are rounded to this, metres.
constexpr double kPlanStepM = 1e-4;

/// What loops wind around counter-clockwise more often than clockwise, at least once. The loops may cross themselves
/// and each other. Coordinates below 1e9 m.
PlanLoops united(const PlanLoops& loops);

/// What lies at least so far within: of a corner that points inwards no less than that, but more. Below 0: with what
/// lies that far outside, as much and more. by_m: less than 1e6. loops: as united gives them.
PlanLoops shrunk(const PlanLoops& loops, double by_m);

/// Each outline by itself with the holes in it, the outline first.
std::vector<PlanLoops> taken_apart(const PlanLoops& loops);

/// Square metres, holes taken off.
double area_m2(const PlanLoops& loops);

/// Whether the point lies within. Of points on the border some do.
bool contains(const PlanLoops& loops, const glm::dvec2& point);

}  // namespace promenade
