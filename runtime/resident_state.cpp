// The ways of parts and nodes through memory, and the accounts of it.

#include "runtime/resident_state.h"

#include <algorithm>

#include "runtime/decode_part.h"

namespace promenade {

using residency::NodeStage, residency::NodeState, residency::Part, residency::PartStatus;

uint64_t ResidentSet::State::staged_bound(uint32_t part, NodeId node) const {
  const uint32_t texture = texture_of_part[part];
  if (texture != kNoTexture) return limited_bytes_bound(model.tables.textures[texture], renderer, texture_limit);
  const NodeRecord& record = model.tables.nodes[index_of(node)];
  return renderer.mesh_bytes_bound(record.vertices, record.triangles);
}

uint64_t ResidentSet::State::decoding_bytes(uint32_t part, NodeId node) const {
  const uint32_t texture = texture_of_part[part];
  const uint64_t decoded = texture != kNoTexture ? decoded_bytes_bound(model.tables.textures[texture])
                                                 : decoded_bytes_bound(model.tables.nodes[index_of(node)]);
  const uint64_t staged = staged_bound(part, node);
  // While decoding: the thing itself and its staged form. Afterwards: staged, and the renderer's copy of it.
  const uint64_t later = staged + copy_bound(part, node);
  const uint64_t stored = stored_bytes(part);
  return std::max(decoded + staged, later > stored ? later - stored : 0);
}

void ResidentSet::State::count_locked(PartStatus status, uint64_t bytes, bool add) {
  uint64_t* account = nullptr;
  switch (status) {
    case PartStatus::absent:
      return;
    case PartStatus::partial:
      account = &memory.partial;
      break;
    case PartStatus::decoding:
      account = &memory.decoding;
      break;
    case PartStatus::staged:
    case PartStatus::uploading:
      account = &memory.staged;
      break;
    case PartStatus::uploaded:
    case PartStatus::releasing:
    case PartStatus::destroying:
      account = &memory.uploaded;
      break;
  }
  *account = add ? *account + bytes : *account - bytes;
}

void ResidentSet::State::set_part_locked(uint32_t part, PartStatus status, uint64_t bytes) {
  Part& p = parts[part];
  count_locked(p.status, p.bytes, false);
  p.status = status;
  p.bytes = bytes;
  count_locked(status, bytes, true);
  memory_peak = std::max(memory_peak, memory.total());
}

/// From now on the node holds its textures.
void ResidentSet::State::begin_loading_locked(NodeId id) {
  NodeState& node = nodes[index_of(id)];
  if (node.stage != NodeStage::absent) return;
  node.stage = NodeStage::loading;
  for (const uint32_t texture : model.textures_of(id)) {
    const uint32_t part = model.tables.textures[texture].segment;
    ++parts[part].references;
    if (parts[part].status == PartStatus::releasing) {
      pending_bytes -= parts[part].bytes;
      set_part_locked(part, PartStatus::uploaded, parts[part].bytes);
    }
  }
}

/// Forgets what the loader holds of a part.
void ResidentSet::State::drop_part_locked(uint32_t part) {
  const PartStatus status = parts[part].status;
  if (status == PartStatus::staged) {
    ready.erase(std::remove(ready.begin(), ready.end(), part), ready.end());
    ++counts.staged_dropped;
  }
  transfers.erase(part);
  set_part_locked(part, PartStatus::absent, 0);
}

void ResidentSet::State::release_texture_locked(uint32_t part) {
  if (--parts[part].references > 0) return;
  switch (parts[part].status) {
    case PartStatus::partial:
    case PartStatus::decoding:
    case PartStatus::staged:
      drop_part_locked(part);
      break;
    case PartStatus::uploaded:
      set_part_locked(part, PartStatus::releasing, parts[part].bytes);
      pending_bytes += parts[part].bytes;
      releasing.push_back(part);
      break;
    default:
      break;
  }
}

/// Gives up a node that is not in the renderer.
void ResidentSet::State::drop_node_locked(NodeId id) {
  const uint32_t mesh = mesh_part(id);
  if (parts[mesh].status != PartStatus::absent) drop_part_locked(mesh);
  for (const uint32_t texture : model.textures_of(id)) release_texture_locked(model.tables.textures[texture].segment);
  nodes[index_of(id)].stage = NodeStage::absent;
}

void ResidentSet::State::fail_node_locked(NodeId id) {
  if (nodes[index_of(id)].stage == NodeStage::loading || nodes[index_of(id)].stage == NodeStage::fetched)
    drop_node_locked(id);
  nodes[index_of(id)].stage = NodeStage::failed;
  list.erase(id);
}

}  // namespace promenade
