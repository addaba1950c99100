#include "layout/order_columns.h"

#include <algorithm>
#include <numeric>

namespace promenade {

DistinctColumns distinct_columns(const Incidence& matrix) {
  std::vector<uint32_t> sorted(matrix.columns());
  std::iota(sorted.begin(), sorted.end(), 0U);
  const auto compare = [&](uint32_t a, uint32_t b) {
    const std::span<const uint32_t> x = matrix.column(a), y = matrix.column(b);
    return x.size() != y.size() ? (x.size() < y.size() ? -1 : 1) : [&] {
      const auto [i, j] = std::mismatch(x.begin(), x.end(), y.begin());
      return i == x.end() ? 0 : (*i < *j ? -1 : 1);
    }();
  };
  std::sort(sorted.begin(), sorted.end(), [&](uint32_t a, uint32_t b) {
    const int difference = compare(a, b);
    return difference != 0 ? difference < 0 : a < b;
  });
  // The lowest of each kind comes first among its equals.
  std::vector<uint32_t> lowest(matrix.columns());
  for (size_t i = 0; i < sorted.size(); ++i)
    lowest[sorted[i]] = i > 0 && compare(sorted[i - 1], sorted[i]) == 0 ? lowest[sorted[i - 1]] : sorted[i];
  DistinctColumns distinct;
  distinct.kind_of.resize(matrix.columns());
  for (uint32_t i = 0; i < matrix.columns(); ++i) {
    if (lowest[i] == i) distinct.first.push_back(i);
    distinct.kind_of[i] =
        lowest[i] == i ? static_cast<uint32_t>(distinct.first.size() - 1) : distinct.kind_of[lowest[i]];
  }
  return distinct;
}

ColumnOrder spread(const DistinctColumns& distinct, const std::vector<uint32_t>& kinds) {
  std::vector<uint32_t> place(kinds.size());
  for (size_t i = 0; i < kinds.size(); ++i) place[kinds[i]] = static_cast<uint32_t>(i);
  ColumnOrder order(distinct.kind_of.size());
  std::iota(order.begin(), order.end(), 0U);
  std::stable_sort(order.begin(), order.end(),
                   [&](uint32_t a, uint32_t b) { return place[distinct.kind_of[a]] < place[distinct.kind_of[b]]; });
  return order;
}

}  // namespace promenade
