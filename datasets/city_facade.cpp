// Source: [xiong1996] appendix A for segments, dividers and colours; the rest is what streets look like.

#include "datasets/city_facade.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>

namespace promenade {
namespace {

constexpr float kBelowGroundM = 0.3F;  // walls reach below the pavement, so that no gap shows under them

/// A hole in a wall, in the wall's frame.
struct Opening {
  float x0, x1, z0, z1;
};

/// One bay of one floor.
struct Cell {
  float x0, x1, z0, z1;
  int bay, floor;
};

class WallBuilder {
 public:
  WallBuilder(Shape& shape, const Wall& wall, const FacadeStyle& style, int tier, const Random& random)
      : shape_(shape),
        wall_(wall),
        style_(style),
        tier_(tier),
        random_(random),
        frame_(WallFrame::between(wall.a, wall.b)),
        length_(glm::distance(wall.a, wall.b)) {}

  void build();

 private:
  void build_floor(int floor, float z0, float z1);
  void build_rooms(int floor, float z0, float z1);
  void build_cell(const Cell& cell);
  void plain(float x0, float x1, float z0, float z1);
  void hole(const Cell& cell, const Opening& opening, float recess_m);
  void pane(const Opening& o, float recess_m, Random random);
  void bars(const Opening& o, float recess_m, int across, int up);
  void window(const Cell& cell);
  void window_dressing(const Cell& cell, const Opening& o, Random random);
  void balcony(const Cell& cell);
  void shop(const Cell& cell);
  void door(const Cell& cell);
  Opening window_of(const Cell& cell) const;
  bool windowed(const Cell& cell) const;
  bool has_room(const Cell& cell) const;

  /// The ends are the wall's corners to the bit, so that walls meet without a gap.
  glm::vec2 ground_point(float x) const {
    return x <= 0 ? wall_.a : x >= length_ ? wall_.b : frame_.origin + frame_.along * x;
  }
  uint32_t wall_vertex(float x, float z, float y = 0) {
    return shape_.vertex({ground_point(x) + frame_.out * y, z}, texcoord(x, z));
  }
  glm::vec2 texcoord(float x, float z) const {
    return {wall_.u0 + (wall_.u1 - wall_.u0) * (x / length_), 1 - std::max(z, 0.0F) * wall_.v_per_m};
  }
  void wall_paint(int floor) {
    shape_.material(wall_.panes != nullptr ? kTexturedWall : kOpaque);
    shape_.color(wall_.panes != nullptr ? rgb(255, 255, 255) : floor % 2 == 0 ? style_.wall : style_.wall_other);
  }
  void paint(const Color& color) { shape_.material(kOpaque), shape_.color(color); }

