#pragma once
// View cells as a build makes them: viewing space halved again and again, leaves made cells where somebody may stand.

#include <span>
#include <vector>

#include "layout/cells.h"

namespace promenade {

/// A tree of halvings under construction. Its leaves are cells, or dead space where nobody stands.
/// Not thread-safe.
class CellPlan {
 public:
  explicit CellPlan(const Box& box);

  static constexpr uint32_t kRoot = 0;
  const Box& box_of(uint32_t node) const { return nodes_[node].box; }
  bool is_leaf(uint32_t node) const { return nodes_[node].axis == CellTreeNode::kLeaf; }
  /// Halves a leaf at a plane strictly inside it; the parts below and above it are the next two nodes.
  void split(uint32_t leaf, uint32_t axis, float at_m);
  uint32_t below(uint32_t node) const { return nodes_[node].child; }
  uint32_t above(uint32_t node) const { return nodes_[node].child + 1; }
  /// Leaves are dead until somebody says that they are cells. box: what of the leaf's is the cell's.
  void set_cell(uint32_t leaf, const Box& box) { nodes_[leaf].is_cell = true, nodes_[leaf].cell = box; }
  /// Whether a node has two parts, both leaves without a cell.
  bool is_dead(uint32_t node) const {
    const auto dead = [this](uint32_t part) { return is_leaf(part) && !nodes_[part].is_cell; };
    return !is_leaf(node) && dead(below(node)) && dead(above(node));
  }
  const Box& cell_of(uint32_t leaf) const { return nodes_[leaf].cell; }
  /// The box that the cells of a node's two parts fill together; empty: they are not two cells that fill one.
  Box joined_cells(uint32_t node) const;
  /// Undoes a leaf's splits: the node is a leaf again. What was below it is forgotten.
  void merge(uint32_t node) { nodes_[node].axis = CellTreeNode::kLeaf; }

  /// Makes dead space of a node.
  void drop(uint32_t node) { merge(node), nodes_[node].is_cell = false; }

  /// All nodes but the forgotten, each after its parent.
  std::vector<uint32_t> nodes() const;

  /// Splits a leaf as an octree does: halves every axis along which it is longer than half its longest side, so that
  /// flat space is divided like a quadtree until its parts are about cubes. Returns the parts.
  std::vector<uint32_t> split_octants(uint32_t leaf);

 private:
  struct Node {
    Box box;
    Box cell{};  ///< of a leaf that is one
    uint32_t axis = CellTreeNode::kLeaf;
    float split_m = 0;
    uint32_t child = 0;  ///< the first of two
    bool is_cell = false;
  };
  std::vector<Node> nodes_;
  friend CellTables tables_of(const CellPlan& plan, const FrontBound& bound, std::vector<uint32_t>& leaves);
};

/// Cells in depth-first order (so that numbers near each other are places near each other), without faces
/// (layout/cell_faces.h finds them). leaves[i] becomes the plan's node of cell i.
CellTables tables_of(const CellPlan& plan, const FrontBound& bound, std::vector<uint32_t>& leaves);

}  // namespace promenade
