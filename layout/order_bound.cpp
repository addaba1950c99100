// A 1-tree: a spanning tree over the distinct columns, and the two shortest edges of the empty column to them. No tour
// is shorter than the shortest 1-tree; weights on the columns that the tree likes too much or too little tighten it.
#include <algorithm>
#include <cmath>
#include <limits>

#include "layout/order_columns.h"
#include "layout/order_tour.h"

namespace promenade {
namespace {

struct OneTree {
  double length = 0;  ///< with weights
  std::vector<int> degrees;
};

/// Distances between all kinds and the empty column, which is the last.
std::vector<uint32_t> all_distances(const Incidence& matrix, std::span<const uint32_t> kinds) {
  const size_t size = kinds.size() + 1;
  std::vector<uint32_t> distances(size * size);
  for (size_t i = 0; i < size; ++i)
    for (size_t k = 0; k < i; ++k) {
      const std::span<const uint32_t> a = i == kinds.size() ? std::span<const uint32_t>() : matrix.column(kinds[i]);
      distances[i * size + k] = distances[k * size + i] = hamming_distance(a, matrix.column(kinds[k]));
    }
  return distances;
}

OneTree shortest_one_tree(const std::vector<uint32_t>& distances, const std::vector<double>& weights) {
  const size_t size = weights.size(), empty = size - 1;
  const auto length = [&](size_t a, size_t b) { return distances[a * size + b] + weights[a] + weights[b]; };
  OneTree tree;
  tree.degrees.assign(size, 0);
  // R. C. Prim, 1957, over all but the empty column.
  std::vector<double> nearest(empty, std::numeric_limits<double>::max());
  std::vector<size_t> from(empty, 0);
  std::vector<uint8_t> in(empty);
  size_t at = 0;
  for (size_t count = 1; count < empty; ++count) {
    in[at] = 1;
    size_t next = empty;
    for (size_t i = 0; i < empty; ++i) {
      if (in[i] != 0) continue;
      if (const double l = length(at, i); l < nearest[i]) nearest[i] = l, from[i] = at;
      if (next == empty || nearest[i] < nearest[next]) next = i;
    }
    tree.length += nearest[next];
    ++tree.degrees[next], ++tree.degrees[from[next]];
    at = next;
  }
  std::vector<size_t> order(empty);
  for (size_t i = 0; i < empty; ++i) order[i] = i;
  std::partial_sort(order.begin(), order.begin() + 2, order.end(),
                    [&](size_t a, size_t b) { return length(empty, a) < length(empty, b); });
  for (size_t i = 0; i < 2; ++i) {
    tree.length += length(empty, order[i]);
    ++tree.degrees[empty], ++tree.degrees[order[i]];
  }
  return tree;
}

}  // namespace

uint64_t lower_bound_of_runs(const Incidence& matrix, uint32_t steps, uint32_t most_columns) {
  const DistinctColumns distinct = distinct_columns(matrix);
  if (distinct.first.size() < 2 || distinct.first.size() > most_columns) return 0;
  const std::vector<uint32_t> distances = all_distances(matrix, distinct.first);
  std::vector<double> weights(distinct.first.size() + 1, 0);
  double best = 0, step = 0;
  for (uint32_t i = 0; i <= steps; ++i) {
    const OneTree tree = shortest_one_tree(distances, weights);
    double twice = 0;
    for (const double w : weights) twice += 2 * w;
    best = std::max(best, tree.length - twice);
    if (i == 0) step = tree.length / (2 * static_cast<double>(weights.size()));
    for (size_t k = 0; k < weights.size(); ++k) weights[k] += step * (tree.degrees[k] - 2);
    constexpr double kShrink = 0.92;
    step *= kShrink;
  }
  // A tour's length is even; rounding of the sums must not lift the bound.
  constexpr double kSlack = 1e-6;
  return static_cast<uint64_t>(std::ceil(best / 2 - kSlack * (1 + best)));
}

}  // namespace promenade
