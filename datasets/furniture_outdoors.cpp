// What stands around the building and on its roof.
#include <cmath>

#include "datasets/furniture.h"
#include "datasets/furniture_palette.h"
#include "datasets/furniture_variants.h"

namespace promenade {

namespace {

using glm::dvec3;
using namespace palette;

Mesh street_lamp(double quality) {
  Sculptor s(quality);
  const glm::dvec2 post[] = {{0, 0},      {0.14, 0},     {0.14, 0.06}, {0.07, 0.12},
                             {0.06, 0.7}, {0.045, 0.75}, {0.032, 3.9}, {0, 3.9}};
  s.paint(kGraphite).lathe(post, false, s.steps(14, 6));
  const glm::dvec2 hood[] = {{0, 4.28}, {0.26, 4.2}, {0.27, 4.22}, {0.1, 4.36}, {0.03, 4.4}, {0, 4.42}};
  s.lathe(hood, false, s.steps(22, 8));
  s.paint(kLight);
  const glm::dvec2 globe[] = {{0, 3.88}, {0.06, 3.89}, {0.12, 4.0}, {0.13, 4.1}, {0.1, 4.19}, {0, 4.2}};
  s.lathe(globe, false, s.steps(18, 6));
  return s.take();
}

Mesh bollard(double quality) {
  Sculptor s(quality);
  const glm::dvec2 post[] = {{0, 0}, {0.09, 0}, {0.09, 0.7}, {0.1, 0.72}, {0.1, 0.78}, {0.07, 0.85}, {0, 0.88}};
  s.paint(kDarkSteel).lathe(post, false, s.steps(14, 6));
  return s.take();
}

Mesh bicycle_stand(double quality) {
  Sculptor s(quality);
  const dvec3 hoop[] = {{-0.35, 0, 0}, {-0.35, 0, 0.7}, {-0.3, 0, 0.78}, {0.3, 0, 0.78}, {0.35, 0, 0.7}, {0.35, 0, 0}};
  s.paint(kSteel).tube(hoop, 0.025, s.steps(9, 4));
  return s.take();
}

Mesh air_handler(double length_m, double quality) {
  Sculptor s(quality);
  const double half = length_m / 2;
  s.paint(kDarkSteel).box({-half - 0.1, -0.9, 0}, {half + 0.1, 0.9, 0.2});
  s.paint(kAluminium).rounded_box({-half, -0.8, 0.2001}, {half, 0.8, 1.7}, 0.04, s.steps(2, 1));
  const uint32_t slats = s.steps(10, 3);
  s.paint(kSteel);
  for (uint32_t i = 0; i < slats; ++i) {
    const double z = 0.4 + 1.1 * i / slats;
    s.box({-half + 0.2, -0.83, z}, {half - 0.2, -0.8001, z + 0.05});
  }
  for (const double x : {-half / 2, half / 2}) {
    const glm::dvec2 cowl[] = {{0.42, 1.7001}, {0.5, 1.7001}, {0.48, 1.95}, {0.42, 1.95}};
    s.stand(moved({x, 0, 0})).paint(kGraphite).lathe(cowl, true, s.steps(22, 8));
    for (int blade = 0; blade < 6; ++blade) {
      s.stand(moved({x, 0, 1.8}) * turned_z(60 * blade) * turned_x(25)).box({0.05, -0.08, -0.006}, {0.41, 0.08, 0.006});
    }
    s.stand(moved({x, 0, 0})).cylinder({0, 0, 1.7001}, {0, 0, 1.86}, 0.07, s.steps(12, 5));
    s.stand();
  }
  return s.take();
}

Mesh mast(double quality) {
  Sculptor s(quality);
  s.paint(kSteel).cone({0, 0, 0}, {0, 0, 6}, 0.08, 0.03, s.steps(10, 4));
  for (int i = 0; i < 5; ++i) {
    const double z = 3.5 + 0.5 * i, reach = 0.9 - 0.12 * i;
    s.cylinder({-reach, 0, z}, {reach, 0, z}, 0.015, s.steps(6, 3));
  }
  const glm::dvec2 dish[] = {{0, 0},       {0.2, 0.03},  {0.4, 0.12},  {0.55, 0.26},
                             {0.54, 0.28}, {0.38, 0.15}, {0.19, 0.06}, {0, 0.03}};
  s.stand(moved({0, -0.1, 2.4}) * turned_x(60)).paint(kWhite).lathe(dish, false, s.steps(26, 8));
  return s.take();
}

/// A storey of pier on the facade: 0.6 m wide, its back at y = 0, from z = 0 to 1, to be stretched to the storey's
/// height.
Mesh pilaster(glm::u8vec4 stone, double quality) {
  Sculptor s(quality);
  s.paint(stone).box({-0.25, -0.16, 0}, {0.25, 0, 1});
  return s.take();
}

}  // namespace

void add_outdoors(FurnitureCatalogue& catalogue) {
  catalogue.add("street_lamp", "street_lamp", {[](double q) { return street_lamp(q); }});
  catalogue.add("bollard", "bollard", {[](double q) { return bollard(q); }});
  catalogue.add("bicycle_stand", "bicycle_stand", {[](double q) { return bicycle_stand(q); }});
  catalogue.add("air_handler", "air_handler",
                {[](double q) { return air_handler(3.2, q); }, [](double q) { return air_handler(4.6, q); }});
  catalogue.add("mast", "mast", {[](double q) { return mast(q); }});
  catalogue.add(
      "pilaster", "pilaster",
      {[](double q) { return pilaster(rgb(0xd8cdb8), q); }, [](double q) { return pilaster(rgb(0xb4613f), q); }});
}

}  // namespace promenade
