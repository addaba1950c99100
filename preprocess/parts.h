#pragma once
// Disjoint parts of a mesh, and how far points lie from what would remain without one.

#include <cstdint>
#include <functional>
#include <glm/vec3.hpp>
#include <optional>
#include <vector>

#include "geometry/closest_point.h"
#include "preprocess/work_mesh.h"

namespace promenade {

/// Parts are sets of triangles that share places, numbered in order of their first triangle; then come copies of them,
/// which are not in the work mesh, by original. Those that are not alive in the beginning are never what others are
/// near to, but their own removal can be asked about. Distances are to the parts as they were in the beginning, those
/// not removed: collapses meanwhile move them by less than anything still in the queue would cost.
class Parts {
 public:
  /// The work mesh must outlive it. offsets_of: of the copies of the part that a triangle is in, from it; unset: none.
  explicit Parts(const WorkMesh& work, const std::function<std::vector<glm::vec3>(uint32_t triangle)>& offsets_of = {});

  uint32_t count() const { return static_cast<uint32_t>(copies_.size()); }
  uint32_t originals() const { return static_cast<uint32_t>(triangles_.size()); }
  /// An original.
  uint32_t of_place(uint32_t place) const { return part_of_place_[place]; }
  /// Of a part; an original's is itself.
  uint32_t original_of(uint32_t part) const { return copies_[part].original; }
  /// Of a part from its original.
  const glm::vec3& offset(uint32_t part) const { return copies_[part].offset; }
  /// The copies of an original: so many parts, from this one on.
  uint32_t first_copy(uint32_t original) const { return first_copy_[original]; }
  uint32_t copies(uint32_t original) const { return first_copy_[original + 1] - first_copy_[original]; }
  /// The triangles of a part's original, as the work mesh numbers them.
  const std::vector<uint32_t>& triangles(uint32_t part) const { return triangles_[original_of(part)]; }

  /// Of a triangle beside a point.
  struct Beside {
    uint32_t corner;         ///< the nearest to the point, as the work mesh numbers them
    uint32_t part;           ///< whose it is: where it lies is that corner and the part's offset
    uint32_t tree_triangle;  ///< where to begin to look again
  };

  /// Distance of one of a part's places to the parts that remain without it; infinite where none does. Within the limit
  /// that of any triangle that near.
  float first_look(uint32_t part, float limit_m);
  bool looked_at(uint32_t part) const { return looked_at_[part] != 0; }

  /// Largest distance of the points to the parts that remain without `part`; infinite where none does. Where that is
  /// over the limit only some points are looked at: the largest distance of those. beside: for each point, where no
  /// more than the limit is returned, a triangle as near as that. After first_look.
  float removal_cost(uint32_t part, const std::vector<glm::vec3>& points, float limit_m, std::vector<Beside>& beside);

  void remove(uint32_t part);

  /// A corner, as the work mesh numbers them, of the triangle nearest to a point among the parts that remain without
  /// `part`; kNone where none does. near: in and out, the tree's triangle found for a neighbouring point.
  uint32_t nearest_corner_besides(uint32_t part, const glm::vec3& point, uint32_t& near);

  /// How far a point lies in front of the triangle nearest to it among the parts that remain without `part`, as it was;
  /// nullopt where that does not face along `normal`, or there is none.
  std::optional<float> height_besides(uint32_t part, const glm::vec3& point, const glm::vec3& normal);

 private:
  uint32_t nearest_besides(uint32_t part, const glm::vec3& point, uint32_t hint = kNoTriangle);
  void build_tree();
  /// The corner of a triangle of the tree that is nearest to a point.
  uint32_t corner_of(uint32_t tree_triangle, const glm::vec3& point) const;

  struct Copy {
    uint32_t original;
    glm::vec3 offset;
  };
  const std::vector<glm::vec3>& positions_;
  std::vector<uint32_t> indices_;  // as in the beginning
  std::vector<uint32_t> part_of_place_;
  std::vector<std::vector<uint32_t>> triangles_;  // of each original
  std::vector<Copy> copies_;                      // all parts
  std::vector<uint32_t> first_copy_;              // of each original, and the number of all parts
  std::vector<uint8_t> hidden_;
  std::vector<uint8_t> looked_at_;
  std::vector<glm::vec3> farthest_;  // of each part: the farthest point that the last look found
  uint32_t remaining_ = 0;

  // The tree has the triangles that remained when it was built: hidden ones cost time, so it is built anew when half
  // are.
  ClosestPointTree tree_;
  std::vector<uint32_t> tree_triangles_;  // their originals
  std::vector<uint32_t> part_of_tree_triangle_;
  size_t hidden_in_tree_ = 0;
};

}  // namespace promenade
