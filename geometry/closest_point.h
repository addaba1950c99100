#pragma once
// The closest point of a mesh's surface to a point in space, found in a tree of boxes.

#include <cstdint>
#include <glm/vec3.hpp>
#include <limits>
#include <span>
#include <vector>

#include "geometry/box.h"
#include "geometry/mesh.h"

namespace promenade {

/// Where a surface is nearest to the point asked about. Nothing found within the limit: triangle is kNoTriangle and
/// distance2_m2 the limit given.
struct ClosestPoint {
  float distance2_m2 = std::numeric_limits<float>::infinity();  ///< squared distance
  uint32_t triangle = kNoTriangle;                              ///< index into the mesh's triangles
  glm::vec3 point{0};                                           ///< on that triangle
  glm::vec3 barycentric{0};  ///< weights of the triangle's corners at `point`: each >= 0, sum 1
};

/// Closest-point queries on a triangle soup: a tree of eight boxes a node over leaves of at most 16 triangles, which
/// are stored as structures of arrays in frames of their own, so that boxes and triangles are tested several at a time.
/// Degenerate triangles count as the segment or point that they are.
///
/// Distances are those to real points of the surface within a rounding of at most 2e-6 of (distance + the triangle's
/// longest edge); positions need not be near zero.
/// Immutable once built: any number of threads may query. Holds copies of what it needs, not the mesh.
class ClosestPointTree {
 public:
  /// positions finite; indices in range, a whole number of triangles, possibly none (then nothing is ever found).
  ClosestPointTree(std::span<const glm::vec3> positions, std::span<const uint32_t> indices);
  explicit ClosestPointTree(const Mesh& mesh) : ClosestPointTree(mesh.positions, mesh.indices) {}

  size_t triangle_count() const { return slot_of_triangle_.size(); }
  const Box& bounds() const { return bounds_; }

  /// What a query may be told beforehand. None of it changes the distance that is found.
  struct Limits {
    /// Only surface strictly nearer than this is looked for.
    float max_distance2_m2 = std::numeric_limits<float>::infinity();
    /// A triangle that is likely near, such as the answer for a neighbouring point: tried first.
    uint32_t hint = kNoTriangle;
    /// Good enough: the search may stop at the first triangle found within this, nearest or not. 0: the nearest.
    float enough_distance2_m2 = 0;
    /// Triangles to look through, as if they were not there: those whose group is hidden. Both or neither.
    const uint32_t* group_of_triangle = nullptr;
    const uint8_t* group_hidden = nullptr;
  };

  /// Squared distance and triangle only: the fast query.
  struct Nearest {
    float distance2_m2 = std::numeric_limits<float>::infinity();
    uint32_t triangle = kNoTriangle;
  };
  Nearest nearest(const glm::vec3& p, const Limits& limits) const;
  Nearest nearest(const glm::vec3& p) const { return nearest(p, Limits{}); }

  /// The nearest triangle, and where on it.
  ClosestPoint closest(const glm::vec3& p, const Limits& limits) const;
  ClosestPoint closest(const glm::vec3& p) const { return closest(p, Limits{}); }

  /// Squared distance from p to one triangle.
  float distance2_to(uint32_t triangle, const glm::vec3& p) const;

  /// The closest point of one triangle.
  ClosestPoint closest_on(uint32_t triangle, const glm::vec3& p) const;

 private:
  static constexpr size_t kWidth = 8;        // boxes a node
  static constexpr size_t kLanes = 8;        // triangles a block
  static constexpr uint32_t kLeafSize = 16;  // triangles a leaf: measured, see bench_closest_point
  static constexpr uint32_t kLeafBit = 1U << 31U;

  /// Eight children's boxes; unused ones are empty (infinitely far away).
  struct alignas(16) Node {
    float min_x[kWidth], min_y[kWidth], min_z[kWidth];
    float max_x[kWidth], max_y[kWidth], max_z[kWidth];
    uint32_t child[kWidth];   // a node, or kLeafBit | first block
    uint32_t blocks[kWidth];  // of a leaf
  };

  /// Eight triangles, each in its own frame: origin at a corner, x along the longest edge (length `base`), y across it
  /// towards the apex (apex_x, apex_y), z along the normal. Computed in double, so that slivers have good frames.
  struct alignas(16) Block {
    float origin_x[kLanes], origin_y[kLanes], origin_z[kLanes];
    float x_x[kLanes], x_y[kLanes], x_z[kLanes];
    float y_x[kLanes], y_y[kLanes], y_z[kLanes];
    float z_x[kLanes], z_y[kLanes], z_z[kLanes];
    float base[kLanes], apex_x[kLanes], apex_y[kLanes];
    float inverse_left2[kLanes];   // 1 / squared length of the edge origin-apex, 0 if it has none
    float inverse_right2[kLanes];  // of the edge base-apex
    uint32_t triangle[kLanes];
    uint32_t turn[kLanes];  // which corner of the triangle the origin is
  };

  struct Builder;
  struct Query;
  void search_leaf(uint32_t first, uint32_t blocks, const Query& query, const Limits& limits, Nearest& best) const;

  std::vector<Node> nodes_;
  std::vector<Block> blocks_;
  std::vector<uint32_t> slot_of_triangle_;  // block * kLanes + lane
  Box bounds_;
};

}  // namespace promenade
