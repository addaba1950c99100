#include "datasets/building_structure.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "datasets/furniture_palette.h"
#include "datasets/shapes.h"
#include "geometry/random.h"

namespace promenade {

namespace {

using glm::dvec2;
using glm::dvec3;

constexpr glm::u8vec4 kPlaster = rgb(0xece6d9), kStone = rgb(0xcabfa9), kBrick = rgb(0xa9603f),
                      kConcrete = rgb(0x9c9a95), kTiles = rgb(0xbdb7aa), kLawn = rgb(0x6f9152), kPaving = rgb(0xb3aca0),
                      kRoofing = rgb(0x8d8f90);

glm::u8vec4 facade_of(uint32_t floor) { return floor == 0 ? kStone : kBrick; }

/// The paint of a room's walls and its floor's colour; what ends at a corridor takes the corridor's plaster.
struct Finish {
  glm::u8vec4 wall = kPlaster, floor = kTiles;
};

Finish finish_of(const Room& room, uint64_t seed) {
  static constexpr std::array<glm::u8vec4, 6> kPaints = {rgb(0xe9e1cf), rgb(0xdfe5dc), rgb(0xe8d9c8),
                                                         rgb(0xd9e2e8), rgb(0xeee3c4), rgb(0xe6dbe0)};
  static constexpr std::array<glm::u8vec4, 5> kCarpets = {rgb(0x6b7d8c), rgb(0x8a7a63), rgb(0x5f7a6b), rgb(0x86605a),
                                                          rgb(0x77718a)};
  Random random(seed ^ (uint64_t{room.floor} << 40U) ^ static_cast<uint64_t>(room.min.x * 64 + 4096 * room.min.y * 64));
  const glm::u8vec4 paint = kPaints[random.below(kPaints.size())], carpet = kCarpets[random.below(kCarpets.size())];
  switch (room.kind) {
    case RoomKind::corridor:
      return {kPlaster, room.floor == 0 ? kTiles : rgb(0x9a8f84)};
    case RoomKind::lobby:
      return {rgb(0xe9dcc4), rgb(0xc9c0b0)};
    case RoomKind::auditorium:
      return {rgb(0xc7a98a), rgb(0x6e3b40)};
    case RoomKind::library:
      return {rgb(0xe7dcc6), rgb(0x5f6f5a)};
    case RoomKind::toilet:
      return {rgb(0xcfe0e0), rgb(0x8fa3a5)};
    case RoomKind::kitchenette:
      return {rgb(0xf0e4c0), rgb(0xb9a98f)};
    case RoomKind::class_room:
      return {paint, rgb(0xb08d62)};
    case RoomKind::lounge:
      return {paint, palette::kBeech};
    case RoomKind::laboratory:
      return {rgb(0xe3e6e6), rgb(0x7d8a96)};
    case RoomKind::server_room:
    case RoomKind::storage:
    case RoomKind::stairwell:
    case RoomKind::lift:
      return {rgb(0xd9d6ce), rgb(0x9a9a98)};
    default:
      return {paint, carpet};
  }
}

class Builder {
 public:
  Builder(const BuildingPlan& plan, uint64_t seed) : plan_(plan), seed_(seed) {}

  void wall(const Wall& wall);
  void room(const Room& room);
  void slab(uint32_t floor);
  void stairs();
  void auditorium();
  void roof();
  void ledges();
  void ground();
  Structure take() { return std::move(structure_); }

 private:
  uint32_t keep() {
    structure_.meshes.push_back(sculptor_.take());
    return static_cast<uint32_t>(structure_.meshes.size() - 1);
  }
  void part(std::string name, const char* class_name, uint32_t mesh, const glm::dmat4& at) {
    structure_.parts.push_back({std::move(name), class_name, mesh, at});
  }
  void box_part(std::string name, const char* class_name, glm::u8vec4 color, const dvec3& min, const dvec3& max) {
    sculptor_.stand().paint(color).box({0, 0, 0}, max - min);
    part(std::move(name), class_name, keep(), moved(min));
  }
  glm::u8vec4 paint_of(uint32_t room, uint32_t floor) const {
    return room == kOutside ? facade_of(floor) : finish_of(plan_.rooms[room], seed_).wall;
  }

