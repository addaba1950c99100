#include "datasets/building_plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "datasets/shapes.h"
#include "geometry/random.h"

namespace promenade {

namespace {

constexpr double kTouchM = 1e-6;  // lines closer than this are one

// The lines of the plan. A ring of corridors runs between the outer rooms and the core; a branch crosses the core.
constexpr double kRing0 = 6.6, kRing1 = 9.2;  // the ring's outer and inner line, from each facade
constexpr double kEastRing1 = kWidthM - kRing1, kEastRing0 = kWidthM - kRing0;
constexpr double kNorthRing1 = kDepthM - kRing1, kNorthRing0 = kDepthM - kRing0;
constexpr double kBranch0 = 29.7, kBranch1 = 32.3;
constexpr double kStairDepth = 6.1, kStairWidth = 3.4, kServiceWidth = 5.0;
constexpr double kMiddle = kDepthM / 2;

struct Use {
  RoomKind kind;
  double from, to;
};

class Planner {
 public:
  Planner(uint64_t seed, uint32_t floors) : random_(seed * 0x9e3779b9ULL + 17) { plan_.floors = floors; }

  BuildingPlan take() { return std::move(plan_); }
  uint32_t floors() const { return plan_.floors; }

  Room& room(RoomKind kind, uint32_t floor, glm::dvec2 min, glm::dvec2 max, Side side, double door_at) {
    Room room;
    room.kind = kind, room.floor = floor, room.min = min, room.max = max;
    room.door_side = side, room.door_at = door_at, room.door_width_m = kDoorWidthM;
    room.door_closed = (kind == RoomKind::office && random_.chance(0.2)) || kind == RoomKind::storage;
    if (kind == RoomKind::lounge || kind == RoomKind::stairwell) room.has_door = false, room.door_width_m = 1.6;
    if (kind == RoomKind::lobby) room.has_door = false, room.door_width_m = 4;
    if (kind == RoomKind::library || kind == RoomKind::auditorium) room.door_width_m = kDoubleDoorM;
    if (kind == RoomKind::corridor) room.door_width_m = 0;
    room.name = kind == RoomKind::corridor ? fmt::format("{}C{}", floor + 1, ++corridors_)
                                           : fmt::format("{}{:02}", floor + 1, ++numbers_);
    plan_.rooms.push_back(std::move(room));
    return plan_.rooms.back();
  }

  void start_floor() { numbers_ = corridors_ = 0; }

  /// Rooms side by side along the south or north facade; a door may only open to the corridor.
  void row(uint32_t floor, bool south, std::span<const Use> uses) {
    for (const Use& use : uses) {
      const bool last = std::abs(use.to - kWidthM) < kTouchM;
      const double low = std::max(use.from, kRing0) + 0.95, high = std::min(use.to, kEastRing0) - 0.95;
      const bool right = use.from < kTouchM || (!last && random_.chance(0.5));
      double at = right ? high : low;
      if (use.kind == RoomKind::lobby || use.kind == RoomKind::library) at = (use.from + use.to) / 2;
      if (use.kind == RoomKind::lounge) at = use.from < kTouchM ? kRing1 - 1.3 : kEastRing1 + 1.3;
      room(use.kind, floor, {use.from, south ? 0 : kNorthRing0}, {use.to, south ? kRing0 : kDepthM},
           south ? Side::north : Side::south, at);
    }
  }

  void ring(uint32_t floor) {
    const auto corridor = [&](glm::dvec2 min, glm::dvec2 max) {
      room(RoomKind::corridor, floor, min, max, Side::south, 0);
    };
    corridor({kRing0, kRing0}, {kEastRing0, kRing1});
    corridor({kRing0, kNorthRing1}, {kEastRing0, kNorthRing0});
    corridor({kRing0, kRing1}, {kRing1, kNorthRing1});
    corridor({kEastRing1, kRing1}, {kEastRing0, kNorthRing1});
    corridor({kBranch0, kRing1}, {kBranch1, kNorthRing1});
  }

  void sides(uint32_t floor) {
    constexpr int kEach = 4;
    for (const bool west : {true, false}) {
      for (int i = 0; i < kEach; ++i) {
        const double y0 = kRing0 + (kNorthRing0 - kRing0) * i / kEach,
                     y1 = kRing0 + (kNorthRing0 - kRing0) * (i + 1) / kEach;
        room(RoomKind::office, floor, {west ? 0 : kEastRing0, y0}, {west ? kRing0 : kWidthM, y1},
             west ? Side::east : Side::west, random_.chance(0.5) ? y0 + 0.95 : y1 - 0.95);
      }
    }
  }

