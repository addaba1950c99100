#pragma once
// How a build divides its memory: everything that grows with the model gets its share before the work starts.

#include <cstdint>

#include "geometry/result.h"
#include "preprocess/level_factors.h"

namespace promenade {

/// Shares in bytes unless they say otherwise. chunk_triangles and samples affect the model's bytes, so they depend on
/// `memory_bytes` alone (in powers of two) unless given, never on the number of threads.
struct MemoryBudget {
  uint64_t memory_bytes = 0;
  uint32_t jobs = 1;             ///< threads that work at once
  uint32_t chunk_triangles = 0;  ///< most triangles of a chunk, about
  uint32_t samples = 0;          ///< triangles whose places decide the partition, at most
  uint32_t chunk_slots = 0;      ///< chunks in work at once
  uint64_t scenes = 0;           ///< imported parts held at once
  uint64_t spill_buffers = 0;    ///< triangles on their way to the spill file
  uint64_t textures = 0;         ///< decoded pictures
};

/// As in BuildOptions.
struct MemoryWishes {
  uint64_t memory_bytes = 0;
  uint32_t jobs = 0;  ///< 0: as many as cores
  uint32_t node_triangles = 2250;
  LevelFactors level_factors;
  uint32_t chunk_triangles = 0;  ///< 0: what memory allows
};

/// Errors: less than 256 MiB, or nodes or chunks so large that one does not fit.
Result<MemoryBudget> plan_memory(const MemoryWishes& wishes);

}  // namespace promenade
