// Source: [xiong1996] appendix A for the grid.

#include "datasets/city_plan.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <numbers>

namespace promenade {
namespace {

constexpr double kJointStepM = 12;  // a street with a radius of 300 m bends by 6 cm within it

}  // namespace

CityPlan::CityPlan(const CityOptions& options) : options_(options) {
  if (options_.style == StreetStyle::grid) return;
  Random random(options_.seed, {0x9a});
  // Waves that move the plan mostly across their way shear it: streets bend and meet at other than right angles while
  // blocks keep their size. All together they move a point by less than 0.65 of the way to it, so that the plan never
  // folds.
  for (Wave& wave : waves_) {
    const double length_m = random.range(380.0, 1300.0), angle = random.range(0.0, 2 * std::numbers::pi);
    const double number = 2 * std::numbers::pi / length_m, way = angle + std::numbers::pi / 2 + random.range(-0.4, 0.4);
    wave.number = number * glm::dvec2(std::cos(angle), std::sin(angle));
    wave.amplitude = random.range(0.06, 0.13) / number * glm::dvec2(std::cos(way), std::sin(way));
    wave.phase = random.range(0.0, 2 * std::numbers::pi);
  }
}

glm::dvec2 CityPlan::size() const {
  return {options_.blocks_x * (options_.block_length_m + options_.street_width_m),
          options_.blocks_y * (options_.block_width_m + options_.street_width_m)};
}

double CityPlan::cut_x(uint32_t i, uint32_t row) const {
  const double pitch = options_.block_length_m + options_.street_width_m;
  const double even = i * pitch;
  if (options_.style == StreetStyle::grid || i == 0 || i == options_.blocks_x) return even;
  Random random(options_.seed, {0x51, row, i});
  return even + pitch * random.range(-0.24, 0.24);
}

double CityPlan::cut_y(uint32_t j) const {
  const double pitch = options_.block_width_m + options_.street_width_m;
  const double even = j * pitch;
  if (options_.style == StreetStyle::grid || j == 0 || j == options_.blocks_y) return even;
  Random random(options_.seed, {0x52, j});
  return even + pitch * random.range(-0.12, 0.12);
}

PlanRect CityPlan::cell(uint32_t x, uint32_t y) const {
  return {{cut_x(x, y), cut_y(y)}, {cut_x(x + 1, y), cut_y(y + 1)}};
}

PlanRect CityPlan::block(uint32_t x, uint32_t y) const { return cell(x, y).inset(options_.street_width_m / 2); }

glm::dvec2 CityPlan::world(const glm::dvec2& plan) const {
  const glm::dvec2 p = plan - size() * 0.5;
  if (options_.style == StreetStyle::grid) return p;
  glm::dvec2 result = p;
  for (const Wave& wave : waves_) result += wave.amplitude * std::sin(glm::dot(wave.number, p) + wave.phase);
  return result;
}

std::vector<glm::dvec2> CityPlan::joint(const glm::dvec2& from, const glm::dvec2& to) const {
  const bool across = from.y == to.y;
  const double a = across ? from.x : from.y, b = across ? to.x : to.y;
  const auto at = [&](double t) { return across ? glm::dvec2(t, from.y) : glm::dvec2(from.x, t); };
  // An end between two cuts lies on the chord that the neighbour draws between them.
  const auto on_chord = [&](double t) {
    const double low = std::floor(t / kJointStepM) * kJointStepM;
    return glm::mix(world(at(low)), world(at(low + kJointStepM)), (t - low) / kJointStepM);
  };
  std::vector<glm::dvec2> points = {on_chord(std::min(a, b))};
  for (double t = (std::floor(std::min(a, b) / kJointStepM) + 1) * kJointStepM; t < std::max(a, b) - 1e-9;
       t += kJointStepM)
    points.push_back(world(at(t)));
  points.push_back(on_chord(std::max(a, b)));
  if (a > b) std::reverse(points.begin(), points.end());
  return points;
}

std::vector<glm::dvec2> CityPlan::line(const glm::dvec2& from, const glm::dvec2& to, double step_m) const {
  const auto count = static_cast<size_t>(std::max(1.0, std::ceil(glm::distance(from, to) / step_m)));
  std::vector<glm::dvec2> points(count + 1);
  for (size_t i = 0; i <= count; ++i)
    points[i] = world(glm::mix(from, to, static_cast<double>(i) / static_cast<double>(count)));
  return points;
}

glm::dvec2 CityPlan::direction(const glm::dvec2& plan, const glm::dvec2& way) const {
  const glm::dvec2 step = glm::normalize(way) * 0.25;
  return glm::normalize(world(plan + step) - world(plan - step));
}

}  // namespace promenade
