#pragma once
// Where the eye is among a model's view cells.

#include <cstdint>
#include <optional>
#include <vector>

#include "layout/cells.h"

namespace promenade {

/// Follows the eye from cell to cell: across a face where it can, else down the tree. One thread.
class Cursor {
 public:
  /// tables must outlive it; null: the eye is never in a cell.
  explicit Cursor(const CellTables* tables) : tables_(tables) {}

  enum class Move : uint8_t {
    stayed,   ///< in the same cell
    stepped,  ///< into a neighbour, across a shared face
    jumped,   ///< into a cell that is no neighbour, or from outside
    left,     ///< the cells: the tree alone serves
    outside,  ///< as before
  };
  /// eye: metres, model space. Takes as long as the cell has neighbours, or the tree is deep.
  Move move_to(const glm::dvec3& eye);
  std::optional<CellId> cell() const { return cell_; }
  /// The cells across the faces of this one, the nearest to the eye first.
  std::vector<CellId> neighbours() const;

 private:
  const CellTables* tables_;
  std::optional<CellId> cell_;
  glm::dvec3 eye_{0};
};

}  // namespace promenade
