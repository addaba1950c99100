#pragma once
// What closes a building at its top.

#include <span>
#include <vector>

#include "datasets/city_shape.h"
#include "geometry/random.h"

namespace promenade {

enum class RoofKind : uint8_t { flat, spire, hip, ridge };

/// spire: a cone over a cylinder, a pyramid over anything else.
RoofKind choose_roof(std::span<const glm::vec2> footprint, bool cylindrical, float height_m, bool house, Random random);
/// How much of the building's height the roof takes.
float roof_height_m(RoofKind kind, std::span<const glm::vec2> footprint, float height_m);

struct Roof {
  RoofKind kind = RoofKind::flat;
  std::span<const glm::vec2> outline;
  float walls_top_m = 0, highest_m = 0;
  int tier = 0;
  Color trim{255}, wall{255}, accent{255};
};
void build_roof(Shape& shape, const Roof& roof, Random random);

}  // namespace promenade
