#pragma once
// Segments of the plan and rectangles in it.

#include <algorithm>
#include <glm/vec2.hpp>

#include "geometry/box.h"

namespace promenade {

inline double cross(const glm::dvec2& a, const glm::dvec2& b) { return a.x * b.y - a.y * b.x; }

/// Whether the boxes of a segment and of a rectangle overlap.
inline bool overlaps(const Box& clear, const glm::vec2& a, const glm::vec2& b) {
  return std::min(a.x, b.x) <= clear.max.x && std::max(a.x, b.x) >= clear.min.x && std::min(a.y, b.y) <= clear.max.y &&
         std::max(a.y, b.y) >= clear.min.y;
}

/// Whether the segment comes within the rectangle: the rectangle's corners on both sides of its line, or boxes apart.
inline bool meets(const Box& clear, const glm::vec2& a, const glm::vec2& b) {
  if (!overlaps(clear, a, b)) return false;
  const glm::dvec2 from(a), along = glm::dvec2(b) - from;
  bool left = false, right = false;
  for (unsigned i = 0; i < 4; ++i) {
    const glm::dvec2 corner((i & 1U) != 0 ? clear.max.x : clear.min.x, (i & 2U) != 0 ? clear.max.y : clear.min.y);
    const double side = cross(along, corner - from);
    left |= side >= 0, right |= side <= 0;
  }
  return left && right;
}

}  // namespace promenade
