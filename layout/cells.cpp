#include "layout/cells.h"

#include <fmt/format.h>

#include <cmath>
#include <glm/vector_relational.hpp>

namespace promenade {
namespace {

bool in_range(uint64_t first, uint64_t count, size_t size) { return first <= size && count <= size - first; }

bool is_solid(const Box& box) {
  for (int i = 0; i < 3; ++i)
    if (!std::isfinite(box.min[i]) || !std::isfinite(box.max[i])) return false;
  return glm::all(glm::lessThan(box.min, box.max));
}

std::string find_cell_defect(const CellTables& tables) {
  for (size_t i = 0; i < tables.cells.size(); ++i) {
    const CellRecord& cell = tables.cells[i];
    if (!is_solid(cell.box)) return fmt::format("cell {}: box is empty, flat or not finite", i);
    if (!in_range(cell.first_face, cell.face_count, tables.faces_of_cells.size()))
      return fmt::format("cell {}: faces {} + {} of {}", i, cell.first_face, cell.face_count,
                         tables.faces_of_cells.size());
    for (const uint32_t face : tables.faces_of(CellId{static_cast<uint32_t>(i)})) {
      if (face >= tables.faces.size()) return fmt::format("cell {}: face {} of {}", i, face, tables.faces.size());
      const CellFace& f = tables.faces[face];
      if (index_of(f.below) != i && index_of(f.above) != i) return fmt::format("cell {}: face {} is not its", i, face);
    }
  }
  return {};
}

std::string find_face_defect(const CellTables& tables, const CellFace& face) {
  const size_t count = tables.cells.size();
  if (index_of(face.below) >= count || index_of(face.above) >= count || face.axis > 2)
    return fmt::format("cells {} and {} of {}, axis {}", index_of(face.below), index_of(face.above), count, face.axis);
  const Box &below = tables.cells[index_of(face.below)].box, &above = tables.cells[index_of(face.above)].box;
  const int axis = static_cast<int>(face.axis);
  if (below.max[axis] != above.min[axis])
    return fmt::format("cells {} and {} do not touch", index_of(face.below), index_of(face.above));
  const Box rectangle = rectangle_of(tables, face);
  for (int i = 0; i < 3; ++i)
    if (i != axis && rectangle.min[i] >= rectangle.max[i])
      return fmt::format("cells {} and {} share no rectangle", index_of(face.below), index_of(face.above));
  if (!in_range(face.first_portal, face.portal_count, tables.portals.size()))
    return fmt::format("portals {} + {} of {}", face.first_portal, face.portal_count, tables.portals.size());
  for (const Box& portal : tables.portals_of(face))
    if (portal.empty() || !rectangle.contains(portal)) return "a portal is not within the face";
  return {};
}

/// Walks the tree from the root: every node and every cell must be met exactly once.
class TreeWalk {
 public:
  explicit TreeWalk(const CellTables& tables) : tables_(tables), met_(tables.cells.size()) {}

  std::string run() {
    if (tables_.tree.empty()) return tables_.cells.empty() ? "" : "cells without a tree";
    if (!is_solid(tables_.box)) return "the tree's box is empty, flat or not finite";
    open_.push_back({0, tables_.box});
    size_t nodes = 0, cells = 0;
    while (!open_.empty()) {
      const auto [index, box] = open_.back();
      open_.pop_back();
      if (++nodes > tables_.tree.size()) return "a tree node is met twice";
      const CellTreeNode& node = tables_.tree[index];
      const bool leaf = node.axis == CellTreeNode::kLeaf;
      std::string defect = leaf ? leaf_defect(node, box, cells) : inner_defect(node, index, box);
      if (!defect.empty()) return fmt::format("tree node {}: {}", index, defect);
    }
    if (nodes != tables_.tree.size() || cells != tables_.cells.size())
      return fmt::format("{} of {} tree nodes and {} of {} cells are met", nodes, tables_.tree.size(), cells,
                         tables_.cells.size());
    return {};
  }

 private:
  struct Open {
    uint32_t index;
    Box box;
  };

  std::string leaf_defect(const CellTreeNode& node, const Box& box, size_t& cells) {
    if (node.below == index_of(kNoCell)) return {};
    if (node.below >= met_.size()) return fmt::format("cell {} of {}", node.below, met_.size());
    if (met_[node.below]) return fmt::format("cell {} is met twice", node.below);
    if (!box.contains(tables_.cells[node.below].box)) return fmt::format("cell {} is not within it", node.below);
    met_[node.below] = true;
    ++cells;
    return {};
  }

  std::string inner_defect(const CellTreeNode& node, uint32_t index, const Box& box) {
    if (node.axis > CellTreeNode::kLeaf) return fmt::format("axis {}", node.axis);
    const int axis = static_cast<int>(node.axis);
    if (!(node.split_m > box.min[axis] && node.split_m < box.max[axis]))
      return fmt::format("is split at {} m, outside it", node.split_m);
    for (const uint32_t child : {node.below, node.above})
      if (child <= index || child >= tables_.tree.size())
        return fmt::format("child {} of {}", child, tables_.tree.size());
    Box below = box, above = box;
    below.max[axis] = above.min[axis] = node.split_m;
    open_.push_back({node.below, below});
    open_.push_back({node.above, above});
    return {};
  }

  const CellTables& tables_;
  std::vector<bool> met_;
  std::vector<Open> open_;
};

}  // namespace

uint64_t CellTables::byte_size() const {
  const auto bytes = [](const auto& v) { return uint64_t(v.capacity()) * sizeof(v[0]); };
  return bytes(tree) + bytes(cells) + bytes(faces) + bytes(faces_of_cells) + bytes(portals);
}

Box rectangle_of(const CellTables& tables, const CellFace& face) {
  const Box &below = tables.cells[index_of(face.below)].box, &above = tables.cells[index_of(face.above)].box;
  return {glm::max(below.min, above.min), glm::min(below.max, above.max)};
}

std::optional<CellId> cell_at(const CellTables& tables, const glm::dvec3& point) {
  const auto holds = [&point](const Box& box) { return DBox{box.min, box.max}.contains(point); };
  if (tables.tree.empty() || !holds(tables.box)) return std::nullopt;
  const CellTreeNode* node = &tables.tree.front();
  while (node->axis != CellTreeNode::kLeaf)
    node = &tables.tree[point[static_cast<int>(node->axis)] < double(node->split_m) ? node->below : node->above];
  if (node->below == index_of(kNoCell) || !holds(tables.cells[node->below].box)) return std::nullopt;
  return CellId{node->below};
}

std::string find_defect(const CellTables& tables) {
  const FrontBound& bound = tables.bound;
  if (!(std::isfinite(bound.pixel_error) && bound.pixel_error > 0 && std::isfinite(bound.scale.focal_px) &&
        bound.scale.focal_px > 0 && std::isfinite(bound.scale.tan_corner) && bound.scale.tan_corner >= 0))
    return "the bound of the fronts is no number of pixels";
  if (tables.cells.size() >= index_of(kNoCell)) return fmt::format("{} cells are too many", tables.cells.size());
  if (std::string defect = find_cell_defect(tables); !defect.empty()) return defect;
  if (tables.faces_of_cells.size() != 2 * tables.faces.size())
    return fmt::format("{} faces, named {} times", tables.faces.size(), tables.faces_of_cells.size());
  for (size_t i = 0; i < tables.faces.size(); ++i)
    if (const std::string defect = find_face_defect(tables, tables.faces[i]); !defect.empty())
      return fmt::format("face {}: {}", i, defect);
  return TreeWalk(tables).run();
}

}  // namespace promenade
