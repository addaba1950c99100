#pragma once
// A rectangle of a wall, asked at the points of a grid: covered or not; and the rectangles of what is not.

#include <cstdint>
#include <glm/vec2.hpp>
#include <vector>

namespace promenade {

/// One side of a wall: which points of a grid over a rectangle some triangle covers.
class WallMask {
 public:
  /// The grid is at most step_m fine and never has more than kMostPoints along a side. Its outermost points stand
  /// kSealM inside the rectangle: what does not reach the border by less than that is taken to reach it.
  WallMask(const glm::dvec2& low, const glm::dvec2& high, double step_m);
  static constexpr uint32_t kMostPoints = 4096;
  static constexpr double kSealM = 0.004;

  static uint64_t points_of(const glm::dvec2& low, const glm::dvec2& high, double step_m);

  /// Points within a triangle, or a millimetre beside it, are covered. Any winding.
  void cover(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c);

  struct Opening {
    glm::dvec2 low, high;
  };
  /// All of the rectangle is within one of these or within four covered points of the grid. At most so many: beyond,
  /// some are united with what lies between them.
  std::vector<Opening> openings(size_t most) const;

 private:
  struct Axis {
    double first = 0, step = 1;
    uint32_t points = 2;
    double at(uint32_t i) const { return first + step * i; }
  };
  static Axis axis_of(double low, double high, double step_m);
  bool covered(uint32_t x, uint32_t y) const { return bits_[size_t(y) * x_.points + x]; }
  bool open_square(uint32_t x, uint32_t y) const {
    return !(covered(x, y) && covered(x + 1, y) && covered(x, y + 1) && covered(x + 1, y + 1));
  }

  glm::dvec2 low_, high_;
  Axis x_, y_;
  std::vector<bool> bits_;
};

}  // namespace promenade
