#include "datasets/city_traffic.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <numeric>

namespace promenade {
namespace {

constexpr double kSpeedMps = 8;
constexpr double kCornerM = 5;         // radius of a turn
constexpr int kCornerSteps = 6;        // a turn is a polygon; the car's middle leaves the arc by 4 cm
constexpr double kStraightStepM = 12;  // streets of organic cities bend

/// Once around, clockwise, in the plan; the last point is the first.
std::vector<glm::dvec2> way_around(const PlanRect& lane) {
  const double radius = std::min({kCornerM, lane.size().x / 3, lane.size().y / 3});
  const PlanRect inner = lane.inset(radius);
  // Corners with the direction that the arc begins at, seen from its middle.
  const struct {
    glm::dvec2 middle;
    double from_rad;
  } corners[] = {{{inner.low.x, inner.high.y}, std::numbers::pi},
                 {inner.high, std::numbers::pi / 2},
                 {{inner.high.x, inner.low.y}, 0},
                 {inner.low, -std::numbers::pi / 2}};
  std::vector<glm::dvec2> points;
  const auto go_to = [&points](const glm::dvec2& to) {
    if (!points.empty()) {
      const glm::dvec2 from = points.back();
      const auto steps = static_cast<int>(std::max(1.0, std::ceil(glm::distance(from, to) / kStraightStepM)));
      for (int i = 1; i < steps; ++i) points.push_back(from + (to - from) * (double(i) / steps));
    }
    points.push_back(to);
  };
  for (const auto& corner : corners)
    for (int i = 0; i <= kCornerSteps; ++i) {
      const double at = corner.from_rad - std::numbers::pi / 2 * i / kCornerSteps;
      go_to(corner.middle + radius * glm::dvec2(std::cos(at), std::sin(at)));
    }
  go_to(glm::dvec2(points.front()));
  return points;
}

/// points: closed. Begins at one of them; a key a point.
NodeMotion motion_along(const std::vector<glm::dvec2>& points, size_t begin, double height_m) {
  NodeMotion motion;
  const size_t count = points.size() - 1;  // the last is the first
  double t_s = 0, yaw_rad = 0;
  for (size_t i = 0; i <= count; ++i) {
    const glm::dvec2 at = points[(begin + i) % count];
    const glm::dvec2 before = points[(begin + i + count - 1) % count], after = points[(begin + i + 1) % count];
    const glm::dvec2 way = glm::normalize(at - before) + glm::normalize(after - at);
    const double heading = std::atan2(way.y, way.x);
    yaw_rad = i == 0 ? heading : yaw_rad + std::remainder(heading - yaw_rad, 2 * std::numbers::pi);
    if (i > 0) t_s += glm::distance(before, at) / kSpeedMps;
    motion.times_s.push_back(static_cast<float>(t_s));
    motion.places.emplace_back(static_cast<float>(at.x), static_cast<float>(at.y), static_cast<float>(height_m));
    motion.yaws_rad.push_back(static_cast<float>(yaw_rad));
  }
  return motion;
}

}  // namespace

std::vector<MovingCar> traffic_of(const CityPlan& plan, uint32_t count, int level) {
  Random random(plan.options().seed, {0xca5});
  std::vector<uint32_t> blocks(size_t(plan.blocks_x()) * plan.blocks_y());
  std::iota(blocks.begin(), blocks.end(), 0U);
  for (size_t i = blocks.size(); i > 1; --i) std::swap(blocks[i - 1], blocks[random.below(static_cast<uint32_t>(i))]);
  const double lane_m = std::min(2.4, plan.options().street_width_m / 4);
  std::vector<MovingCar> cars;
  cars.reserve(count);
  for (uint32_t i = 0; i < count; ++i) {
    const uint32_t block = blocks[i % blocks.size()];
    std::vector<glm::dvec2> points =
        way_around(plan.cell(block % plan.blocks_x(), block / plan.blocks_x()).inset(lane_m));
    for (glm::dvec2& point : points) point = plan.world(point);
    const size_t begin = random.below(static_cast<uint32_t>(points.size() - 1));
    cars.push_back({{PropClass::car, random.below(variants_of(PropClass::car)), level},
                    motion_along(points, begin, plan.options().street_height_m)});
  }
  return cars;
}

}  // namespace promenade
