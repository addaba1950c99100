#pragma once
// Disjoint parts of a mesh, and how far each lies from what would remain without it.

#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "geometry/closest_point.h"
#include "preprocess/work_mesh.h"

namespace promenade {

/// Parts are sets of triangles that share places, numbered in order of their first triangle.
///
/// Taking a part away moves no surface but leaves the part's own points without any: the cost is their distance to what
/// remains. A later removal may take away what they were near, so the points of a removed part are handed to the part
/// that they are nearest to, and count when that one's turn comes.
class Parts {
 public:
  explicit Parts(const WorkMesh& work);

  uint32_t count() const { return static_cast<uint32_t>(points_.size()); }
  uint32_t remaining() const { return remaining_; }
  bool removed(uint32_t part) const { return hidden_[part] != 0; }
  uint32_t of_place(uint32_t place) const { return part_of_place_[place]; }

  /// Distance in metres, at most: a quick lower estimate of removal_cost.
  float least_removal_cost(uint32_t part);

  /// Largest distance of the points that only this part represents to the parts that remain. Infinite for the last
  /// part.
  float removal_cost(uint32_t part);

  /// Takes the part away. The caller kills its triangles.
  void remove(uint32_t part);

  /// The triangles of a part, as the work mesh numbers them.
  const std::vector<uint32_t>& triangles(uint32_t part) const { return triangles_[part]; }

 private:
  float cost_of_points(uint32_t part, size_t stride);

  ClosestPointTree tree_;  // of the whole, as it was in the beginning
  std::vector<uint32_t> part_of_place_;
  std::vector<uint32_t> part_of_triangle_;
  std::vector<std::vector<glm::vec3>> points_;  // of each part, inherited ones included
  std::vector<std::vector<uint32_t>> triangles_;
  std::vector<uint8_t> hidden_;
  uint32_t remaining_ = 0;
};

}  // namespace promenade
