// Source: [xiong1996] appendix A: cylindrical or rectangular, solid or semi-transparent, segments of one colour or of
// alternating ones, dividers between floors, tops like cones and pyramids.

#include "datasets/city_building.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>

#include "datasets/city_roof.h"

namespace promenade {
namespace {

constexpr float kBelowGroundM = 0.2F;  // where walls end that nobody sees end

enum class Character : uint8_t { masonry, plaster, office, glass_tower, house };

Color pick(Random& random, std::initializer_list<Color> colors) {
  return *(colors.begin() + random.below(static_cast<uint32_t>(colors.size())));
}

Character character_of(const HousePlan& plan, Random random) {
  const double h = plan.height_m, dice = random.unit();
  if (h > 38) return dice < 0.45 ? Character::glass_tower : dice < 0.8 ? Character::office : Character::masonry;
  if (h > 20) return dice < 0.3 ? Character::office : dice < 0.68 ? Character::masonry : Character::plaster;
  if (h > 11) return dice < 0.45 ? Character::masonry : dice < 0.9 ? Character::plaster : Character::office;
  return dice < 0.75 ? Character::house : Character::plaster;
}

void style_masonry(FacadeStyle& s, Random& r) {
  s.wall = pick(r, {rgb(152, 82, 62), rgb(134, 70, 54), rgb(170, 104, 74), rgb(186, 150, 112), rgb(200, 178, 142),
                    rgb(122, 82, 66), rgb(176, 128, 96), rgb(158, 148, 136)});
  s.trim = pick(r, {rgb(224, 214, 194), rgb(206, 192, 168), rgb(236, 230, 218)});
  s.frame = pick(r, {rgb(238, 236, 228), rgb(64, 58, 52), rgb(52, 70, 60), rgb(226, 218, 200)});
  s.bay_m = r.range(2.7F, 3.4F), s.window_width_m = r.range(1.1F, 1.35F), s.window_height_m = r.range(1.6F, 1.95F);
  s.sill_m = 0.75F, s.lintels = r.chance(0.8), s.panes_up = 2;
  s.shop = r.chance(0.65), s.coolers = r.chance(0.3);
}

void style_plaster(FacadeStyle& s, Random& r) {
  s.wall = pick(r, {rgb(226, 206, 164), rgb(214, 186, 150), rgb(204, 214, 206), rgb(226, 190, 170), rgb(196, 206, 216),
                    rgb(236, 228, 210), rgb(216, 200, 180), rgb(190, 200, 176), rgb(222, 214, 204)});
  s.trim = pick(r, {rgb(244, 240, 230), rgb(228, 222, 210)});
  s.frame = pick(r, {rgb(246, 244, 240), rgb(120, 84, 58)});
  s.bay_m = r.range(3.0F, 3.8F), s.window_width_m = 1.2F, s.window_height_m = 1.5F;
  s.shutters = r.chance(0.45), s.flower_boxes = r.chance(0.5), s.coolers = r.chance(0.3);
  s.balcony_every = r.chance(0.5) ? r.between(2, 3) : 0;
  s.shop = r.chance(0.4), s.lintels = r.chance(0.3);
}

void style_office(FacadeStyle& s, Random& r) {
  s.wall =
      pick(r, {rgb(176, 176, 172), rgb(196, 190, 178), rgb(150, 154, 158), rgb(216, 214, 208), rgb(160, 146, 130)});
  s.trim = shade(s.wall, 0.85F);
  s.frame = pick(r, {rgb(60, 62, 66), rgb(120, 122, 124), rgb(92, 74, 58)});
  s.floor_m = 3.6F, s.bay_m = r.range(2.6F, 3.6F);
  s.window_width_m = s.bay_m - r.range(0.45F, 0.8F), s.window_height_m = 1.9F, s.sill_m = 0.85F;
  s.panes_across = 2, s.panes_up = 1, s.shop = r.chance(0.5), s.recess_m = r.range(0.15F, 0.4F);
}

void style_glass_tower(FacadeStyle& s, Random& r) {
  s.wall = pick(r, {rgb(94, 108, 120), rgb(70, 78, 86), rgb(140, 150, 156), rgb(96, 110, 106), rgb(180, 184, 186)});
  s.trim = shade(s.wall, 1.15F), s.frame = pick(r, {rgb(54, 58, 62), rgb(190, 194, 196)});
  s.glass = pick(r, {rgb(62, 96, 122), rgb(70, 112, 128), rgb(54, 74, 100), rgb(92, 118, 130), rgb(84, 110, 104)});
  s.floor_m = 3.6F, s.bay_m = r.range(2.2F, 3.2F), s.window_width_m = s.bay_m - 0.3F;
  s.window_height_m = 2.9F, s.sill_m = 0.35F, s.recess_m = 0.12F, s.sills = false;
  s.panes_across = 2, s.panes_up = 2, s.ground_floor_m = 5, s.shop = true;
}

void style_house(FacadeStyle& s, Random& r) {
  style_plaster(s, r);
  s.ground_floor_m = 3.2F, s.shop = false, s.balcony_every = 0;
  s.shutters = r.chance(0.7), s.flower_boxes = true;
  if (r.chance(0.35)) s.wall = pick(r, {rgb(160, 92, 70), rgb(146, 80, 62), rgb(178, 120, 88)});
}

FacadeStyle style_of(Character character, Random r) {
  FacadeStyle s;
  s.glass = shade(pick(r, {rgb(62, 78, 94), rgb(72, 88, 100), rgb(54, 64, 78), rgb(80, 92, 98)}), 1.0F);
  s.accent = pick(r, {rgb(122, 42, 40), rgb(40, 74, 60), rgb(44, 62, 96), rgb(140, 90, 40), rgb(70, 52, 46),
                      rgb(60, 84, 100), rgb(34, 36, 40)});
  switch (character) {
    case Character::masonry:
      style_masonry(s, r);
      break;
    case Character::plaster:
      style_plaster(s, r);
      break;
    case Character::office:
      style_office(s, r);
      break;
    case Character::glass_tower:
      style_glass_tower(s, r);
      break;
    case Character::house:
      style_house(s, r);
      break;
  }
  s.wall = shade(s.wall, r.range(0.93F, 1.06F));
  const bool alternating = r.chance(character == Character::house ? 0.05 : 0.22);
  s.wall_other = alternating ? blend(s.wall, s.trim, 0.45F) : s.wall;
  return s;
}

/// A building in one style, segment upon segment.
class HouseBuilder {
 public:
  HouseBuilder(Shape& shape, const HousePlan& plan, const HouseOptions& options, FacadeSketch& sketch)
      : shape_(shape), plan_(plan), options_(options), sketch_(sketch), random_(plan.seed) {}
  void build();

