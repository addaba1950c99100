#pragma once
// The plan of the furnished building: its rooms, walls, doors and windows, before anything has a shape.

#include <cstdint>
#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <string>
#include <vector>

namespace promenade {

// Metres. Heights are above a storey's floor.
constexpr double kStoreyM = 3.8;   ///< from floor to floor
constexpr double kSlabM = 0.3;     ///< concrete between storeys
constexpr double kFinishM = 0.02;  ///< carpet or tiles on it
constexpr double kWallTopM = kStoreyM - kSlabM - kFinishM;
constexpr double kCeilingM = 3.0;  ///< of rooms
constexpr double kCorridorCeilingM = 2.7;
constexpr double kWallHalfM = 0.1;            ///< inner walls: to both sides of their line; outer walls: inwards
constexpr double kFacadeM = 0.3;              ///< outer walls reach so far out of their line
constexpr double kWidthM = 62, kDepthM = 34;  ///< between the lines of the outer walls: x, y
constexpr double kDoorWidthM = 1.0, kDoubleDoorM = 1.9, kDoorHeightM = 2.1;
constexpr double kWindowWidthM = 1.6, kWindowHeightM = 1.8, kWindowSillM = 0.85;

// Stairs: two flights around a half landing, the main landing at the door.
constexpr double kTreadM = 0.28;
constexpr uint32_t kTreads = 10;  ///< a flight; one more riser
constexpr double kRiserM = kStoreyM / (2.0 * (kTreads + 1));
constexpr double kLandingM = 1.6, kFlightWidthM = 1.5;

// The auditorium climbs one storey in rows.
constexpr uint32_t kRows = 12;
constexpr double kRowDepthM = 0.95, kFrontRowM = 3.0, kAisleM = 1.3;

enum class RoomKind : uint8_t {
  corridor,
  office,
  student_office,
  laboratory,
  class_room,
  auditorium,
  conference,
  library,
  toilet,
  kitchenette,
  lobby,
  lounge,
  storage,
  server_room,
  stairwell,
  lift
};
const char* name_of(RoomKind kind);

enum class Side : uint8_t { south, east, north, west };

struct Room {
  RoomKind kind = RoomKind::office;
  uint32_t floor = 0;
  glm::dvec2 min{0}, max{0};     ///< on the lines of its walls
  Side door_side = Side::south;  ///< where its way in is
  double door_at = 0;            ///< x (south, north) or y of the middle of the way in
  double door_width_m = 0;       ///< 0: no way in (a shaft, or the upper half of a hall)
  bool has_door = true;          ///< false: an open passage
  bool door_closed = false;
  bool has_floor = true, has_ceiling = true;  ///< not between the halves of a two-storey room
  std::string name;                           ///< "302"
};

enum class OpeningKind : uint8_t { passage, door, window, lift };

/// A hole in a wall.
struct Opening {
  OpeningKind kind = OpeningKind::door;
  double at = 0;  ///< middle, in the world along the wall
  double width_m = 0, bottom_m = 0, top_m = 0;
  uint32_t room = 0;  ///< that a door or a window belongs to
};

constexpr uint32_t kOutside = 0xffffffffU;

/// A straight piece of wall between two rooms, or between a room and the outside.
struct Wall {
  uint32_t floor = 0;
  bool along_x = true;
  double line = 0;                                    ///< y if along_x, otherwise x
  double from = 0, to = 0;                            ///< its solid's ends
  double below_m = kWallHalfM, above_m = kWallHalfM;  ///< thickness towards smaller and larger coordinates
  uint32_t low = kOutside, high = kOutside;           ///< rooms there
  std::vector<Opening> openings;                      ///< ascending, apart
};

struct BuildingPlan {
  uint32_t floors = 0;
  std::vector<Room> rooms;
  std::vector<Wall> walls;
};

/// The whole plan. floors >= 1. Pure; any thread.
BuildingPlan plan_building(uint64_t seed, uint32_t floors);

/// A room seen from its way in: u to the right, v into the room, w up, from the inner corner on the left of who enters.
struct RoomFrame {
  glm::dmat4 world_from_room{1};
  double width_m = 0, depth_m = 0;  ///< along u, v, between the walls' inner faces
  double door_u = 0;
};
RoomFrame frame_of(const Room& room);

}  // namespace promenade
