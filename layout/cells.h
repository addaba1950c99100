#pragma once
// View cells as a model has them: boxes of viewing space, the tree that finds them, their neighbours and the portals
// between. FORMAT.md says how cells.bin holds them.

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "geometry/box.h"
#include "layout/cell_front.h"

namespace promenade {

/// A cell's place in the model's list of cells.
enum class CellId : uint32_t {};
constexpr CellId kNoCell{0xffffffffU};
constexpr uint32_t index_of(CellId id) { return static_cast<uint32_t>(id); }

/// One region of viewing space: a leaf of the tree. Cells do not overlap, but for their faces.
struct CellRecord {
  Box box;                  ///< metres, model space; closed: its faces belong to it
  uint32_t first_face = 0;  ///< into CellTables::faces_of_cells
  uint32_t face_count = 0;
  bool operator==(const CellRecord&) const = default;
};

/// The rectangle that two cells share, with what of it is open.
struct CellFace {
  CellId below = kNoCell;  ///< the cell on the side of smaller coordinates
  CellId above = kNoCell;
  uint32_t axis = 0;          ///< 0, 1, 2: x, y, z; the rectangle is perpendicular to it
  uint32_t first_portal = 0;  ///< into CellTables::portals
  uint32_t portal_count = 0;  ///< 0: a wall, nothing is seen through it
  CellId other(CellId cell) const { return cell == below ? above : below; }
  bool operator==(const CellFace&) const = default;
};

/// An inner node of the tree halves space at a plane; a leaf is a cell, or space without one.
struct CellTreeNode {
  static constexpr uint32_t kLeaf = 3;
  uint32_t axis = kLeaf;  ///< 0, 1, 2; kLeaf: a leaf
  float split_m = 0;      ///< the plane; a point on it belongs above
  uint32_t below = 0;     ///< tree node; a leaf's cell, or kNoCell
  uint32_t above = 0;     ///< tree node; 0 in a leaf
  bool operator==(const CellTreeNode&) const = default;
};

struct CellTables {
  FrontBound bound;                      ///< what the fronts of all cells were made for
  Box box;                               ///< of the tree's root; empty without cells
  std::vector<CellTreeNode> tree;        ///< the root first; empty without cells. Children stand after their parents
  std::vector<CellRecord> cells;         ///< by CellId
  std::vector<CellFace> faces;           ///< each pair of neighbours once
  std::vector<uint32_t> faces_of_cells;  ///< each cell's faces, contiguous
  std::vector<Box> portals;              ///< flat boxes: rectangles within their face. Closed

  std::span<const uint32_t> faces_of(CellId id) const {
    const CellRecord& cell = cells[index_of(id)];
    return {faces_of_cells.data() + cell.first_face, cell.face_count};
  }
  std::span<const Box> portals_of(const CellFace& face) const {
    return {portals.data() + face.first_portal, face.portal_count};
  }
  uint64_t byte_size() const;
};

/// The rectangle that a face's cells share: a box that is flat along the axis.
Box rectangle_of(const CellTables& tables, const CellFace& face);

/// The cell that holds a point (metres, model space); nullopt: none does.
std::optional<CellId> cell_at(const CellTables& tables, const glm::dvec3& point);

/// Empty when every index, range, box and number is sound (tree without cycles, every cell met exactly once and equal
/// to its leaf's box or within it, faces shared by their cells, portals within them); else what is wrong.
std::string find_defect(const CellTables& tables);

}  // namespace promenade