  /// One half of the core: stairs, services, and two large rooms back to back.
  void core(uint32_t floor, bool west, RoomKind south, RoomKind north) {
    // x of a line at distance `along` from the ring corridor of this half.
    const auto x = [&](double along) { return west ? kRing1 + along : kEastRing1 - along; };
    const auto span = [&](double a, double b) { return std::pair{std::min(x(a), x(b)), std::max(x(a), x(b))}; };
    const double length = kBranch0 - kRing1;
    const Side ring_side = west ? Side::west : Side::east, branch_side = west ? Side::east : Side::west;
    const auto [s0, s1] = span(0, kStairWidth);
    room(RoomKind::stairwell, floor, {s0, kRing1}, {s1, kRing1 + kStairDepth}, Side::south, (s0 + s1) / 2);
    room(RoomKind::kitchenette, floor, {s0, kRing1 + kStairDepth}, {s1, 20}, ring_side, 18.6);
    room(RoomKind::storage, floor, {s0, 20}, {s1, kNorthRing1}, ring_side, 21);
    const auto [b0, b1] = span(kStairWidth, length - kServiceWidth);
    large_rooms(floor, west, south, north, {b0, kRing1}, {b1, kNorthRing1});
    const auto [v0, v1] = span(length - kServiceWidth, length);
    if (west) {
      room(RoomKind::lift, floor, {v1 - 2.2, kRing1}, {v1, kRing1 + 2.4}, branch_side, kRing1 + 1.2);
      room(RoomKind::lift, floor, {v1 - 2.2, kRing1 + 2.4}, {v1, kRing1 + 4.8}, branch_side, kRing1 + 3.6);
      room(RoomKind::storage, floor, {v0, kRing1}, {v1 - 2.2, kRing1 + 4.8}, Side::south, v0 + 1.1);
      room(RoomKind::toilet, floor, {v0, kRing1 + 4.8}, {v1, 19.4}, branch_side, 15);
      room(RoomKind::toilet, floor, {v0, 19.4}, {v1, kNorthRing1}, branch_side, 23.8);
    } else {
      room(RoomKind::storage, floor, {v0, kRing1}, {v1, kRing1 + 4.8}, branch_side, 10.2);
      room(RoomKind::student_office, floor, {v0, kRing1 + 4.8}, {v1, 19.4}, branch_side, 15);
      room(RoomKind::conference, floor, {v0, 19.4}, {v1, kNorthRing1}, branch_side, 23.85);
    }
  }

 private:
  void large_rooms(uint32_t floor, bool west, RoomKind south, RoomKind north, glm::dvec2 min, glm::dvec2 max) {
    if (south == RoomKind::auditorium) {
      Room& hall =
          room(south, floor, min, max, floor == 0 ? Side::south : Side::north, min.x + (floor == 0 ? 1.3 : 0.9));
      if (floor == 0) hall.has_ceiling = false;
      if (floor == 1) hall.has_floor = false, hall.door_width_m = kDoorWidthM;
      return;
    }
    const double near = west ? min.x + 1.05 : max.x - 1.05;
    room(south, floor, min, {max.x, kMiddle}, Side::south, near);
    room(north, floor, {min.x, kMiddle}, max, Side::north, near);
  }