 private:
  struct Segment {
    std::vector<glm::vec2> outline;
    float bottom, top;
  };
  std::vector<Segment> segments(float walls_top) const;
  void build_solid(const std::vector<Segment>& all);
  void build_segment(const Segment& segment, bool ground, bool last);
  void build_walls(const Segment& segment, bool ground);
  void build_bands(const Segment& segment, bool ground);
  void build_ledges(const Segment& segment, bool ground, bool last);
  void build_inside(const Segment& segment);
  float snapped(float height, bool ground) const;
  void paint(const Color& color) { shape_.material(kOpaque), shape_.color(color); }

  Shape& shape_;
  const HousePlan& plan_;
  const HouseOptions& options_;
  FacadeSketch& sketch_;
  Random random_;
  FacadeStyle style_;
  int tier_ = 0;
  bool see_through_ = false, dividers_ = false;
  std::vector<float> edge_u_;
};

/// A height that whole floors fill.
float HouseBuilder::snapped(float height, bool ground) const {
  const float first = ground ? style_.ground_floor_m : 0;
  return first + std::max(ground ? 0.0F : 1.0F, std::round((height - first) / style_.floor_m)) * style_.floor_m;
}

std::vector<HouseBuilder::Segment> HouseBuilder::segments(float walls_top) const {
  Random random = random_.fork(3);
  const float around = [&] {
    float sum = 0;
    for (size_t i = 0; i < plan_.footprint.size(); ++i)
      sum += glm::distance(plan_.footprint[i], plan_.footprint[(i + 1) % plan_.footprint.size()]);
    return sum;
  }();
  const float inradius = 2 * area_of(plan_.footprint) / around;
  int count = 1;
  if (walls_top > 22 && inradius > 8) count = random.between(1, walls_top > 40 ? 4 : 3);
  std::vector<Segment> result;
  float inset = 0, z = 0;
  for (int k = 0; k < count; ++k) {
    const bool last = k + 1 == count;
    const float share = (walls_top - z) * (last ? 1.0F : random.range(0.35F, 0.65F));
    const float top = std::min(z + std::max(snapped(share, k == 0), style_.floor_m), walls_top);
    std::vector<glm::vec2> outline = k == 0 ? plan_.footprint : outset(plan_.footprint, -inset);
    result.push_back({std::move(outline), z, last ? std::max(top, z + 2.5F) : top});
    z = result.back().top;
    inset += random.range(0.9F, 2.2F);
    if (walls_top - z < style_.floor_m * 1.5F || inset > inradius * 0.45F) break;
  }
  return result;
}

void HouseBuilder::build() {
  Random random = random_.fork(1);
  const Character character =
      plan_.cylindrical && plan_.height_m > 12 ? Character::glass_tower : character_of(plan_, random.fork(2));
  style_ = style_of(plan_.cylindrical && random.chance(0.5) ? Character::office : character, random.fork(4));
  const double blended = options_.detail * 1.2 + random.unit();
  tier_ = std::clamp(static_cast<int>(std::floor(blended)), 0, kMaxTier);
  see_through_ = !options_.textured && !options_.interiors && !options_.plain && character == Character::glass_tower &&
                 random.chance(0.12);
  dividers_ = random.chance(character == Character::glass_tower ? 0.35 : 0.5);
  const RoofKind roof =
      choose_roof(plan_.footprint, plan_.cylindrical, plan_.height_m, character == Character::house, random.fork(5));
  const float roof_m = roof_height_m(roof, plan_.footprint, plan_.height_m);
  const float walls_top =
      std::max(snapped(plan_.height_m - roof_m - style_.floor_m * 0.4F, true), style_.ground_floor_m);
  const size_t n = plan_.footprint.size();
  edge_u_.assign(n + 1, 0);
  for (size_t i = 0; i < n; ++i)
    edge_u_[i + 1] = edge_u_[i] + glm::distance(plan_.footprint[i], plan_.footprint[(i + 1) % n]);
  if (options_.textured) {
    shape_.enable_texcoords();
    sketch_ = {
        edge_u_[n],     walls_top,
        style_.floor_m, style_.ground_floor_m,
        style_.wall,    style_.wall_other,
        style_.glass,   character == Character::masonry || (character == Character::house && style_.wall.g < 130),
        plan_.seed,     {}};
  }
  const std::vector<Segment> all = segments(walls_top);
  if (options_.solid) return build_solid(all);
  for (size_t k = 0; k < all.size(); ++k) build_segment(all[k], k == 0, k + 1 == all.size());
  build_roof(shape_,
             {roof, all.back().outline, all.back().top, plan_.height_m, tier_, style_.trim, style_.wall, style_.accent},
             random.fork(6));
}

/// One closed surface: every edge is shared by two triangles.
void HouseBuilder::build_solid(const std::vector<Segment>& all) {
  paint(style_.wall);
  const auto cap = [&](std::span<const glm::vec2> outline, float z, bool up) {
    const std::vector<uint32_t> corners = triangulated(outline);
    for (size_t t = 0; t + 2 < corners.size(); t += 3) {
      const glm::vec3 a(outline[corners[t]], z), b(outline[corners[t + 1]], z), c(outline[corners[t + 2]], z);
      shape_.face(a, up ? b : c, up ? c : b);
    }
  };
  const auto band = [&](std::span<const glm::vec2> low, float z0, std::span<const glm::vec2> high, float z1) {
    for (size_t i = 0; i < low.size(); ++i) {
      const size_t next = (i + 1) % low.size();
      shape_.face({low[i], z0}, {low[next], z0}, {high[next], z1}, {high[i], z1});
    }
  };
  cap(all.front().outline, -kBelowGroundM, false);
  for (size_t k = 0; k < all.size(); ++k) {
    band(all[k].outline, k == 0 ? -kBelowGroundM : all[k].bottom, all[k].outline, all[k].top);
    if (k + 1 < all.size()) band(all[k].outline, all[k].top, all[k + 1].outline, all[k].top);
  }
  cap(all.back().outline, all.back().top, true);
}

void HouseBuilder::build_segment(const Segment& segment, bool ground, bool last) {
  if (options_.plain)
    build_bands(segment, ground);
  else
    build_walls(segment, ground);
  if (see_through_) build_inside(segment);
  build_ledges(segment, ground, last);
  if (last) return;
  paint(rgb(122, 118, 112));
  shape_.cap(segment.outline, segment.top);
}

/// A building of [xiong1996]'s: bands of a floor, or of some where there is to be little detail, in one colour or in
/// two by turns.
void HouseBuilder::build_bands(const Segment& segment, bool ground) {
  Random random = random_.fork(10);
  const bool alternating = random.chance(0.5);
  constexpr double kMostFloors = 4;
  const float band_m =
      style_.floor_m * static_cast<float>(std::max(
                           1.0, std::floor(1 + (1 - options_.detail) * (kMostFloors - 1) + random.unit() - 0.5)));
  float bottom = ground ? -kBelowGroundM : segment.bottom;
  float top = segment.bottom + (ground ? style_.ground_floor_m : band_m);
  for (int band = 0; bottom < segment.top; ++band) {
    if (segment.top - top < band_m / 2) top = segment.top;
    paint(alternating && band % 2 == 1 ? style_.trim : style_.wall);
    const std::array<glm::vec2, 2> profile = {glm::vec2(0, bottom), {0, top}};
    shape_.ring(segment.outline, profile);
    bottom = top, top += band_m;
  }
}

void HouseBuilder::build_walls(const Segment& segment, bool ground) {
  const size_t n = segment.outline.size();
  const float around = edge_u_[n];
  const float inradius = 2 * area_of(segment.outline) / around;
  // Rooms at a corner must not run into each other: those of every second wall stop short of it.
  const float deep = options_.interiors && !plan_.cylindrical && n == 4 ? std::min(4.8F, inradius * 0.8F) : 0;
  size_t door = n;
  for (size_t i = 0; i < n; ++i)
    if (plan_.street[i] && (door == n || edge_u_[i + 1] - edge_u_[i] > edge_u_[door + 1] - edge_u_[door])) door = i;
  for (size_t i = 0; i < n; ++i) {
    Wall wall;
    wall.a = segment.outline[i], wall.b = segment.outline[(i + 1) % n];
    wall.bottom_m = segment.bottom, wall.top_m = segment.top;
    wall.ground = ground, wall.street = plan_.street[i] || segment.bottom > 12, wall.door = i == door;
    wall.see_through = see_through_;
    wall.room_depth_m = deep > 2 ? deep : 0;
    wall.trim_a_m = wall.trim_b_m = i % 2 == 1 ? deep + 0.3F : deep * 0.25F;
    if (options_.textured) {
      wall.u0 = edge_u_[i] / around, wall.u1 = edge_u_[i + 1] / around;
      wall.v_per_m = 1 / sketch_.height_m, wall.panes = &sketch_.panes;
    }
    build_wall(shape_, wall, style_, wall.street ? tier_ : std::min(tier_, std::max(1, tier_ - 1)),
               random_.fork(100 + i + (ground ? 0 : static_cast<uint64_t>(segment.bottom * 64))));
  }
}

void HouseBuilder::build_ledges(const Segment& segment, bool ground, bool last) {
  paint(style_.trim);
  const float top = segment.top;
  if (tier_ > 0 && ground && plan_.height_m > 9 && !options_.plain) {
    const float z = std::min(style_.ground_floor_m, top - 0.5F);
    const std::array<glm::vec2, 4> ledge = {
        glm::vec2(0, z - 0.15F), {0.14F, z - 0.05F}, {0.14F, z + 0.08F}, {0, z + 0.1F}};
    shape_.ring(segment.outline, ledge);
  }
  if (dividers_ && (tier_ > 0 || !options_.plain) &&
      tier_ < 2 + static_cast<int>(random_.fork(9).next() % 2 == 0 ? 9 : 0)) {
    for (float z = segment.bottom + (ground ? style_.ground_floor_m : style_.floor_m) + (ground ? style_.floor_m : 0);
         z < top - 1; z += style_.floor_m) {
      const std::array<glm::vec2, 4> divider = {
          glm::vec2(0, z - 0.07F), {0.08F, z - 0.07F}, {0.08F, z + 0.07F}, {0, z + 0.07F}};
      shape_.ring(segment.outline, divider);
    }
  }
  if (!last && tier_ > 0 && !options_.plain) {
    const std::array<glm::vec2, 5> parapet = {
        glm::vec2(0, top - 0.3F), {0.12F, top - 0.1F}, {0.12F, top + 0.45F}, {-0.15F, top + 0.45F}, {-0.15F, top}};
    shape_.ring(segment.outline, parapet);
  }
}

/// Floors and a core, seen through the glass.
void HouseBuilder::build_inside(const Segment& segment) {
  const std::vector<glm::vec2> slab = outset(segment.outline, -0.35F), core = outset(segment.outline, -5);
  for (float z = segment.bottom + style_.floor_m; z < segment.top; z += style_.floor_m) {
    paint(rgb(206, 202, 192));
    const std::array<glm::vec2, 2> edge = {glm::vec2(0, z - 0.3F), {0, z}};
    shape_.ring(slab, edge);
    shape_.cap(slab, z);
  }
  if (area_of(core) < 20) return;
  paint(rgb(150, 146, 140));
  const std::array<glm::vec2, 2> shaft = {glm::vec2(0, segment.bottom), {0, segment.top}};
  shape_.ring(core, shaft);
}

}  // namespace

void build_house(Shape& shape, const HousePlan& plan, const HouseOptions& options, FacadeSketch& sketch) {
  HouseBuilder(shape, plan, options, sketch).build();
}

}  // namespace promenade
