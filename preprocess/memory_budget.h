#pragma once
// How a build divides its memory: everything that grows with the model gets its share before the work starts.

#include <cstdint>

#include "geometry/result.h"

namespace promenade {

/// Shares in bytes unless they say otherwise. chunk_triangles and samples affect the model's bytes, so they depend on
/// `memory_bytes` alone (in powers of two), never on the number of threads.
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

/// Errors: less than 256 MiB, or nodes so large that building one does not fit.
/// jobs: 0 for as many as cores.
Result<MemoryBudget> plan_memory(uint64_t memory_bytes, uint32_t jobs, uint32_t node_triangles, uint32_t level_factor);

}  // namespace promenade
