#pragma once
// Table 1 of [chhugani2003] made anew: what the tour takes and gains on matrices of growing size.

#include <cstdint>
#include <functional>
#include <vector>

#include "cli/command.h"
#include "layout/order_tour.h"

namespace promenade {

/// One size.
struct OrderTableRow {
  uint32_t columns = 0;
  uint64_t ones = 0, distinct_columns = 0;
  bool generated = false;              ///< of a landscape, not of the model
  TourFigures greedy, from_bisection;  ///< the tour as published, and the default
  uint64_t shuffled = 0, input = 0;    ///< runs of these orders; a shuffled one is what no thought gives
  uint64_t lower_bound = 0;            ///< 0: too many columns to tell
};

/// For 500, 1000, 3000, 9000, 27000, 100000, 300000 and a million columns, up to most_columns. of_model: a matrix of so
/// many of the model's columns, for as many as it has (model_columns); beyond, a landscape is generated. Stops early,
/// with what it has, when the monitor is cancelled.
std::vector<OrderTableRow> order_table(uint32_t most_columns, uint32_t model_columns,
                                       const std::function<Incidence(uint32_t)>& of_model, JobMonitor& monitor);

/// Of the rows: JSON, and Markdown for a page of text.
Json json_of(const std::vector<OrderTableRow>& rows);
std::string markdown_of(const std::vector<OrderTableRow>& rows);

}  // namespace promenade
