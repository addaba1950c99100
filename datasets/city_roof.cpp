#include "datasets/city_roof.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

namespace promenade {
namespace {

float radius_of(std::span<const glm::vec2> outline) {
  const glm::vec2 center = centroid_of(outline);
  float nearest = std::numeric_limits<float>::max();
  for (size_t i = 0; i < outline.size(); ++i) {
    const WallFrame frame = WallFrame::between(outline[i], outline[(i + 1) % outline.size()]);
    nearest = std::min(nearest, glm::dot(frame.origin - center, frame.out));
  }
  return nearest;
}

Color tiles(Random& random) {
  const std::array<Color, 6> colors = {rgb(158, 84, 58), rgb(136, 70, 52), rgb(92, 88, 90),
                                       rgb(72, 76, 84),  rgb(112, 84, 66), rgb(96, 124, 112)};
  return shade(colors[random.below(6)], random.range(0.9F, 1.1F));
}

/// The underside and the edge of eaves; returns the outline at which the slopes begin.
std::vector<glm::vec2> eaves(Shape& shape, const Roof& roof, float out) {
  const float z = roof.walls_top_m;
  shape.color(roof.trim);
  const std::array<glm::vec2, 4> profile = {
      glm::vec2(0, z - 0.12F), {out, z - 0.22F}, {out, z}, {out - 0.05F, z + 0.04F}};
  shape.ring(roof.outline, profile);
  return outset(roof.outline, out - 0.05F);
}

void chimney(Shape& shape, const glm::vec2& at, float bottom, float top) {
  shape.color(rgb(140, 80, 62));
  shape.box({at.x - 0.4F, at.y - 0.3F, bottom}, {at.x + 0.4F, at.y + 0.3F, top}, Shape::bottom);
  shape.color(rgb(170, 160, 148));
  shape.box({at.x - 0.46F, at.y - 0.36F, top}, {at.x + 0.46F, at.y + 0.36F, top + 0.1F});
  shape.color(rgb(156, 88, 60));
  for (const float side : {-0.18F, 0.18F}) shape.cylinder({at.x + side, at.y, top + 0.1F}, 0.11F, 0.09F, 0.35F, 8);
}

void build_spire(Shape& shape, const Roof& roof, Random random) {
  const std::vector<glm::vec2> base = eaves(shape, roof, 0.35F);
  shape.color(tiles(random));
  shape.spire(base, roof.walls_top_m + 0.04F, {centroid_of(roof.outline), roof.highest_m - 0.8F});
  shape.color(rgb(200, 176, 104));
  shape.cylinder({centroid_of(roof.outline), roof.highest_m - 1.1F}, 0.09F, 0.01F, 1.1F, 8);
}

/// Two slopes and two gables or hips over a quadrilateral, along its longer sides.
void build_ridge(Shape& shape, const Roof& roof, bool hips, Random random) {
  const std::vector<glm::vec2> e = eaves(shape, roof, 0.45F);
  const size_t first = glm::distance(e[0], e[1]) >= glm::distance(e[1], e[2]) ? 0 : 1;
  const auto corner = [&](size_t i) { return e[(first + i) % 4]; };
  const glm::vec2 end_a = (corner(0) + corner(3)) * 0.5F, end_b = (corner(1) + corner(2)) * 0.5F;
  const float in =
      hips ? std::min(0.3F, 0.5F * glm::distance(corner(0), corner(3)) / glm::distance(end_a, end_b)) : 0.0F;
  const float z = roof.walls_top_m + 0.04F, top = roof.highest_m - 1.0F;
  const glm::vec3 a(end_a + (end_b - end_a) * in, top), b(end_b + (end_a - end_b) * in, top);
  const auto low = [&](size_t i) { return glm::vec3(corner(i), z); };
  const Color tile = tiles(random);
  shape.color(tile);
  shape.face(low(0), low(1), b, a), shape.face(low(2), low(3), a, b);
  if (!hips) shape.color(roof.wall);
  shape.face(low(1), low(2), b), shape.face(low(3), low(0), a);
  if (roof.tier > 0) {
    const glm::vec2 at = glm::mix(glm::vec2(a), glm::vec2(b), random.range(0.25F, 0.75F));
    chimney(shape, at, (z + top) / 2, top + 0.5F);
  }
  // Rows of tiles, seen as lines of shade: thin steps along the slopes.
  const int rows = roof.tier >= 4 ? 12 : roof.tier >= 2 ? 5 : 0;
  shape.color(shade(tile, 0.85F));
  for (const size_t side : {size_t(0), size_t(2)}) {
    const glm::vec3 l0 = low(side), l1 = low(side + 1), h1 = side == 0 ? b : a, h0 = side == 0 ? a : b;
    for (int k = 1; k <= rows; ++k) {
      const float t = static_cast<float>(k) / static_cast<float>(rows + 1);
      const glm::vec3 up(0, 0, 0.05F), p = glm::mix(l0, h0, t), q = glm::mix(l1, h1, t);
      const glm::vec3 p1 = glm::mix(l0, h0, t + 0.02F), q1 = glm::mix(l1, h1, t + 0.02F);
      shape.face(p, q, q + up, p + up), shape.face(p + up, q + up, q1, p1);
    }
  }
}

void cooler(Shape& shape, const glm::vec2& at, float z, int tier, Random& random) {
  const float w = random.range(0.8F, 1.6F), d = random.range(0.7F, 1.2F), h = random.range(0.9F, 1.5F);
  shape.color(rgb(184, 186, 186));
  shape.box({at.x - w, at.y - d, z + 0.15F}, {at.x + w, at.y + d, z + h});
  shape.color(rgb(70, 72, 74));
  const int sides = tier >= 3 ? 14 : 6;
  for (const float side : {-0.5F, 0.5F})
    shape.cylinder({at.x + side * w, at.y, z + h}, 0.32F * w, 0.3F * w, 0.16F, sides);
}

void water_tank(Shape& shape, const glm::vec2& at, float z, int tier) {
  const int sides = tier >= 3 ? 20 : 10;
  shape.color(rgb(70, 66, 62));
  for (const glm::vec2 leg : {glm::vec2(-1, -1), glm::vec2(1, -1), glm::vec2(1, 1), glm::vec2(-1, 1)})
    shape.box({at.x + leg.x - 0.08F, at.y + leg.y - 0.08F, z}, {at.x + leg.x + 0.08F, at.y + leg.y + 0.08F, z + 1.6F},
              Shape::bottom);
  shape.color(rgb(124, 90, 62));
  shape.box({at.x - 1.3F, at.y - 1.3F, z + 1.5F}, {at.x + 1.3F, at.y + 1.3F, z + 1.62F});
  shape.cylinder({at, z + 1.62F}, 1.35F, 1.3F, 2.2F, sides);
  shape.color(rgb(96, 84, 76));
  shape.cylinder({at, z + 3.82F}, 1.5F, 0.05F, 0.8F, sides);
}

void build_flat(Shape& shape, const Roof& roof, Random random) {
  const float z = roof.walls_top_m;
  const float parapet = std::clamp(roof.highest_m - z, 0.4F, 0.9F);
  shape.color(roof.trim);
  const std::array<glm::vec2, 7> cornice = {
      glm::vec2(0, z - 0.45F), {0.1F, z - 0.38F},  {0.14F, z - 0.15F},  {0.34F, z},
      {0.34F, z + 0.12F},      {0.08F, z + 0.16F}, {0.06F, z + parapet}};
  const std::array<glm::vec2, 3> plain = {glm::vec2(0, z - 0.02F), {0.06F, z}, {0.06F, z + parapet}};
  shape.ring(roof.outline, roof.tier > 0 ? std::span<const glm::vec2>(cornice) : std::span<const glm::vec2>(plain));
  const std::array<glm::vec2, 3> inner = {glm::vec2(0.06F, z + parapet), {-0.22F, z + parapet}, {-0.22F, z + 0.05F}};
  shape.ring(roof.outline, inner);
  const std::array<Color, 4> covers = {rgb(128, 124, 118), rgb(104, 102, 100), rgb(150, 146, 138), rgb(120, 108, 98)};
  shape.color(covers[random.below(4)]);
  shape.cap(outset(roof.outline, -0.22F), z + 0.05F);
  const float radius = radius_of(roof.outline), room = roof.highest_m - z;
  if (roof.tier == 0 || radius < 3.5F) return;
  const glm::vec2 center = centroid_of(roof.outline);
  const auto spot = [&] {
    return center + glm::vec2(random.range(-0.55F, 0.55F), random.range(-0.55F, 0.55F)) * radius;
  };
  if (room > 2.8F) {
    shape.color(shade(roof.wall, 0.95F));
    const glm::vec2 at = center + glm::vec2(random.range(-0.2F, 0.2F), random.range(-0.2F, 0.2F)) * radius;
    const float size = std::min(radius * 0.3F, 2.5F);
    shape.box({at - glm::vec2(size, size * 0.8F), z}, {at + glm::vec2(size, size * 0.8F), z + 2.6F}, Shape::bottom);
  }
  for (int k = random.between(1, 2 + roof.tier); k > 0; --k) cooler(shape, spot(), z, roof.tier, random);
  if (room > 4.8F && random.chance(0.35)) water_tank(shape, spot(), z, roof.tier);
  if (room > 4) {
    shape.color(rgb(160, 160, 164));
    shape.cylinder({spot(), z}, 0.07F, 0.02F, room - 0.2F, 6);
  }
}

}  // namespace

RoofKind choose_roof(std::span<const glm::vec2> footprint, bool cylindrical, float height_m, bool house,
                     Random random) {
  const double dice = random.unit();
  const size_t corners = footprint.size();
  if (cylindrical) return dice < 0.5 ? RoofKind::spire : RoofKind::flat;
  // Slopes over wide buildings would be hills.
  if (corners != 4 || radius_of(footprint) > 11) return RoofKind::flat;
  if (house) return dice < 0.5 ? RoofKind::ridge : RoofKind::hip;
  if (height_m < 20) return dice < 0.35 ? RoofKind::hip : dice < 0.45 ? RoofKind::ridge : RoofKind::flat;
  return dice < 0.14 ? RoofKind::spire : RoofKind::flat;
}

float roof_height_m(RoofKind kind, std::span<const glm::vec2> footprint, float height_m) {
  const float radius = radius_of(footprint);
  switch (kind) {
    case RoofKind::flat:
      return height_m > 14 ? 5.0F : 1.0F;
    case RoofKind::spire:
      return std::min(radius * 1.1F + 1.5F, height_m * 0.35F);
    case RoofKind::hip:
    case RoofKind::ridge:
      return std::min(radius * 0.65F + 1.6F, height_m * 0.5F);
  }
  return 0;
}

void build_roof(Shape& shape, const Roof& roof, Random random) {
  shape.material(kOpaque);
  switch (roof.kind) {
    case RoofKind::flat:
      return build_flat(shape, roof, random);
    case RoofKind::spire:
      return build_spire(shape, roof, random);
    case RoofKind::hip:
      return build_ridge(shape, roof, true, random);
    case RoofKind::ridge:
      return build_ridge(shape, roof, false, random);
  }
}

}  // namespace promenade
