#include "layout/cell_faces.h"

#include <fmt/format.h>

#include <algorithm>

namespace promenade {
namespace {

/// Tree nodes that are visited for a cell, and neighbours that it has, in the mean and at most. A tree of halvings
/// stays far below.
constexpr uint64_t kMostVisits = 4096, kMostFaces = 64;

/// Finds each pair of cells that share a rectangle, once: from the cell below, across its upper face along each axis.
class FaceFinder {
 public:
  explicit FaceFinder(CellTables& tables) : tables_(tables), most_visits_(kMostVisits * (tables.cells.size() + 1)) {}

  Status run() {
    tables_.faces.clear(), tables_.portals.clear(), tables_.faces_of_cells.clear();
    for (uint32_t i = 0; i < tables_.cells.size(); ++i) {
      tables_.cells[i].first_face = tables_.cells[i].face_count = 0;
      for (uint32_t axis = 0; axis < 3; ++axis) find_above(CellId{i}, axis);
      if (visits_ > most_visits_ || tables_.faces.size() > kMostFaces * tables_.cells.size())
        return Error{fmt::format("{} cells have too many neighbours", tables_.cells.size())};
    }
    list_by_cell();
    return Done{};
  }

 private:
  void find_above(CellId id, uint32_t axis) {
    const int a = static_cast<int>(axis);
    const Box& box = tables_.cells[index_of(id)].box;
    std::vector<uint32_t> found;
    open_.assign(1, 0);
    while (!open_.empty() && ++visits_ <= most_visits_) {
      const CellTreeNode& node = tables_.tree[open_.back()];
      open_.pop_back();
      if (node.axis == CellTreeNode::kLeaf) {
        if (node.below != index_of(kNoCell) && shares_face(box, tables_.cells[node.below].box, a))
          found.push_back(node.below);
        continue;
      }
      // The plane through the upper face, and the face's extent along the other axes.
      const int split_axis = static_cast<int>(node.axis);
      const float low = split_axis == a ? box.max[a] : box.min[split_axis], high = box.max[split_axis];
      if (low < node.split_m) open_.push_back(node.below);
      if (high >= node.split_m) open_.push_back(node.above);
    }
    std::sort(found.begin(), found.end());
    for (const uint32_t other : found) add(id, CellId{other}, axis);
  }

  static bool shares_face(const Box& below, const Box& above, int axis) {
    if (below.max[axis] != above.min[axis]) return false;
    for (int i = 0; i < 3; ++i)
      if (i != axis && std::max(below.min[i], above.min[i]) >= std::min(below.max[i], above.max[i])) return false;
    return true;
  }

  void add(CellId below, CellId above, uint32_t axis) {
    CellFace face{below, above, axis, static_cast<uint32_t>(tables_.portals.size()), 1};
    tables_.portals.push_back(rectangle_of(tables_, face));
    tables_.faces.push_back(face);
  }

  void list_by_cell() {
    for (const CellFace& face : tables_.faces)
      for (const CellId id : {face.below, face.above}) ++tables_.cells[index_of(id)].face_count;
    uint32_t first = 0;
    for (CellRecord& cell : tables_.cells) {
      cell.first_face = first;
      first += cell.face_count;
      cell.face_count = 0;
    }
    tables_.faces_of_cells.resize(first);
    for (uint32_t i = 0; i < tables_.faces.size(); ++i)
      for (const CellId id : {tables_.faces[i].below, tables_.faces[i].above}) {
        CellRecord& cell = tables_.cells[index_of(id)];
        tables_.faces_of_cells[cell.first_face + cell.face_count++] = i;
      }
  }

  CellTables& tables_;
  uint64_t most_visits_, visits_ = 0;
  std::vector<uint32_t> open_;
};

}  // namespace

Status find_faces(CellTables& tables) { return FaceFinder(tables).run(); }

bool faces_follow(const CellTables& tables) {
  CellTables found = tables;
  return find_faces(found).ok() && found.faces == tables.faces && found.portals == tables.portals &&
         found.faces_of_cells == tables.faces_of_cells && found.cells == tables.cells;
}

}  // namespace promenade
