// Computers and other machines.
#include <cmath>

#include "datasets/furniture.h"
#include "datasets/furniture_palette.h"
#include "datasets/furniture_variants.h"

namespace promenade {

namespace {

using glm::dvec3;
using namespace palette;

struct Monitor {
  double width_m = 0.54, height_m = 0.33;
  glm::u8vec4 body = kBlack;
  glm::u8vec4 desktop = rgb(0x2f5f8f);  ///< what the screen shows behind its windows
};

Mesh monitor(const Monitor& p, double quality) {
  Sculptor s(quality);
  const double w = p.width_m / 2, z0 = 0.13, z1 = z0 + p.height_m;
  s.paint(p.body).rounded_box({-w, -0.015, z0}, {w, 0.02, z1}, 0.008, s.steps(1, 0));
  s.rounded_box({-0.12, 0.0201, z0 + 0.06}, {0.12, 0.045, z1 - 0.06}, 0.012, s.steps(1, 0));
  s.box({-0.03, 0.022, 0.015}, {0.03, 0.04, z0 + 0.1});
  s.rounded_box({-0.12, -0.07, 0}, {0.12, 0.1, 0.016}, 0.007, s.steps(1.4, 0));
  const double y = -0.0153;
  s.paint(p.desktop).box({-w + 0.012, y - 0.0012, z0 + 0.014}, {w - 0.012, y, z1 - 0.012});
  s.paint(kPaper).box({-w + 0.04, y - 0.0022, z0 + 0.06}, {0.02, y - 0.0013, z1 - 0.05});
  s.paint(kSlate).box({-w + 0.04, y - 0.0022, z1 - 0.0499}, {0.02, y - 0.0013, z1 - 0.036});
  s.paint(kGraphite).box({0.05, y - 0.0022, z0 + 0.09}, {w - 0.03, y - 0.0013, z1 - 0.03});
  const uint32_t lines = s.steps(4, 0);
  s.paint(kSlate);
  for (uint32_t i = 0; i < lines; ++i) {
    const double z = z1 - 0.075 - i * (p.height_m - 0.16) / std::max(1U, lines), right = -0.02 - 0.05 * (i * 7 % 3);
    s.box({-w + 0.055, y - 0.003, z}, {right, y - 0.0023, z + 0.006});
  }
  return s.take();
}

/// Six rows of keys, the lowest with a space bar.
Mesh keyboard(glm::u8vec4 body, glm::u8vec4 key, double quality) {
  Sculptor s(quality);
  s.paint(body).box({-0.22, -0.075, 0}, {0.22, 0.075, 0.016});
  const uint32_t rows = quality < 0.12 ? 0 : 5, columns = s.steps(12, 4);
  for (uint32_t row = 0; row < rows; ++row) {
    const double y = -0.066 + row * 0.0268;
    double x = -0.212;
    const double width = 0.424 / columns;
    for (uint32_t column = 0; column < columns; ++column) {
      const bool space = row == 0 && column == columns / 3;
      const double keys = space ? columns / 3 + 1 : 1;
      s.paint(column == 0 || (column + 1 == columns) ? shaded(key, -0.18) : key);
      s.box({x + 0.0015, y, 0.0161}, {x + width * keys - 0.0015, y + 0.0235, 0.024});
      x += width * keys;
      if (space) column += columns / 3;
    }
  }
  return s.take();
}

Mesh mouse(glm::u8vec4 body, double quality) {
  Sculptor s(quality);
  s.paint(body).ellipsoid({0, 0, 0.012}, {0.031, 0.055, 0.024}, s.steps(14, 6), s.steps(8, 4));
  if (quality >= kFineDetail)
    s.paint(kGraphite).cylinder({-0.004, -0.028, 0.031}, {0.004, -0.028, 0.031}, 0.008, s.steps(8, 4));
  s.paint(kSlate).box({-0.1, -0.11, 0}, {0.1, 0.09, 0.003});
  return s.take();
}

Mesh tower(glm::u8vec4 body, double quality) {
  Sculptor s(quality);
  s.paint(body).rounded_box({-0.1, -0.2, 0.01}, {0.1, 0.2, 0.42}, 0.01, s.steps(1, 0));
  s.paint(shaded(body, -0.3));
  s.box({-0.085, -0.203, 0.33}, {0.085, -0.2002, 0.37});
  s.box({-0.085, -0.203, 0.28}, {0.085, -0.2002, 0.32});
  s.paint(kChrome).cylinder({0.05, -0.208, 0.24}, {0.05, -0.2, 0.24}, 0.012, s.steps(10, 4));
  s.paint(kBlack);
  const uint32_t slots = s.steps(5, 1);
  for (uint32_t i = 0; i < slots; ++i) s.box({-0.06, -0.202, 0.05 + 0.02 * i}, {0.06, -0.2002, 0.058 + 0.02 * i});
  return s.take();
}

Mesh laptop(glm::u8vec4 body, double quality) {
  Sculptor s(quality);
  s.paint(body).rounded_box({-0.17, -0.12, 0}, {0.17, 0.12, 0.016}, 0.006, s.steps(1, 0));
  s.paint(kGraphite);
  for (int row = 0; row < (quality < 0.3 ? 0 : 4); ++row) {
    const uint32_t keys = s.steps(10, 4);
    for (uint32_t k = 0; k < keys; ++k) {
      const double x = -0.15 + 0.3 * k / keys, y = -0.02 + row * 0.026;
      s.box({x + 0.001, y, 0.0161}, {x + 0.3 / keys - 0.001, y + 0.022, 0.019});
    }
  }
  s.box({-0.05, -0.1, 0.0161}, {0.05, -0.035, 0.0168});
  s.stand(moved({0, 0.12, 0.014}) * turned_x(-18));
  s.paint(body).rounded_box({-0.17, 0, 0}, {0.17, 0.008, 0.23}, 0.0035, s.steps(1, 0));
  s.paint(rgb(0x3f6fa3)).box({-0.16, -0.0012, 0.012}, {0.16, -0.0001, 0.222});
  return s.take();
}

Mesh telephone(glm::u8vec4 body, double quality) {
  Sculptor s(quality);
  s.paint(body).rounded_box({-0.09, -0.1, 0}, {0.09, 0.1, 0.045}, 0.012, s.steps(1, 0));
  const dvec3 handset[] = {{-0.06, -0.09, 0.06}, {-0.06, -0.06, 0.072}, {-0.06, 0.06, 0.072}, {-0.06, 0.09, 0.06}};
  s.paint(shaded(body, -0.2)).tube(handset, 0.018, s.steps(8, 4));
  if (quality < kFineDetail) s.paint(kPaper).box({-0.015, -0.07, 0.0451}, {0.067, 0.034, 0.049});
  for (int i = 0; i < 12 && quality >= kFineDetail; ++i) {
    const int column = i % 3, row = i / 3;
    const double x = -0.015 + 0.03 * column, y = -0.07 + 0.028 * row;
    s.paint(kPaper).box({x, y, 0.0451}, {x + 0.022, y + 0.02, 0.049});
  }
  s.paint(rgb(0x9fb8a0)).box({-0.02, 0.05, 0.0451}, {0.075, 0.085, 0.047});
  return s.take();
}

struct Printer {
  double width_m = 0.46, depth_m = 0.42, height_m = 0.34;
  glm::u8vec4 body = kOffWhite;
  uint32_t trays = 1;
};

Mesh printer(const Printer& p, double quality) {
  Sculptor s(quality);
  const double w = p.width_m / 2, d = p.depth_m / 2, h = p.height_m;
  s.paint(p.body).rounded_box({-w, -d, 0}, {w, d, h}, 0.02, s.steps(2, 1));
  const double tray = 0.5 * h / p.trays;
  for (uint32_t i = 0; i < p.trays; ++i) {
    s.paint(shaded(p.body, -0.12))
        .rounded_box({-w + 0.03, -d - 0.015, 0.02 + i * tray}, {w - 0.03, -d + 0.01, 0.01 + (i + 1) * tray}, 0.006,
                     s.steps(1, 0));
    s.paint(kGraphite).box({-0.06, -d - 0.018, 0.04 + i * tray}, {0.06, -d - 0.0151, 0.055 + i * tray});
  }
  s.paint(kGraphite).box({-w + 0.05, -d - 0.002, h * 0.62}, {w - 0.05, -d + 0.03, h * 0.8});
  s.paint(kPaper).box({-0.105, -d - 0.06, h * 0.66}, {0.105, -d + 0.02, h * 0.665});
  s.paint(kGraphite).rounded_box({w - 0.16, -d + 0.02, h - 0.005}, {w - 0.03, -d + 0.12, h + 0.02}, 0.008,
                                 s.steps(1, 0));
  s.paint(rgb(0x6fa8c0)).box({w - 0.145, -d + 0.05, h + 0.0201}, {w - 0.07, -d + 0.105, h + 0.022});
  s.paint(shaded(p.body, -0.08)).box({-w + 0.04, -d + 0.15, h + 0.0001}, {w - 0.04, d - 0.03, h + 0.025});
  return s.take();
}

/// Hangs from the ceiling (z = 0), shines towards -y.
Mesh projector(double quality) {
  Sculptor s(quality);
  s.paint(kAluminium).cylinder({0, 0, -0.02}, {0, 0, 0}, 0.07, s.steps(14, 5));
  s.cylinder({0, 0, -0.3}, {0, 0, -0.02}, 0.018, s.steps(10, 4));
  s.paint(kOffWhite).rounded_box({-0.17, -0.14, -0.42}, {0.17, 0.14, -0.3}, 0.02, s.steps(2, 1));
  s.paint(kBlack).cylinder({0.07, -0.17, -0.36}, {0.07, -0.13, -0.36}, 0.04, s.steps(18, 6));
  s.paint(rgb(0x9fb7d6)).ellipsoid({0.07, -0.17, -0.36}, {0.032, 0.012, 0.032}, s.steps(12, 5), s.steps(6, 3));
  return s.take();
}

Mesh server_rack(glm::u8vec4 lamp, double quality) {
  Sculptor s(quality);
  s.paint(kBlack).box({-0.3, -0.42, 0}, {0.3, 0.45, 2.0});
  const uint32_t units = s.steps(14, 3);
  for (uint32_t i = 0; i < units; ++i) {
    const double h = 1.84 / units, z = 0.08 + i * h;
    s.paint(i % 3 == 0 ? kDarkSteel : kGraphite).box({-0.27, -0.44, z}, {0.27, -0.4201, z + h * 0.88});
    s.paint(i % 4 == 1 ? kMustard : lamp).box({0.2, -0.443, z + h * 0.3}, {0.24, -0.4402, z + h * 0.5});
    s.paint(kChrome).box({-0.25, -0.445, z + h * 0.3}, {-0.1, -0.4402, z + h * 0.5});
  }
  return s.take();
}

Mesh vending_machine(double quality) {
  Sculptor s(quality);
  s.paint(kRust).rounded_box({-0.45, -0.38, 0}, {0.45, 0.4, 1.85}, 0.03, s.steps(2, 1));
  s.paint(kGraphite).box({-0.4, -0.384, 0.5}, {0.15, -0.3801, 1.75});
  for (int row = 0; row < 5; ++row) {
    for (uint32_t k = 0; k < 5; ++k) {
      const glm::u8vec4 colors[] = {kMustard, kSage, kNavy, kPaper, kWine};
      s.paint(colors[(static_cast<uint32_t>(row) * 2 + k) % 5]);
      s.cylinder({-0.34 + 0.1 * k, -0.4, 0.56 + 0.23 * row}, {-0.34 + 0.1 * k, -0.4, 0.7 + 0.23 * row}, 0.03,
                 s.steps(10, 4));
    }
  }
  s.paint(kSteel).box({0.22, -0.39, 0.8}, {0.4, -0.3801, 1.5});
  s.paint(kBlack).box({-0.38, -0.386, 0.2}, {0.1, -0.3801, 0.36});
  return s.take();
}

Mesh coffee_machine(double quality) {
  Sculptor s(quality);
  s.paint(kBlack).rounded_box({-0.13, -0.02, 0}, {0.13, 0.2, 0.36}, 0.015, s.steps(2, 1));
  s.rounded_box({-0.13, -0.18, 0.25}, {0.13, 0, 0.36}, 0.015, s.steps(2, 1));
  s.paint(kSteel).box({-0.12, -0.18, 0}, {0.12, -0.0201, 0.03});
  s.cylinder({0, -0.1, 0.2}, {0, -0.1, 0.26}, 0.025, s.steps(12, 5));
  const glm::dvec2 pot[] = {{0, 0}, {0.05, 0}, {0.062, 0.05}, {0.05, 0.1}, {0.045, 0.13}, {0, 0.13}};
  s.stand(moved({0, -0.1, 0.031})).paint(rgb(0x5a3a26)).lathe(pot, false, s.steps(16, 6));
  return s.take();
}

Mesh microwave(double quality) {
  Sculptor s(quality);
  s.paint(kSteel).rounded_box({-0.25, -0.18, 0}, {0.25, 0.18, 0.28}, 0.01, s.steps(1, 0));
  s.paint(kBlack).box({-0.23, -0.186, 0.03}, {0.1, -0.1801, 0.25});
  s.paint(kChrome).cylinder({0.12, -0.2, 0.05}, {0.12, -0.2, 0.23}, 0.008, s.steps(8, 4));
  s.paint(kGraphite).box({0.14, -0.184, 0.05}, {0.235, -0.1801, 0.24});
  return s.take();
}

}  // namespace

void add_devices(FurnitureCatalogue& catalogue) {
  catalogue.add("monitor", "monitor",
                each<Monitor>(monitor, {{},
                                        {.width_m = 0.6, .height_m = 0.36, .body = kGraphite, .desktop = rgb(0x3c7a5e)},
                                        {.body = kAluminium, .desktop = rgb(0x6b4a86)}}));
  catalogue.add("keyboard", "keyboard",
                {[](double q) { return keyboard(kGraphite, rgb(0x4a4d53), q); },
                 [](double q) { return keyboard(kAluminium, kWhite, q); }});
  catalogue.add("mouse", "mouse",
                {[](double q) { return mouse(kBlack, q); }, [](double q) { return mouse(kWhite, q); }});
  catalogue.add("tower", "computer",
                {[](double q) { return tower(kBlack, q); }, [](double q) { return tower(kOffWhite, q); }});
  catalogue.add("laptop", "computer",
                {[](double q) { return laptop(kAluminium, q); }, [](double q) { return laptop(kGraphite, q); }});
  catalogue.add("telephone", "telephone",
                {[](double q) { return telephone(kGraphite, q); }, [](double q) { return telephone(kOffWhite, q); }});
  catalogue.add("printer", "printer", each<Printer>(printer, {{}, {.width_m = 0.5, .body = kGraphite, .trays = 2}}));
  catalogue.add("copier", "printer",
                each<Printer>(printer, {{.width_m = 0.65, .depth_m = 0.65, .height_m = 1.05, .trays = 3}}));
  catalogue.add("projector", "projector", {[](double q) { return projector(q); }});
  catalogue.add(
      "server_rack", "rack",
      {[](double q) { return server_rack(rgb(0x57d07a), q); }, [](double q) { return server_rack(rgb(0x5aa9e6), q); }});
  catalogue.add("vending_machine", "machine", {[](double q) { return vending_machine(q); }});
  catalogue.add("coffee_machine", "machine", {[](double q) { return coffee_machine(q); }});
  catalogue.add("microwave", "machine", {[](double q) { return microwave(q); }});
}

}  // namespace promenade