  Shape& shape_;
  const Wall& wall_;
  const FacadeStyle& style_;
  int tier_;
  Random random_;
  WallFrame frame_;
  float length_;
  int bays_ = 1;
  int floors_ = 1;
};

void WallBuilder::build() {
  const float first = wall_.ground ? std::min(style_.ground_floor_m, wall_.top_m - wall_.bottom_m) : style_.floor_m;
  floors_ = std::max(1, 1 + static_cast<int>(std::lround((wall_.top_m - wall_.bottom_m - first) / style_.floor_m)));
  bays_ = std::max(1, static_cast<int>(std::lround(length_ / style_.bay_m)));
  const bool bare = tier_ == 0 || length_ < 1.5F;
  const float rest = floors_ > 1 ? (wall_.top_m - wall_.bottom_m - first) / static_cast<float>(floors_ - 1) : 0;
  for (int f = 0; f < floors_; ++f) {
    const float z0 = f == 0 ? wall_.bottom_m : wall_.bottom_m + first + rest * static_cast<float>(f - 1);
    const float z1 = f + 1 == floors_ ? wall_.top_m : wall_.bottom_m + first + rest * static_cast<float>(f);
    wall_paint(f);
    if (bare)
      plain(0, length_, f == 0 && wall_.ground ? z0 - kBelowGroundM : z0, z1);
    else
      build_floor(f, z0, z1);
  }
}

void WallBuilder::build_floor(int floor, float z0, float z1) {
  if (floor == 0 && wall_.ground) plain(0, length_, z0 - kBelowGroundM, z0);
  for (int bay = 0; bay < bays_; ++bay) {
    const float x0 = length_ * static_cast<float>(bay) / static_cast<float>(bays_);
    const float x1 = bay + 1 == bays_ ? length_ : length_ * static_cast<float>(bay + 1) / static_cast<float>(bays_);
    build_cell({x0, x1, z0, z1, bay, floor});
  }
  if (wall_.room_depth_m > 0) build_rooms(floor, z0, z1);
}

bool WallBuilder::has_room(const Cell& cell) const {
  return wall_.room_depth_m > 0 && cell.x0 >= wall_.trim_a_m && cell.x1 <= length_ - wall_.trim_b_m;
}

void WallBuilder::build_rooms(int floor, float z0, float z1) {
  const auto bay_start = [&](int bay) { return length_ * static_cast<float>(bay) / static_cast<float>(bays_); };
  for (int bay = 0; bay < bays_;) {
    if (!has_room({bay_start(bay), bay_start(bay + 1), z0, z1, bay, floor})) {
      ++bay;
      continue;
    }
    Random random = random_.fork(0x700000 + static_cast<uint64_t>(floor) * 512 + static_cast<uint64_t>(bay));
    int end = bay + 1;
    const int wish = bay + random.between(1, 3);
    while (end < wish && end < bays_ && has_room({bay_start(end), bay_start(end + 1), z0, z1, end, floor})) ++end;
    build_room(shape_,
               {frame_, bay_start(bay) + 0.06F, bay_start(end) - 0.06F, wall_.room_depth_m, z0 + 0.12F, z1 - 0.15F},
               random);
    bay = end;
  }
}

void WallBuilder::plain(float x0, float x1, float z0, float z1) {
  const uint32_t a = wall_vertex(x0, z0), b = wall_vertex(x1, z0), c = wall_vertex(x1, z1), d = wall_vertex(x0, z1);
  shape_.quad(a, b, c, d);
}

bool WallBuilder::windowed(const Cell& cell) const {
  if (cell.x1 - cell.x0 < 1.0F || cell.z1 - cell.z0 < 2.0F) return false;
  // Walls towards a neighbour have a window here and there.
  return wall_.street || (cell.bay + cell.floor / 64) % 2 == 1;
}

Opening WallBuilder::window_of(const Cell& cell) const {
  const float middle = (cell.x0 + cell.x1) / 2, height = cell.z1 - cell.z0;
  const float half = std::min(style_.window_width_m, cell.x1 - cell.x0 - 0.3F) / 2;
  const bool tall = style_.balcony_every > 0 && cell.floor > 0 && cell.bay % style_.balcony_every == 0;
  const float z0 = cell.z0 + (tall ? 0.12F : std::min(style_.sill_m, height * 0.4F));
  const float z1 = std::min(cell.z0 + style_.sill_m + style_.window_height_m, cell.z1 - 0.2F);
  return {middle - half, middle + half, z0, z1};
}

void WallBuilder::build_cell(const Cell& cell) {
  wall_paint(cell.floor);
  const bool at_street = cell.floor == 0 && wall_.ground && wall_.street;
  if (at_street && wall_.door && cell.bay == bays_ / 2 && cell.x1 - cell.x0 > 1.4F) return door(cell);
  if (at_street && style_.shop && cell.x1 - cell.x0 > 1.6F) return shop(cell);
  if (windowed(cell)) return window(cell);
  plain(cell.x0, cell.x1, cell.z0, cell.z1);
}

/// The wall around a hole, and the hole's own sides.
void WallBuilder::hole(const Cell& cell, const Opening& o, float recess_m) {
  const std::array<uint32_t, 4> outer = {wall_vertex(cell.x0, cell.z0), wall_vertex(cell.x1, cell.z0),
                                         wall_vertex(cell.x1, cell.z1), wall_vertex(cell.x0, cell.z1)};
  std::array<uint32_t, 4> edge{}, inner{};
  const std::array<glm::vec2, 4> corners = {glm::vec2(o.x0, o.z0), {o.x1, o.z0}, {o.x1, o.z1}, {o.x0, o.z1}};
  for (size_t i = 0; i < 4; ++i) {
    edge[i] = wall_vertex(corners[i].x, corners[i].y);
    inner[i] = wall_vertex(corners[i].x, corners[i].y, -recess_m);
  }
  for (size_t i = 0; i < 4; ++i) {
    const size_t j = (i + 1) % 4;
    shape_.quad(outer[i], outer[j], edge[j], edge[i]);
    shape_.quad(edge[i], edge[j], inner[j], inner[i]);
  }
}

void WallBuilder::pane(const Opening& o, float recess_m, Random random) {
  const bool room = has_room({o.x0, o.x1, o.z0, o.z1, 0, 0});
  const float tone = random.range(0.75F, 1.3F);
  if (wall_.see_through || room) {
    shape_.material(kGlass);
    shape_.color({style_.glass.r, style_.glass.g, style_.glass.b, static_cast<uint8_t>(room ? 70 : 150)});
  } else if (wall_.panes != nullptr) {
    shape_.material(kTexturedWall), shape_.color(rgb(255, 255, 255));
    if (!shape_.counting()) wall_.panes->push_back({texcoord(o.x0, o.z1), texcoord(o.x1, o.z0)});
  } else {
    shape_.material(kOpaque), shape_.color(shade(style_.glass, tone));
  }
  const uint32_t a = wall_vertex(o.x0, o.z0, -recess_m), b = wall_vertex(o.x1, o.z0, -recess_m);
  // The sky is brighter at the top of a pane.
  if (!wall_.see_through && !room && wall_.panes == nullptr)
    shape_.color(blend(shade(style_.glass, tone), rgb(176, 200, 222), 0.3F));
  const uint32_t c = wall_vertex(o.x1, o.z1, -recess_m), d = wall_vertex(o.x0, o.z1, -recess_m);
  shape_.quad(a, b, c, d);
}

/// A frame in the opening with bars across and up.
void WallBuilder::bars(const Opening& o, float recess_m, int across, int up) {
  paint(style_.frame);
  const float front = -recess_m + 0.05F, back = -recess_m, w = 0.06F;
  const std::array<glm::vec2, 4> outer = {glm::vec2(o.x0, o.z0), {o.x1, o.z0}, {o.x1, o.z1}, {o.x0, o.z1}};
  const std::array<glm::vec2, 4> inner = {
      glm::vec2(o.x0 + w, o.z0 + w), {o.x1 - w, o.z0 + w}, {o.x1 - w, o.z1 - w}, {o.x0 + w, o.z1 - w}};
  std::array<uint32_t, 4> a{}, b{}, c{};
  for (size_t i = 0; i < 4; ++i) {
    a[i] = shape_.vertex(frame_.at(outer[i].x, front, outer[i].y));
    b[i] = shape_.vertex(frame_.at(inner[i].x, front, inner[i].y));
    c[i] = shape_.vertex(frame_.at(inner[i].x, back, inner[i].y));
  }
  for (size_t i = 0; i < 4; ++i) {
    const size_t j = (i + 1) % 4;
    shape_.quad(a[i], a[j], b[j], b[i]);
    shape_.quad(b[i], b[j], c[j], c[i]);
  }
  for (int k = 1; k < across; ++k) {
    const float x = o.x0 + (o.x1 - o.x0) * static_cast<float>(k) / static_cast<float>(across);
    shape_.box(frame_, {x - 0.025F, back, o.z0 + w}, {x + 0.025F, front - 0.01F, o.z1 - w},
               Shape::back | Shape::top | Shape::bottom);
  }
  for (int k = 1; k < up; ++k) {
    const float z =
        o.z0 + (o.z1 - o.z0) * (k == up - 1 && up == 2 ? 0.68F : static_cast<float>(k) / static_cast<float>(up));
    shape_.box(frame_, {o.x0 + w, back, z - 0.025F}, {o.x1 - w, front - 0.015F, z + 0.025F}, Shape::back);
  }
}

void WallBuilder::window(const Cell& cell) {
  const Opening o = window_of(cell);
  Random random = random_.fork(static_cast<uint64_t>(cell.floor) * 512 + static_cast<uint64_t>(cell.bay));
  const float recess = style_.recess_m;
  hole(cell, o, recess);
  pane(o, recess, random.fork(1));
  if (tier_ >= 2 && style_.balcony_every > 0 && cell.floor > 0 && cell.bay % style_.balcony_every == 0 && wall_.street)
    balcony(cell);
  else if (tier_ >= 2 && style_.sills) {
    paint(style_.trim);
    shape_.box(frame_, {o.x0 - 0.1F, -0.02F, o.z0 - 0.08F}, {o.x1 + 0.1F, 0.09F, o.z0}, Shape::back);
  }
  if (tier_ >= 3) bars(o, recess, style_.panes_across, style_.panes_up);
  if (tier_ >= 4) window_dressing(cell, o, random.fork(2));
}

void WallBuilder::window_dressing(const Cell& cell, const Opening& o, Random random) {
  if (style_.lintels) {
    paint(style_.trim);
    shape_.box(frame_, {o.x0 - 0.15F, -0.02F, o.z1}, {o.x1 + 0.15F, 0.06F, o.z1 + 0.14F}, Shape::back);
    shape_.box(frame_, {o.x0 - 0.2F, -0.02F, o.z1 + 0.14F}, {o.x1 + 0.2F, 0.12F, o.z1 + 0.2F}, Shape::back);
  }
  const bool opaque = !wall_.see_through && wall_.room_depth_m <= 0;
  if (opaque && random.chance(0.45)) {
    const float low = o.z1 - (o.z1 - o.z0) * random.range(0.15F, 0.75F);
    paint(shade(rgb(222, 214, 198), random.range(0.85F, 1.05F)));
    shape_.face(frame_.at(o.x0, -style_.recess_m + 0.01F, low), frame_.at(o.x1, -style_.recess_m + 0.01F, low),
                frame_.at(o.x1, -style_.recess_m + 0.01F, o.z1), frame_.at(o.x0, -style_.recess_m + 0.01F, o.z1));
  }
  if (tier_ < 5) return;
  if (style_.shutters && cell.x1 - cell.x0 > (o.x1 - o.x0) * 1.9F)
    for (const float side : {-1.0F, 1.0F}) {
      const float w = (o.x1 - o.x0) / 2;
      const float x0 = side < 0 ? o.x0 - w - 0.03F : o.x1 + 0.03F;
      paint(style_.accent);
      shape_.box(frame_, {x0, -0.01F, o.z0}, {x0 + w, 0.04F, o.z1}, Shape::back);
      const int slats = tier_ >= 6 ? 14 : 6;
      paint(shade(style_.accent, 0.82F));
      for (int k = 0; k < slats; ++k) {
        const float z = o.z0 + (o.z1 - o.z0) * (static_cast<float>(k) + 0.5F) / static_cast<float>(slats);
        shape_.box(frame_, {x0 + 0.05F, 0.03F, z - 0.02F}, {x0 + w - 0.05F, 0.06F, z + 0.02F}, Shape::back);
      }
    }
  if (style_.flower_boxes && random.chance(0.5)) {
    paint(rgb(110, 66, 44));
    shape_.box(frame_, {o.x0 + 0.05F, 0.09F, o.z0 - 0.02F}, {o.x1 - 0.05F, 0.3F, o.z0 + 0.16F}, Shape::back);
    const std::array<Color, 4> flowers = {rgb(196, 52, 60), rgb(226, 120, 160), rgb(240, 200, 70), rgb(90, 140, 60)};
    const int count = tier_ >= 6 ? 12 : 5;
    for (int k = 0; k < count; ++k) {
      const float x = o.x0 + 0.12F + (o.x1 - o.x0 - 0.24F) * static_cast<float>(k) / static_cast<float>(count - 1);
      paint(flowers[random.below(4)]);
      shape_.cylinder(frame_.at(x, random.range(0.14F, 0.25F), o.z0 + 0.12F), 0.07F, 0.03F, random.range(0.1F, 0.24F),
                      5);
    }
  }
  if (style_.coolers && random.chance(0.25)) {
    paint(rgb(214, 214, 208));
    shape_.box(frame_, {o.x0 + 0.1F, 0, o.z0 - 0.62F}, {o.x0 + 0.9F, 0.34F, o.z0 - 0.14F}, Shape::back);
    paint(rgb(80, 82, 84));
    for (int k = 0; k < 6; ++k) {
      const float z = o.z0 - 0.57F + 0.065F * static_cast<float>(k);
      shape_.box(frame_, {o.x0 + 0.16F, 0.33F, z}, {o.x0 + 0.72F, 0.36F, z + 0.03F}, Shape::back);
    }
  }
}

void WallBuilder::balcony(const Cell& cell) {
  const float x0 = cell.x0 + 0.15F, x1 = cell.x1 - 0.15F, z = cell.z0, deep = 1.1F;
  paint(shade(style_.trim, 0.95F));
  shape_.box(frame_, {x0, -0.02F, z - 0.08F}, {x1, deep, z + 0.1F}, Shape::back);
  paint(style_.accent);
  const float rail = z + 1.1F;
  if (tier_ < 4) {
    for (const float y : {deep - 0.05F}) shape_.box(frame_, {x0, y, z + 0.1F}, {x1, y + 0.04F, rail}, Shape::bottom);
    for (const float x : {x0, x1 - 0.04F})
      shape_.box(frame_, {x, 0, z + 0.1F}, {x + 0.04F, deep - 0.05F, rail}, Shape::back);
    return;
  }
  shape_.box(frame_, {x0, deep - 0.07F, rail - 0.05F}, {x1, deep - 0.01F, rail});
  for (const float x : {x0, x1 - 0.05F})
    shape_.box(frame_, {x, 0, rail - 0.05F}, {x + 0.05F, deep - 0.07F, rail}, Shape::back);
  const float gap = tier_ >= 6 ? 0.11F : 0.2F;
  const int across = static_cast<int>((x1 - x0) / gap), along = static_cast<int>(deep / gap);
  const auto post = [&](float x, float y) {
    shape_.box(frame_, {x - 0.012F, y - 0.012F, z + 0.1F}, {x + 0.012F, y + 0.012F, rail - 0.05F},
               Shape::top | Shape::bottom);
  };
  for (int k = 0; k <= across; ++k)
    post(x0 + 0.03F + (x1 - x0 - 0.06F) * static_cast<float>(k) / static_cast<float>(across), deep - 0.04F);
  for (int k = 1; k < along; ++k)
    for (const float x : {x0 + 0.03F, x1 - 0.03F}) post(x, deep * static_cast<float>(k) / static_cast<float>(along));
}

void WallBuilder::shop(const Cell& cell) {
  const Opening o{cell.x0 + 0.22F, cell.x1 - 0.22F, cell.z0 + 0.45F, std::min(cell.z0 + 2.9F, cell.z1 - 0.7F)};
  Random random = random_.fork(0x5000 + static_cast<uint64_t>(cell.bay));
  hole(cell, o, 0.25F);
  pane(o, 0.25F, random.fork(1));
  if (tier_ >= 3) bars(o, 0.25F, 2, 2);
  if (tier_ < 2) return;
  const Random building = random_.fork(0x77);
  const bool awning = Random(building).chance(0.5);
  paint(style_.accent);
  shape_.box(frame_, {cell.x0 + 0.1F, -0.02F, o.z1 + 0.1F}, {cell.x1 - 0.1F, 0.1F, o.z1 + 0.55F}, Shape::back);
  if (!awning) return;
  const int stripes = tier_ >= 3 ? 8 : 2;
  for (int k = 0; k < stripes; ++k) {
    const float x0 = o.x0 + (o.x1 - o.x0) * static_cast<float>(k) / static_cast<float>(stripes);
    const float x1 = o.x0 + (o.x1 - o.x0) * static_cast<float>(k + 1) / static_cast<float>(stripes);
    const float deep = 1.0F, top = o.z1 + 0.12F, low = o.z1 - 0.2F;
    paint(k % 2 == 0 ? shade(style_.accent, 1.25F) : rgb(236, 230, 216));
    shape_.face(frame_.at(x0, deep, low), frame_.at(x1, deep, low), frame_.at(x1, 0, top), frame_.at(x0, 0, top));
    shape_.face(frame_.at(x1, deep, low), frame_.at(x0, deep, low), frame_.at(x0, 0, top), frame_.at(x1, 0, top));
    shape_.face(frame_.at(x0, deep, low - 0.18F), frame_.at(x1, deep, low - 0.18F), frame_.at(x1, deep, low),
                frame_.at(x0, deep, low));
    shape_.face(frame_.at(x1, deep, low - 0.18F), frame_.at(x0, deep, low - 0.18F), frame_.at(x0, deep, low),
                frame_.at(x1, deep, low));
  }
}

void WallBuilder::door(const Cell& cell) {
  const float middle = (cell.x0 + cell.x1) / 2, half = std::min(1.0F, (cell.x1 - cell.x0) / 2 - 0.2F);
  const Opening o{middle - half, middle + half, cell.z0 + 0.02F, std::min(cell.z0 + 2.6F, cell.z1 - 0.3F)};
  const float recess = 0.4F, head = cell.z0 + 2.12F;
  hole(cell, o, recess);
  paint(shade(style_.accent, 0.8F));
  shape_.face(frame_.at(o.x0, -recess, o.z0), frame_.at(o.x1, -recess, o.z0), frame_.at(o.x1, -recess, o.z1),
              frame_.at(o.x0, -recess, o.z1));
  paint(rgb(168, 162, 152));
  shape_.box(frame_, {o.x0 - 0.1F, -0.05F, cell.z0 - 0.1F}, {o.x1 + 0.1F, 0.35F, cell.z0 + 0.015F},
             Shape::back | Shape::bottom);
  if (tier_ < 3) return;
  for (int leaf = 0; leaf < 2; ++leaf) {
    const float x0 = leaf == 0 ? o.x0 + 0.08F : middle + 0.02F, x1 = leaf == 0 ? middle - 0.02F : o.x1 - 0.08F;
    paint(style_.accent);
    shape_.box(frame_, {x0, -recess, o.z0}, {x1, -recess + 0.05F, head}, Shape::back | Shape::bottom);
    for (int k = 0; k < 3; ++k) {
      const float z = o.z0 + 0.15F + 0.66F * static_cast<float>(k);
      paint(k == 2 ? style_.glass : shade(style_.accent, 1.2F));
      shape_.box(frame_, {x0 + 0.12F, -recess + 0.03F, z}, {x1 - 0.12F, -recess + 0.07F, z + 0.52F}, Shape::back);
    }
    paint(rgb(206, 172, 96));
    const float handle = leaf == 0 ? x1 - 0.08F : x0 + 0.05F;
    shape_.box(frame_, {handle, -recess + 0.05F, o.z0 + 0.95F}, {handle + 0.03F, -recess + 0.12F, o.z0 + 1.2F},
               Shape::back);
  }
  paint(style_.glass);
  shape_.box(frame_, {o.x0 + 0.08F, -recess, head + 0.06F}, {o.x1 - 0.08F, -recess + 0.03F, o.z1 - 0.06F}, Shape::back);
  paint(style_.trim);
  for (const float x : {o.x0 - 0.2F, o.x1})
    shape_.box(frame_, {x, -0.02F, cell.z0}, {x + 0.2F, 0.1F, o.z1 + 0.05F}, Shape::back | Shape::bottom);
  shape_.box(frame_, {o.x0 - 0.3F, -0.02F, o.z1 + 0.05F}, {o.x1 + 0.3F, 0.5F, o.z1 + 0.2F}, Shape::back);
}

}  // namespace

void build_wall(Shape& shape, const Wall& wall, const FacadeStyle& style, int tier, const Random& random) {
  WallBuilder(shape, wall, style, tier, random).build();
}

}  // namespace promenade
