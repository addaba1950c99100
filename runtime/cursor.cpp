#include "runtime/cursor.h"

#include <algorithm>

namespace promenade {
namespace {

DBox box_of(const CellTables& tables, CellId id) {
  const Box& box = tables.cells[index_of(id)].box;
  return {box.min, box.max};
}

}  // namespace

Cursor::Move Cursor::move_to(const glm::dvec3& eye) {
  eye_ = eye;
  if (tables_ == nullptr) return Move::outside;
  if (cell_ && box_of(*tables_, *cell_).contains(eye)) return Move::stayed;
  if (cell_)
    for (const uint32_t face : tables_->faces_of(*cell_)) {
      const CellId next = tables_->faces[face].other(*cell_);
      if (!box_of(*tables_, next).contains(eye)) continue;
      cell_ = next;
      return Move::stepped;
    }
  const bool was_inside = cell_.has_value();
  cell_ = cell_at(*tables_, eye);
  if (cell_) return Move::jumped;
  return was_inside ? Move::left : Move::outside;
}

std::vector<CellId> Cursor::neighbours() const {
  std::vector<std::pair<double, CellId>> by_distance;
  if (cell_)
    for (const uint32_t face : tables_->faces_of(*cell_)) {
      const CellId next = tables_->faces[face].other(*cell_);
      by_distance.emplace_back(box_of(*tables_, next).distance(eye_), next);
    }
  std::sort(by_distance.begin(), by_distance.end());
  std::vector<CellId> cells;
  cells.reserve(by_distance.size());
  for (const auto& [distance_m, cell] : by_distance) cells.push_back(cell);
  return cells;
}

}  // namespace promenade
