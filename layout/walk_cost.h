#pragma once
// What a whole walk reads when nodes stay in memory while there is room: those it wanted before, and those that lay
// between wanted ones and were read with them.

#include <cstdint>
#include <span>
#include <vector>

#include "layout/read_cost.h"

namespace promenade {

struct WalkOptions {
  StorageProfile profile;
  double least_useful = 0;  ///< see merge_reads
  /// Stored bytes of the nodes in memory; what a visit wants is there even if it takes more. More: less is read twice.
  uint64_t memory_bytes = 0;
};

struct WalkCost {
  ReadPlan start;      ///< for the first visit
  ReadPlan steps;      ///< for all others together
  uint64_t taken = 0;  ///< so many steps
  /// Of all bytes that were read, the start's too, those of nodes that some visit wanted while they were in memory.
  /// Both plans' useful_bytes count only what their own visits wanted at once.
  double useful_share = 1;
};

/// wanted: by visit, the places of the nodes that must be in memory, ascending. What was wanted longest ago goes first
/// when room is needed. Pure.
WalkCost walk_cost(const NodeLayout& layout, std::span<const std::vector<uint32_t>> wanted, const WalkOptions& options);

}  // namespace promenade
