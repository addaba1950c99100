#include <cmath>
#include <glm/ext/matrix_transform.hpp>
#include <glm/geometric.hpp>
#include <numbers>

#include "datasets/city_prop.h"
#include "datasets/city_smooth.h"
#include "geometry/random.h"

namespace promenade {
namespace {

/// Lumps of leaves on a sphere.
float lumpy(const glm::vec3& p, float seed) {
  return 1 + 0.12F * std::sin(5.1F * p.x + seed) * std::sin(4.3F * p.y + 2 * seed) +
         0.08F * std::sin(9.7F * p.z + 6.1F * p.x + seed) + 0.05F * std::sin(14 * p.y - 11 * p.z + 3 * seed);
}

Color leaf_color(uint32_t variant, Random& random) {
  const std::array<Color, 4> greens = {rgb(92, 132, 56), rgb(74, 116, 52), rgb(112, 142, 64), rgb(84, 122, 70)};
  return shade(greens[variant % 4], random.range(0.9F, 1.12F));
}

void clump(SmoothShape& shape, const glm::vec3& center, const glm::vec3& radii, int level, float seed) {
  const int rings = 4 << (level > 0 ? level - 1 : 0), sides = level == 0 ? 6 : 7 << (level - 1);
  shape.blob(center, radii, level == 0 ? 4 : rings + 1, sides, [seed](const glm::vec3& p) { return lumpy(p, seed); });
}

void trunk(SmoothShape& shape, float height, float radius, int level) {
  shape.color(rgb(98, 76, 58));
  const std::vector<glm::vec2> profile = {
      {radius * 1.5F, -0.05F}, {radius * 1.1F, 0.25F}, {radius, height * 0.5F}, {radius * 0.6F, height}};
  shape.lathe({0, 0, 0}, profile, level == 0 ? 5 : 4 + 4 * level);
}

void branch(SmoothShape& shape, const glm::vec3& from, const glm::vec3& to, float radius, int level) {
  const glm::vec3 way = glm::normalize(to - from);
  const glm::vec3 side = glm::normalize(glm::cross(way, glm::vec3(0.31F, 0.95F, 0.02F))), other = glm::cross(way, side);
  const glm::mat4 place(glm::vec4(side, 0), glm::vec4(other, 0), glm::vec4(way, 0), glm::vec4(from, 1));
  shape.place(place);
  const std::vector<glm::vec2> profile = {{radius, 0}, {radius * 0.45F, glm::distance(from, to)}};
  shape.lathe({0, 0, 0}, profile, 3 + 2 * level);
  shape.place(glm::mat4(1));
}

void broadleaf(SmoothShape& shape, uint32_t variant, int level, Random& random) {
  const float height = random.range(6.6F, 9.0F), spread = height * random.range(0.26F, 0.33F);
  const float crown = 3.0F;
  trunk(shape, height * 0.62F, 0.15F, level);
  const int clumps = level == 0 ? 1 : 4 + level * 2;
  const Color green = leaf_color(variant, random);
  for (int k = 0; k < clumps; ++k) {
    const float angle = 2.4F * static_cast<float>(k), t = static_cast<float>(k) / static_cast<float>(clumps);
    const float out = k == 0 ? 0 : spread * 0.62F * std::sqrt(1 - t * 0.75F);
    const float size = level == 0 ? spread * 1.15F : spread * random.range(0.55F, 0.75F);
    const glm::vec3 center(
        out * std::cos(angle), out * std::sin(angle),
        k == 0 ? crown + (height - crown) * 0.5F : crown + size * 0.75F + (height - crown - size * 1.5F) * t);
    if (k > 0) shape.color(rgb(98, 76, 58)), branch(shape, {0, 0, height * 0.33F}, center, 0.07F, level);
    shape.color(shade(green, random.range(0.86F, 1.14F)));
    const float z = level == 0 || k == 0 ? (height - crown) * 0.5F : size * 0.8F;
    clump(shape, center, {size, size, z}, level, random.range(0.0F, 6.0F));
  }
}

void conifer(SmoothShape& shape, int level, Random& random) {
  const float height = random.range(6.0F, 8.5F);
  trunk(shape, height * 0.5F, 0.13F, level);
  const int tiers = 4 + level;
  for (int k = 0; k < tiers; ++k) {
    const float t = static_cast<float>(k) / static_cast<float>(tiers);
    shape.color(shade(rgb(58, 92, 62), 0.85F + 0.3F * t));
    const float z = 2.8F + (height - 2.8F) * t, r = 1.7F * (1 - t) + 0.35F,
                h = (height - 2.8F) / static_cast<float>(tiers) * 1.7F;
    const std::vector<glm::vec2> profile = {
        {0, z + 0.25F}, {r * 0.8F, z + 0.05F}, {r, z}, {r * 0.62F, z + h * 0.35F}, {0, std::min(z + h, height)}};
    shape.lathe({0, 0, 0}, profile, 7 + 5 * level);
  }
}

void poplar(SmoothShape& shape, uint32_t variant, int level, Random& random) {
  const float height = random.range(8.0F, 10.5F);
  trunk(shape, height * 0.6F, 0.14F, level);
  const Color green = leaf_color(variant, random);
  for (int k = 0; k < 2 + level; ++k) {
    shape.color(shade(green, random.range(0.9F, 1.1F)));
    const float angle = 2.4F * static_cast<float>(k);
    const glm::vec3 center(0.3F * std::cos(angle), 0.3F * std::sin(angle),
                           2.4F + (height - 2.4F) * (0.56F + 0.06F * static_cast<float>(k % 2)));
    clump(shape, center, {0.95F, 0.95F, (height - 2.4F) * 0.43F}, level, random.range(0.0F, 6.0F));
  }
}

}  // namespace

Mesh make_tree(uint32_t variant, int level) {
  SmoothShape shape;
  Random random(0x7ee, {variant});
  if (variant < 5)
    broadleaf(shape, variant, level, random);
  else if (variant < 7)
    poplar(shape, variant, level, random);
  else
    conifer(shape, level, random);
  return shape.take();
}

Mesh make_bush(uint32_t variant, int level) {
  SmoothShape shape;
  Random random(0xb054, {variant});
  for (int k = 0; k < 3; ++k) {
    shape.color(shade(leaf_color(variant, random), 0.9F));
    const float angle = 2.1F * static_cast<float>(k);
    clump(shape, {0.3F * std::cos(angle), 0.3F * std::sin(angle), 0.4F}, {0.5F, 0.5F, 0.5F}, level,
          static_cast<float>(k));
  }
  return shape.take();
}

}  // namespace promenade
