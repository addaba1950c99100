#pragma once
// What the city stands on: streets, kerbs, pavements, parks, fountains. Closed from one end of the city to the other.

#include <span>
#include <vector>

#include "datasets/city_plan.h"
#include "datasets/city_shape.h"

namespace promenade {

/// From the world to a mesh's own frame, which is near it.
struct LocalFrame {
  glm::dvec2 origin{0};
  glm::vec2 local(const glm::dvec2& world) const { return glm::vec2(world - origin); }
};

/// Street, kerb, pavement and the block's inner ground, with markings.
void build_ground(Shape& shape, const CityPlan& plan, uint32_t x, uint32_t y, const LocalFrame& frame,
                  Color inner_color);

/// Four L-shaped strips of grass in a quadrilateral's corners, on ground at height z.
void build_park(Shape& shape, std::span<const glm::vec2> corners, float z);
/// Rings of wall and water, each inner one smaller and taller.
void build_fountain(Shape& shape, const glm::vec2& center, float radius, float height, float z, int layers, int sides);

}  // namespace promenade
