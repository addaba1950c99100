#include "runtime/node_sizes.h"

#include <algorithm>
#include <limits>

namespace promenade {
namespace {

uint32_t narrowed(double bytes) {
  return static_cast<uint32_t>(std::min(bytes, double(std::numeric_limits<uint32_t>::max())));
}

}  // namespace

NodeSizes::NodeSizes(const Model& model, const Renderer& renderer, const TextureLimit& limit)
    : model_(model), renderer_(renderer), known_(model.tables.nodes.size(), 0) {
  budget_.node_bytes.reserve(known_.size());
  for (uint32_t i = 0; i < known_.size(); ++i) budget_.node_bytes.push_back(bound_of(NodeId{i}));
  budget_.texture_bytes.reserve(model.tables.textures.size());
  for (const TextureRecord& texture : model.tables.textures)
    budget_.texture_bytes.push_back(narrowed(double(limited_bytes(texture, limit))));
}

uint32_t NodeSizes::bound_of(NodeId id) const {
  const NodeRecord& node = model_.tables.nodes[index_of(id)];
  return narrowed(double(renderer_.mesh_bytes_bound(node.vertices, node.triangles)));
}

void NodeSizes::learn(NodeId id, uint64_t bytes) {
  if (known_[index_of(id)] != 0) return;
  known_[index_of(id)] = 1;
  budget_.node_bytes[index_of(id)] = narrowed(double(bytes));
  known_bytes_ += double(bytes);
  known_bounds_ += double(bound_of(id));
  if (++known_nodes_ < guess_at_) return;
  guess_unknown();
  guess_at_ = 2 * known_nodes_;  // so that all guesses together take a look at each node for each time it doubles
}

void NodeSizes::guess_unknown() {
  const double part = known_bytes_ / std::max(known_bounds_, 1.0);
  for (uint32_t i = 0; i < known_.size(); ++i)
    if (known_[i] == 0) budget_.node_bytes[i] = narrowed(part * double(bound_of(NodeId{i})));
}

}  // namespace promenade
