#pragma once
// What upright walls hide from a whole cell, as a map: by place of the plan, up to which height nothing is seen.
// Source: [chhugani2003] section 5.1: horizon planes and cull maps; the map is its [WS99].

#include <cstdint>
#include <glm/vec2.hpp>
#include <span>
#include <vector>

#include "geometry/box.h"

namespace promenade {

/// One thread. All roundings go the safe way.
class CullMap {
 public:
  static constexpr uint32_t kSidePx = 512;

  /// Begins a map of a rectangle of the plan for the eyes of a cell. Nothing is hidden.
  void reset(const Box& cell, const glm::vec2& low, const glm::vec2& high);

  /// The shadow of a wall between two points that is solid from the ground up to top_m: beyond its line, between the
  /// upright planes through its ends, below the plane through its top, each of which touches the cell and has cell and
  /// wall on one side. A wall that the cell is on both sides of has none, nor has one that comes within `clear` (a
  /// rectangle of the plan).
  void add_wall(const glm::vec2& a, const glm::vec2& b, float top_m, const Box& clear);
  /// Walls along a polygon, and the widest one through it as seen from the cell, where that lies in it. The polygon is
  /// solid within.
  void add_solid(std::span<const glm::vec2> polygon, float top_m, const Box& clear);

  /// Whether no point of the box is seen from the cell. False where it reaches out of the map.
  bool hides(const Box& box) const;

 private:
  float& at(uint32_t x, uint32_t y) { return heights_[size_t(y) * kSidePx + x]; }

  Box cell_;
  glm::dvec2 low_{0}, pixel_m_{0};
  std::vector<float> heights_;
};

}  // namespace promenade
