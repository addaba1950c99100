#include "layout/order_landscape.h"

#include <algorithm>
#include <array>

namespace promenade {
namespace {

constexpr int64_t kCellLength = 2;    // in leaves
constexpr int64_t kRefineWithin = 2;  // of a node's size: nearer, its children take its place
constexpr int64_t kGroupCells = 4;    // by so many a side, what they see is hidden together

struct Square {
  int64_t x = 0, y = 0, size = 1;
};

class Landscape {
 public:
  explicit Landscape(uint32_t columns) : columns_(columns) {
    uint64_t nodes = 1;
    while (nodes < columns) nodes = 4 * nodes + 1, side_ *= 2;
    cells_ = std::max<int64_t>(1, side_ / kCellLength);
    matrix_.rows = static_cast<uint32_t>(4 * cells_ * cells_);
    matrix_.first.reserve(size_t(columns) + 1);
  }

  Incidence run() {
    if (columns_ > 0) add({0, 0, side_});
    return std::move(matrix_);
  }

 private:
  /// A node and its descendants, while columns are left.
  void add(const Square& node) {
    if (matrix_.columns() == columns_) return;
    add_column(node);
    if (node.size == 1) return;
    const int64_t half = node.size / 2;
    for (const int64_t y : {node.y, node.y + half})
      for (const int64_t x : {node.x, node.x + half}) add({x, y, half});
  }

  /// Between a cell's square and another, along the axis where they are farther apart.
  static int64_t distance(const Square& a, const Square& b) {
    return std::max(
        {a.x - (b.x + b.size), b.x - (a.x + a.size), a.y - (b.y + b.size), b.y - (a.y + a.size), int64_t(0)});
  }

  bool sees(int64_t cell_x, int64_t cell_y, const Square& node) const {
    const Square cell{cell_x * kCellLength, cell_y * kCellLength, kCellLength};
    const Square parent{node.x / (2 * node.size) * 2 * node.size, node.y / (2 * node.size) * 2 * node.size,
                        2 * node.size};
    if (node.size < side_ && distance(cell, parent) >= kRefineWithin * parent.size) return false;
    if (node.size > 1 && distance(cell, node) < kRefineWithin * node.size) return false;
    const auto group = [](int64_t a, int64_t b) { return static_cast<uint64_t>(a) << 32U ^ static_cast<uint64_t>(b); };
    const uint64_t pair = group(cell_x / kGroupCells, cell_y / kGroupCells) * 0x9e3779b97f4a7c15U ^
                          group(2 * node.x + node.size, 2 * node.y + node.size) * 0xc2b2ae3d27d4eb4fU;
    return (pair * 0x165667b19e3779f9U) >> 62U != 0;
  }

  void add_column(const Square& node) {
    const int64_t reach = (2 * kRefineWithin + 2) * node.size + kCellLength;
    const auto cell_at = [this](int64_t place) { return std::clamp<int64_t>(place / kCellLength, 0, cells_ - 1); };
    const int64_t from_x = cell_at(node.x - reach), to_x = cell_at(node.x + node.size + reach);
    const int64_t from_y = cell_at(node.y - reach), to_y = cell_at(node.y + node.size + reach);
    for (int64_t y = from_y; y <= to_y; ++y)
      for (int64_t x = from_x; x <= to_x; ++x) {
        const bool here = sees(x, y, node);
        const std::array<bool, 2> beside = {x + 1 < cells_ ? sees(x + 1, y, node) : here,
                                            y + 1 < cells_ ? sees(x, y + 1, node) : here};
        for (size_t axis = 0; axis < 2; ++axis)
          if (beside[axis] != here)
            matrix_.ones.push_back(static_cast<uint32_t>(4 * (y * cells_ + x)) + static_cast<uint32_t>(2 * axis) +
                                   (here ? 1U : 0U));
      }
    matrix_.first.push_back(matrix_.ones.size());
  }

  uint32_t columns_;
  int64_t side_ = 1, cells_ = 1;
  Incidence matrix_;
};

}  // namespace

Incidence landscape_steps(uint32_t columns) { return Landscape(columns).run(); }

}  // namespace promenade
