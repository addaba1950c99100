#include "layout/incidence.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <string_view>

namespace promenade {

Incidence incidence_of(std::span<const std::vector<uint32_t>> rows, uint32_t columns) {
  Incidence matrix;
  matrix.rows = static_cast<uint32_t>(rows.size());
  matrix.first.assign(size_t(columns) + 1, 0);
  for (const std::vector<uint32_t>& row : rows)
    for (const uint32_t column : row) ++matrix.first[column + 1];
  for (uint32_t i = 0; i < columns; ++i) matrix.first[i + 1] += matrix.first[i];
  matrix.ones.resize(matrix.first.back());
  std::vector<uint64_t> at(matrix.first.begin(), matrix.first.end() - 1);
  for (uint32_t row = 0; row < matrix.rows; ++row)
    for (const uint32_t column : rows[row]) matrix.ones[at[column]++] = row;
  return matrix;
}

uint32_t hamming_distance(std::span<const uint32_t> a, std::span<const uint32_t> b) {
  size_t i = 0, j = 0, both = 0;
  while (i < a.size() && j < b.size()) {
    const uint32_t x = a[i], y = b[j];
    both += x == y ? 1 : 0;
    i += x <= y ? 1 : 0;
    j += y <= x ? 1 : 0;
  }
  return static_cast<uint32_t>(a.size() + b.size() - 2 * both);
}

bool is_permutation_of(std::span<const uint32_t> order, uint32_t columns) {
  std::vector<uint8_t> seen(columns);
  for (const uint32_t column : order) {
    if (column >= columns || seen[column] != 0) return false;
    seen[column] = 1;
  }
  return order.size() == columns;
}

uint64_t count_runs(const Incidence& matrix, std::span<const uint32_t> order) {
  if (order.empty()) return 0;
  uint64_t length = matrix.column(order.front()).size() + matrix.column(order.back()).size();
  for (size_t i = 1; i < order.size(); ++i)
    length += hamming_distance(matrix.column(order[i - 1]), matrix.column(order[i]));
  return length / 2;
}

Result<ColumnOrder> parse_order(std::string_view text, uint32_t columns) {
  ColumnOrder order;
  size_t line = 1;
  while (!text.empty()) {
    const size_t end = std::min(text.find('\n'), text.size());
    const std::string_view digits = text.substr(0, end);
    uint32_t column = 0;
    const auto [rest, error] = std::from_chars(digits.data(), digits.data() + digits.size(), column);
    if (error != std::errc() || rest != digits.data() + digits.size())
      return Error{fmt::format("line {}: \"{}\" is no number of a node", line, digits.substr(0, 40))};
    if (order.size() == columns) return Error{fmt::format("line {}: more than {} nodes", line, columns)};
    order.push_back(column);
    text.remove_prefix(std::min(end + 1, text.size()));
    ++line;
  }
  if (!is_permutation_of(order, columns))
    return Error{fmt::format("{} lines: not each of the nodes 0 to {} once", order.size(), columns - 1)};
  return order;
}

}  // namespace promenade
