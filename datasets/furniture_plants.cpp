// Plants in pots and trees outside.
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/constants.hpp>

#include "datasets/furniture.h"
#include "datasets/furniture_palette.h"
#include "datasets/furniture_variants.h"

namespace promenade {

namespace {

using glm::dvec3;
using namespace palette;

struct Plant {
  glm::u8vec4 leaf = kLeaf;
  glm::u8vec4 pot = kTerracotta;
  double pot_radius_m = 0.16, pot_height_m = 0.3;
  double stem_m = 0;  ///< a trunk of that height carries the crown; 0: leaves rise from the soil
  uint32_t leaves = 40;
  double leaf_length_m = 0.5, leaf_width_m = 0.06;
  double rise_deg = 65, spread_deg = 25;  ///< how steeply leaves start, and by how much that varies
  double droop = 1.2;                     ///< radians that a leaf bends down over its length
  double crown_m = 0;                     ///< radius of a ball on whose inside the leaves start
  uint64_t seed = 1;
};

void add_pot(Sculptor& s, const Plant& p) {
  const double r = p.pot_radius_m, h = p.pot_height_m;
  const glm::dvec2 profile[] = {{0, 0}, {r * 0.7, 0},  {r * 0.92, h * 0.85}, {r, h * 0.86},
                                {r, h}, {r * 0.88, h}, {r * 0.86, h * 0.9},  {0, h * 0.9}};
  s.paint(p.pot).lathe(profile, false, s.steps(20, 6));
  s.paint(kSoil).cylinder({0, 0, h * 0.9}, {0, 0, h * 0.93}, r * 0.855, s.steps(20, 6));
}

void add_leaf(Sculptor& s, const Plant& p, const dvec3& root, double heading, double rise, double length) {
  const uint32_t joints = s.steps(4, 2);
  std::vector<dvec3> points{root}, side;
  const dvec3 out(std::cos(heading), std::sin(heading), 0), across(out.y, -out.x, 0);
  for (uint32_t i = 0; i <= joints; ++i) {
    const double u = double(i) / joints;
    side.push_back(across * (p.leaf_width_m / 2 * std::pow(std::sin(glm::pi<double>() * std::pow(u, 0.8)), 0.8)));
    const double angle = rise - p.droop * u;
    if (i < joints)
      points.push_back(points.back() + (length / joints) * (out * std::cos(angle) + dvec3(0, 0, std::sin(angle))));
  }
  s.leaf(points, side, p.leaf_width_m * 0.06);
}

Mesh plant(const Plant& p, double quality) {
  Sculptor s(quality);
  add_pot(s, p);
  Random random(p.seed * 7919);
  const double soil = p.pot_height_m * 0.92;
  if (p.stem_m > 0) {
    const dvec3 trunk[] = {{0, 0, soil - 0.02},
                           {0.02, 0.01, soil + p.stem_m * 0.4},
                           {-0.015, 0.02, soil + p.stem_m * 0.75},
                           {0, 0, soil + p.stem_m}};
    s.paint(kBark).tube(trunk, 0.018, s.steps(8, 4));
  }
  // Fewer, wider leaves at low quality would change the plant's look; fewer leaves only thin it.
  const auto leaves = static_cast<uint32_t>(std::max(6.0, p.leaves * std::min(1.0, 0.35 + 0.65 * quality)));
  for (uint32_t i = 0; i < leaves; ++i) {
    const double heading = 2.39996 * i + random.range(-0.3, 0.3);  // the golden angle: no two leaves above each other
    const double rise = glm::radians(p.rise_deg + random.range(-p.spread_deg, p.spread_deg));
    const double length = p.leaf_length_m * random.range(0.7, 1.1);
    dvec3 root(p.pot_radius_m * 0.3 * std::cos(heading), p.pot_radius_m * 0.3 * std::sin(heading), soil);
    if (p.stem_m > 0) root = dvec3(0, 0, soil + p.stem_m);
    if (p.crown_m > 0) {
      const double z = random.range(-0.9, 1.0), r = std::sqrt(1 - z * z) * p.crown_m * random.range(0.3, 1.0);
      root += dvec3(r * std::cos(heading), r * std::sin(heading), z * p.crown_m);
      if (i % 4 == 0 && p.stem_m > 0)
        s.paint(kBark).cone({0, 0, soil + p.stem_m * 0.8}, root, 0.008, 0.003, s.steps(5, 3));
    }
    s.paint(shaded(p.leaf, random.range(-0.2, 0.22)));
    add_leaf(s, p, root, heading, rise, length);
  }
  return s.take();
}

struct Tree {
  double height_m = 7, crown_m = 2.2;
  glm::u8vec4 leaf = kLeaf;
  uint32_t blobs = 14;
  uint64_t seed = 1;
};

Mesh tree(const Tree& p, double quality) {
  Sculptor s(quality);
  Random random(p.seed * 104729);
  const double fork = p.height_m - 1.5 * p.crown_m;
  s.paint(kBark).cone({0, 0, -0.2}, {0, 0, fork + p.crown_m}, 0.2, 0.07, s.steps(10, 5));
  for (uint32_t i = 0; i < p.blobs; ++i) {
    const double heading = 2.39996 * i, z = 2 * (i + 0.5) / p.blobs - 1, r = 0.72 * p.crown_m * std::sqrt(1 - z * z);
    const dvec3 center(r * std::cos(heading), r * std::sin(heading), fork + p.crown_m * (0.75 + 0.8 * z));
    s.paint(kBark).cone({0, 0, fork + 0.35 * p.crown_m}, center, 0.06, 0.02, s.steps(5, 3));
    s.paint(shaded(p.leaf, random.range(-0.22, 0.18)));
    const double size = p.crown_m * random.range(0.42, 0.58);
    s.stand(moved(center) * turned_z(random.range(0.0, 360.0)) * turned_x(random.range(-30.0, 30.0)));
    s.ellipsoid({0, 0, 0}, {size, size * 0.85, size * 0.75}, s.steps(11, 5), s.steps(8, 4));
    s.stand();
  }
  return s.take();
}

}  // namespace

void add_plants(FurnitureCatalogue& catalogue) {
  catalogue.add("plant", "plant",
                each<Plant>(plant, {{.leaves = 44, .seed = 1},
                                    {.leaf = kDarkLeaf,
                                     .pot = kWhite,
                                     .leaves = 26,
                                     .leaf_length_m = 0.8,
                                     .leaf_width_m = 0.07,
                                     .rise_deg = 84,
                                     .spread_deg = 8,
                                     .droop = 0.15,
                                     .seed = 2},
                                    {.leaf = kLime,
                                     .pot = kSlate,
                                     .stem_m = 0.75,
                                     .leaves = 110,
                                     .leaf_length_m = 0.13,
                                     .leaf_width_m = 0.06,
                                     .rise_deg = 10,
                                     .spread_deg = 45,
                                     .droop = 0.6,
                                     .crown_m = 0.3,
                                     .seed = 3},
                                    {.leaf = kLeaf,
                                     .pot = kWhite,
                                     .stem_m = 0.9,
                                     .leaves = 34,
                                     .leaf_length_m = 0.6,
                                     .leaf_width_m = 0.05,
                                     .rise_deg = 50,
                                     .spread_deg = 35,
                                     .droop = 2.0,
                                     .seed = 4},
                                    {.leaf = kDarkLeaf,
                                     .pot = kTerracotta,
                                     .leaves = 22,
                                     .leaf_length_m = 0.75,
                                     .leaf_width_m = 0.24,
                                     .rise_deg = 72,
                                     .spread_deg = 14,
                                     .droop = 1.4,
                                     .seed = 5},
                                    {.leaf = rgb(0x6f9a58),
                                     .pot = kBlack,
                                     .stem_m = 0.6,
                                     .leaves = 90,
                                     .leaf_length_m = 0.2,
                                     .leaf_width_m = 0.05,
                                     .rise_deg = 25,
                                     .spread_deg = 40,
                                     .droop = 0.9,
                                     .crown_m = 0.24,
                                     .seed = 6}}));
  catalogue.add("desk_plant", "plant",
                each<Plant>(plant, {{.leaf = kLime,
                                     .pot = kWhite,
                                     .pot_radius_m = 0.06,
                                     .pot_height_m = 0.1,
                                     .leaves = 18,
                                     .leaf_length_m = 0.16,
                                     .leaf_width_m = 0.03,
                                     .seed = 7},
                                    {.leaf = kDarkLeaf,
                                     .pot = kMustard,
                                     .pot_radius_m = 0.055,
                                     .pot_height_m = 0.09,
                                     .leaves = 14,
                                     .leaf_length_m = 0.1,
                                     .leaf_width_m = 0.045,
                                     .rise_deg = 40,
                                     .droop = 0.5,
                                     .seed = 8}}));
  catalogue.add("tree", "tree",
                each<Tree>(tree, {{.seed = 1},
                                  {.height_m = 9, .crown_m = 2.7, .leaf = kDarkLeaf, .blobs = 18, .seed = 2},
                                  {.height_m = 6, .crown_m = 1.9, .leaf = kLime, .seed = 3}}));
  catalogue.add("shrub", "plant",
                each<Tree>(tree, {{.height_m = 1.0, .crown_m = 0.62, .leaf = kDarkLeaf, .blobs = 7, .seed = 4},
                                  {.height_m = 0.9, .crown_m = 0.55, .leaf = kLeaf, .blobs = 6, .seed = 5}}));
}

}  // namespace promenade
