#include "preprocess/visibility/view_cells.h"

namespace promenade {

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

std::vector<uint32_t> CellPlan::nodes() const {
  std::vector<uint32_t> found = {kRoot};
  for (size_t i = 0; i < found.size(); ++i) {
    const uint32_t node = found[i];
    if (!is_leaf(node)) found.push_back(below(node)), found.push_back(above(node));
  }
  return found;
}

Box CellPlan::joined_cells(uint32_t node) const {
  if (is_leaf(node)) return {};
  const Node &low = nodes_[below(node)], &high = nodes_[above(node)];
  if (low.axis != CellTreeNode::kLeaf || high.axis != CellTreeNode::kLeaf || !low.is_cell || !high.is_cell) return {};
  const int axis = static_cast<int>(nodes_[node].axis);
  if (low.cell.max[axis] != high.cell.min[axis]) return {};
  for (int i = 0; i < 3; ++i)
    if (i != axis && (low.cell.min[i] != high.cell.min[i] || low.cell.max[i] != high.cell.max[i])) return {};
  Box joined = low.cell;
  joined.add(high.cell);
  return joined;
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
  return tables;
}

}  // namespace promenade
