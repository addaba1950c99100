#pragma once
// Which node belongs to which row (a cell's vLOD, or the delta across a face): a sparse matrix of zeros and ones, whose
// columns are to be put in an order in which the ones of a row stand together. Source: [chhugani2003] section 3.

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "geometry/result.h"

namespace promenade {

/// Columns one behind the other, each the ascending numbers of the rows that have a one in it.
struct Incidence {
  uint32_t rows = 0;
  std::vector<uint64_t> first = {0};  ///< by column, and one more: where its ones begin
  std::vector<uint32_t> ones;
  uint32_t columns() const { return static_cast<uint32_t>(first.size() - 1); }
  std::span<const uint32_t> column(uint32_t i) const {
    return std::span(ones).subspan(first[i], first[i + 1] - first[i]);
  }
};

/// From sets of columns, one a row, each ascending and below `columns`.
Incidence incidence_of(std::span<const std::vector<uint32_t>> rows, uint32_t columns);

/// In how many rows the columns differ.
uint32_t hamming_distance(std::span<const uint32_t> a, std::span<const uint32_t> b);

/// A permutation: which column stands at each place.
using ColumnOrder = std::vector<uint32_t>;
bool is_permutation_of(std::span<const uint32_t> order, uint32_t columns);

/// Runs of ones in all rows together: what the order is to make small. Half the length of the tour through all columns
/// and an empty one, in the Hamming metric.
uint64_t count_runs(const Incidence& matrix, std::span<const uint32_t> order);

/// The matrix and an order as text, one row a line: the numbers of its columns, ascending, separated by blanks; and
/// one column number a line. Read back what `--order file:` is given. Errors: no permutation of 0 to columns - 1.
Result<ColumnOrder> parse_order(std::string_view text, uint32_t columns);

}  // namespace promenade
