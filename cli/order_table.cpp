#include "cli/order_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <numeric>
#include <random>

#include "layout/order_landscape.h"
#include "layout/order_tour.h"

namespace promenade {
namespace {

constexpr std::array<uint32_t, 8> kSizes = {500, 1000, 3000, 9000, 27000, 100000, 300000, 1000000};
constexpr uint32_t kMostBoundColumns = 3000;  // the bound's time grows with their square

ColumnOrder shuffled(uint32_t columns) {
  ColumnOrder order(columns);
  std::iota(order.begin(), order.end(), 0U);
  std::mt19937 random(1);
  for (uint32_t i = columns; i > 1; --i) std::swap(order[i - 1], order[random() % i]);
  return order;
}

OrderTableRow row_of(const Incidence& matrix, bool generated) {
  OrderTableRow row;
  row.columns = matrix.columns(), row.ones = matrix.ones.size(), row.generated = generated;
  ColumnOrder input(matrix.columns());
  std::iota(input.begin(), input.end(), 0U);
  row.shuffled = count_runs(matrix, shuffled(matrix.columns()));
  row.input = count_runs(matrix, input);
  tour_order(matrix, TourOptions(TourSeed::greedy), &row.greedy);
  tour_order(matrix, TourOptions(TourSeed::bisection), &row.from_bisection);
  row.distinct_columns = row.greedy.distinct_columns;
  constexpr uint32_t kSteps = 30;
  if (row.distinct_columns <= kMostBoundColumns)
    row.lower_bound = lower_bound_of_runs(matrix, kSteps, kMostBoundColumns);
  return row;
}

Json json_of(const TourFigures& figures) {
  return {{"neighbours_s", figures.neighbours_s},
          {"seed_s", figures.seed_s},
          {"improve_s", figures.improve_s},
          {"passes", figures.passes},
          {"runs_seed", figures.runs_of_seed},
          {"runs_pass_1", figures.runs_after_pass_1},
          {"runs", figures.runs}};
}

double times(uint64_t more, uint64_t fewer) { return double(more) / std::max<double>(1, double(fewer)); }

}  // namespace

std::vector<OrderTableRow> order_table(uint32_t most_columns, uint32_t model_columns,
                                       const std::function<Incidence(uint32_t)>& of_model, JobMonitor& monitor) {
  std::vector<OrderTableRow> rows;
  for (const uint32_t columns : kSizes) {
    if (columns > most_columns || monitor.cancelled()) break;
    const bool generated = columns > model_columns;
    rows.push_back(row_of(generated ? landscape_steps(columns) : of_model(columns), generated));
    monitor.progress("table", columns, most_columns);
  }
  return rows;
}

Json json_of(const std::vector<OrderTableRow>& rows) {
  Json list = Json::array();
  for (const OrderTableRow& row : rows)
    list.push_back({{"columns", row.columns},
                    {"generated", row.generated},
                    {"ones", row.ones},
                    {"distinct_columns", row.distinct_columns},
                    {"runs_shuffled", row.shuffled},
                    {"runs_input", row.input},
                    {"greedy", json_of(row.greedy)},
                    {"from_bisection", json_of(row.from_bisection)},
                    {"runs_lower_bound", row.lower_bound}});
  return list;
}

std::string markdown_of(const std::vector<OrderTableRow>& rows) {
  std::string text =
      "| columns | ones | neighbours s | greedy: seed s | improve s | fewer runs than shuffled: seed | pass 1 | end | "
      "than the input | over the 1-tree bound | from bisection: seed s | improve s | fewer than shuffled: seed | end "
      "|\n"
      "|---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n";
  for (const OrderTableRow& row : rows) {
    const TourFigures &g = row.greedy, &b = row.from_bisection;
    const auto gain = [&row](uint64_t runs) { return times(row.shuffled, runs); };
    text +=
        fmt::format("| {}{} | {} | {:.2f} | {:.2f} | {:.2f} | {:.2f} | {:.2f} | {:.2f} | {:.2f} | {} |", row.columns,
                    row.generated ? " (landscape)" : "", row.ones, g.neighbours_s, g.seed_s, g.improve_s,
                    gain(g.runs_of_seed), gain(g.runs_after_pass_1), gain(g.runs), times(row.input, g.runs),
                    row.lower_bound > 0 ? fmt::format("{:.1f} %", 100 * (times(g.runs, row.lower_bound) - 1)) : "");
    text += fmt::format(" {:.2f} | {:.2f} | {:.2f} | {:.2f} |\n", b.seed_s, b.improve_s, gain(b.runs_of_seed),
                        gain(b.runs));
  }
  return text;
}

}  // namespace promenade
