#pragma once
// Where a source is divided into chunks: k-d planes found from a sample of its triangles.

#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "geometry/box.h"
#include "preprocess/level_factors.h"

namespace promenade {

/// One triangle out of many: all have the same chance, whatever the source's size or order.
struct TriangleSample {
  glm::dvec3 centroid{0};  ///< metres, in the world
  float edge_m = 0;        ///< longest edge
  float area_m2 = 0;
  uint64_t priority = 0;  ///< the smaller stay
};

/// A tree of planes that ends in chunks, and the tree of nodes above the chunks that follows from it.
struct ChunkTree {
  /// A reference with this bit names a chunk, one without it a plane (or a branch).
  static constexpr uint32_t kChunk = 0x80000000U;
  static constexpr int32_t kByTurns = 3;  ///< no plane divides the triangles: every other one goes either way

  struct Plane {
    int32_t axis = 0;  ///< 0, 1, 2 or kByTurns
    float value = 0;   ///< model space
    uint32_t below = 0, above = 0;
  };
  /// A node above the chunks.
  struct Branch {
    std::vector<uint32_t> children;
  };
  std::vector<Plane> planes;
  uint32_t first_plane = kChunk;
  std::vector<Branch> branches;
  uint32_t root = kChunk;
  std::vector<Box> chunk_cells;
  float cut_step_m = 0;  ///< of the lattice that large triangles are cut along; planes lie on it where they can
  uint32_t chunks() const { return static_cast<uint32_t>(chunk_cells.size()); }
};

/// The cell of a tree's root: everything.
Box unbounded_cell();

struct ChunkTreeOptions {
  uint64_t triangles = 0;        ///< of the source
  uint32_t chunk_triangles = 0;  ///< a chunk's limit, which holds on average
  uint32_t node_triangles = 0;
  LevelFactors level_factors;
  glm::dvec3 origin{0};
};

/// samples: any order (they are reordered); at least one. Deterministic. One thread.
ChunkTree divide_into_chunks(std::vector<TriangleSample>& samples, const ChunkTreeOptions& options);

/// A multiple of the lattice's step near a value; the value itself without a lattice.
float on_lattice(float value, float step_m);

}  // namespace promenade
