// What is read or decoded next, and what leaves to make room for it.

#include "runtime/resident_state.h"

#include <algorithm>

namespace promenade {

using residency::kNoPart, residency::kSlackDivisor, residency::NodeStage, residency::NodeState;
using residency::PartStatus, residency::Transfer;

namespace {

/// What matters by this much less than what is asked for now is only foreseen.
constexpr double kMuchLess = 1e-6;
/// After so many bytes in a row the most important node has its turn, wherever it lies.
constexpr uint64_t kLongestRun = uint64_t(512) << 10;

}  // namespace

bool ResidentSet::State::may_evict_locked(NodeId id) const {
  const NodeState& node = nodes[index_of(id)];
  if (node.pinned) return false;
  if (node.stage == NodeStage::resident || node.stage == NodeStage::loading) return true;
  if (node.stage != NodeStage::fetched) return false;
  bool uploading = false;
  each_part(id, [&](uint32_t part) { uploading = uploading || parts[part].status == PartStatus::uploading; });
  return !uploading;
}

void ResidentSet::State::evict_locked(NodeId id) {
  NodeState& node = nodes[index_of(id)];
  if (node.stage == NodeStage::resident) {
    node.stage = NodeStage::evicting;
    list.erase(id);
    evicting.push_back(id);
    pending_bytes += parts[mesh_part(id)].bytes;
    for (const uint32_t texture : model.textures_of(id)) release_texture_locked(model.tables.textures[texture].segment);
    ++counts.nodes_evicted;
    return;
  }
  if (node.stage == NodeStage::loading) ++counts.partials_dropped;
  drop_node_locked(id);
  list.set_loaded(id, false);
  // What nobody wants any more is not to be loaded again either.
  if (node.visited != epoch) list.erase(id);
}

/// Evicts, least important first, until `bytes` fit or only more important nodes are left.
ResidentSet::State::Room ResidentSet::State::make_room_locked(uint64_t bytes, NodeId candidate) {
  if (memory.total() + bytes <= memory_bytes) return Room::granted;
  const double importance = double(list.priority(candidate));
  NodeId at = list.back();
  while (memory.total() - pending_bytes + bytes > memory_bytes) {
    while (at != kNoNode && (at == candidate || !may_evict_locked(at))) at = list.before(at);
    if (at == kNoNode || double(list.priority(at)) * (1 + eviction_margin) >= importance) return Room::refused;
    const NodeId victim = at;
    at = list.before(at);
    evict_locked(victim);
  }
  make_slack_locked(candidate);
  return memory.total() + bytes <= memory_bytes ? Room::granted : Room::pending;
}

void ResidentSet::State::make_slack_locked(NodeId candidate) {
  const uint64_t enough = memory_bytes - memory_bytes / kSlackDivisor;
  NodeId at = list.back();
  while (at != kNoNode && memory.total() - pending_bytes > enough && list.priority(at) < list.priority(candidate)) {
    const NodeId victim = at;
    at = list.before(at);
    const bool spare = nodes[index_of(victim)].visited != epoch ||
                       double(list.priority(victim)) < kMuchLess * double(list.priority(candidate));
    if (victim != candidate && spare && may_evict_locked(victim)) evict_locked(victim);
  }
}

ResidentSet::Task ResidentSet::State::task_without_room_locked(Room room) {
  if (room == Room::pending) {
    ++counts.waits_for_eviction;
    return {Next::waiting, kNoNode, 0, 0, {}, {}};
  }
  ++counts.refused_memory;
  return {};
}

/// Whether the next thing to do for a node is to read, not to decode what was read.
bool ResidentSet::State::waits_for_disk_locked(NodeId id) const {
  bool reads = false, found = false;
  each_part(id, [&](uint32_t part) {
    const PartStatus status = parts[part].status;
    if (found || (status != PartStatus::absent && status != PartStatus::partial)) return;
    found = true;
    const auto transfer = transfers.find(part);
    reads = status == PartStatus::absent || transfer == transfers.end() || transfer->second.read < stored_bytes(part);
  });
  return reads;
}

/// The node whose mesh lies where the last read ended, if it is worth reading now: it goes on where the disk is.
NodeId ResidentSet::State::along_locked(NodeId most_important, uint64_t piece_bytes) const {
  if (last_read == kNoPart || behind.empty() || run_bytes >= kLongestRun || !waits_for_disk_locked(most_important))
    return kNoNode;
  const NodeId id = behind[last_read];
  if (id == kNoNode || id == most_important || !list.contains(id) || list.loaded(id) ||
      nodes[index_of(id)].stage != NodeStage::absent)
    return kNoNode;
  if (double(list.priority(id)) < along_share * double(list.priority(most_important))) return kNoNode;
  const uint32_t mesh = mesh_part(id);
  bool only_mesh = stored_bytes(mesh) <= piece_bytes;
  each_part(id, [&](uint32_t part) {
    const PartStatus status = parts[part].status;
    only_mesh = only_mesh && (part == mesh || status == PartStatus::staged || status == PartStatus::uploading ||
                              status == PartStatus::uploaded);
  });
  // Nothing makes room for what came along.
  const bool fits = memory.total() + stored_bytes(mesh) + decoding_bytes(mesh, id) <= memory_bytes;
  return only_mesh && fits ? id : kNoNode;
}

ResidentSet::Task ResidentSet::State::task_for_locked(NodeId id, uint32_t part, uint64_t piece_bytes) {
  const uint64_t stored = stored_bytes(part);
  if (parts[part].status == PartStatus::absent) {
    const Room room = make_room_locked(stored, id);
    if (room != Room::granted) return task_without_room_locked(room);
    set_part_locked(part, PartStatus::partial, stored);
    parts[part].useful = false;
    Transfer& begun = transfers[part];
    begun.stored.resize(stored);
    begun.node = id;
  }
  Transfer& transfer = transfers[part];
  if (transfer.read < stored) {
    const uint64_t bytes = std::min(piece_bytes, stored - transfer.read);
    return {Next::read, id, part, transfer.read, std::span(transfer.stored).subspan(transfer.read, bytes), {}};
  }
  const uint64_t extra = decoding_bytes(part, id);
  const Room room = make_room_locked(extra, id);
  if (room != Room::granted) return task_without_room_locked(room);
  set_part_locked(part, PartStatus::decoding, stored + extra);
  return {Next::decode, id, part, 0, {}, transfer.stored};
}

}  // namespace promenade
