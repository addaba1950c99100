#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "layout/order_rivals.h"

namespace promenade {
namespace {

constexpr int kExchanges = 20;    // Dhulipala et al. use as many
constexpr size_t kSmallest = 8;   // parts of so few stay as they are
constexpr size_t kOwnTask = 256;  // parts of so many are worth a thread's attention

/// Rows of a part, by half: how many of its columns have a one there.
struct Degrees {
  std::vector<uint32_t> first, second;
};

class Bisection {
 public:
  explicit Bisection(const Incidence& matrix) : matrix_(matrix), order_(matrix.columns()), gains_(matrix.columns()) {
    std::iota(order_.begin(), order_.end(), 0U);
    logs_.resize(size_t(matrix.columns()) + 2);
    for (size_t i = 1; i < logs_.size(); ++i) logs_[i] = std::log2(static_cast<double>(i));
  }

  ColumnOrder run() {
    order_part(order_);
    return order_;
  }

 private:
  /// As deep as the logarithm of the columns.
  void order_part(std::span<uint32_t> part) {
    if (part.size() <= kSmallest) return;
    halve(part, degrees_.local());
    const std::span<uint32_t> first = part.first(part.size() / 2), second = part.subspan(part.size() / 2);
    if (part.size() < kOwnTask) {
      order_part(first), order_part(second);
      return;
    }
    tbb::parallel_invoke([&] { order_part(first); }, [&] { order_part(second); });
  }

  /// Bits that a row with so many ones among so many columns takes, about.
  double cost(uint32_t ones, size_t columns) const { return ones == 0 ? 0 : ones * (logs_[columns] - logs_[ones + 1]); }

  /// What is gained when the column leaves the half with the degrees `here`.
  double gain_of(uint32_t column, const std::vector<uint32_t>& here, size_t here_size,
                 const std::vector<uint32_t>& there, size_t there_size) const {
    double gain = 0;
    for (const uint32_t row : matrix_.column(column))
      gain += cost(here[row], here_size) + cost(there[row], there_size) - cost(here[row] - 1, here_size) -
              cost(there[row] + 1, there_size);
    return gain;
  }

  void count(std::span<const uint32_t> half, std::vector<uint32_t>& degrees) const {
    for (const uint32_t column : half)
      for (const uint32_t row : matrix_.column(column)) ++degrees[row];
  }
  void forget(std::span<const uint32_t> part, Degrees& degrees) const {
    for (const uint32_t column : part)
      for (const uint32_t row : matrix_.column(column)) degrees.first[row] = degrees.second[row] = 0;
  }

  /// degrees: all 0, and so again in the end.
  void halve(std::span<uint32_t> part, Degrees& degrees) {
    const std::span<uint32_t> first = part.first(part.size() / 2), second = part.subspan(part.size() / 2);
    for (int i = 0; i < kExchanges; ++i) {
      count(first, degrees.first), count(second, degrees.second);
      for (const uint32_t c : first) gains_[c] = gain_of(c, degrees.first, first.size(), degrees.second, second.size());
      for (const uint32_t c : second)
        gains_[c] = gain_of(c, degrees.second, second.size(), degrees.first, first.size());
      forget(part, degrees);
      const auto more = [this](uint32_t a, uint32_t b) {
        return gains_[a] != gains_[b] ? gains_[a] > gains_[b] : a < b;
      };
      std::sort(first.begin(), first.end(), more);
      std::sort(second.begin(), second.end(), more);
      size_t swaps = 0;
      while (swaps < first.size() && gains_[first[swaps]] + gains_[second[swaps]] > 0) {
        std::swap(first[swaps], second[swaps]);
        ++swaps;
      }
      if (swaps == 0) break;
    }
    // Halves in the order of the input, where their own halving begins.
    std::sort(first.begin(), first.end());
    std::sort(second.begin(), second.end());
  }

  const Incidence& matrix_;
  ColumnOrder order_;
  std::vector<double> gains_;  ///< by column; a part's belong to the thread that has it
  tbb::enumerable_thread_specific<Degrees> degrees_{[rows = matrix_.rows] {
    return Degrees{std::vector<uint32_t>(rows), std::vector<uint32_t>(rows)};
  }};
  std::vector<double> logs_;
};

}  // namespace

ColumnOrder bisection_order(const Incidence& matrix) { return Bisection(matrix).run(); }

}  // namespace promenade
