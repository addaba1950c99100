// Why the half-spaces are enough. Let x lie in all of them and e in the cell. What the solid box hides from e is
// convex: bounded by planes through e and an edge of the box's outline, and by the faces that e sees. The latter are
// fronts. An outline's edge lies between a face that e sees and one that it does not. Where the whole cell is on the
// inner side of the second, the plane through the edge that touches the cell, with box and cell on one side, is a side;
// x, inside of it and beyond the first face, is inside of the plane through e too. Where a part of the cell sees the
// second face, that face is a front.
//
// Planes through an edge along an axis that touch a box along the same axes contain one of that box's edges along that
// axis: so all sides are found in the three plans along the axes, as the edges between the two rectangles in the
// outline of both together.

#include "preprocess/visibility/box_shadow.h"

#include <algorithm>
#include <cmath>
#include <glm/vec2.hpp>

namespace promenade {
namespace {

constexpr double kTouches = 1e-9;  // of the boxes' size: a plane so near to a box is taken to touch it
using Corners = std::array<glm::dvec2, 4>;

Corners corners_of(const Box& box, int u, int v) {
  const glm::dvec2 low(box.min[u], box.min[v]), high(box.max[u], box.max[v]);
  return {low, glm::dvec2(high.x, low.y), high, glm::dvec2(low.x, high.y)};
}

double farthest(const Corners& corners, const glm::dvec2& way) {
  double most = glm::dot(corners[0], way);
  for (const glm::dvec2& corner : corners) most = std::max(most, glm::dot(corner, way));
  return most;
}

/// The outline of points, anticlockwise; how many corners it has.
size_t outline_of(std::array<glm::dvec2, 8> points, std::array<glm::dvec2, 17>& outline) {
  std::sort(points.begin(), points.end(),
            [](const glm::dvec2& a, const glm::dvec2& b) { return a.x < b.x || (a.x == b.x && a.y < b.y); });
  size_t count = 0;
  const auto add = [&](const glm::dvec2& p, size_t fixed) {
    for (; count > fixed; --count) {
      const glm::dvec2 a = outline[count - 1] - outline[count - 2], b = p - outline[count - 1];
      if (a.x * b.y - a.y * b.x > 0) break;
    }
    outline[count++] = p;
  };
  for (const glm::dvec2& p : points) add(p, 1);
  const size_t lower = count;
  for (size_t i = points.size() - 1; i-- > 0;) add(points[i], lower);
  return count - 1;  // the last is the first
}

}  // namespace

BoxShadow::BoxShadow(const Box& cell, const Box& solid) {
  for (int axis = 0; axis < 3; ++axis) {
    add_sides(cell, solid, axis);
    glm::dvec3 way(0);
    way[axis] = 1;
    if (cell.max[axis] > solid.max[axis]) fronts_[front_count_++] = {way, double(solid.max[axis])};
    if (cell.min[axis] < solid.min[axis]) fronts_[front_count_++] = {-way, -double(solid.min[axis])};
  }
}

void BoxShadow::add_sides(const Box& cell, const Box& solid, int across) {
  const int u = (across + 1) % 3, v = (across + 2) % 3;
  const Corners of_cell = corners_of(cell, u, v), of_solid = corners_of(solid, u, v);
  std::array<glm::dvec2, 8> points;
  std::copy(of_solid.begin(), of_solid.end(), std::copy(of_cell.begin(), of_cell.end(), points.begin()));
  std::array<glm::dvec2, 17> outline;
  const size_t count = outline_of(points, outline);
  for (size_t i = 0; i < count; ++i) {
    const glm::dvec2 along = outline[i + 1] - outline[i];
    const double length = glm::length(along);
    if (!(length > 0)) continue;
    const glm::dvec2 out = glm::dvec2(along.y, -along.x) / length;
    const double to_cell = farthest(of_cell, out), to_solid = farthest(of_solid, out);
    const double scale = std::abs(to_cell) + std::abs(to_solid) + length;
    if (std::abs(to_cell - to_solid) > kTouches * scale) continue;
    HalfSpace& side = sides_[side_count_++];
    side.normal[u] = out.x, side.normal[v] = out.y;
    side.offset = std::min(to_cell, to_solid);
  }
}

bool BoxShadow::may_be_seen_from(const glm::dvec3& eye) const {
  return std::all_of(sides().begin(), sides().end(), [&](const HalfSpace& side) { return side.holds(eye); });
}

}  // namespace promenade
