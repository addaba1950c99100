// What lies on desks and hangs on walls.
#include <cmath>
#include <glm/gtc/constants.hpp>

#include "datasets/furniture.h"
#include "datasets/furniture_palette.h"
#include "datasets/furniture_variants.h"

namespace promenade {

namespace {

using glm::dvec3;
using namespace palette;

/// Six-sided, with a wooden cone, a graphite point and a rubber; lies along x.
Mesh pencil(glm::u8vec4 paint, double quality) {
  Sculptor s(quality);
  const double r = 0.004, z = 0.0035;
  s.paint(paint).cylinder({-0.075, 0, z}, {0.07, 0, z}, r, 6);
  s.paint(kMaple).cone({0.07, 0, z}, {0.084, 0, z}, r, 0.0013, 6);
  s.paint(kBlack).cone({0.084, 0, z}, {0.09, 0, z}, 0.0013, 0, 6);
  if (quality < kFineDetail) return s.take();
  s.paint(kBrass).cylinder({-0.083, 0, z}, {-0.075, 0, z}, 0.0042, s.steps(8, 4));
  s.paint(rgb(0xd98080)).cylinder({-0.092, 0, z}, {-0.083, 0, z}, 0.0036, s.steps(8, 4));
  return s.take();
}

Mesh pencil_cup(glm::u8vec4 paint, double quality) {
  Sculptor s(quality);
  const glm::dvec2 cup[] = {{0, 0}, {0.04, 0}, {0.042, 0.1}, {0.038, 0.1}, {0.036, 0.006}, {0, 0.006}};
  s.paint(paint).lathe(cup, false, s.steps(18, 6));
  const glm::u8vec4 colors[] = {kMustard, kRust, kNavy, kSage, kBlack};
  for (int i = 0; i < (quality < kFineDetail ? 3 : 5); ++i) {
    const double a = 1.2566 * i, x = std::cos(a), y = std::sin(a), length = 0.15 + 0.01 * i;
    const dvec3 foot(-0.015 * x, -0.015 * y, 0.008), top(0.034 * x, 0.034 * y, length);
    const dvec3 shoulder = foot + (top - foot) * 0.93;
    s.paint(colors[i]).cylinder(foot, shoulder, 0.0038, 6);
    s.paint(kMaple).cone(shoulder, top, 0.0038, 0, 6);
  }
  return s.take();
}

Mesh mug(glm::u8vec4 paint, double quality) {
  Sculptor s(quality);
  const glm::dvec2 wall[] = {{0, 0},        {0.034, 0},     {0.038, 0.004},  {0.04, 0.05},
                             {0.041, 0.09}, {0.0375, 0.09}, {0.0365, 0.075}, {0, 0.075}};
  s.paint(paint).lathe(wall, false, s.steps(20, 6));
  s.paint(rgb(0x4a2c1a)).cylinder({0, 0, 0.0752}, {0, 0, 0.077}, 0.0363, s.steps(20, 6));
  std::vector<dvec3> handle;
  const uint32_t bends = s.steps(7, 3);
  for (uint32_t i = 0; i <= bends; ++i) {
    const double a = glm::pi<double>() * (0.5 - double(i) / bends);
    handle.emplace_back(0.039 + 0.027 * std::cos(a), 0, 0.047 + 0.028 * std::sin(a));
  }
  s.paint(paint).tube(handle, 0.005, s.steps(7, 4));
  return s.take();
}

Mesh papers(uint32_t sheets, double quality) {
  Sculptor s(quality);
  Random random(0xa4 + sheets);
  for (uint32_t i = 0; i < sheets; ++i) {
    const double z = 0.004 * i;
    s.stand(moved({random.range(-0.01, 0.01), random.range(-0.01, 0.01), z}) * turned_z(random.range(-8.0, 8.0)));
    s.paint(shaded(kPaper, -0.06 * (i % 2))).box({-0.105, -0.148, 0.0002}, {0.105, 0.148, 0.004});
  }
  s.paint(kSlate);
  const uint32_t lines = s.steps(6, 0);
  for (uint32_t i = 0; i < lines; ++i) {
    const double y = 0.11 - 0.2 * i / lines;
    s.box({-0.08, y, 0.0041}, {0.08 - 0.03 * (i % 3), y + 0.008, 0.0048});
  }
  return s.take();
}

struct Bin {
  double rim_m = 0.15, foot_m = 0.12, height_m = 0.32;
  glm::u8vec4 paint = kGraphite;
};

Mesh waste_bin(const Bin& p, double quality) {
  Sculptor s(quality);
  const double r = p.rim_m, f = p.foot_m, h = p.height_m;
  const glm::dvec2 profile[] = {{0, 0},         {f, 0},         {r, h - 0.015},    {r + 0.008, h - 0.015},
                                {r + 0.008, h}, {r - 0.004, h}, {f - 0.004, 0.01}, {0, 0.01}};
  s.paint(p.paint).lathe(profile, false, s.steps(20, 6));
  if (quality < 0.3) return s.take();
  s.paint(kPaper).ellipsoid({0.02, 0.01, 0.06}, {0.05, 0.04, 0.045}, s.steps(7, 4), s.steps(4, 3));
  s.ellipsoid({-0.04, -0.03, 0.05}, {0.04, 0.045, 0.04}, s.steps(7, 4), s.steps(4, 3));
  return s.take();
}

/// Hangs at y = 0; a painting of bands and discs, another for each seed.
Mesh picture(uint32_t variant, double quality) {
  Sculptor s(quality);
  Random random(0x9a11 + variant);
  static constexpr glm::u8vec4 kFrames[] = {kWalnut, kBlack, kOak, kBrass};
  static constexpr glm::u8vec4 kInks[] = {kNavy, kRust, kMustard, kSage, kWine, kTealCloth, kSand, kSlate};
  const bool upright = variant % 3 == 1;
  const double w = upright ? 0.27 : 0.42, h = upright ? 0.38 : 0.29, rim = 0.028;
  const glm::dvec2 outer[] = {{-w, -h}, {w, -h}, {w, h}, {-w, h}};
  const std::vector<std::vector<glm::dvec2>> hole{
      {{-w + rim, -h + rim}, {-w + rim, h - rim}, {w - rim, h - rim}, {w - rim, -h + rim}}};
  s.stand(turned_x(90)).paint(kFrames[variant % 4]).extrude(outer, hole, 0.001, 0.028);
  s.stand().paint(kPaper).box({-w + rim, -0.008, -h + rim}, {w - rim, -0.001, h - rim});
  const double iw = w - rim - 0.05, ih = h - rim - 0.05;
  double z = -ih;
  while (z < ih - 0.02) {
    const double next = std::min(ih, z + random.range(0.06, 0.2));
    s.paint(shaded(kInks[random.below(8)], random.range(0.0, 0.35)))
        .box({-iw, -0.0095, z}, {iw, -0.0081, next - 0.0001});
    z = next;
  }
  for (int i = 0; i < (quality < kFineDetail ? 1 : 3); ++i) {
    const double r = random.range(0.03, 0.09), x = random.range(-iw + r, iw - r), y = random.range(-ih + r, ih - r);
    const double depth = 0.011 + 0.001 * i;
    s.paint(kInks[random.below(8)]).cylinder({x, -0.0096, y}, {x, -depth, y}, r, s.steps(20, 6));
  }
  return s.take();
}

Mesh clock(double quality) {
  Sculptor s(quality);
  s.stand(turned_x(90));
  const glm::dvec2 rim[] = {{0.155, 0}, {0.17, 0}, {0.17, 0.03}, {0.155, 0.04}};
  s.paint(kBlack).lathe(rim, true, s.steps(28, 8));
  s.paint(kWhite).cylinder({0, 0, 0}, {0, 0, 0.02}, 0.157, s.steps(28, 8));
  s.paint(kBlack);
  for (int i = 0; i < 12; i += quality < kFineDetail ? 3 : 1)
    s.stand(turned_x(90) * turned_z(30 * i)).box({-0.005, 0.12, 0.0201}, {0.005, 0.145, 0.022});
  s.stand(turned_x(90) * turned_z(50)).box({-0.006, -0.02, 0.0201}, {0.006, 0.09, 0.024});
  s.stand(turned_x(90) * turned_z(-70)).box({-0.004, -0.02, 0.0245}, {0.004, 0.13, 0.027});
  return s.take();
}

struct Board {
  double width_m = 1.8, height_m = 1.1;
  glm::u8vec4 face = kWhite;
  glm::u8vec4 rim = kAluminium;
  uint32_t notes = 0;  ///< pinned papers; 0: a writing board with a tray and pens
  uint32_t seed = 1;
};

Mesh board(const Board& p, double quality) {
  Sculptor s(quality);
  const double w = p.width_m / 2, h = p.height_m / 2;
  Random random(0xb0a4d + p.seed);
  s.paint(p.face).box({-w + 0.02, -0.018, -h + 0.02}, {w - 0.02, -0.001, h - 0.02});
  s.paint(p.rim);
  const glm::dvec2 outer[] = {{-w, -h}, {w, -h}, {w, h}, {-w, h}};
  const std::vector<std::vector<glm::dvec2>> hole{
      {{-w + 0.02, -h + 0.02}, {-w + 0.02, h - 0.02}, {w - 0.02, h - 0.02}, {w - 0.02, -h + 0.02}}};
  s.stand(turned_x(90)).extrude(outer, hole, 0.001, 0.026);
  s.stand();
  if (p.notes == 0) {
    s.rounded_box({-w * 0.6, -0.09, -h - 0.03}, {w * 0.6, -0.001, -h - 0.01}, 0.008, s.steps(1, 0));
    const glm::u8vec4 inks[] = {kNavy, kRust, kSage};
    for (int i = 0; i < 3; ++i)
      s.paint(inks[i]).cylinder({-0.3 + 0.16 * i, -0.05, -h}, {-0.18 + 0.16 * i, -0.05, -h}, 0.009, s.steps(8, 4));
    for (uint32_t i = 0; i < s.steps(6, 2); ++i) {  // what somebody wrote
      const double x = random.range(-w * 0.8, w * 0.2), z = h * (0.7 - 0.24 * (i % 6));
      s.paint(inks[i % 3]).box({x, -0.0192, z}, {x + random.range(0.2, 0.6) * w, -0.0181, z + 0.018});
    }
  }
  for (uint32_t i = 0; i < p.notes; ++i) {
    const double x = -w + 0.18 + (p.width_m - 0.36) * (i % 5) / 4, z = i < 5 ? h * 0.4 : -h * 0.42;
    s.stand(moved({x, 0, z}));
    s.paint(i % 3 == 1 ? shaded(kMustard, 0.5) : i % 3 == 2 ? shaded(kTealCloth, 0.6) : kPaper);
    const double nw = random.range(0.07, 0.11), nh = random.range(0.1, 0.17);
    s.box({-nw, -0.021, -nh}, {nw, -0.0185, nh});
    if (quality < kFineDetail) continue;
    s.paint(kRust).ellipsoid({0, -0.022, nh - 0.02}, dvec3(0.008), s.steps(7, 4), s.steps(4, 3));
  }
  return s.take();
}

/// Lowered in front of a wall; the lower edge is at z = 0.
Mesh projection_screen(double width_m, double height_m, double quality) {
  Sculptor s(quality);
  const double w = width_m / 2;
  s.paint(kOffWhite).rounded_box({-w - 0.06, -0.12, height_m}, {w + 0.06, -0.01, height_m + 0.12}, 0.02, s.steps(2, 1));
  s.paint(kBlack).box({-w, -0.068, 0}, {w, -0.062, height_m - 0.0001});
  s.paint(kWhite).box({-w + 0.05, -0.0695, 0.05}, {w - 0.05, -0.0681, height_m - 0.05});
  s.paint(kGraphite).cylinder({-w, -0.065, -0.01}, {w, -0.065, -0.01}, 0.015, s.steps(8, 4));
  return s.take();
}

Mesh lectern(double quality) {
  Sculptor s(quality);
  s.paint(kWalnut).rounded_box({-0.3, -0.24, 0}, {0.3, 0.24, 0.05}, 0.01, s.steps(1, 0));
  s.box({-0.25, -0.02, 0.05}, {0.25, 0.2, 1.02});
  s.paint(kOak)
      .stand(moved({0, 0, 1.08}) * turned_x(15))
      .rounded_box({-0.32, -0.26, -0.02}, {0.32, 0.24, 0.02}, 0.01, s.steps(1, 0));
  s.box({-0.3, -0.26, 0.0201}, {0.3, -0.24, 0.04});
  const dvec3 neck[] = {{0.2, 0.18, 0.02}, {0.2, 0.16, 0.2}, {0.18, 0.1, 0.3}, {0.15, 0.02, 0.34}};
  s.paint(kBlack).tube(neck, 0.006, s.steps(6, 4));
  s.ellipsoid({0.15, 0.01, 0.34}, {0.018, 0.035, 0.018}, s.steps(10, 5), s.steps(6, 3));
  return s.take();
}

Mesh coat_stand(double quality) {
  Sculptor s(quality);
  const glm::dvec2 foot[] = {{0, 0},        {0.19, 0},     {0.19, 0.02}, {0.03, 0.05},
                             {0.022, 0.06}, {0.018, 1.72}, {0.03, 1.75}, {0, 1.78}};
  s.paint(kWalnut).lathe(foot, false, s.steps(18, 6));
  for (int i = 0; i < 6; ++i) {
    s.stand(turned_z(60 * i) * moved({0, 0, 1.55 + 0.09 * (i % 2)}));
    const dvec3 hook[] = {{0, 0, 0}, {0.09, 0, 0.01}, {0.14, 0, 0.05}, {0.15, 0, 0.11}};
    s.tube(hook, 0.009, s.steps(7, 4));
    if (quality < kFineDetail) continue;
    s.ellipsoid({0.15, 0, 0.115}, dvec3(0.014), s.steps(8, 4), s.steps(5, 3));
  }
  return s.take();
}

/// A bottle with two ends: a sculpture for the lobby, in memory of the one in Soda Hall.
Mesh sculpture(double quality) {
  Sculptor s(quality);
  s.paint(kOffWhite).rounded_box({-0.3, -0.3, 0}, {0.3, 0.3, 0.9}, 0.02, s.steps(2, 1));
  const glm::dvec2 body[] = {{0, 0},       {0.1, 0.005}, {0.19, 0.05}, {0.24, 0.14}, {0.24, 0.24}, {0.19, 0.34},
                             {0.11, 0.43}, {0.06, 0.52}, {0.045, 0.6}, {0.04, 0.68}, {0.03, 0.69}, {0, 0.69}};
  s.stand(moved({0, 0, 0.9})).paint(kTealCloth).lathe(body, false, s.steps(36, 8));
  std::vector<dvec3> neck;
  const uint32_t bends = s.steps(24, 8);
  for (uint32_t i = 0; i <= bends; ++i) {
    const double a = glm::pi<double>() * (1 - 1.35 * double(i) / bends);
    neck.emplace_back(0.16 + 0.16 * std::cos(a), 0, 0.66 + 0.2 * std::sin(a) - (i * 0.2 / bends));
  }
  s.paint(kBrass).tube(neck, 0.038, s.steps(18, 6));
  return s.take();
}

}  // namespace

void add_small_things(FurnitureCatalogue& catalogue) {
  std::vector<std::function<Mesh(double)>> pencils, cups, mugs, pictures, stacks;
  for (const glm::u8vec4 c : {kMustard, kRust, kNavy, kSage}) {
    pencils.emplace_back([c](double quality) { return pencil(c, quality); });
    mugs.emplace_back([c](double quality) { return mug(shaded(c, 0.15), quality); });
  }
  for (const glm::u8vec4 c : {kBlack, kTealCloth})
    cups.emplace_back([c](double quality) { return pencil_cup(c, quality); });
  for (uint32_t i = 0; i < 12; ++i) pictures.emplace_back([i](double quality) { return picture(i, quality); });
  for (const uint32_t n : {1U, 4U, 9U}) stacks.emplace_back([n](double quality) { return papers(n, quality); });
  catalogue.add("pencil", "pencil", pencils);
  catalogue.add("pencil_cup", "cup", cups);
  catalogue.add("mug", "cup", mugs);
  catalogue.add("papers", "papers", stacks);
  catalogue.add("picture", "picture", pictures);
  catalogue.add(
      "waste_bin", "bin",
      each<Bin>(waste_bin, {{}, {.rim_m = 0.2, .foot_m = 0.18, .height_m = 0.65, .paint = kSteel}, {.paint = kSage}}));
  catalogue.add("clock", "clock", {[](double q) { return clock(q); }});
  catalogue.add(
      "whiteboard", "whiteboard",
      each<Board>(board,
                  {{}, {.width_m = 2.8, .height_m = 1.2, .seed = 2}, {.width_m = 1.2, .height_m = 0.9, .seed = 3}}));
  catalogue.add(
      "blackboard", "whiteboard",
      each<Board>(board, {{.width_m = 3.6, .height_m = 1.25, .face = rgb(0x2d4a3e), .rim = kOak, .seed = 4}}));
  catalogue.add("notice_board", "notice_board",
                each<Board>(board, {{.width_m = 1.5, .height_m = 0.95, .face = rgb(0xc08f58), .rim = kOak, .notes = 10},
                                    {.width_m = 1.5, .height_m = 0.95, .face = kSlate, .notes = 8, .seed = 5}}));
  catalogue.add("projection_screen", "screen",
                {[](double q) { return projection_screen(2.2, 1.5, q); },
                 [](double q) { return projection_screen(5.2, 3.0, q); }});
  catalogue.add("lectern", "lectern", {[](double q) { return lectern(q); }});
  catalogue.add("coat_stand", "coat_stand", {[](double q) { return coat_stand(q); }});
  catalogue.add("sculpture", "sculpture", {[](double q) { return sculpture(q); }});
}

}  // namespace promenade
