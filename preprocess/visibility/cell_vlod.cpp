#include "preprocess/visibility/cell_vlod.h"

namespace promenade {

Result<CellVlod> cell_vlod(const Model& model, HiderChain hiders, const Box& cell, const FrontBound& bound) {
  const std::vector<NodeId> front = cell_front(model, cell, bound);
  std::vector<uint8_t> hidden(front.size(), 0);
  for (const std::unique_ptr<Hider>& hider : hiders) PROMENADE_TRY(hider->hide({cell, front}, hidden));
  CellVlod vlod;
  vlod.front_nodes = static_cast<uint32_t>(front.size());
  for (size_t i = 0; i < front.size(); ++i) {
    const uint32_t triangles = model.tables.nodes[index_of(front[i])].triangles;
    vlod.front_triangles += triangles;
    if (hidden[i] != 0) continue;
    vlod.nodes.push_back(front[i]);
    vlod.triangles += triangles;
  }
  return vlod;
}

}  // namespace promenade
