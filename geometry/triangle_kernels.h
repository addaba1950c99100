#pragma once
// The inner loops of closest-point queries, eight triangles or boxes at a time. The processor's vectors decide which of
// two compilations of the same code runs (as in raster/); both give the same bits.

#include <cstddef>
#include <cstdint>

namespace promenade {

constexpr size_t kLanes = 8;

/// Eight triangles, each in its own frame: origin at a corner, x along an edge (length `base`), y across it towards the
/// apex (apex_x, apex_y >= 0), z along the normal.
struct alignas(32) TriangleFrames {
  float origin_x[kLanes], origin_y[kLanes], origin_z[kLanes];
  float x_x[kLanes], x_y[kLanes], x_z[kLanes];
  float y_x[kLanes], y_y[kLanes], y_z[kLanes];
  float z_x[kLanes], z_y[kLanes], z_z[kLanes];
  float base[kLanes], apex_x[kLanes], apex_y[kLanes];
  float inverse_left2[kLanes];   ///< 1 / squared length of the edge origin-apex, 0 if it has none
  float inverse_right2[kLanes];  ///< of the edge base-apex
};

/// The corners of eight triangles.
struct alignas(32) TriangleCorners {
  float at[3][3][kLanes];  ///< by corner, axis, triangle
};

/// Eight points.
struct alignas(32) PointLanes {
  float x[kLanes], y[kLanes], z[kLanes];
};

/// Eight children's boxes; unused ones are empty (infinitely far away).
struct alignas(32) BoxTreeNode {
  static constexpr uint32_t kLeafBit = 1U << 31U;
  float min_x[kLanes], min_y[kLanes], min_z[kLanes];
  float max_x[kLanes], max_y[kLanes], max_z[kLanes];
  uint32_t child[kLanes];   ///< a node, or kLeafBit | first block
  uint32_t blocks[kLanes];  ///< of a leaf
};

/// Eight triangles of a leaf; spare lanes repeat the last one.
struct alignas(32) TriangleBlock : TriangleFrames {
  uint32_t triangle[kLanes];
  uint32_t turn[kLanes];  ///< which corner of the triangle the origin is
};

/// A search in a tree: what is looked for, and the nearest triangle so far.
struct TreeSearch {
  const BoxTreeNode* nodes;  ///< the first is the root
  const TriangleBlock* blocks;
  float point[3];
  float enough_distance2;             ///< stop when the nearest so far is no farther
  const uint32_t* group_of_triangle;  ///< null: all are visible
  const uint8_t* group_hidden;
  float distance2;  ///< in and out
  uint32_t triangle;
};

struct TriangleKernels {
  /// The first of the triangles nearest to a point, by its place among the lanes; groups > 0.
  uint32_t (*nearest)(const TriangleFrames* frames, size_t groups, const float* point, float& distance2);
  /// Squared distances of a point to eight triangles. distances2: aligned to 32 bytes.
  void (*distances)(const TriangleFrames& frames, const float* point, float* distances2);
  /// Squared distances of eight points to one of the triangles: the same bits as `distances` gives for each of them.
  void (*distances_of)(const TriangleFrames& frames, size_t triangle, const PointLanes& points, float* distances2);
  /// Frames along the first edge of each triangle, in single precision. Degenerate triangles are segments.
  void (*make_frames)(const TriangleCorners* corners, size_t groups, TriangleFrames* frames);
  /// Goes on with a search until nothing nearer is left, or it is near enough.
  void (*search)(TreeSearch& search);
};

/// The fastest that this processor runs.
const TriangleKernels& triangle_kernels();

/// For every processor, and for tests.
const TriangleKernels& portable_triangle_kernels();
/// For those that have AVX2 only; the portable ones where they could not be compiled.
const TriangleKernels& avx2_triangle_kernels();

}  // namespace promenade
