// Desks and tables.
#include <cmath>
#include <glm/gtc/constants.hpp>

#include "datasets/furniture.h"
#include "datasets/furniture_palette.h"
#include "datasets/furniture_variants.h"

namespace promenade {

namespace {

using glm::dvec3;
using namespace palette;

struct Desk {
  double width_m = 1.6, depth_m = 0.8, height_m = 0.74;
  glm::u8vec4 top = kOak;
  glm::u8vec4 body = kOffWhite;
  uint32_t drawers = 3;       ///< in a pedestal at the user's right; 0: none
  bool modesty_panel = true;  ///< closes the side away from the user
  bool metal_legs = true;
};

void add_pedestal(Sculptor& s, const Desk& p) {
  const double x1 = p.width_m / 2 - 0.07, x0 = x1 - 0.42, y0 = -p.depth_m / 2 + 0.06, y1 = p.depth_m / 2 - 0.08;
  const double top = p.height_m - 0.05, height = (top - 0.06) / p.drawers;
  s.paint(p.body).box({x0, y0, 0.04}, {x1, y1, top});
  for (uint32_t i = 0; i < p.drawers; ++i) {
    const double z = 0.05 + i * height;
    s.paint(shaded(p.top, -0.05));
    s.rounded_box({x0 + 0.008, y0 - 0.018, z}, {x1 - 0.008, y0 - 0.001, z + height - 0.012}, 0.006, s.steps(1, 0));
    const double m = (x0 + x1) / 2, h = z + height - 0.06;
    const dvec3 handle[] = {
        {m - 0.06, y0 - 0.015, h}, {m - 0.06, y0 - 0.04, h}, {m + 0.06, y0 - 0.04, h}, {m + 0.06, y0 - 0.015, h}};
    if (s.quality() < kFineDetail)
      s.paint(kChrome).box({m - 0.06, y0 - 0.035, h - 0.005}, {m + 0.06, y0 - 0.0181, h + 0.005});
    else
      s.paint(kChrome).tube(handle, 0.005, s.steps(6, 3));
  }
}

Mesh desk(const Desk& p, double quality) {
  Sculptor s(quality);
  const double w = p.width_m / 2, d = p.depth_m / 2, h = p.height_m;
  s.paint(p.top).rounded_box({-w, -d, h - 0.03}, {w, d, h}, 0.012, s.steps(2, 0));
  s.paint(p.metal_legs ? kDarkSteel : p.body);
  for (const double x : {-w + 0.05, w - 0.05}) {
    if (p.metal_legs) {
      s.rounded_box({x - 0.03, -d + 0.06, 0}, {x + 0.03, d - 0.06, 0.03}, 0.01, s.steps(1, 0));
      s.cylinder({x, 0.12, 0.03}, {x, 0.12, h - 0.03}, 0.03, s.steps(12, 4));
      s.box({x - 0.02, -d + 0.1, h - 0.06}, {x + 0.02, d - 0.1, h - 0.031});
    } else {
      s.box({x - 0.015, -d + 0.05, 0}, {x + 0.015, d - 0.02, h - 0.031});
    }
  }
  if (p.modesty_panel) s.paint(p.body).box({-w + 0.08, d - 0.06, 0.3}, {w - 0.08, d - 0.04, h - 0.031});
  if (p.drawers > 0) add_pedestal(s, p);
  s.paint(kGraphite).cylinder({-0.1, d - 0.1, h - 0.031}, {-0.1, d - 0.1, h + 0.003}, 0.035, s.steps(12, 5));
  return s.take();
}

struct Table {
  double width_m = 1.4, depth_m = 0.7, height_m = 0.74;
  double corner_m = 0.02;  ///< rounding in plan; half of the depth makes an oval
  double bulge_m = 0;      ///< a boat's sides
  glm::u8vec4 top = kBeech;
  glm::u8vec4 legs = kDarkSteel;
  uint32_t columns = 0;  ///< 0: four legs; otherwise that many central columns
};

/// The plan of a table top: a rectangle with round corners and swelling long sides.
std::vector<glm::dvec2> outline(const Table& p, uint32_t arc, uint32_t side) {
  const double w = p.width_m / 2, d = p.depth_m / 2, r = std::min(p.corner_m, std::min(w, d) * 0.999);
  std::vector<glm::dvec2> points;
  for (int quarter = 0; quarter < 4; ++quarter) {
    const double cx = (quarter == 0 || quarter == 3 ? 1 : -1) * (w - r), cy = (quarter < 2 ? 1 : -1) * (d - r);
    for (uint32_t i = 0; i <= arc; ++i) {
      const double a = glm::half_pi<double>() * (quarter + double(i) / arc);
      points.emplace_back(cx + r * std::cos(a), cy + r * std::sin(a));
    }
    if (p.bulge_m > 0 && quarter % 2 == 0) {
      const double y = quarter == 0 ? 1 : -1, from = y * (w - r);
      for (uint32_t i = 1; i < side; ++i) {
        const double u = double(i) / side;
        points.emplace_back(from - 2 * from * u, y * (d + 4 * p.bulge_m * u * (1 - u)));
      }
    }
  }
  return points;
}

Mesh table(const Table& p, double quality) {
  Sculptor s(quality);
  const double w = p.width_m / 2, d = p.depth_m / 2, h = p.height_m;
  s.paint(p.top).extrude(outline(p, s.steps(p.corner_m > 0.1 ? 8 : 2, 1), s.steps(12, 4)), {}, h - 0.035, h);
  s.paint(p.legs);
  for (uint32_t i = 0; i < p.columns; ++i) {
    const double x = p.columns == 1 ? 0 : -w * 0.6 + 1.2 * w * i / (p.columns - 1);
    const double foot = std::min(0.36, d * 0.75);
    s.stand(moved({x, 0, 0}));
    const glm::dvec2 profile[] = {{0, 0},          {foot, 0},        {foot, 0.015},     {0.07, 0.04},  {0.05, 0.08},
                                  {0.05, h - 0.1}, {0.12, h - 0.04}, {0.12, h - 0.034}, {0, h - 0.034}};
    s.lathe(profile, false, s.steps(18, 6));
  }
  if (p.columns == 0) {
    for (const double x : {-w + 0.06, w - 0.06}) {
      for (const double y : {-d + 0.06, d - 0.06}) s.cone({x, y, 0}, {x, y, h - 0.034}, 0.016, 0.022, s.steps(8, 4));
      s.box({x - 0.012, -d + 0.06, h - 0.085}, {x + 0.012, d - 0.06, h - 0.034});
    }
    s.box({-w + 0.06, d - 0.075, h - 0.085}, {w - 0.06, d - 0.05, h - 0.034});
  }
  return s.take();
}

/// A reception or an issue desk: a curved counter, higher towards the visitor at +y.
Mesh counter(glm::u8vec4 front, glm::u8vec4 top, double length_m, double quality) {
  Sculptor s(quality);
  const uint32_t n = s.steps(16, 6);
  const auto arc = [&](double offset) {
    std::vector<glm::dvec2> points;
    for (uint32_t i = 0; i <= n; ++i) {
      const double u = 2.0 * i / n - 1;
      points.emplace_back(length_m / 2 * u, offset - 0.35 * u * u);
    }
    return points;
  };
  const auto band = [&](double y0, double y1, double z0, double z1) {
    std::vector<glm::dvec2> outline = arc(y0);
    const std::vector<glm::dvec2> back = arc(y1);
    outline.insert(outline.end(), back.rbegin(), back.rend());
    s.extrude(outline, {}, z0, z1);
  };
  s.paint(front), band(0.22, 0.3, 0, 1.08);
  s.paint(top), band(0.12, 0.38, 1.081, 1.12);
  s.paint(shaded(top, 0.1)), band(-0.4, 0.219, 0.7, 0.735);
  s.paint(kSteel), band(0.301, 0.31, 0.3, 0.33);
  return s.take();
}

}  // namespace

void add_tables(FurnitureCatalogue& catalogue) {
  catalogue.add("desk", "desk",
                each<Desk>(desk, {{.top = kOak},
                                  {.top = kMaple, .body = kSteel},
                                  {.top = kWalnut, .body = kWalnut, .metal_legs = false},
                                  {.top = kCherry, .body = kCherry, .drawers = 2, .metal_legs = false},
                                  {.top = kWhite, .body = kGraphite}}));
  catalogue.add("lab_bench", "desk",
                each<Desk>(desk, {{.width_m = 1.5, .depth_m = 0.75, .top = kOffWhite, .drawers = 0},
                                  {.width_m = 1.5, .depth_m = 0.75, .top = kBeech, .body = kSlate, .drawers = 0}}));
  catalogue.add(
      "class_table", "table",
      each<Table>(table, {{.width_m = 1.3, .depth_m = 0.5}, {.width_m = 1.3, .depth_m = 0.5, .top = kOffWhite}}));
  catalogue.add("reading_table", "table",
                each<Table>(table, {{.width_m = 1.8, .depth_m = 0.95, .top = kCherry, .legs = kWalnut},
                                    {.width_m = 1.8, .depth_m = 0.95, .top = kOak, .legs = kOak}}));
  catalogue.add(
      "conference_table", "table",
      each<Table>(table,
                  {{.width_m = 3.6, .depth_m = 1.3, .corner_m = 0.25, .top = kWalnut, .columns = 2},
                   {.width_m = 3.6, .depth_m = 1.4, .corner_m = 0.7, .top = kCherry, .columns = 2},
                   {.width_m = 3.6, .depth_m = 1.0, .corner_m = 0.08, .bulge_m = 0.2, .top = kMaple, .columns = 2}}));
  catalogue.add(
      "cafe_table", "table",
      each<Table>(table,
                  {{.width_m = 0.8, .depth_m = 0.8, .corner_m = 0.4, .top = kWhite, .legs = kChrome, .columns = 1},
                   {.width_m = 0.75, .depth_m = 0.75, .corner_m = 0.1, .top = kOak, .legs = kBlack, .columns = 1}}));
  catalogue.add(
      "coffee_table", "table",
      each<Table>(
          table, {{.width_m = 1.1, .depth_m = 0.6, .height_m = 0.4, .corner_m = 0.1, .top = kOak, .legs = kBlack},
                  {.width_m = 0.9, .depth_m = 0.9, .height_m = 0.38, .corner_m = 0.45, .top = kWalnut, .columns = 1}}));
  catalogue.add("printer_stand", "table",
                each<Table>(table, {{.width_m = 0.7, .depth_m = 0.6, .height_m = 0.66, .top = kOffWhite}}));
  catalogue.add("counter", "desk",
                {[](double q) { return counter(kWalnut, kWhite, 3.0, q); },
                 [](double q) { return counter(kOak, kMaple, 2.4, q); }});
}

}  // namespace promenade
