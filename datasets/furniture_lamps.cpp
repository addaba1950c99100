// Lamps on desks, floors and ceilings.
#include <cmath>
#include <glm/gtc/constants.hpp>

#include "datasets/furniture.h"
#include "datasets/furniture_palette.h"
#include "datasets/furniture_variants.h"

namespace promenade {

namespace {

using glm::dvec3;
using namespace palette;

/// A shade as a thin shell: a bell from its rim up to its neck, open below.
void add_shade(Sculptor& s, double rim_m, double neck_m, double height_m, double bell, uint32_t rings, uint32_t sides) {
  std::vector<glm::dvec2> profile;
  const double thick = 0.003;
  const auto radius = [&](double u) {
    return neck_m + (rim_m - neck_m) * (bell * std::cos(glm::half_pi<double>() * u) + (1 - bell) * (1 - u));
  };
  for (uint32_t i = 0; i <= rings; ++i) profile.emplace_back(radius(double(i) / rings), height_m * i / rings);
  for (uint32_t i = rings + 1; i-- > 0;) profile.emplace_back(radius(double(i) / rings) - thick, height_m * i / rings);
  s.lathe(profile, true, sides);
}

struct DeskLamp {
  glm::u8vec4 shade = kSage;
  glm::u8vec4 arm = kDarkSteel;
  double lower_m = 0.3, upper_m = 0.28;
  double lean_deg = 18, bend_deg = 70;
  double rim_m = 0.085, bell = 0.8;
};

Mesh desk_lamp(const DeskLamp& p, double quality) {
  Sculptor s(quality);
  const glm::dvec2 base[] = {{0, 0},        {0.09, 0},     {0.09, 0.008}, {0.082, 0.018},
                             {0.03, 0.024}, {0.018, 0.04}, {0, 0.042}};
  s.paint(p.arm).lathe(base, false, s.steps(18, 6));
  const double a = glm::radians(p.lean_deg), b = glm::radians(p.bend_deg);
  const dvec3 foot(0, 0, 0.03), elbow = foot + p.lower_m * dvec3(0, std::sin(a), std::cos(a));
  const dvec3 head = elbow + p.upper_m * dvec3(0, -std::sin(b), std::cos(b));
  for (const double x : {-0.008, 0.008}) {
    s.cylinder(foot + dvec3(x, 0, 0), elbow + dvec3(x, 0, 0), 0.004, s.steps(7, 3));
    s.cylinder(elbow + dvec3(x, 0, 0), head + dvec3(x, 0, 0), 0.004, s.steps(7, 3));
  }
  s.cylinder(elbow - dvec3(0.018, 0, 0), elbow + dvec3(0.018, 0, 0), 0.012, s.steps(10, 4));
  s.ellipsoid(head, dvec3(0.016), s.steps(10, 5), s.steps(6, 3));
  s.stand(moved(head - dvec3(0, 0.02, 0.1)) * turned_x(-12));
  s.paint(p.shade);
  add_shade(s, p.rim_m, 0.024, 0.11, p.bell, s.steps(8, 3), s.steps(24, 13));
  s.paint(p.arm).cylinder({0, 0, 0.1}, {0, 0, 0.13}, 0.023, s.steps(12, 5));
  s.paint(kLight).ellipsoid({0, 0, 0.05}, {0.028, 0.028, 0.036}, s.steps(12, 5), s.steps(7, 3));
  return s.take();
}

struct FloorLamp {
  glm::u8vec4 shade = kPaper;
  glm::u8vec4 stem = kBlack;
  double height_m = 1.6, rim_m = 0.22, neck_m = 0.14;
};

Mesh floor_lamp(const FloorLamp& p, double quality) {
  Sculptor s(quality);
  const glm::dvec2 base[] = {{0, 0}, {0.15, 0}, {0.15, 0.015}, {0.02, 0.035}, {0, 0.036}};
  s.paint(p.stem).lathe(base, false, s.steps(24, 6));
  s.cylinder({0, 0, 0.03}, {0, 0, p.height_m - 0.1}, 0.011, s.steps(10, 4));
  for (int i = 0; i < 3; ++i) {
    s.stand(turned_z(120 * i));
    s.cylinder({0, 0, p.height_m - 0.12}, {p.neck_m + 0.02, 0, p.height_m - 0.12}, 0.004, s.steps(5, 3));
  }
  s.stand(moved({0, 0, p.height_m - 0.28})).paint(p.shade);
  add_shade(s, p.rim_m, p.neck_m, 0.3, 0.1, s.steps(4, 1), s.steps(28, 8));
  s.paint(kLight).ellipsoid({0, 0, 0.14}, {0.045, 0.045, 0.06}, s.steps(12, 5), s.steps(8, 3));
  return s.take();
}

struct CeilingPanel {
  double length_m = 1.2, width_m = 0.3;
  uint32_t louvres = 6;
};

/// Hangs below z = 0 by 6 cm.
Mesh ceiling_panel(const CeilingPanel& p, double quality) {
  Sculptor s(quality);
  const double l = p.length_m / 2, w = p.width_m / 2;
  s.paint(kWhite).box({-l, -w, -0.015}, {l, w, 0});
  if (quality < kFineDetail) {  // a closed diffuser
    s.box({-l, -w, -0.06}, {l, w, -0.0151});
    s.paint(kLight).box({-l + 0.02, -w + 0.02, -0.064}, {l - 0.02, w - 0.02, -0.0601});
    return s.take();
  }
  for (const double side : {-1.0, 1.0}) {
    s.box({-l, side > 0 ? w - 0.015 : -w, -0.06}, {l, side > 0 ? w : -w + 0.015, -0.0151});
    s.box({side > 0 ? l - 0.015 : -l, -w + 0.0151, -0.06}, {side > 0 ? l : -l + 0.015, w - 0.0151, -0.0151});
  }
  s.paint(kLight);
  const uint32_t tubes = p.width_m > 0.5 ? 3 : 2;
  for (uint32_t i = 0; i < tubes; ++i) {
    const double y = -w + p.width_m * (i + 0.5) / tubes;
    s.cylinder({-l + 0.03, y, -0.035}, {l - 0.03, y, -0.035}, 0.013, s.steps(8, 4));
  }
  s.paint(kAluminium);
  const uint32_t louvres = s.steps(p.louvres, 0);
  for (uint32_t i = 0; i < louvres; ++i) {
    const double x = -l + p.length_m * (i + 1) / (louvres + 1);
    s.box({x - 0.002, -w + 0.0152, -0.058}, {x + 0.002, w - 0.0152, -0.05});
  }
  return s.take();
}

struct Pendant {
  glm::u8vec4 shade = kRust;
  double drop_m = 0.9, rim_m = 0.24;
};

Mesh pendant(const Pendant& p, double quality) {
  Sculptor s(quality);
  s.paint(kBlack).cylinder({0, 0, -0.03}, {0, 0, 0}, 0.05, s.steps(14, 5));
  s.cylinder({0, 0, -p.drop_m + 0.2}, {0, 0, -0.03}, 0.004, s.steps(5, 3));
  s.stand(moved({0, 0, -p.drop_m})).paint(p.shade);
  add_shade(s, p.rim_m, 0.03, 0.22, 0.9, s.steps(8, 2), s.steps(28, 8));
  s.paint(kLight).ellipsoid({0, 0, 0.08}, dvec3(0.05), s.steps(12, 5), s.steps(8, 4));
  return s.take();
}

}  // namespace

void add_lamps(FurnitureCatalogue& catalogue) {
  catalogue.add(
      "desk_lamp", "lamp",
      each<DeskLamp>(desk_lamp, {{},
                                 {.shade = kBrass, .arm = kBrass, .bend_deg = 60, .rim_m = 0.1, .bell = 0.5},
                                 {.shade = kRust, .arm = kChrome, .lean_deg = 28, .bend_deg = 78},
                                 {.shade = kBlack, .arm = kBlack, .lower_m = 0.36, .rim_m = 0.075, .bell = 1}}));
  catalogue.add("floor_lamp", "lamp",
                each<FloorLamp>(floor_lamp, {{}, {.shade = kSand, .stem = kBrass, .neck_m = 0.2}}));
  catalogue.add("ceiling_panel", "light",
                each<CeilingPanel>(ceiling_panel, {{}, {.length_m = 0.6, .width_m = 0.6, .louvres = 4}}));
  catalogue.add("pendant", "light",
                each<Pendant>(pendant, {{}, {.shade = kTealCloth}, {.shade = kMustard, .rim_m = 0.3}}));
}

}  // namespace promenade
