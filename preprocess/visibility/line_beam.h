#pragma once
// Sets of sight lines: all lines of one sector of directions that touch some boxes, bounded from outside.
//
// In a sector one axis (the main one) is walked fastest, and the signs of all three steps are known. After mirroring, a
// line is p = m t + c and q = n t + d with t along the main axis and slopes in [0, 1]: a point (m, c) and a point
// (n, d). The lines that touch a box in one of the two projections are those between two parallel bounds, so what
// touches many boxes is a convex polygon in each plane. Where all boxes are flat across the main axis (portals), this
// is exact; else it is a superset. Source: [funkhouser1993] section 4.1 stabs axial portals in projections likewise.

#include <array>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "geometry/box.h"

namespace promenade {

/// One of 24 sectors of directions: every direction lies in one of them, or in several.
struct LineSector {
  static constexpr uint32_t kCount = 24;

  int main = 0;          ///< axis
  glm::dvec3 sign{1.0};  ///< of the steps along each axis
  glm::dvec3 origin{0};  ///< what is mirrored about it; near what is looked at, for precision

  /// number: 0 to 23; number / 3 is the octant: bit i set when axis i is walked down.
  LineSector(uint32_t number, const glm::dvec3& about);
  DBox placed(const DBox& box) const;
};

/// Lines x = slope t + offset, as a convex polygon of points (slope, offset); empty when no line is left.
class LinePolygon {
 public:
  static constexpr uint32_t kMostCorners = 20;
  LinePolygon() = default;
  /// The lines with slopes in [0, 1] that touch a rectangle.
  LinePolygon(double t0, double t1, double x0, double x1);

  bool empty() const { return count_ == 0; }
  /// Keeps the lines that touch the rectangle, and perhaps some within a hair of it.
  void keep_touching(double t0, double t1, double x0, double x1);
  bool touches(double t0, double t1, double x0, double x1) const;
  /// Lines of both, and those between them.
  void add(const LinePolygon& other);
  bool contains(const LinePolygon& other) const;
  double area() const;

 private:
  void keep(double t, double x, double side);
  std::array<glm::dvec2, kMostCorners> corners_;  ///< counter-clockwise
  uint32_t count_ = 0;
};

/// A bundle of lines of one sector. Boxes are those that LineSector::placed gives.
class LineBeam {
 public:
  /// The lines that touch the box that they start from.
  LineBeam(const LineSector& sector, const DBox& from);

  bool empty() const { return across_[0].empty() || across_[1].empty(); }
  void keep_touching(const DBox& box);
  bool touches(const DBox& box) const;
  void add(const LineBeam& other);
  bool contains(const LineBeam& other) const;
  double volume() const { return across_[0].area() * across_[1].area(); }

 private:
  int main_;
  std::array<LinePolygon, 2> across_;  ///< along the axis after the main one, and the one after that
};

}  // namespace promenade
