#pragma once
// Every order of nodes on disk behind one interface.

#include <glm/vec3.hpp>
#include <string>
#include <string_view>

#include "layout/incidence.h"
#include "layout/order_tour.h"

namespace promenade {

struct OrderQuestion {
  const Incidence* matrix = nullptr;  ///< a column a node
  std::span<const glm::vec3> points;  ///< by node: where it is, metres
};

/// "input", "morton", "hilbert", "bisection", "greedy-tour" (as published), "tour".
std::span<const std::string_view> order_names();

struct MadeOrder {
  std::string_view name;
  ColumnOrder order;
  uint64_t runs = 0;
  double wall_s = 0;
};

/// By one of order_names(); any other is a bug. Deterministic.
MadeOrder make_order(std::string_view name, const OrderQuestion& question);

/// The one with fewest runs; of equals the first.
const MadeOrder& best_of(std::span<const MadeOrder> orders);

}  // namespace promenade
