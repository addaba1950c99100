#pragma once
// The convex quadratic program of three unknowns that a projection point asks for.

#include <glm/vec3.hpp>
#include <span>

#include "preprocess/visibility/box_shadow.h"

namespace promenade {

/// Of the points that lie in all half-spaces, the one with the least sum of stiffness * (x - wanted)^2 over the axes:
/// any quadratic form whose axes are the model's. `inside` lies in all of them; the answer does too, exactly, for it is
/// the last point on the way there from `inside` that does. Stiffness above 0. In time linear in their number.
glm::dvec3 closest_in_half_spaces(std::span<const HalfSpace> half_spaces, const glm::dvec3& wanted,
                                  const glm::dvec3& stiffness, const glm::dvec3& inside);

}  // namespace promenade
