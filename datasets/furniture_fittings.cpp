// What is built in: doors, windows, sanitary and kitchen ware, signs.
#include <cmath>
#include <glm/gtc/constants.hpp>

#include "datasets/building_plan.h"
#include "datasets/furniture.h"
#include "datasets/furniture_palette.h"
#include "datasets/furniture_variants.h"

namespace promenade {

namespace {

using glm::dvec3;
using namespace palette;

struct DoorLeaf {
  glm::u8vec4 wood = kBeech;
  double width_m = 0.9, height_m = 2.04;
  bool window = false;  ///< an opening with a thin frame, as laboratories have
};

/// Hinged at the origin, closed along +x; thick 45 mm, half to either side.
Mesh door_leaf(const DoorLeaf& p, double quality) {
  Sculptor s(quality);
  const double w = p.width_m - 0.006, h = p.height_m;
  const glm::dvec2 outer[] = {{0.006, 0.006}, {w, 0.006}, {w, h}, {0.006, h}};
  std::vector<std::vector<glm::dvec2>> hole;
  if (p.window) hole = {{{w * 0.35, 1.2}, {w * 0.35, 1.85}, {w * 0.65, 1.85}, {w * 0.65, 1.2}}};
  s.stand(turned_x(90)).paint(p.wood).extrude(outer, hole, -0.0225, 0.0225);
  s.stand().paint(kSteel);
  for (const double side : {-1.0, 1.0}) {
    const double y = side * 0.0226, out = side * 0.0245;
    s.box({0.1, std::min(y, out), 0.02}, {w - 0.1, std::max(y, out), 0.2});  // kick plate
  }
  if (quality < 0.3) return s.take();
  for (const double z : {0.25, 1.0, 1.8}) s.cylinder({0, 0.018, z}, {0, 0.018, z + 0.1}, 0.009, s.steps(8, 4));
  return s.take();
}

/// Both sides of a leaf, at the middle of its lock.
Mesh door_handle(glm::u8vec4 metal, double quality) {
  Sculptor s(quality);
  s.paint(metal);
  for (const double side : {-1.0, 1.0}) {
    const double y = side * 0.0226;
    s.rounded_box({-0.02, std::min(y, y + side * 0.008), -0.11}, {0.02, std::max(y, y + side * 0.008), 0.06}, 0.0035,
                  s.steps(2, 0));
    const dvec3 lever[] = {
        {0, y, 0}, {0, side * 0.055, 0}, {-0.012, side * 0.066, 0}, {-0.03, side * 0.07, 0}, {-0.12, side * 0.07, 0}};
    s.tube(lever, 0.009, s.steps(12, 4));
    if (quality < kFineDetail) continue;
    s.cylinder({0, y, -0.08}, {0, y + side * 0.012, -0.08}, 0.008, s.steps(10, 4));
  }
  return s.take();
}

/// Lines an opening of the given width (2.1 m high) in a wall of the given thickness; the opening's middle is the
/// origin, the wall runs along x.
Mesh door_frame(double width_m, double wall_m, glm::u8vec4 paint, double quality) {
  Sculptor s(quality);
  const double w = width_m / 2, h = 2.1, d = wall_m / 2 + 0.015, rim = 0.05, trim = 0.06;
  const glm::dvec2 lining[] = {{-w + 0.001, 0.001},    {-w + rim, 0.001},      {-w + rim, h - rim},
                               {w - rim, h - rim},     {w - rim, 0.001},       {w - 0.001, 0.001},
                               {w - 0.001, h - 0.001}, {-w + 0.001, h - 0.001}};
  s.stand(turned_x(90)).paint(paint).extrude(lining, {}, -d + 0.014, d - 0.014);
  const glm::dvec2 casing[] = {{-w - trim, 0.001}, {-w + 0.02, 0.001}, {-w + 0.02, h - 0.02}, {w - 0.02, h - 0.02},
                               {w - 0.02, 0.001},  {w + trim, 0.001},  {w + trim, h + trim},  {-w - trim, h + trim}};
  s.paint(shaded(paint, 0.06));
  s.extrude(casing, {}, d - 0.0139, d), s.extrude(casing, {}, -d, -d + 0.0139);
  return s.take();
}

struct Window {
  double width_m = 1.6, height_m = 1.8;
  double outside_m = 0.3, inside_m = 0.1;  ///< the wall reaches so far to +y and to -y: the front is the room's side
  glm::u8vec4 frame = kGraphite;
};

/// Frame, mullion, transom, sills; the middle of the opening's lower edge is the origin. The glass is clear: none.
Mesh window(const Window& p, double quality) {
  Sculptor s(quality);
  const double w = p.width_m / 2, h = p.height_m, rim = 0.055, y0 = 0.06, y1 = 0.13;
  const double transom = h * 0.72;
  const glm::dvec2 outer[] = {{-w + 0.001, 0.001}, {w - 0.001, 0.001}, {w - 0.001, h - 0.001}, {-w + 0.001, h - 0.001}};
  const auto pane = [&](double x0, double x1, double z0, double z1) {
    return std::vector<glm::dvec2>{{x0, z0}, {x0, z1}, {x1, z1}, {x1, z0}};
  };
  const std::vector<std::vector<glm::dvec2>> panes{pane(-w + rim, -rim / 2, rim, transom),
                                                   pane(rim / 2, w - rim, rim, transom),
                                                   pane(-w + rim, w - rim, transom + rim, h - rim)};
  s.stand(turned_x(90)).paint(p.frame).extrude(outer, panes, -y1, -y0);
  s.stand().paint(kOffWhite).rounded_box({-w - 0.05, -p.inside_m - 0.08, -0.03}, {w + 0.05, -p.inside_m - 0.001, 0.012},
                                         0.008, s.steps(2, 0));
  s.box({-w + 0.001, -p.inside_m - 0.0009, 0.001}, {w - 0.001, y0 - 0.001, 0.012});
  s.paint(kSteel).box({-w + 0.001, y1 + 0.001, 0.001}, {w - 0.001, p.outside_m + 0.05, 0.018});
  if (quality < kFineDetail) return s.take();
  s.paint(kChrome).cylinder({-0.005, y0, transom * 0.5}, {-0.005, y0 - 0.03, transom * 0.5}, 0.008, s.steps(8, 4));
  s.box({-0.012, y0 - 0.04, transom * 0.5 - 0.1}, {0.004, y0 - 0.028, transom * 0.5 + 0.01});
  return s.take();
}

Mesh radiator(double quality) {
  Sculptor s(quality);
  s.paint(kWhite).box({-0.65, -0.06, 0.12}, {0.65, -0.05, 0.62});
  const uint32_t ribs = s.steps(14, 2);
  for (uint32_t i = 0; i < ribs; ++i) {
    const double x = -0.63 + 1.26 * i / ribs;
    s.box({x, -0.095, 0.14}, {x + 0.5 * 1.26 / ribs, -0.0601, 0.6});
  }
  s.box({-0.65, -0.1, 0.6201}, {0.65, -0.02, 0.64});
  s.paint(kChrome).cylinder({0.67, -0.06, 0}, {0.67, -0.06, 0.2}, 0.011, s.steps(8, 4));
  s.paint(kWhite).cylinder({0.66, -0.06, 0.18}, {0.74, -0.06, 0.18}, 0.022, s.steps(10, 5));
  return s.take();
}

Mesh toilet(double quality) {
  Sculptor s(quality);
  const glm::dvec2 bowl[] = {{0, 0},       {0.12, 0},     {0.13, 0.05}, {0.12, 0.18}, {0.17, 0.32},
                             {0.19, 0.39}, {0.14, 0.395}, {0.12, 0.33}, {0, 0.24}};
  glm::dmat4 stretch(1);
  stretch[1][1] = 1.25;
  s.paint(kCeramic).stand(moved({0, -0.05, 0}) * stretch).lathe(bowl, false, s.steps(20, 6));
  s.stand().rounded_box({-0.2, 0.16, 0.38}, {0.2, 0.32, 0.76}, 0.025, s.steps(2, 1));
  s.paint(kOffWhite)
      .stand(moved({0, 0.16, 0.41}) * turned_x(-8))
      .rounded_box({-0.18, 0, 0}, {0.18, 0.025, 0.4}, 0.01, s.steps(1, 0));
  s.stand().paint(kChrome).cylinder({0, 0.24, 0.76}, {0, 0.24, 0.772}, 0.03, s.steps(12, 5));
  return s.take();
}

void add_tap(Sculptor& s, double x, double y, double z) {
  const dvec3 spout[] = {
      {x, y, z}, {x, y, z + 0.12}, {x, y - 0.03, z + 0.16}, {x, y - 0.1, z + 0.16}, {x, y - 0.12, z + 0.13}};
  s.paint(kChrome).tube(spout, 0.011, s.steps(9, 4));
  s.cylinder({x + 0.05, y, z}, {x + 0.05, y, z + 0.05}, 0.014, s.steps(9, 4));
}

Mesh wash_basin(double quality) {
  Sculptor s(quality);
  const glm::dvec2 bowl[] = {{0, 0.68},    {0.1, 0.69},  {0.2, 0.76}, {0.25, 0.85},
                             {0.25, 0.87}, {0.21, 0.87}, {0.17, 0.8}, {0, 0.74}};
  s.paint(kCeramic).stand(moved({0, -0.24, 0})).lathe(bowl, false, s.steps(22, 6));
  s.stand().rounded_box({-0.2, -0.06, 0.75}, {0.2, 0, 0.87}, 0.015, s.steps(1, 0));
  add_tap(s, 0, -0.035, 0.87);
  s.paint(kChrome).cylinder({0, -0.22, 0.4}, {0, -0.22, 0.7}, 0.018, s.steps(8, 4));
  s.cylinder({0, -0.22, 0.42}, {0, -0.001, 0.42}, 0.018, s.steps(8, 4));
  return s.take();
}

Mesh mirror(double quality) {
  Sculptor s(quality);
  s.paint(kAluminium).rounded_box({-0.31, -0.02, -0.41}, {0.31, -0.001, 0.41}, 0.008, s.steps(1, 0));
  s.paint(rgb(0xbfd3da)).box({-0.29, -0.0215, -0.39}, {0.29, -0.0201, 0.39});
  return s.take();
}

/// One side wall and the front of a toilet cubicle 1 m wide and 1.5 m deep; the back stands at y = 0.
Mesh cubicle(double quality) {
  Sculptor s(quality);
  s.paint(shaded(kTealCloth, 0.35)).box({0.48, -1.5, 0.15}, {0.51, -0.001, 2.0});
  s.box({0.3, -1.53, 0.15}, {0.479, -1.5, 2.0});
  s.paint(shaded(kTealCloth, 0.15)).box({-0.44, -1.525, 0.15}, {0.298, -1.505, 1.95});
  s.paint(kChrome);
  for (const double z : {0.0, 2.0}) s.box({0.47, -1.53, z}, {0.52, -1.48, z == 0 ? 0.1499 : 2.04});
  s.cylinder({0.22, -1.525, 1.0}, {0.22, -1.55, 1.0}, 0.022, s.steps(10, 5));
  return s.take();
}

struct Kitchen {
  double length_m = 2.4;
  glm::u8vec4 doors = kSage;
  glm::u8vec4 top = kGraphite;
};

Mesh kitchen_unit(const Kitchen& p, double quality) {
  Sculptor s(quality);
  const double half = p.length_m / 2;
  const auto count = static_cast<int>(std::lround(p.length_m / 0.6));
  s.paint(kGraphite).box({-half + 0.02, -0.52, 0}, {half - 0.02, -0.001, 0.1});
  s.paint(kOffWhite).box({-half, -0.58, 0.1001}, {half, -0.001, 0.87});
  s.box({-half, -0.33, 1.45}, {half, -0.001, 2.1});
  for (int i = 0; i < count; ++i) {
    const double x = -half + 0.6 * i;
    for (const bool upper : {false, true}) {
      const double y = upper ? -0.33 : -0.58, z0 = upper ? 1.46 : 0.11, z1 = upper ? 2.09 : 0.86;
      s.paint(p.doors).rounded_box({x + 0.004, y - 0.02, z0}, {x + 0.596, y - 0.0001, z1}, 0.005, s.steps(1, 0));
      s.paint(kChrome).cylinder({x + 0.2, y - 0.04, upper ? z0 + 0.05 : z1 - 0.06},
                                {x + 0.4, y - 0.04, upper ? z0 + 0.05 : z1 - 0.06}, 0.006, s.steps(7, 4));
    }
  }
  const glm::dvec2 outer[] = {
      {-half - 0.01, -0.62}, {half + 0.01, -0.62}, {half + 0.01, -0.001}, {-half - 0.01, -0.001}};
  const double sx = -half + 0.7;
  const std::vector<std::vector<glm::dvec2>> hole{
      {{sx - 0.25, -0.52}, {sx - 0.25, -0.15}, {sx + 0.25, -0.15}, {sx + 0.25, -0.52}}};
  s.paint(p.top).extrude(outer, hole, 0.8701, 0.91);
  s.paint(kSteel).box({sx - 0.249, -0.519, 0.8702}, {sx + 0.249, -0.151, 0.873});
  add_tap(s, sx, -0.08, 0.91);
  return s.take();
}

Mesh fridge(double quality) {
  Sculptor s(quality);
  s.paint(kSteel).rounded_box({-0.3, -0.28, 0.02}, {0.3, 0.3, 1.8}, 0.015, s.steps(2, 1));
  s.paint(shaded(kSteel, 0.2)).rounded_box({-0.298, -0.32, 0.03}, {0.298, -0.2801, 0.62}, 0.012, s.steps(2, 1));
  s.rounded_box({-0.298, -0.32, 0.64}, {0.298, -0.2801, 1.79}, 0.012, s.steps(2, 1));
  s.paint(kChrome);
  for (const double z : {0.32, 0.75}) s.cylinder({0.24, -0.345, z}, {0.24, -0.345, z + 0.26}, 0.01, s.steps(8, 4));
  return s.take();
}

Mesh water_cooler(double quality) {
  Sculptor s(quality);
  s.paint(kOffWhite).rounded_box({-0.16, -0.16, 0}, {0.16, 0.16, 0.98}, 0.02, s.steps(2, 1));
  const glm::dvec2 bottle[] = {{0, 0},        {0.04, 0},     {0.05, 0.06},  {0.13, 0.13}, {0.135, 0.2},
                               {0.128, 0.22}, {0.135, 0.24}, {0.135, 0.38}, {0.12, 0.41}, {0, 0.415}};
  s.stand(moved({0, 0, 0.98})).paint(rgb(0x8fc3e0)).lathe(bottle, false, s.steps(22, 7));
  s.stand().paint(kGraphite).box({-0.1, -0.162, 0.6}, {0.1, -0.1601, 0.85});
  s.paint(kNavy).cylinder({-0.05, -0.19, 0.76}, {-0.05, -0.16, 0.76}, 0.015, s.steps(8, 4));
  s.paint(kRust).cylinder({0.05, -0.19, 0.76}, {0.05, -0.16, 0.76}, 0.015, s.steps(8, 4));
  return s.take();
}

Mesh extinguisher(double quality) {
  Sculptor s(quality);
  const glm::dvec2 body[] = {{0, -0.25},   {0.07, -0.25}, {0.078, -0.235}, {0.078, 0.14},
                             {0.06, 0.19}, {0.025, 0.21}, {0.02, 0.25},    {0, 0.25}};
  s.stand(moved({0, -0.1, 0})).paint(rgb(0xc3272b)).lathe(body, false, s.steps(18, 6));
  s.stand().paint(kBlack).box({-0.015, -0.16, 0.25}, {0.015, -0.06, 0.28});
  const dvec3 hose[] = {{0.02, -0.1, 0.24}, {0.09, -0.1, 0.24}, {0.1, -0.1, 0.1}, {0.095, -0.1, -0.1}};
  s.tube(hose, 0.011, s.steps(8, 4));
  s.paint(kSteel).box({-0.03, -0.02, -0.1}, {0.03, -0.001, 0.15});
  return s.take();
}

/// Hangs from the ceiling (z = 0); reads both ways.
Mesh exit_sign(double quality) {
  Sculptor s(quality);
  s.paint(kSteel);
  for (const double x : {-0.1, 0.1}) s.cylinder({x, 0, -0.1}, {x, 0, 0}, 0.004, s.steps(6, 3));
  s.paint(rgb(0x1d8f4e)).box({-0.2, -0.015, -0.28}, {0.2, 0.015, -0.1});
  s.paint(kWhite);
  for (const double side : {-1.0, 1.0}) {
    const double a = side * 0.0151, b = side * 0.017;
    s.box({-0.13, std::min(a, b), -0.21}, {0.06, std::max(a, b), -0.17});
    const glm::dvec2 arrow[] = {{0.06, -0.25}, {0.14, -0.19}, {0.06, -0.13}};
    s.stand(turned_x(90)).extrude(arrow, {}, std::min(-a, -b), std::max(-a, -b));
    s.stand();
  }
  return s.take();
}

Mesh room_sign(glm::u8vec4 paint, double quality) {
  Sculptor s(quality);
  s.paint(kAluminium).rounded_box({-0.09, -0.01, -0.08}, {0.09, -0.0005, 0.08}, 0.004, s.steps(1, 0));
  s.paint(paint).box({-0.08, -0.0115, 0.02}, {0.08, -0.0101, 0.07});
  s.paint(kGraphite).box({-0.07, -0.0115, -0.03}, {0.03, -0.0101, -0.01});
  s.box({-0.07, -0.0115, -0.06}, {0.05, -0.0101, -0.045});
  return s.take();
}

/// Two sliding leaves with their frame in a wall 0.2 m thick; gap: how far each leaf is open.
Mesh lift_door(double gap_m, double quality) {
  Sculptor s(quality);
  const glm::dvec2 casing[] = {{-0.65, 0.001}, {-0.54, 0.001}, {-0.54, 2.12}, {0.54, 2.12},
                               {0.54, 0.001},  {0.65, 0.001},  {0.65, 2.24},  {-0.65, 2.24}};
  s.stand(turned_x(90)).paint(kDarkSteel).extrude(casing, {}, 0.1001, 0.13);
  s.stand().paint(kSteel);
  s.box({-0.54 - gap_m, 0.02, 0.005}, {-0.002 - gap_m, 0.05, 2.115});
  s.box({0.002 + gap_m, 0.02, 0.005}, {0.54 + gap_m, 0.05, 2.115});
  s.paint(kAluminium).box({0.78, -0.115, 0.95}, {0.88, -0.1001, 1.25});
  s.paint(kLight).cylinder({0.83, -0.122, 1.05}, {0.83, -0.115, 1.05}, 0.02, s.steps(12, 5));
  s.cylinder({0.83, -0.122, 1.15}, {0.83, -0.115, 1.15}, 0.02, s.steps(12, 5));
  s.paint(kBlack).box({-0.1, -0.112, 2.3}, {0.1, -0.1001, 2.38});
  return s.take();
}

/// The two rails of a stairwell's flights, between them: the origin is the foot of the first step on the well's middle
/// line, the first flight climbs along +y at -x.
Mesh stair_rail(double quality) {
  Sculptor s(quality);
  const double run = kTreads * kTreadM, half = (kTreads + 1) * kRiserM, x = 0.06, height = 0.9;
  const dvec3 first[] = {{-x, 0, height}, {-x, run, half + height}, {-x, run + 0.06, half + height}};
  const dvec3 second[] = {{x, run + 0.06, half + height}, {x, run, half + height}, {x, 0, 2 * half + height}};
  s.paint(kOak).tube(first, 0.024, s.steps(10, 5)), s.tube(second, 0.024, s.steps(10, 5));
  s.paint(kGraphite);
  for (uint32_t i = 0; i <= kTreads; i += 2) {
    const double y = i * kTreadM + (i == 0 ? 0.02 : 0), climb = y / run * half;
    s.cylinder({-x, y, climb - 0.1}, {-x, y, climb + height}, 0.009, s.steps(8, 4));
    s.cylinder({x, run - y, half + climb - 0.1}, {x, run - y, half + climb + height}, 0.009, s.steps(8, 4));
  }
  return s.take();
}

/// Closes the hole where no further flight leads up; as wide as one.
Mesh stair_guard(double quality) {
  Sculptor s(quality);
  const double w = kFlightWidthM / 2;
  s.paint(kOak).cylinder({-w, 0, 1.0}, {w, 0, 1.0}, 0.024, s.steps(10, 5));
  s.paint(kGraphite).cylinder({-w, 0, 0.1}, {w, 0, 0.1}, 0.012, s.steps(8, 4));
  for (int i = 0; i <= 12; ++i) {
    const double x = -w + 0.02 + (2 * w - 0.04) * i / 12;
    s.cylinder({x, 0, 0}, {x, 0, 1.0}, 0.009, s.steps(8, 4));
  }
  return s.take();
}

/// The cabin of a lift, open at -y; 1.6 m wide, 1.5 m deep.
Mesh lift_cabin(double quality) {
  Sculptor s(quality);
  s.paint(kSlate).box({-0.8, 0, -0.1}, {0.8, 1.5, -0.001});
  s.paint(kSteel).box({-0.8, 1.46, 0}, {0.8, 1.5, 2.3}), s.box({-0.8, 0, 0}, {-0.76, 1.4599, 2.3}),
      s.box({0.76, 0, 0}, {0.8, 1.4599, 2.3});
  s.paint(kWhite).box({-0.8, 0, 2.3001}, {0.8, 1.5, 2.36});
  s.paint(rgb(0xbfd3da)).box({-0.6, 1.452, 0.9}, {0.6, 1.4599, 2.1});
  s.paint(kChrome).cylinder({-0.7, 1.38, 0.9}, {0.7, 1.38, 0.9}, 0.02, s.steps(10, 5));
  s.paint(kLight).cylinder({0, 0.75, 2.28}, {0, 0.75, 2.3}, 0.2, s.steps(20, 6));
  return s.take();
}

}  // namespace

void add_fittings(FurnitureCatalogue& catalogue) {
  catalogue.add("door_leaf", "door",
                each<DoorLeaf>(door_leaf, {{},
                                           {.wood = kOak},
                                           {.wood = kCherry},
                                           {.wood = shaded(kTealCloth, 0.1), .window = true},
                                           {.wood = kSlate, .window = true}}));
  catalogue.add("door_handle", "door_handle",
                {[](double q) { return door_handle(kBrass, q); }, [](double q) { return door_handle(kChrome, q); }});
  catalogue.add("door_frame", "door_frame",
                {[](double q) { return door_frame(1.0, 0.2, kOffWhite, q); },
                 [](double q) { return door_frame(1.0, 0.2, kWalnut, q); }});
  catalogue.add("double_door_frame", "door_frame", {[](double q) { return door_frame(1.9, 0.2, kWalnut, q); }});
  catalogue.add("entrance_frame", "door_frame", {[](double q) { return door_frame(1.9, 0.4, kGraphite, q); }});
  catalogue.add("window", "window", each<Window>(window, {{}, {.width_m = 1.2}}));
  catalogue.add("radiator", "radiator", {[](double q) { return radiator(q); }});
  catalogue.add("toilet", "toilet", {[](double q) { return toilet(q); }});
  catalogue.add("wash_basin", "basin", {[](double q) { return wash_basin(q); }});
  catalogue.add("mirror", "mirror", {[](double q) { return mirror(q); }});
  catalogue.add("cubicle", "partition", {[](double q) { return cubicle(q); }});
  catalogue.add("kitchen_unit", "kitchen", each<Kitchen>(kitchen_unit, {{}, {.doors = kMustard, .top = kWalnut}}));
  catalogue.add("fridge", "machine", {[](double q) { return fridge(q); }});
  catalogue.add("water_cooler", "machine", {[](double q) { return water_cooler(q); }});
  catalogue.add("extinguisher", "extinguisher", {[](double q) { return extinguisher(q); }});
  catalogue.add("exit_sign", "sign", {[](double q) { return exit_sign(q); }});
  catalogue.add("room_sign", "sign",
                {[](double q) { return room_sign(kNavy, q); }, [](double q) { return room_sign(kRust, q); }});
  catalogue.add("lift_door", "lift_door",
                {[](double q) { return lift_door(0, q); }, [](double q) { return lift_door(0.5, q); }});
  catalogue.add("stair_rail", "handrail", {[](double q) { return stair_rail(q); }});
  catalogue.add("stair_guard", "handrail", {[](double q) { return stair_guard(q); }});
  catalogue.add("lift_cabin", "lift_cabin", {[](double q) { return lift_cabin(q); }});
}

}  // namespace promenade
