#include "cli/near_sets.h"

#include <algorithm>

#include "cli/console.h"
#include "codec/id_set.h"

namespace promenade {

std::vector<uint32_t> leaves_near(const Model& model, const Box& box) {
  std::vector<uint32_t> leaves;
  std::vector<NodeId> open = model.tables.roots;
  while (!open.empty()) {
    const NodeId id = open.back();
    open.pop_back();
    const NodeRecord& node = model.tables.nodes[index_of(id)];
    if (!node.box.overlaps(box)) continue;
    if (node.child_count == 0) leaves.push_back(index_of(id));
    for (const NodeId child : model.children_of(id)) open.push_back(child);
  }
  std::sort(leaves.begin(), leaves.end());
  return leaves;
}

void NearSets::add(const Model& model, const Box& near, const Box& near_beside) {
  const WallClock finding;
  const std::vector<uint32_t> here = leaves_near(model, near);
  find_s += finding.seconds();
  const std::vector<uint32_t> difference = symmetric_difference(here, leaves_near(model, near_beside));
  ++steps, leaves += here.size(), changed += difference.size(), delta_bytes += encode_ids(difference).size();
}

}  // namespace promenade
