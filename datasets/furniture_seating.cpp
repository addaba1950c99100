// Chairs, sofas, benches.
#include <cmath>
#include <glm/gtc/constants.hpp>

#include "datasets/furniture.h"
#include "datasets/furniture_palette.h"
#include "datasets/furniture_variants.h"

namespace promenade {

namespace {

using glm::dvec3;
using namespace palette;

struct OfficeChair {
  glm::u8vec4 fabric = kNavy;
  glm::u8vec4 frame = kBlack;
  double seat_height_m = 0.47, seat_width_m = 0.49, seat_depth_m = 0.47;
  double back_height_m = 0.52;
  uint32_t castors = 5;
  bool arms = true;
  bool headrest = false;
};

void add_castor(Sculptor& s, const dvec3& hub) {
  const uint32_t sides = s.steps(10, 4);
  if (s.quality() < kFineDetail)
    return s.cylinder(hub + dvec3(-0.02, 0, -0.03), hub + dvec3(0.02, 0, -0.03), 0.03, sides);
  s.cylinder(hub + dvec3(-0.022, 0, -0.03), hub + dvec3(-0.006, 0, -0.03), 0.03, sides);
  s.cylinder(hub + dvec3(0.006, 0, -0.03), hub + dvec3(0.022, 0, -0.03), 0.03, sides);
  s.cylinder(hub + dvec3(0, 0, -0.02), hub + dvec3(0, 0, 0.02), 0.006, s.steps(5, 3));
}

void add_arm(Sculptor& s, const OfficeChair& p, double side) {
  const double x = side * (p.seat_width_m / 2 + 0.035), z = p.seat_height_m;
  const dvec3 support[] = {{x - side * 0.08, 0.06, z - 0.05}, {x, 0.06, z - 0.04}, {x, 0.05, z + 0.17}};
  s.paint(p.frame).tube(support, 0.014, s.steps(7, 4));
  s.rounded_box({x - 0.035, -0.1, z + 0.165}, {x + 0.035, 0.16, z + 0.195}, 0.014, s.steps(1.4, 0));
}

Mesh office_chair(const OfficeChair& p, double quality) {
  Sculptor s(quality);
  s.paint(p.frame);
  for (uint32_t i = 0; i < p.castors; ++i) {
    const double angle = 360.0 * i / p.castors + 90;
    s.stand(turned_z(angle));
    s.cone({0.03, 0, 0.1}, {0.29, 0, 0.075}, 0.022, 0.012, s.steps(7, 3));
    add_castor(s.stand(turned_z(angle) * moved({0.28, 0, 0.06})), {0, 0, 0});
  }
  s.stand();
  const glm::dvec2 column[] = {{0, 0.08},     {0.045, 0.08}, {0.045, 0.12}, {0.028, 0.13},
                               {0.028, 0.28}, {0.017, 0.28}, {0.017, 0.41}, {0, 0.41}};
  s.paint(kGraphite).lathe(column, false, s.steps(12, 5));
  const double w = p.seat_width_m / 2, d = p.seat_depth_m / 2, z = p.seat_height_m;
  s.paint(p.frame).box({-0.1, -0.12, z - 0.09}, {0.1, 0.12, z - 0.05});
  s.paint(p.fabric).rounded_box({-w, -d, z - 0.055}, {w, d, z + 0.025}, 0.038, s.steps(3, 1));
  const dvec3 spine[] = {{0, 0.1, z - 0.07}, {0, d + 0.07, z - 0.06}, {0, d + 0.1, z + 0.05}, {0, d + 0.09, z + 0.35}};
  s.paint(p.frame).tube(spine, 0.016, s.steps(7, 4));
  s.stand(moved({0, d + 0.03, z + 0.12}) * turned_x(-9));
  s.paint(p.fabric).rounded_box({-w + 0.02, 0, 0}, {w - 0.02, 0.075, p.back_height_m}, 0.035, s.steps(3, 1));
  if (p.headrest)
    s.rounded_box({-0.13, 0.01, p.back_height_m + 0.04}, {0.13, 0.07, p.back_height_m + 0.19}, 0.03, s.steps(2, 1));
  s.stand();
  if (p.arms) add_arm(s, p, 1), add_arm(s, p, -1);
  return s.take();
}

struct VisitorChair {
  glm::u8vec4 fabric = kRust;
  glm::u8vec4 frame = kChrome;
  bool sled = true;  ///< two bent tubes; otherwise four wooden legs
  bool arms = false;
};

void add_sled(Sculptor& s, double x) {
  const dvec3 points[] = {{x, 0.21, 0.8},  {x, 0.19, 0.46},  {x, 0.17, 0.44},  {x, -0.19, 0.44},
                          {x, -0.22, 0.4}, {x, -0.22, 0.03}, {x, -0.2, 0.012}, {x, 0.22, 0.012}};
  s.tube(points, 0.012, s.steps(7, 4));
}

Mesh visitor_chair(const VisitorChair& p, double quality) {
  Sculptor s(quality);
  s.paint(p.frame);
  for (const double x : {-0.23, 0.23}) {
    if (p.sled) {
      add_sled(s, x);
    } else {
      s.cone({x * 1.02, -0.21, 0}, {x * 0.9, -0.19, 0.44}, 0.013, 0.02, s.steps(8, 4));
      s.cone({x * 1.02, 0.24, 0}, {x * 0.9, 0.19, 0.44}, 0.013, 0.02, s.steps(8, 4));
      s.cone({x * 0.9, 0.19, 0.44}, {x * 0.85, 0.25, 0.8}, 0.02, 0.014, s.steps(8, 4));
    }
    if (p.arms) s.rounded_box({x - 0.025, -0.2, 0.63}, {x + 0.025, 0.2, 0.655}, 0.01, s.steps(1, 0));
    if (p.arms) s.cylinder({x, -0.17, 0.44}, {x, -0.17, 0.64}, 0.011, s.steps(6, 4));
  }
  s.paint(p.fabric).rounded_box({-0.22, -0.22, 0.43}, {0.22, 0.2, 0.485}, 0.026, s.steps(2, 1));
  s.stand(moved({0, 0.2, 0.56}) * turned_x(-7));
  s.rounded_box({-0.215, -0.015, 0}, {0.215, 0.025, 0.28}, 0.019, s.steps(2, 1));
  return s.take();
}

Mesh stacking_chair(glm::u8vec4 shell, double quality) {
  Sculptor s(quality);
  s.paint(kChrome);
  for (const double x : {-0.2, 0.2}) {
    s.cylinder({x * 1.1, -0.2, 0}, {x * 0.8, -0.15, 0.43}, 0.011, s.steps(6, 3));
    s.cylinder({x * 1.1, 0.22, 0}, {x * 0.8, 0.16, 0.43}, 0.011, s.steps(6, 3));
  }
  s.paint(shell).rounded_box({-0.21, -0.21, 0.425}, {0.21, 0.19, 0.45}, 0.012, s.steps(1, 0));
  s.stand(moved({0, 0.19, 0.44}) * turned_x(-10))
      .rounded_box({-0.2, -0.015, 0}, {0.2, 0.01, 0.38}, 0.012, s.steps(1, 0));
  return s.take();
}

/// Bolted to the step, with a folding table.
Mesh auditorium_seat(glm::u8vec4 fabric, double quality) {
  Sculptor s(quality);
  s.paint(kGraphite);
  for (const double x : {-0.25, 0.25}) {
    if (quality >= kFineDetail) s.box({x - 0.015, -0.2, 0}, {x + 0.015, 0.18, 0.04});
    s.box({x - 0.015, -0.05, 0.0001}, {x + 0.015, 0.12, 0.62});
    s.paint(kOak).rounded_box({x - 0.025, -0.19, 0.62}, {x + 0.025, 0.17, 0.65}, 0.012, s.steps(1, 0));
    s.paint(kGraphite);
  }
  s.paint(fabric).rounded_box({-0.23, -0.22, 0.4}, {0.23, 0.18, 0.48}, 0.035, s.steps(1.6, 1));
  s.stand(moved({0, 0.16, 0.46}) * turned_x(-10));
  s.rounded_box({-0.23, 0, 0}, {0.23, 0.06, 0.46}, 0.028, s.steps(1.6, 1));
  s.paint(kOak).rounded_box({-0.23, 0.06, 0.02}, {0.23, 0.075, 0.44}, 0.007, 0);
  return s.take();
}

struct Sofa {
  glm::u8vec4 fabric = kTealCloth;
  glm::u8vec4 legs = kWalnut;
  uint32_t seats = 3;
  double seat_width_m = 0.64;
};

Mesh sofa(const Sofa& p, double quality) {
  Sculptor s(quality);
  const double half = p.seats * p.seat_width_m / 2;
  const uint32_t arc = s.steps(3, 1);
  s.paint(p.legs);
  for (const double x : {-half - 0.05, half + 0.05}) {
    for (const double y : {-0.34, 0.34}) s.cone({x, y, 0}, {x, y, 0.12}, 0.018, 0.028, s.steps(10, 4));
  }
  s.paint(shaded(p.fabric, -0.12)).rounded_box({-half - 0.14, -0.4, 0.11}, {half + 0.14, 0.42, 0.3}, 0.03, arc);
  for (const double side : {-1.0, 1.0}) {
    const double inner = side * half, outer = side * (half + 0.15);
    s.rounded_box({std::min(inner, outer), -0.42, 0.12}, {std::max(inner, outer), 0.42, 0.6}, 0.06, arc);
  }
  s.rounded_box({-half, 0.26, 0.25}, {half, 0.43, 0.72}, 0.06, arc);
  s.paint(p.fabric);
  for (uint32_t i = 0; i < p.seats; ++i) {
    const double x = -half + i * p.seat_width_m;
    s.stand().rounded_box({x + 0.005, -0.42, 0.29}, {x + p.seat_width_m - 0.005, 0.24, 0.44}, 0.055, arc);
    s.stand(moved({x, 0.13, 0.43}) * turned_x(-12));
    s.rounded_box({0.01, 0, 0}, {p.seat_width_m - 0.01, 0.16, 0.42}, 0.065, arc);
  }
  return s.take();
}

Mesh bench(glm::u8vec4 wood, glm::u8vec4 metal, double length_m, double quality) {
  Sculptor s(quality);
  const double half = length_m / 2;
  s.paint(wood);
  for (int i = 0; i < 5; ++i) {
    const double y = -0.2 + i * 0.085;
    s.rounded_box({-half, y, 0.42}, {half, y + 0.07, 0.45}, 0.008, s.steps(1, 0));
  }
  s.paint(metal);
  for (const double x : {-half + 0.2, half - 0.2}) {
    const dvec3 leg[] = {{x, -0.19, 0.01}, {x, -0.17, 0.4}, {x, 0.18, 0.4}, {x, 0.2, 0.01}};
    s.tube(leg, 0.02, s.steps(7, 4));
  }
  return s.take();
}

Mesh stool(glm::u8vec4 seat, double quality) {
  Sculptor s(quality);
  for (int i = 0; i < 4; ++i) {
    s.stand(turned_z(45 + 90 * i));
    s.paint(kBeech).cone({0.22, 0, 0}, {0.12, 0, 0.66}, 0.013, 0.018, s.steps(8, 4));
  }
  const glm::dvec2 top[] = {{0, 0.65}, {0.165, 0.65}, {0.18, 0.665}, {0.18, 0.69}, {0.165, 0.705}, {0, 0.71}};
  s.stand().paint(seat).lathe(top, false, s.steps(20, 8));
  s.paint(kChrome);
  std::vector<glm::dvec2> ring;
  for (int i = 0; i < 5; ++i) {
    const double angle = glm::two_pi<double>() * i / 5;
    ring.emplace_back(0.19 + 0.008 * std::cos(angle), 0.22 + 0.008 * std::sin(angle));
  }
  s.lathe(ring, true, s.steps(20, 8));
  return s.take();
}

}  // namespace

void add_seating(FurnitureCatalogue& catalogue) {
  catalogue.add("office_chair", "chair",
                each<OfficeChair>(office_chair, {{.fabric = kNavy},
                                                 {.fabric = kTealCloth, .headrest = true},
                                                 {.fabric = kRust},
                                                 {.fabric = kSage, .back_height_m = 0.6},
                                                 {.fabric = kWine, .headrest = true},
                                                 {.fabric = kSlate, .frame = kGraphite}}));
  catalogue.add("task_chair", "chair",
                each<OfficeChair>(office_chair, {{.fabric = kSlate, .back_height_m = 0.38, .arms = false},
                                                 {.fabric = kMustard, .back_height_m = 0.38, .arms = false},
                                                 {.fabric = kTealCloth, .back_height_m = 0.38, .arms = false}}));
  catalogue.add("visitor_chair", "chair",
                each<VisitorChair>(visitor_chair, {{.fabric = kRust},
                                                   {.fabric = kSlate, .arms = true},
                                                   {.fabric = kSage, .frame = kBeech, .sled = false},
                                                   {.fabric = kMustard, .frame = kWalnut, .sled = false},
                                                   {.fabric = kNavy, .arms = true}}));
  catalogue.add("conference_chair", "chair",
                each<OfficeChair>(office_chair, {{.fabric = kBlack, .frame = kChrome, .back_height_m = 0.58},
                                                 {.fabric = kWine, .frame = kGraphite, .back_height_m = 0.55},
                                                 {.fabric = kSand, .frame = kChrome, .back_height_m = 0.5}}));
  std::vector<std::function<Mesh(double)>> stacking, seats, stools;
  for (const glm::u8vec4 c : {kTealCloth, kRust, kMustard, kSlate})
    stacking.emplace_back([c](double quality) { return stacking_chair(c, quality); });
  for (const glm::u8vec4 c : {kWine, rgb(0x8c3a44)})
    seats.emplace_back([c](double quality) { return auditorium_seat(c, quality); });
  for (const glm::u8vec4 c : {kBeech, kRust}) stools.emplace_back([c](double quality) { return stool(c, quality); });
  catalogue.add("stacking_chair", "chair", stacking);
  catalogue.add("auditorium_seat", "seat", seats);
  catalogue.add("stool", "chair", stools);
  catalogue.add("sofa", "sofa", each<Sofa>(sofa, {{}, {.fabric = kMustard, .seats = 2}, {.fabric = kSlate}}));
  catalogue.add("armchair", "sofa", each<Sofa>(sofa, {{.fabric = kRust, .seats = 1}, {.fabric = kSage, .seats = 1}}));
  catalogue.add("bench", "bench",
                {[](double q) { return bench(kOak, kDarkSteel, 1.5, q); },
                 [](double q) { return bench(kTeak, kGraphite, 1.8, q); }});
}

}  // namespace promenade
