#include "layout/cell_front.h"

#include <algorithm>

namespace promenade {

bool ends_front(const NodeRecord& node, const Box& cell, const FrontBound& bound) {
  return node.child_count == 0 ||
         double(node.error_m) <= allowed_error_m(cell, node.box, bound.pixel_error, bound.scale);
}

std::vector<NodeId> cell_front(const Model& model, const Box& cell, const FrontBound& bound) {
  std::vector<NodeId> front, open = model.tables.roots;
  while (!open.empty()) {
    const NodeId id = open.back();
    open.pop_back();
    if (ends_front(model.tables.nodes[index_of(id)], cell, bound)) {
      front.push_back(id);
      continue;
    }
    const std::span<const NodeId> children = model.children_of(id);
    open.insert(open.end(), children.begin(), children.end());
  }
  std::sort(front.begin(), front.end());
  return front;
}

}  // namespace promenade
