// Cars: a body lofted through cross sections, with wheels and lights.

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/ext/matrix_transform.hpp>
#include <glm/geometric.hpp>
#include <vector>

#include "datasets/city_prop.h"
#include "datasets/city_smooth.h"

namespace promenade {
namespace {

/// A body's side view, front at +x. Metres; the four corners of the cabin from the windscreen's foot to the rear
/// window's foot.
struct CarForm {
  float length, width, roof, belt, nose, tail, sill;
  float screen_foot, screen_top, rear_top, rear_foot;  ///< x
  float wheel_front, wheel_rear, wheel;                ///< x, x, radius
};

constexpr std::array<CarForm, 4> kForms = {
    CarForm{4.5F, 1.8F, 1.44F, 0.92F, 0.74F, 0.9F, 0.24F, 0.85F, 0.2F, -1.05F, -1.72F, 1.4F, -1.32F, 0.32F},  // saloon
    CarForm{4.0F, 1.74F, 1.5F, 0.93F, 0.78F, 0.95F, 0.24F, 0.95F, 0.3F, -1.45F, -1.85F, 1.25F, -1.22F,
            0.31F},  // hatchback
    CarForm{4.6F, 1.88F, 1.72F, 1.06F, 0.95F, 1.04F, 0.32F, 0.95F, 0.4F, -1.75F, -2.15F, 1.42F, -1.38F,
            0.37F},  // off-roader
    CarForm{5.2F, 1.95F, 2.15F, 1.2F, 1.0F, 1.2F, 0.3F, 1.9F, 1.25F, -2.45F, -2.52F, 1.75F, -1.6F, 0.35F},  // van
};

constexpr std::array<Color, 12> kPaints = {rgb(176, 34, 34),   rgb(226, 226, 224), rgb(42, 44, 48),
                                           rgb(150, 154, 160), rgb(36, 62, 112),   rgb(92, 98, 104),
                                           rgb(240, 240, 238), rgb(46, 84, 66),    rgb(214, 168, 46),
                                           rgb(120, 42, 52),   rgb(90, 130, 170),  rgb(196, 188, 170)};
constexpr Color kWindow = rgb(34, 42, 50);

float ramp(float x, float from, float to) {
  const float t = std::clamp((x - from) / (to - from), 0.0F, 1.0F);
  return t * t * (3 - 2 * t);
}

/// Height of the bonnet, belt and boot line.
float belt_at(const CarForm& f, float x) {
  const float front = f.length / 2, end = std::abs(x) / front;
  const float droop = 0.22F * std::pow(end, 8.0F);
  return x > 0 ? f.belt + (f.nose - f.belt) * ramp(x, f.screen_foot * 0.6F, front) - droop
               : f.belt + (f.tail - f.belt) * ramp(-x, -f.rear_foot * 0.6F, front) - droop * 0.7F;
}

/// Height of the highest line, the belt where there is no cabin.
float roof_at(const CarForm& f, float x) {
  const float up = x > f.rear_top ? 1 - ramp(x, f.screen_top, f.screen_foot) : ramp(x, f.rear_foot, f.rear_top);
  const float middle = (f.screen_top + f.rear_top) / 2;
  const float crown = 0.05F * (x - middle) * (x - middle) / (f.length * 0.1F);
  const float belt = belt_at(f, x);
  return belt + std::max(0.0F, f.roof - crown * up - belt) * up;
}

/// Half a cross section, from the sill over the belt to the roof's middle: rows points of (y, z).
std::vector<glm::vec2> section_at(const CarForm& f, float x, int side_rows, int cabin_rows, int roof_rows) {
  const float end = std::abs(x) / (f.length / 2);
  const float half = f.width / 2 * (1 - 0.16F * std::pow(end, 5.0F));
  const float belt = belt_at(f, x), top = roof_at(f, x), cabin = top - belt;
  const float roof_half = half - 0.1F - 0.32F * std::min(cabin, 0.6F);
  std::vector<glm::vec2> points;
  for (int k = 0; k <= side_rows; ++k) {
    const float t = static_cast<float>(k) / static_cast<float>(side_rows);
    const float sill = f.sill + 0.12F * std::pow(end, 6.0F);
    points.emplace_back(half - 0.07F * (2 * t - 0.9F) * (2 * t - 0.9F) - 0.02F, sill + (belt - sill) * t);
  }
  for (int k = 1; k <= cabin_rows; ++k) {
    const float t = static_cast<float>(k) / static_cast<float>(cabin_rows);
    points.emplace_back(half - 0.105F + (roof_half - half + 0.105F) * t,
                        belt + 0.015F + (top - 0.06F * std::min(cabin * 4, 1.0F) - belt) * t);
  }
  for (int k = 1; k <= roof_rows; ++k) {
    const float t = static_cast<float>(k) / static_cast<float>(roof_rows);
    const float from = points[static_cast<size_t>(side_rows) + static_cast<size_t>(cabin_rows)].y;
    points.emplace_back(roof_half * std::cos(t * 1.5708F), from + (top + 0.02F - from) * std::sin(t * 1.5708F));
  }
  return points;
}

struct BodyRows {
  int side, cabin, roof;
  int half() const { return side + cabin + roof; }
};

Color body_color(const CarForm& f, const Color& paint, float x, int row, const BodyRows& rows) {
  const int from_sill = row < rows.half() ? row : 2 * rows.half() - 1 - row;
  const bool in_cabin = x < f.screen_foot - 0.12F && x > f.rear_foot + 0.12F;
  if (from_sill == 0) return rgb(38, 40, 42);
  if (from_sill < rows.side || !in_cabin) return paint;
  const bool screen = x > f.screen_top || x < f.rear_top;
  if (from_sill < rows.side + rows.cabin) {
    const float pillar = (f.screen_top + f.rear_top) / 2 - 0.05F;
    const bool solid = std::abs(x - pillar) < 0.07F || (f.roof > 2 && x < 0.6F);
    return solid ? paint : kWindow;
  }
  return screen ? kWindow : paint;
}

void body(SmoothShape& shape, const CarForm& f, const Color& paint, int stations, const BodyRows& rows) {
  const auto columns = 2 * static_cast<size_t>(rows.half()) + 1;
  std::vector<glm::vec3> points;
  std::vector<float> xs;
  for (int s = 0; s <= stations; ++s) {
    // More stations towards the ends, where the body bends.
    const float t = static_cast<float>(s) / static_cast<float>(stations);
    xs.push_back(f.length / 2 * (-std::cos(3.14159265F * t) * 0.35F + (2 * t - 1) * 0.65F));
    const std::vector<glm::vec2> half = section_at(f, xs.back(), rows.side, rows.cabin, rows.roof);
    for (size_t k = 0; k < half.size(); ++k) points.emplace_back(xs.back(), -half[k].x, half[k].y);
    for (size_t k = half.size() - 1; k-- > 0;) points.emplace_back(xs.back(), half[k].x, half[k].y);
  }
  shape.grid(points, columns, [&](size_t station, size_t column) {
    return body_color(f, paint, (xs[station] + xs[station + 1]) / 2, static_cast<int>(column), rows);
  });
  // The ends and the underside.
  for (const bool front : {false, true}) {
    const size_t first = front ? points.size() - columns : 0;
    std::vector<glm::vec3> end;
    const float bulge = front ? 0.07F : -0.05F;
    for (const float t : {0.0F, 0.5F, 1.0F})
      for (size_t c = 0; c < columns; ++c) {
        const glm::vec3 p = points[first + c];
        const glm::vec3 middle(p.x + bulge, 0, (points[first].z + points[first + columns / 2].z) / 2);
        end.push_back(glm::mix(p, middle, t) + glm::vec3(bulge * 2 * t * (1 - t), 0, 0));
      }
    if (!front) {
      std::vector<glm::vec3> turned;
      for (size_t r = 0; r < 3; ++r)
        for (size_t c = columns; c-- > 0;) turned.push_back(end[r * columns + c]);
      end = std::move(turned);
    }
    shape.grid(end, columns, [&](size_t, size_t column) {
      const int row = static_cast<int>(column), from_sill = row < rows.half() ? row : 2 * rows.half() - 1 - row;
      return from_sill < rows.side ? (from_sill <= rows.side / 3 ? rgb(44, 46, 48) : paint) : paint;
    });
  }
  std::vector<glm::vec3> under;
  for (size_t s = 0; s < xs.size(); ++s) {
    under.push_back(points[s * columns + columns - 1]);
    under.push_back(points[s * columns]);
  }
  shape.grid(under, 2, [](size_t, size_t) { return rgb(24, 25, 26); });
}

void wheel(SmoothShape& shape, const CarForm& f, float x, bool left, int sides) {
  const float y = (left ? 1.0F : -1.0F) * (f.width / 2 - 0.17F);
  const glm::mat4 turn = glm::rotate(glm::translate(glm::mat4(1), {x, y, f.wheel}), glm::radians(left ? -90.0F : 90.0F),
                                     glm::vec3(1, 0, 0));
  shape.place(turn);
  const float r = f.wheel;
  shape.color(rgb(20, 20, 22));
  shape.lathe({0, 0, 0.085F}, std::vector<glm::vec2>{{r + 0.075F, 0}, {r + 0.075F, 0.05F}, {0.0F, 0.052F}}, sides);
  shape.color(rgb(32, 32, 34));
  shape.lathe({0, 0, -0.06F},
              std::vector<glm::vec2>{{r * 0.7F, 0},
                                     {r * 0.94F, 0.02F},
                                     {r, 0.06F},
                                     {r, 0.2F},
                                     {r * 0.94F, 0.235F},
                                     {r * 0.68F, 0.245F},
                                     {r * 0.66F, 0.22F}},
              sides);
  shape.color(rgb(186, 190, 194));
  shape.lathe(
      {0, 0, 0.14F},
      std::vector<glm::vec2>{{r * 0.67F, 0.03F}, {r * 0.6F, 0.0F}, {r * 0.3F, 0.02F}, {r * 0.16F, 0.045F}, {0, 0.05F}},
      sides);
  for (int k = 0; k < 5; ++k) {
    shape.place(glm::rotate(turn, 1.2566F * static_cast<float>(k), glm::vec3(0, 0, 1)));
    shape.color(rgb(58, 60, 64));
    shape.box({r * 0.28F, -r * 0.07F, 0.155F}, {r * 0.56F, r * 0.07F, 0.166F});
  }
  shape.place(glm::mat4(1));
}

void fittings(SmoothShape& shape, const CarForm& f, const Color& paint, int round) {
  const auto ball = [](const glm::vec3&) { return 1.0F; };
  const float nose = f.length / 2, lamp_y = f.width / 2 - 0.36F;
  for (const float side : {-1.0F, 1.0F}) {
    shape.color(rgb(236, 238, 240));
    shape.blob({nose - 0.07F, side * lamp_y, f.nose - 0.2F}, {0.12F, 0.2F, 0.08F}, round, round + 2, ball);
    shape.color(rgb(176, 26, 26));
    shape.blob({-nose + 0.05F, side * (lamp_y + 0.04F), f.tail - 0.2F}, {0.09F, 0.17F, 0.09F}, round, round + 2, ball);
    shape.color(shade(paint, 0.9F));
    shape.blob({f.screen_foot - 0.28F, side * (f.width / 2 + 0.06F), f.belt + 0.07F}, {0.07F, 0.11F, 0.07F}, round,
               round + 2, ball);
    shape.color(rgb(40, 42, 44));
    for (const float x : {0.15F, -0.75F})
      shape.box({x - 0.1F, side * (f.width / 2 - 0.035F) - 0.02F, f.belt - 0.14F},
                {x + 0.06F, side * (f.width / 2 - 0.035F) + 0.02F, f.belt - 0.11F});
  }
  shape.color(rgb(240, 240, 232));
  shape.box({nose - 0.02F, -0.26F, 0.42F}, {nose + 0.075F, 0.26F, 0.53F});
  shape.box({-nose - 0.06F, -0.26F, 0.58F}, {-nose + 0.02F, 0.26F, 0.69F});
  shape.color(rgb(26, 28, 30));
  shape.box({nose - 0.06F, -0.42F, 0.57F}, {nose + 0.065F, 0.42F, 0.68F});
}

}  // namespace

Mesh make_car(uint32_t variant, int level) {
  const uint32_t model = variant % 7;
  const CarForm& form = kForms[model < 2 ? 0 : model < 4 ? 1 : model < 6 ? 2 : 3];
  const Color paint = kPaints[(variant * 5 + 1) % kPaints.size()];
  SmoothShape shape;
  // Level 0 to 3: about 2, 3, 9 and 28 thousand triangles.
  const int fine = 1 << std::max(0, level - 1);
  const BodyRows rows = level == 0 ? BodyRows{3, 3, 2} : BodyRows{5 * fine, 3 * fine, 3 * fine};
  body(shape, form, paint, level == 0 ? 20 : 28 * fine, rows);
  for (const float x : {form.wheel_front, form.wheel_rear})
    for (const bool left : {false, true}) wheel(shape, form, x, left, level == 0 ? 10 : 14 * fine);
  fittings(shape, form, paint, level == 0 ? 3 : 4 * fine);
  return shape.take();
}

}  // namespace promenade
