#pragma once
// Columns in the order of a short tour in the Hamming metric, so that rows have few runs. Source: [chhugani2003]
// section 3; D. S. Johnson and L. A. McGeoch, The traveling salesman problem: a case study, 1997.

#include <cstdint>
#include <functional>

#include "layout/incidence.h"
#include "layout/order_neighbours.h"

namespace promenade {

/// What 2-opt and Or-opt start from.
enum class TourSeed : uint8_t {
  greedy,  ///< shortest edges between near neighbours first, as published
  /// Recursive bisection, whose halves keep together what is read together at every scale. With short turns only, which
  /// leave that alone, the tour has about as few runs, and steps read from a disk in half the time.
  bisection,
  best,  ///< both: the one with fewer runs, but the second also with up to 3 % more
};

struct TourOptions {
  explicit TourOptions(TourSeed from = TourSeed::best) : seed(from) {}
  TourSeed seed;
  NeighbourOptions neighbours;
  uint32_t passes = 8;  ///< of 2-opt and Or-opt over all columns, at most. Each takes time in proportion to them
};

/// What the parts took and gained; of the two tours that are tried, the one that was chosen, its times alone.
struct TourFigures {
  double neighbours_s = 0, seed_s = 0, improve_s = 0;
  uint64_t distinct_columns = 0;  ///< columns that are equal stand together from the beginning
  uint64_t runs_of_seed = 0, runs_after_pass_1 = 0, runs = 0;
  uint32_t passes = 0;
};

/// A seed, improved by 2-opt and Or-opt with lists of near neighbours. Deterministic, whatever the number of threads.
ColumnOrder tour_order(const Incidence& matrix, const TourOptions& options, TourFigures* figures = nullptr);

/// Where the near neighbours of a matrix' distinct columns come from, when not from near_columns: from work units.
using NearSource =
    std::function<Result<NeighbourLists>(std::span<const uint32_t> among, const NeighbourOptions& options)>;
/// The same with neighbours from elsewhere. Errors: the source's.
Result<ColumnOrder> tour_order(const Incidence& matrix, const TourOptions& options, const NearSource& near_source,
                               TourFigures* figures = nullptr);

/// A lower bound on the runs of any order: half the length of the best 1-tree over the distinct columns and an empty
/// one, after `steps` of the subgradient method (M. Held and R. M. Karp, 1971). Time in proportion to the square of
/// the distinct columns. 0: more than most_columns of these.
uint64_t lower_bound_of_runs(const Incidence& matrix, uint32_t steps = 30, uint32_t most_columns = 3000);

}  // namespace promenade