  const BuildingPlan& plan_;
  uint64_t seed_;
  Sculptor sculptor_{1};
  Structure structure_;
};

/// The wall's face as a polygon (along, up): openings that reach the floor are notches, the others holes.
void Builder::wall(const Wall& wall) {
  const bool outer = wall.low == kOutside || wall.high == kOutside;
  const double bottom = outer ? -kSlabM - kFinishM : -kFinishM, length = wall.to - wall.from;
  std::vector<dvec2> outline{{0, bottom}};
  std::vector<std::vector<dvec2>> holes;
  for (const Opening& opening : wall.openings) {
    const double a = opening.at - wall.from - opening.width_m / 2, b = a + opening.width_m;
    // Doors leave a sill as high as the floor's finish: holes too, so that the wall stays one piece.
    holes.push_back({{a, opening.bottom_m}, {a, opening.top_m}, {b, opening.top_m}, {b, opening.bottom_m}});
  }
  outline.insert(outline.end(), {{length, bottom}, {length, kWallTopM}, {0, kWallTopM}});
  const glm::u8vec4 low = paint_of(wall.low, wall.floor), high = paint_of(wall.high, wall.floor);
  const double z = wall.floor * kStoreyM;
  sculptor_.paint(outer ? facade_of(wall.floor) : kPlaster);
  glm::dmat4 world;
  if (wall.along_x) {
    sculptor_.stand(turned_x(90)).extrude(outline, holes, -wall.above_m, wall.below_m, &low, &high);
    world = moved({wall.from, wall.line, z});
  } else {
    sculptor_.stand(turned_z(90) * turned_x(90)).extrude(outline, holes, -wall.below_m, wall.above_m, &high, &low);
    world = moved({wall.line, wall.from, z});
  }
  part(fmt::format("f{}_wall_{}", wall.floor + 1, structure_.parts.size()), "wall", keep(), world);
}

void Builder::room(const Room& room) {
  const Finish finish = finish_of(room, seed_);
  const double z = room.floor * kStoreyM;
  dvec2 min = room.min + kWallHalfM, max = room.max - kWallHalfM;
  // Where a corridor meets the next one there is no wall: north-south corridors reach to those across.
  if (room.kind == RoomKind::corridor && max.y - min.y > max.x - min.x)
    min.y -= 2 * kWallHalfM, max.y += 2 * kWallHalfM;
  const bool shaft = room.kind == RoomKind::lift || room.kind == RoomKind::stairwell;
  if (room.has_floor && (!shaft || room.floor == 0))
    box_part(fmt::format("f{}_{}_floor", room.floor + 1, room.name), "floor", finish.floor, {min, z - kFinishM},
             {max, z});
  if (room.kind == RoomKind::stairwell && room.floor > 0)
    box_part(fmt::format("f{}_{}_floor", room.floor + 1, room.name), "floor", finish.floor, {min, z - kFinishM},
             {max.x, min.y + kLandingM, z});
  if (!room.has_ceiling || shaft) return;
  const double height = room.kind == RoomKind::corridor     ? kCorridorCeilingM
                        : room.kind == RoomKind::auditorium ? 3.35
                                                            : kCeilingM;
  box_part(fmt::format("f{}_{}_ceiling", room.floor + 1, room.name), "ceiling", rgb(0xf4f1ea), {min, z + height},
           {max, z + height + 0.05});
}

void Builder::slab(uint32_t floor) {
  const dvec2 min(kWallHalfM), max(kWidthM - kWallHalfM, kDepthM - kWallHalfM);
  const std::vector<dvec2> outline{min, {max.x, min.y}, max, {min.x, max.y}};
  std::vector<std::vector<dvec2>> holes;
  for (const Room& room : plan_.rooms) {
    if (room.floor != floor || floor == 0) continue;
    const bool hall = room.kind == RoomKind::auditorium && !room.has_floor;
    if (!hall && room.kind != RoomKind::stairwell && room.kind != RoomKind::lift) continue;
    dvec2 a = room.min + kWallHalfM, b = room.max - kWallHalfM;
    if (room.kind == RoomKind::stairwell) a.y += kLandingM;
    holes.push_back({a, {a.x, b.y}, b, {b.x, a.y}});
  }
  const double z = floor * kStoreyM;
  sculptor_.stand().paint(kConcrete).extrude(outline, holes, -kSlabM - kFinishM, -kFinishM);
  part(fmt::format("f{}_slab", floor + 1), "slab", keep(), moved({0, 0, z}));
}

/// Stairs in the frame of the stairwell's inner south-west corner.
void Builder::stairs() {
  const double run = kTreads * kTreadM, half = (kTreads + 1) * kRiserM, y0 = kLandingM, y1 = y0 + run;
  double right = 0;
  for (const Room& room : plan_.rooms) {
    if (room.kind == RoomKind::stairwell) right = room.max.x - room.min.x - 2 * kWallHalfM;
  }
  // A closed block a step, over a sloping underside.
  sculptor_.stand(turned_z(90) * turned_x(90)).paint(kConcrete);
  for (uint32_t i = 0; i < kTreads; ++i) {
    const double near = i * kTreadM, far = (i + 1) * kTreadM, low = i * kRiserM - 0.2, top = (i + 1) * kRiserM;
    const dvec2 up[] = {
        {y0 + near, std::max(0.0, low)}, {y0 + far, std::max(0.0, low + kRiserM)}, {y0 + far, top}, {y0 + near, top}};
    sculptor_.extrude(up, {}, 0, kFlightWidthM);
    const dvec2 back[] = {{y1 - far, half + std::max(-0.18, low + kRiserM)},
                          {y1 - near, half + std::max(-0.18, low)},
                          {y1 - near, half + top},
                          {y1 - far, half + top}};
    sculptor_.extrude(back, {}, right - kFlightWidthM, right);
  }
  sculptor_.stand().box({0, y1, half - 0.18}, {right, y1 + 1.5, half});
  const uint32_t mesh = keep();
  for (const Room& room : plan_.rooms) {
    if (room.kind != RoomKind::stairwell || room.floor + 1 >= plan_.floors) continue;
    part(fmt::format("f{}_{}_stairs", room.floor + 1, room.name), "stairs", mesh,
         moved({room.min + kWallHalfM, room.floor * kStoreyM}));
  }
}

/// The auditorium's rows: one stepped solid, with a half step in both aisles before each.
void Builder::auditorium() {
  for (const Room& room : plan_.rooms) {
    if (room.kind != RoomKind::auditorium || !room.has_floor) continue;
    const dvec2 size = room.max - room.min - 2 * kWallHalfM;
    const double rise = kStoreyM / kRows;
    std::vector<dvec2> profile{{kFrontRowM, 0}, {size.y, 0}, {size.y, kStoreyM}};
    for (uint32_t i = kRows; i-- > 0;) {
      if (i + 1 < kRows) profile.emplace_back(kFrontRowM + (i + 1) * kRowDepthM, (i + 1) * rise);
      profile.emplace_back(kFrontRowM + i * kRowDepthM, (i + 1) * rise);
    }
    sculptor_.stand(turned_z(90) * turned_x(90)).paint(finish_of(room, seed_).floor).extrude(profile, {}, 0, size.x);
    sculptor_.stand().paint(shaded(finish_of(room, seed_).floor, 0.15));
    for (uint32_t i = 0; i < kRows; ++i) {
      const double y = kFrontRowM + i * kRowDepthM, z = i * rise;
      sculptor_.box({0.001, y - 0.42, z}, {kAisleM, y - 0.0001, z + rise / 2});
      sculptor_.box({size.x - kAisleM, y - 0.42, z}, {size.x - 0.001, y - 0.0001, z + rise / 2});
    }
    const uint32_t rows = keep();
    part(fmt::format("f{}_{}_rows", room.floor + 1, room.name), "stairs", rows,
         moved({room.min + kWallHalfM, room.floor * kStoreyM}));
    // A wooden band covers the slab's edge between the two storeys' walls.
    const std::vector<dvec2> outline{
        {0.001, 0.001}, {size.x - 0.001, 0.001}, {size.x - 0.001, size.y - 0.001}, {0.001, size.y - 0.001}};
    const std::vector<std::vector<dvec2>> inside{
        {{0.03, 0.03}, {0.03, size.y - 0.03}, {size.x - 0.03, size.y - 0.03}, {size.x - 0.03, 0.03}}};
    sculptor_.stand().paint(palette::kWalnut).extrude(outline, inside, kWallTopM - 0.06, kStoreyM - 0.001);
    const uint32_t band = keep();
    part(fmt::format("f{}_{}_band", room.floor + 1, room.name), "ledge", band,
         moved({room.min + kWallHalfM, room.floor * kStoreyM}));
  }
}

void Builder::roof() {
  const double z = plan_.floors * kStoreyM, x1 = kWidthM + kFacadeM, y1 = kDepthM + kFacadeM, in = kWallHalfM;
  const double low = z - kSlabM - kFinishM, high = z + 0.9;
  box_part("roof_slab", "roof", kRoofing, {in, in, low}, {kWidthM - in, kDepthM - in, z});
  box_part("parapet_south", "parapet", kBrick, {-kFacadeM, -kFacadeM, low}, {x1, in, high});
  box_part("parapet_north", "parapet", kBrick, {-kFacadeM, kDepthM - in, low}, {x1, y1, high});
  box_part("parapet_west", "parapet", kBrick, {-kFacadeM, in, low}, {in, kDepthM - in, high});
  box_part("parapet_east", "parapet", kBrick, {kWidthM - in, in, low}, {x1, kDepthM - in, high});
  const double out = kFacadeM + 0.12, top = high + 0.12;
  box_part("coping_south", "ledge", kStone, {-out, -out, high}, {kWidthM + out, in + 0.06, top});
  box_part("coping_north", "ledge", kStone, {-out, kDepthM - in - 0.06, high}, {kWidthM + out, kDepthM + out, top});
  box_part("coping_west", "ledge", kStone, {-out, in + 0.06, high}, {in + 0.06, kDepthM - in - 0.06, top});
  box_part("coping_east", "ledge", kStone, {kWidthM - in - 0.06, in + 0.06, high},
           {kWidthM + out, kDepthM - in - 0.06, top});
  box_part("lift_house", "roof", kConcrete, {27.4, 9.1, z}, {29.9, 14.1, z + 1.8});
}

/// Bands around the facade at every storey, each side one solid that ends at the next one's face.
void Builder::ledges() {
  for (uint32_t floor = 1; floor <= plan_.floors; ++floor) {
    const double z = floor * kStoreyM - 0.32, reach = floor == 1 ? 0.22 : 0.1, top = z + (floor == 1 ? 0.4 : 0.26);
    const double a = kFacadeM, b = kFacadeM + reach;
    const glm::u8vec4 color = kStone;
    box_part(fmt::format("f{}_ledge_south", floor + 1), "ledge", color, {-b, -b, z}, {kWidthM + b, -a, top});
    box_part(fmt::format("f{}_ledge_north", floor + 1), "ledge", color, {-b, kDepthM + a, z},
             {kWidthM + b, kDepthM + b, top});
    box_part(fmt::format("f{}_ledge_west", floor + 1), "ledge", color, {-b, -a, z}, {-a, kDepthM + a, top});
    box_part(fmt::format("f{}_ledge_east", floor + 1), "ledge", color, {kWidthM + a, -a, z},
             {kWidthM + b, kDepthM + a, top});
  }
}

void Builder::ground() {
  box_part("lawn", "ground", kLawn, {-50, -55, -1}, {kWidthM + 50, kDepthM + 50, -0.1});
  // Paving around the building and a path to the entrance, each resting in the lawn.
  const double e = 4;
  box_part("paving_south", "ground", kPaving, {-e, -e, -0.3}, {kWidthM + e, -kFacadeM, -0.02});
  box_part("paving_north", "ground", kPaving, {-e, kDepthM + kFacadeM, -0.3}, {kWidthM + e, kDepthM + e, -0.02});
  box_part("paving_west", "ground", kPaving, {-e, -kFacadeM, -0.3}, {-kFacadeM, kDepthM + kFacadeM, -0.02});
  box_part("paving_east", "ground", kPaving, {kWidthM + kFacadeM, -kFacadeM, -0.3},
           {kWidthM + e, kDepthM + kFacadeM, -0.02});
  box_part("entrance_path", "ground", shaded(kPaving, 0.1), {kWidthM / 2 - 3, -52, -0.3}, {kWidthM / 2 + 3, -e, -0.03});
  box_part("canopy", "roof", kStone, {kWidthM / 2 - 3, -3, 2.75}, {kWidthM / 2 + 3, -kFacadeM, 2.95});
  for (const double x : {kWidthM / 2 - 2.7, kWidthM / 2 + 2.5})
    box_part(fmt::format("canopy_post_{}", x < kWidthM / 2 ? 0 : 1), "roof", kStone, {x, -2.9, -0.02},
             {x + 0.2, -2.7, 2.75});
}

}  // namespace

Structure build_structure(const BuildingPlan& plan, uint64_t seed) {
  Builder builder(plan, seed);
  for (uint32_t floor = 0; floor < plan.floors; ++floor) builder.slab(floor);
  for (const Wall& wall : plan.walls) builder.wall(wall);
  for (const Room& room : plan.rooms) builder.room(room);
  builder.stairs();
  builder.auditorium();
  builder.roof();
  builder.ledges();
  builder.ground();
  return builder.take();
}

}  // namespace promenade
