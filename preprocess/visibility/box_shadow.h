#pragma once
// What a solid box hides from a whole cell: the box's umbra, which for two boxes is exactly a set of half-spaces.
// Source: [chhugani2003] sections 5.1, 5.2: the shadow frustum of supporting planes.

#include <array>
#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <span>

#include "geometry/box.h"

namespace promenade {

/// All x with dot(normal, x) <= offset.
struct HalfSpace {
  glm::dvec3 normal{0};
  double offset = 0;
  bool holds(const glm::dvec3& x) const { return glm::dot(normal, x) <= offset; }
};

/// What lies in all of sides() and fronts() cannot be seen from anywhere in the cell.
class BoxShadow {
 public:
  static constexpr size_t kMostSides = 24;  // eight edges in each of three plans

  /// A cell that may be flat and a solid box apart from it.
  BoxShadow(const Box& cell, const Box& solid);

  /// Bounded by planes that touch both boxes, which lie in them. Their normals are across one axis, at least.
  std::span<const HalfSpace> sides() const { return {sides_.data(), side_count_}; }
  /// Beyond the planes of those faces of the solid box that are seen from some point of the cell.
  std::span<const HalfSpace> fronts() const { return {fronts_.data(), front_count_}; }
  /// From such a point the box may stand for itself, shrunk by planes through the point along the sides.
  bool may_be_seen_from(const glm::dvec3& eye) const;

 private:
  void add_sides(const Box& cell, const Box& solid, int across);

  std::array<HalfSpace, kMostSides> sides_;
  std::array<HalfSpace, 6> fronts_;
  uint32_t side_count_ = 0, front_count_ = 0;
};

}  // namespace promenade
