#pragma once
// The closest point of a mesh's surface to a point in space, found in a tree of boxes.

#include <cstdint>
#include <glm/vec3.hpp>
#include <limits>
#include <span>
#include <vector>

#include "geometry/box.h"
#include "geometry/mesh.h"
#include "geometry/triangle_kernels.h"

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

  /// The same for several points at once, eight at a time. distances2_m2: as many.
  void distances2_to(uint32_t triangle, std::span<const glm::vec3> points, float* distances2_m2) const;

  /// The closest point of one triangle.
  ClosestPoint closest_on(uint32_t triangle, const glm::vec3& p) const;

 private:
  static constexpr uint32_t kLeafSize = 16;  // triangles a leaf: measured, see bench_closest_point

  struct Builder;

  std::vector<BoxTreeNode> nodes_;
  std::vector<TriangleBlock> blocks_;  // in frames along the longest edges, computed in double: slivers have good ones
  std::vector<uint32_t> slot_of_triangle_;  // block * kLanes + lane
  Box bounds_;
};

}  // namespace promenade
