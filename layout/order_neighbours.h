#pragma once
// Columns that are near each other in the Hamming metric, without comparing all with all.

#include <cstdint>
#include <span>
#include <vector>

#include "layout/incidence.h"

namespace promenade {

struct NeighbourOptions {
  uint32_t count = 10;       ///< neighbours a column. More: better tours, more time ([chhugani2003] uses 20)
  uint32_t rounds = 8;       ///< random orders of rows by which columns are sorted. More: nearer neighbours, more time
  uint32_t window = 5;       ///< columns on each side in a sorted order that are compared
  uint32_t refinements = 1;  ///< times that the neighbours of neighbours are compared as well
};

struct Neighbour {
  uint32_t distance = 0;
  uint32_t column = 0;
  auto operator<=>(const Neighbour&) const = default;
};

/// By column: up to count neighbours, nearest first, ties by number. `among`: the columns that take part.
struct NeighbourLists {
  std::vector<uint64_t> first;  ///< by place in `among`, and one more
  std::vector<Neighbour> all;   ///< columns as places in `among`
  std::span<const Neighbour> of(uint32_t i) const { return std::span(all).subspan(first[i], first[i + 1] - first[i]); }
};

/// Columns are sorted by the first rows in which they have ones, for several random orders of the rows: columns that
/// share most of their rows come to stand near each other in one of them (min-wise hashing: A. Z. Broder, On the
/// resemblance and containment of documents, 1997). Then neighbours of neighbours (W. Dong et al., NN-descent, 2011). n
/// log n. Deterministic, whatever the number of threads; runs on the threads of the arena.
NeighbourLists near_columns(const Incidence& matrix, std::span<const uint32_t> among, const NeighbourOptions& options);

/// The same in parts, one for each of options.rounds, that several machines may make: what is found by one random order
/// of the rows; and all of it from the parts of all rounds, the same as at once.
NeighbourLists near_columns_of_round(const Incidence& matrix, std::span<const uint32_t> among,
                                     const NeighbourOptions& options, uint32_t round);
NeighbourLists near_columns_of_parts(const Incidence& matrix, std::span<const uint32_t> among,
                                     const NeighbourOptions& options, std::span<const NeighbourLists> parts);

}  // namespace promenade
