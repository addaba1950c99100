#pragma once
// Walls with windows, doors, balconies and rooms behind them.

#include <glm/vec2.hpp>
#include <glm/vec4.hpp>
#include <vector>

#include "datasets/city_shape.h"
#include "geometry/random.h"

namespace promenade {

/// What a building's facades are like. Metres.
struct FacadeStyle {
  float floor_m = 3.2F;
  float ground_floor_m = 4;
  float bay_m = 3.2F;           ///< wall from one window's middle to the next one's, about
  float window_width_m = 1.2F;  ///< at most the bay less 0.3
  float window_height_m = 1.5F;
  float sill_m = 0.9F;  ///< of the window above the floor
  float recess_m = 0.2F;
  int panes_across = 2, panes_up = 1;  ///< of a window, between its bars
  bool sills = true, lintels = false, shutters = false, flower_boxes = false, shop = false, coolers = false;
  int balcony_every = 0;                                           ///< bays; 0: no balconies
  Color wall{200, 190, 175, 255}, wall_other{200, 190, 175, 255};  ///< alternating by floor
  Color trim{230, 225, 215, 255}, frame{240, 240, 238, 255}, glass{70, 90, 110, 255}, accent{120, 40, 40, 255};
};

/// How much geometry goes into a window: 0 none at all, 1 a recess, 2 a sill and a balcony, 3 a frame with bars, 4
/// lintels, blinds and railings, 5 shutters, flowers and coolers, 6 everything finer.
constexpr int kMaxTier = 7;

/// A pane of glass on the building's unrolled facade, for the painter of its texture: texture coordinates.
struct PaneSketch {
  glm::vec2 low, high;
};

/// One side of a building between two heights.
struct Wall {
  glm::vec2 a, b;  ///< the outside to the right of the way
  float bottom_m = 0, top_m = 0;
  bool ground = false;  ///< its lowest floor is at the street's height and goes a little below it
  bool street = false;  ///< looks at a street: it has doors and more windows
  bool door = false;
  bool see_through = false;                  ///< panes of a semi-transparent building
  float room_depth_m = 0;                    ///< 0: no rooms behind the windows
  float trim_a_m = 0, trim_b_m = 0;          ///< rooms stay so far from the ends
  float u0 = 0, u1 = 0, v_per_m = 0;         ///< texture coordinates: along, and upwards from v = 1 at height 0
  std::vector<PaneSketch>* panes = nullptr;  ///< where textured
};

/// tier: 0 to kMaxTier.
void build_wall(Shape& shape, const Wall& wall, const FacadeStyle& style, int tier, const Random& random);

/// A furnished room: its front on the frame's x axis from x0 to x1, reaching depth_m inwards, between two heights.
struct Room {
  WallFrame frame;
  float x0 = 0, x1 = 0, depth_m = 0, floor_m = 0, ceiling_m = 0;
};
void build_room(Shape& shape, const Room& room, Random random);

}  // namespace promenade