  BuildingPlan plan_;
  Random random_;
  uint32_t numbers_ = 0, corridors_ = 0;
};

void append_offices(std::vector<Use>& uses, double from, double to, int count) {
  for (int i = 0; i < count; ++i)
    uses.push_back(
        {RoomKind::office, from + (to - from) * i / count, i + 1 == count ? to : from + (to - from) * (i + 1) / count});
}

std::vector<Use> south_row(uint32_t floor) {
  if (floor == 0) {
    return {{RoomKind::class_room, 0, 12},
            {RoomKind::class_room, 12, 24},
            {RoomKind::lobby, 24, 38},
            {RoomKind::class_room, 38, 50},
            {RoomKind::class_room, 50, kWidthM}};
  }
  std::vector<Use> uses{{RoomKind::conference, 0, kRing1}};
  if (floor == 1) {
    uses.push_back({RoomKind::office, kRing1, 14});
    uses.push_back({RoomKind::library, 14, 48});
    uses.push_back({RoomKind::office, 48, kEastRing1});
  } else {
    append_offices(uses, kRing1, kEastRing1, 8);
  }
  uses.push_back({RoomKind::student_office, kEastRing1, kWidthM});
  return uses;
}

std::vector<Use> north_row(uint32_t floor) {
  std::vector<Use> uses;
  if (floor == 0) {
    uses = {{RoomKind::lounge, 0, 12}, {RoomKind::class_room, 12, 24}, {RoomKind::class_room, 24, 36}};
    append_offices(uses, 36, kEastRing1, 4);
  } else {
    uses = {{RoomKind::lounge, 0, kRing1}};
    append_offices(uses, kRing1, kEastRing1, 8);
  }
  uses.push_back({floor % 2 == 0 ? RoomKind::student_office : RoomKind::lounge, kEastRing1, kWidthM});
  return uses;
}

/// What the four large rooms of the core are: west south, west north, east south, east north.
std::array<RoomKind, 4> core_uses(uint32_t floor, uint32_t floors) {
  constexpr RoomKind kLab = RoomKind::laboratory, kHall = RoomKind::auditorium;
  if (floor < 2 && floors >= 2) return {kHall, kHall, kLab, kLab};
  switch (floor < 2 ? 2 : 2 + (floor - 2) % 5) {
    case 4:
      return {RoomKind::conference, RoomKind::lounge, RoomKind::server_room, RoomKind::storage};
    case 5:
      return {RoomKind::student_office, RoomKind::conference, RoomKind::lounge, RoomKind::student_office};
    case 6:
      return {RoomKind::lounge, RoomKind::student_office, RoomKind::conference, RoomKind::storage};
    default:
      return {kLab, kLab, kLab, kLab};
  }
}

bool same(double a, double b) { return std::abs(a - b) < kTouchM; }

/// The piece of wall that two rooms, or a room and the outside, share on a line; none between two corridors.
void add_walls(BuildingPlan& plan, uint32_t floor, std::span<const uint32_t> rooms, bool along_x) {
  const int along = along_x ? 0 : 1, across = 1 - along;
  const double far = along_x ? kDepthM : kWidthM;
  for (const uint32_t a : rooms) {
    const Room& low = plan.rooms[a];
    Wall wall;
    wall.floor = floor, wall.along_x = along_x;
    if (same(low.min[across], 0) || same(low.max[across], far)) {
      const bool at_far = !same(low.min[across], 0);
      wall.line = at_far ? far : 0, wall.from = low.min[along], wall.to = low.max[along];
      (at_far ? wall.low : wall.high) = a;
      (at_far ? wall.above_m : wall.below_m) = kFacadeM;
      plan.walls.push_back(wall);
    }
    for (const uint32_t b : rooms) {
      const Room& high = plan.rooms[b];
      const double from = std::max(low.min[along], high.min[along]), to = std::min(low.max[along], high.max[along]);
      if (!same(low.max[across], high.min[across]) || to - from < kTouchM) continue;
      if (low.kind == RoomKind::corridor && high.kind == RoomKind::corridor) continue;
      Wall inner;
      inner.floor = floor, inner.along_x = along_x, inner.line = high.min[across];
      inner.from = from, inner.to = to, inner.low = a, inner.high = b;
      plan.walls.push_back(inner);
    }
  }
}

/// Where walls meet: what runs through stays, what ends there stops at its face; at a corner the wall along x fills it.
void join_walls(std::span<Wall> walls) {
  struct End {
    double from, to;
  };
  std::vector<End> ends;
  for (const Wall& wall : walls) {
    End end{wall.from, wall.to};
    for (const bool last : {false, true}) {
      const double at = last ? wall.to : wall.from;
      bool goes_on = false, low = false, high = false;
      double below = 0, above = 0;
      for (const Wall& other : walls) {
        if (other.along_x == wall.along_x)
          goes_on = goes_on || (same(other.line, wall.line) && same(last ? other.from : other.to, at));
        else if (same(other.line, at)) {
          low = low || same(other.to, wall.line), high = high || same(other.from, wall.line);
          if (same(other.to, wall.line) || same(other.from, wall.line)) below = other.below_m, above = other.above_m;
        }
      }
      const bool crossed = low && high;
      double move = 0;  // outwards
      const bool stops = !goes_on && (low || high);
      if (wall.along_x && stops) move = crossed ? -(last ? below : above) : (last ? above : below);
      if (!wall.along_x && (crossed || stops)) move = -(last ? below : above);
      (last ? end.to : end.from) = last ? at + move : at - move;
    }
    ends.push_back(end);
  }
  for (size_t i = 0; i < walls.size(); ++i) walls[i].from = ends[i].from, walls[i].to = ends[i].to;
}

void add_windows(Wall& wall, const Room& room) {
  const double length = wall.to - wall.from;
  const auto count = static_cast<int>(std::floor((length - 0.5) / 2.35));
  // A lobby's middle is its entrance.
  for (int i = 0; i < count; ++i) {
    const double at = wall.from + length * (i + 0.5) / count;
    const bool entrance = room.kind == RoomKind::lobby && std::abs(at - (wall.from + wall.to) / 2) < 2.4;
    if (entrance) continue;
    wall.openings.push_back({OpeningKind::window, at, kWindowWidthM, kWindowSillM, kWindowSillM + kWindowHeightM,
                             wall.low == kOutside ? wall.high : wall.low});
  }
}

bool is_way_in(const Wall& wall, const Room& room, uint32_t id) {
  const bool across_y = room.door_side == Side::south || room.door_side == Side::north;
  const bool at_low_end = room.door_side == Side::south || room.door_side == Side::west;
  return room.door_width_m > 0 && wall.along_x == across_y && (at_low_end ? wall.high : wall.low) == id &&
         wall.from < room.door_at && room.door_at < wall.to;
}

void add_openings(BuildingPlan& plan) {
  for (Wall& wall : plan.walls) {
    const bool outer = wall.low == kOutside || wall.high == kOutside;
    for (const uint32_t id : {wall.low, wall.high}) {
      if (id == kOutside) continue;
      const Room& room = plan.rooms[id];
      if (is_way_in(wall, room, id)) {
        if (room.kind == RoomKind::lift)
          wall.openings.push_back({OpeningKind::lift, room.door_at, 1.2, 0, 2.2, id});
        else if (room.has_door)
          wall.openings.push_back({OpeningKind::door, room.door_at, room.door_width_m, 0, kDoorHeightM, id});
        else
          wall.openings.push_back({OpeningKind::passage, room.door_at, room.door_width_m, 0, 2.5, id});
      }
      if (outer) add_windows(wall, room);
      if (outer && room.kind == RoomKind::lobby)
        wall.openings.push_back({OpeningKind::door, (wall.from + wall.to) / 2, kDoubleDoorM, 0, kDoorHeightM, id});
    }
    std::sort(wall.openings.begin(), wall.openings.end(),
              [](const Opening& a, const Opening& b) { return a.at < b.at; });
  }
}

}  // namespace

const char* name_of(RoomKind kind) {
  static constexpr const char* kNames[] = {
      "corridor", "office",      "student_office", "laboratory", "class_room", "auditorium",  "conference", "library",
      "toilet",   "kitchenette", "lobby",          "lounge",     "storage",    "server_room", "stairwell",  "lift"};
  return kNames[static_cast<size_t>(kind)];
}

BuildingPlan plan_building(uint64_t seed, uint32_t floors) {
  Planner planner(seed, floors);
  for (uint32_t floor = 0; floor < floors; ++floor) {
    planner.start_floor();
    planner.ring(floor);
    planner.row(floor, true, south_row(floor));
    planner.row(floor, false, north_row(floor));
    planner.sides(floor);
    const std::array<RoomKind, 4> uses = core_uses(floor, floors);
    planner.core(floor, true, uses[0], uses[1]);
    planner.core(floor, false, uses[2], uses[3]);
  }
  BuildingPlan plan = planner.take();
  size_t room = 0;
  for (uint32_t floor = 0; floor < floors; ++floor) {
    std::vector<uint32_t> rooms;
    for (; room < plan.rooms.size() && plan.rooms[room].floor == floor; ++room)
      rooms.push_back(static_cast<uint32_t>(room));
    const size_t first = plan.walls.size();
    add_walls(plan, floor, rooms, true);
    add_walls(plan, floor, rooms, false);
    join_walls(std::span(plan.walls).subspan(first));
  }
  add_openings(plan);
  return plan;
}

RoomFrame frame_of(const Room& room) {
  const glm::dvec2 min = room.min + kWallHalfM, max = room.max - kWallHalfM;
  const double z = room.floor * kStoreyM;
  RoomFrame frame;
  const bool across_y = room.door_side == Side::south || room.door_side == Side::north;
  frame.width_m = across_y ? max.x - min.x : max.y - min.y;
  frame.depth_m = across_y ? max.y - min.y : max.x - min.x;
  switch (room.door_side) {
    case Side::south:
      frame.world_from_room = moved({min.x, min.y, z}), frame.door_u = room.door_at - min.x;
      break;
    case Side::north:
      frame.world_from_room = moved({max.x, max.y, z}) * turned_z(180), frame.door_u = max.x - room.door_at;
      break;
    case Side::west:
      frame.world_from_room = moved({min.x, max.y, z}) * turned_z(-90), frame.door_u = max.y - room.door_at;
      break;
    case Side::east:
      frame.world_from_room = moved({max.x, min.y, z}) * turned_z(90), frame.door_u = room.door_at - min.y;
      break;
  }
  return frame;
}

}  // namespace promenade
