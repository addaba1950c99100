#include "preprocess/memory_budget.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <thread>

#include "preprocess/node_builder.h"

namespace promenade {

namespace {

constexpr uint64_t kMiB = uint64_t(1) << 20;
constexpr uint64_t kLeastMemory = 256 * kMiB;
constexpr uint64_t kProgram =
    96 * kMiB;  // measured: libraries, thread stacks and the allocator's slack of an idle build
// A chunk's triangle while the chunk is in work: spilled block, mesh, centroid and lists, encoded nodes with their
// slack.
constexpr uint64_t kChunkTriangle = 400;
constexpr uint64_t kNodeTriangle =
    1200;  // of the children's, while a node is made: copies, quadrics, trees for measuring
// Of what a node is measured against: positions, a tree over them and the distances found.
constexpr uint64_t kReferenceTriangle = 150;
constexpr uint64_t kSample = 40;
constexpr uint32_t kLeastChunk = 1U << 14, kMostChunk = 1U << 20;
constexpr uint32_t kMostSamples = 1U << 22;  // two per mille of error at a chunk of a billion triangles' model

}  // namespace

Result<MemoryBudget> plan_memory(const MemoryWishes& wishes) {
  if (wishes.memory_bytes < kLeastMemory)
    return Error{fmt::format("--memory {} MiB is too little to build with; give at least {} MiB",
                             wishes.memory_bytes / kMiB, kLeastMemory / kMiB)};
  const auto needs = [&](const std::string& what, uint64_t bytes) {
    return Error{fmt::format("{} needs --memory {} MiB, given {} MiB", what, (bytes + kProgram) / kMiB + 1,
                             wishes.memory_bytes / kMiB)};
  };
  MemoryBudget budget;
  budget.memory_bytes = wishes.memory_bytes;
  const uint64_t free = wishes.memory_bytes - kProgram;
  // Half as many children again as a level's factor says: see LeafShares.
  const uint64_t node = uint64_t(wishes.node_triangles) *
                        (wishes.level_factors.largest() * kNodeTriangle * 3 / 2 + kReferenceNodes * kReferenceTriangle);
  if (node > free / 4)
    return needs(fmt::format("a level factor of {} with nodes of {} triangles", wishes.level_factors.largest(),
                             wishes.node_triangles),
                 4 * node);
  const uint32_t jobs = wishes.jobs != 0 ? wishes.jobs : std::max(1U, std::thread::hardware_concurrency());
  budget.jobs = static_cast<uint32_t>(std::min<uint64_t>(jobs, free / 4 / node));

  const uint64_t chunk = std::clamp<uint64_t>(free / 8 / kChunkTriangle, kLeastChunk, kMostChunk);
  budget.chunk_triangles = wishes.chunk_triangles != 0
                               ? wishes.chunk_triangles
                               : std::max(static_cast<uint32_t>(std::bit_floor(chunk)), 2 * wishes.node_triangles);
  const uint64_t chunk_bytes = uint64_t(budget.chunk_triangles) * kChunkTriangle;
  if (chunk_bytes > free / 2)
    return needs(fmt::format("a chunk of {} triangles", budget.chunk_triangles), 2 * chunk_bytes);
  budget.chunk_slots = static_cast<uint32_t>(std::clamp<uint64_t>(free / 2 / chunk_bytes, 1, budget.jobs));
  budget.samples =
      static_cast<uint32_t>(std::bit_floor(std::clamp<uint64_t>(free / 16 / kSample, 1U << 12, kMostSamples)));
  budget.scenes = free / 2;
  budget.spill_buffers = free / 8;
  budget.textures = free / 8;
  return budget;
}

}  // namespace promenade
