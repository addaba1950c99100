#include "preprocess/visibility/view_cells.h"

#include <algorithm>

namespace promenade {
namespace {

/// Finds each pair of cells that share a rectangle, once: from the cell below, across its upper face along each axis.
class FaceFinder {
 public:
  explicit FaceFinder(CellTables& tables) : tables_(tables) {}

  void run() {
    for (uint32_t i = 0; i < tables_.cells.size(); ++i)
      for (uint32_t axis = 0; axis < 3; ++axis) find_above(CellId{i}, axis);
    list_by_cell();
  }

 private:
  void find_above(CellId id, uint32_t axis) {
    const int a = static_cast<int>(axis);
    const Box& box = tables_.cells[index_of(id)].box;
    std::vector<uint32_t> found;
    open_.assign(1, 0);
    while (!open_.empty()) {
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
  std::vector<uint32_t> open_;
};

}  // namespace

CellPlan::CellPlan(const Box& box) { nodes_.push_back({box}); }

void CellPlan::split(uint32_t leaf, uint32_t axis, float at_m) {
  const auto child = static_cast<uint32_t>(nodes_.size());
  nodes_[leaf].axis = axis, nodes_[leaf].split_m = at_m, nodes_[leaf].child = child;
  Box below = nodes_[leaf].box, above = below;
  below.max[static_cast<int>(axis)] = above.min[static_cast<int>(axis)] = at_m;
  nodes_.push_back({below});
  nodes_.push_back({above});
}

std::vector<uint32_t> CellPlan::split_octants(uint32_t leaf) {
  const Box box = box_of(leaf);
  const glm::vec3 size = box.size();
  const float longest = size[box.longest_axis()];
  std::vector<uint32_t> parts = {leaf};
  for (uint32_t axis = 0; axis < 3; ++axis) {
    const int a = static_cast<int>(axis);
    const float middle = box.center()[a];
    // The second test: single precision may have no number between the two faces.
    if (size[a] <= longest / 2 || middle <= box.min[a] || middle >= box.max[a]) continue;
    std::vector<uint32_t> halves;
    for (const uint32_t part : parts) {
      split(part, axis, middle);
      halves.push_back(below(part)), halves.push_back(above(part));
    }
    parts = std::move(halves);
  }
  if (parts.size() == 1) parts.clear();
  return parts;
}

CellTables tables_of(const CellPlan& plan, const FrontBound& bound, std::vector<uint32_t>& leaves) {
  CellTables tables;
  tables.bound = bound;
  leaves.clear();
  struct Open {
    uint32_t plan_node;
    uint32_t tree_node;
  };
  std::vector<Open> open = {{CellPlan::kRoot, 0}};
  tables.box = plan.box_of(CellPlan::kRoot);
  tables.tree.emplace_back();
  while (!open.empty()) {
    const Open at = open.back();
    open.pop_back();
    const CellPlan::Node& node = plan.nodes_[at.plan_node];
    CellTreeNode made{node.axis, node.split_m, index_of(kNoCell), 0};
    if (node.axis != CellTreeNode::kLeaf) {
      made.below = static_cast<uint32_t>(tables.tree.size());
      made.above = made.below + 1;
      tables.tree.resize(tables.tree.size() + 2);
      open.push_back({node.child + 1, made.above});
      open.push_back({node.child, made.below});
    } else if (node.is_cell) {
      made.below = static_cast<uint32_t>(tables.cells.size());
      tables.cells.push_back({node.cell});
      leaves.push_back(at.plan_node);
    }
    if (node.axis == CellTreeNode::kLeaf) made.split_m = 0;
    tables.tree[at.tree_node] = made;
  }
  FaceFinder(tables).run();
  return tables;
}

}  // namespace promenade
