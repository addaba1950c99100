#pragma once
// Where the city's streets run: a plane in which they are straight, and its way into the world.

#include <array>
#include <glm/vec2.hpp>
#include <vector>

#include "datasets/city.h"
#include "geometry/random.h"

namespace promenade {

/// A rectangle of the plan.
struct PlanRect {
  glm::dvec2 low{0}, high{0};
  glm::dvec2 size() const { return high - low; }
  PlanRect inset(double by) const { return {low + by, high - by}; }
};

/// The street plan. Pure; any thread. In the plan, streets are the lines between cells: a cell is a block and the near
/// halves of the streets around it. `grid` shows the plan as it is. `organic` bends it, and gives each row of cells its
/// own cross streets, so that they meet the long streets in T-junctions.
class CityPlan {
 public:
  explicit CityPlan(const CityOptions& options);  ///< blocks_x, blocks_y > 0

  uint32_t blocks_x() const { return options_.blocks_x; }
  uint32_t blocks_y() const { return options_.blocks_y; }
  const CityOptions& options() const { return options_; }
  glm::dvec2 size() const;

  /// From the middle of a street to the middle of the next one.
  PlanRect cell(uint32_t x, uint32_t y) const;
  /// Within the kerbs.
  PlanRect block(uint32_t x, uint32_t y) const;

  glm::dvec2 world(const glm::dvec2& plan) const;
  /// Points along the line between two points of a street's middle, cut where every other cell cuts it too, so that
  /// cells join without a gap.
  std::vector<glm::dvec2> joint(const glm::dvec2& from, const glm::dvec2& to) const;
  /// Points along any other line, at most step_m apart, both ends included.
  std::vector<glm::dvec2> line(const glm::dvec2& from, const glm::dvec2& to, double step_m) const;
  /// Direction in the world of a direction in the plan; unit.
  glm::dvec2 direction(const glm::dvec2& plan, const glm::dvec2& way) const;

 private:
  double cut_x(uint32_t i, uint32_t row) const;
  double cut_y(uint32_t j) const;

  struct Wave {
    glm::dvec2 number, amplitude;
    double phase;
  };
  CityOptions options_;
  std::array<Wave, 5> waves_{};
};

}  // namespace promenade
