#pragma once
// Parts of a surface that are one another moved, such as windows, lamps and studs: one stands for all of them.

#include <cstdint>
#include <functional>
#include <glm/vec3.hpp>
#include <vector>

#include "preprocess/work_mesh.h"

namespace promenade {

/// What has been taken out of a work mesh because something in it is the same, moved. Of each class of such parts an
/// original remains, whose triangles stand for all of them (WorkMesh::alive).
struct Twins {
  static constexpr uint32_t kNone = 0xffffffffU;
  struct Copy {
    glm::vec3 offset{0};        ///< from the original
    uint32_t first_vertex = 0;  ///< of `vertices`: as many as the original has, in its order
  };

  std::vector<uint32_t> class_of_triangle;  ///< of each triangle of the work mesh; kNone: it has no copy
  std::vector<uint32_t> first_copy;         ///< of each class, and the number of all copies
  std::vector<Copy> copies;                 ///< by class
  std::vector<uint32_t> vertices;           ///< of the source, by copy
  std::vector<uint32_t> local;              ///< of each vertex of an original: its number in the lists of its copies

  uint32_t copies_of(uint32_t its_class) const { return first_copy[its_class + 1] - first_copy[its_class]; }
  /// The vertex of a copy that an original's vertex stands for.
  uint32_t vertex_of(uint32_t copy, uint32_t vertex) const {
    return vertices[copies[copy].first_vertex + local[vertex]];
  }
};

/// Takes parts (triangles that share places) out of the work mesh that are others moved: as many triangles, their
/// corners in the same order, the same materials, colours, normals and texture coordinates, and each vertex within what
/// rounding may have moved it of where the move leads. Parts with a place that stays_alone, such as one on the border,
/// are neither originals nor copies. Numbers what remains anew, in the same order. Nothing collapsed yet.
/// Deterministic. Linear time but for many parts that differ in nothing but their shapes. Any thread.
Twins take_twins(WorkMesh& work, const Mesh& source, const std::function<bool(uint32_t place)>& stays_alone);

}  // namespace promenade
