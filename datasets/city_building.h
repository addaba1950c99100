#pragma once
// One building of the city: closed, unique geometry with colours per vertex.

#include <vector>

#include "datasets/city_facade.h"

namespace promenade {

struct HousePlan {
  std::vector<glm::vec2> footprint;  ///< counter-clockwise, metres, around the origin
  std::vector<bool> street;          ///< by edge: it looks at a street
  float height_m = 10;               ///< of the highest point, roof and all
  bool cylindrical = false;
  uint64_t seed = 0;
};

/// What the painter of a facade texture must know. The texture shows the walls unrolled: all around across, from the
/// ground to the top upwards.
struct FacadeSketch {
  float around_m = 0, height_m = 0, floor_m = 3.2F, ground_floor_m = 4;
  Color wall{255}, wall_other{255}, glass{255};
  bool bricks = false;
  uint64_t seed = 0;
  std::vector<PaneSketch> panes;
};

struct HouseOptions {
  double detail = 2;       ///< [0, kMaxTier]: facade tiers, blended over buildings
  bool interiors = false;  ///< furnished rooms behind the windows
  bool textured = false;   ///< walls carry texture coordinates and kTexturedWall
  bool solid = false;      ///< nothing but segments, closed from below the ground to a flat top
  bool plain = false;      ///< no windows: floors in one colour or two, and dividers between them
};

/// Builds into `shape`. sketch: filled when textured (and shape is not counting).
void build_house(Shape& shape, const HousePlan& plan, const HouseOptions& options, FacadeSketch& sketch);

}  // namespace promenade
