// Time of the orders and their parts, on rows that are runs of a hidden order of the columns: [chhugani2003] table 1 on
// such matrices. improvement: runs of the input order over those of the tour.

#include <benchmark/benchmark.h>

#include <algorithm>
#include <numeric>
#include <random>

#include "layout/order.h"
#include "layout/order_landscape.h"
#include "layout/order_rivals.h"

namespace promenade {
namespace {

/// As many rows as columns, each of one to five pieces of the hidden order, a tenth of their ones lost.
Incidence scattered_runs(uint32_t columns) {
  std::mt19937 random(1);
  std::vector<uint32_t> hidden(columns);
  std::iota(hidden.begin(), hidden.end(), 0U);
  for (size_t i = columns; i > 1; --i) std::swap(hidden[i - 1], hidden[random() % i]);
  std::vector<std::vector<uint32_t>> rows(columns);
  for (std::vector<uint32_t>& row : rows) {
    for (size_t pieces = 1 + random() % 5; pieces > 0; --pieces) {
      const size_t begin = random() % columns, end = std::min<size_t>(columns, begin + 1 + random() % 12);
      for (size_t i = begin; i < end; ++i)
        if (random() % 10 != 0) row.push_back(hidden[i]);
    }
    std::sort(row.begin(), row.end());
    row.erase(std::unique(row.begin(), row.end()), row.end());
  }
  return incidence_of(rows, columns);
}

uint64_t runs_of_input(const Incidence& matrix) {
  ColumnOrder order(matrix.columns());
  std::iota(order.begin(), order.end(), 0U);
  return count_runs(matrix, order);
}

void BM_tour(benchmark::State& state, const TourOptions& options) {
  const Incidence matrix = scattered_runs(static_cast<uint32_t>(state.range(0)));
  TourFigures figures;
  for (auto unused : state) benchmark::DoNotOptimize(tour_order(matrix, options, &figures).size());
  const auto input = static_cast<double>(runs_of_input(matrix));
  state.counters["knn_s"] = figures.neighbours_s;
  state.counters["seed_s"] = figures.seed_s;
  state.counters["improve_s"] = figures.improve_s;
  state.counters["improvement_seed"] = input / static_cast<double>(figures.runs_of_seed);
  state.counters["improvement_1"] = input / static_cast<double>(figures.runs_after_pass_1);
  state.counters["improvement"] = input / static_cast<double>(figures.runs);
}
BENCHMARK_CAPTURE(BM_tour, greedy, TourOptions(TourSeed::greedy))
    ->Arg(500)
    ->Arg(1000)
    ->Arg(3000)
    ->Arg(9000)
    ->Arg(27000)
    ->Arg(1000000)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(BM_tour, bisection, TourOptions(TourSeed::bisection))
    ->Arg(9000)
    ->Arg(100000)
    ->Unit(benchmark::kMillisecond);

/// The same for what steps across a landscape bring, whose input order is good already.
void BM_tour_of_landscape(benchmark::State& state) {
  const Incidence matrix = landscape_steps(static_cast<uint32_t>(state.range(0)));
  TourFigures figures;
  for (auto unused : state) benchmark::DoNotOptimize(tour_order(matrix, TourOptions(), &figures).size());
  state.counters["ones"] = static_cast<double>(matrix.ones.size());
  state.counters["improvement"] = static_cast<double>(runs_of_input(matrix)) / static_cast<double>(figures.runs);
}
BENCHMARK(BM_tour_of_landscape)->Arg(9000)->Arg(100000)->Unit(benchmark::kMillisecond);

void BM_bisection(benchmark::State& state) {
  const Incidence matrix = scattered_runs(static_cast<uint32_t>(state.range(0)));
  uint64_t runs = 1;
  for (auto unused : state) runs = count_runs(matrix, bisection_order(matrix));
  state.counters["improvement"] = static_cast<double>(runs_of_input(matrix)) / static_cast<double>(runs);
}
BENCHMARK(BM_bisection)->Arg(500)->Arg(9000)->Unit(benchmark::kMillisecond);

void BM_lower_bound(benchmark::State& state) {
  const Incidence matrix = scattered_runs(static_cast<uint32_t>(state.range(0)));
  uint64_t bound = 1;
  for (auto unused : state) bound = lower_bound_of_runs(matrix);
  state.counters["gap"] =
      static_cast<double>(count_runs(matrix, tour_order(matrix, TourOptions()))) / static_cast<double>(bound) - 1;
}
BENCHMARK(BM_lower_bound)->Arg(500)->Arg(1000)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace promenade
