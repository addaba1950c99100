#include "layout/order_neighbours.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <array>

namespace promenade {
namespace {

/// Three rows with the least hashes, as a key to sort by.
struct Signature {
  std::array<uint32_t, 3> least;
  uint32_t place = 0;
  auto operator<=>(const Signature&) const = default;
};

uint32_t mix(uint32_t value, uint32_t seed) {
  // A bijection of 32 bits: the finaliser of MurmurHash3 (A. Appleby), so that no two rows share a hash.
  value ^= seed * 0x9e3779b9U;
  value ^= value >> 16, value *= 0x85ebca6bU;
  value ^= value >> 13, value *= 0xc2b2ae35U;
  return value ^ (value >> 16);
}

Signature signature_of(std::span<const uint32_t> column, uint32_t place, uint32_t seed) {
  Signature s{{~0U, ~0U, ~0U}, place};
  for (const uint32_t row : column) {
    uint32_t hash = mix(row, seed);
    for (uint32_t& least : s.least)
      if (hash < least) std::swap(hash, least);
  }
  return s;
}

/// Calls work(i) for each place, several at once.
template <class Work>
void for_each_place(size_t count, const Work& work) {
  constexpr size_t kGrain = 256;
  tbb::parallel_for(tbb::blocked_range<uint32_t>(0, static_cast<uint32_t>(count), kGrain),
                    [&work](const tbb::blocked_range<uint32_t>& range) {
                      for (uint32_t i = range.begin(); i < range.end(); ++i) work(i);
                    });
}

/// The nearest found so far, a fixed number a column: unused ones are far away.
class Nearest {
 public:
  Nearest(const Incidence& matrix, std::span<const uint32_t> among, uint32_t count)
      : matrix_(matrix), among_(among), count_(count), lists_(among.size() * count, {~0U, ~0U}) {}

  std::span<Neighbour> list(uint32_t i) { return std::span(lists_).subspan(size_t(i) * count_, count_); }
  std::span<const Neighbour> list(uint32_t i) const { return std::span(lists_).subspan(size_t(i) * count_, count_); }

  /// Only the thread that has column i.
  void consider(uint32_t i, uint32_t other) {
    if (i == other) return;
    const std::span<Neighbour> near = list(i);
    const std::span<const uint32_t> a = matrix_.column(among_[i]), b = matrix_.column(among_[other]);
    const uint64_t least = a.size() > b.size() ? a.size() - b.size() : b.size() - a.size();
    if (least > near.back().distance) return;
    for (const Neighbour& n : near)
      if (n.column == other) return;
    insert(near, {hamming_distance(a, b), other});
  }
  /// One that another search found. Only the thread that has column i.
  void add(uint32_t i, const Neighbour& found) {
    const std::span<Neighbour> near = list(i);
    if (std::find(near.begin(), near.end(), found) == near.end()) insert(near, found);
  }

  /// By the random order of rows with this number.
  void search(uint32_t round, uint32_t window, std::vector<Signature>& sorted) {
    for_each_place(among_.size(),
                   [&](uint32_t i) { sorted[i] = signature_of(matrix_.column(among_[i]), i, round + 1); });
    tbb::parallel_sort(sorted.begin(), sorted.end());
    for_each_place(among_.size(), [&](uint32_t at) {
      const size_t begin = at > window ? at - window : 0;
      const size_t end = std::min<size_t>(size_t(at) + window + 1, sorted.size());
      for (size_t k = begin; k < end; ++k) consider(sorted[at].place, sorted[k].place);
    });
  }

  /// Neighbours of neighbours.
  void refine() {
    const Nearest before = *this;
    for_each_place(among_.size(), [&](uint32_t i) {
      for (const Neighbour& n : before.list(i)) {
        if (n.column == ~0U) break;
        for (const Neighbour& next : before.list(n.column))
          if (next.column != ~0U) consider(i, next.column);
      }
    });
  }

  NeighbourLists lists() const {
    NeighbourLists lists;
    lists.first.reserve(among_.size() + 1);
    lists.first.push_back(0);
    for (uint32_t i = 0; i < among_.size(); ++i) {
      for (const Neighbour& n : list(i))
        if (n.column != ~0U) lists.all.push_back(n);
      lists.first.push_back(lists.all.size());
    }
    return lists;
  }

 private:
  static void insert(std::span<Neighbour> near, const Neighbour& found) {
    if (!(found < near.back())) return;
    const auto at = std::lower_bound(near.begin(), near.end(), found);
    std::move_backward(at, near.end() - 1, near.end());
    *at = found;
  }

  const Incidence& matrix_;
  std::span<const uint32_t> among_;
  uint32_t count_;
  std::vector<Neighbour> lists_;
};

}  // namespace

NeighbourLists near_columns(const Incidence& matrix, std::span<const uint32_t> among, const NeighbourOptions& options) {
  Nearest nearest(matrix, among, std::max(options.count, 1U));
  std::vector<Signature> sorted(among.size());
  for (uint32_t round = 0; round < options.rounds; ++round) nearest.search(round, options.window, sorted);
  for (uint32_t i = 0; i < options.refinements; ++i) nearest.refine();
  return nearest.lists();
}

NeighbourLists near_columns_of_round(const Incidence& matrix, std::span<const uint32_t> among,
                                     const NeighbourOptions& options, uint32_t round) {
  Nearest nearest(matrix, among, std::max(options.count, 1U));
  std::vector<Signature> sorted(among.size());
  nearest.search(round, options.window, sorted);
  return nearest.lists();
}

NeighbourLists near_columns_of_parts(const Incidence& matrix, std::span<const uint32_t> among,
                                     const NeighbourOptions& options, std::span<const NeighbourLists> parts) {
  // The nearest of all are among the nearest of each part.
  Nearest nearest(matrix, among, std::max(options.count, 1U));
  for_each_place(among.size(), [&](uint32_t i) {
    for (const NeighbourLists& part : parts)
      for (const Neighbour& n : part.of(i)) nearest.add(i, n);
  });
  for (uint32_t i = 0; i < options.refinements; ++i) nearest.refine();
  return nearest.lists();
}

}  // namespace promenade
