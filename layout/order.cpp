#include "layout/order.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <chrono>
#include <numeric>

#include "layout/order_rivals.h"

namespace promenade {
namespace {

constexpr std::array<std::string_view, 6> kNames = {"input", "morton", "hilbert", "bisection", "greedy-tour", "tour"};

ColumnOrder order_named(std::string_view name, const OrderQuestion& question) {
  if (name == "morton") return morton_order(question.points);
  if (name == "hilbert") return hilbert_order(question.points);
  if (name == "bisection") return bisection_order(*question.matrix);
  if (name == "greedy-tour") return tour_order(*question.matrix, TourOptions(TourSeed::greedy));
  if (name == "tour") return tour_order(*question.matrix, TourOptions());
  assert(name == "input");
  ColumnOrder order(question.matrix->columns());
  std::iota(order.begin(), order.end(), 0U);
  return order;
}

}  // namespace

std::span<const std::string_view> order_names() { return kNames; }

MadeOrder make_order(std::string_view name, const OrderQuestion& question) {
  const auto start = std::chrono::steady_clock::now();
  MadeOrder made{name, order_named(name, question), 0, 0};
  made.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  made.runs = count_runs(*question.matrix, made.order);
  return made;
}

const MadeOrder& best_of(std::span<const MadeOrder> orders) {
  return *std::min_element(orders.begin(), orders.end(),
                           [](const MadeOrder& a, const MadeOrder& b) { return a.runs < b.runs; });
}

}  // namespace promenade
