#include "runtime/resident_set.h"

#include <algorithm>
#include <cassert>

#include "runtime/resident_state.h"

namespace promenade {

using residency::kFailuresKept, residency::kNoPart, residency::NodeStage, residency::NodeState;
using residency::PartStatus, residency::Transfer;

ResidentSet::ResidentSet(const ModelSource& source, const Renderer& renderer, uint64_t memory_bytes,
                         uint64_t fixed_bytes, double eviction_margin, double along_share,
                         const TextureLimit& texture_limit)
    : state_(std::make_unique<State>(source, renderer, memory_bytes, fixed_bytes, eviction_margin, along_share,
                                     texture_limit)) {}

ResidentSet::~ResidentSet() = default;

ResidentSet::Task ResidentSet::next_task(uint64_t piece_bytes) {
  State& s = *state_;
  const std::lock_guard lock(s.mutex);
  while (true) {
    NodeId id = s.list.next_unloaded();
    if (id == kNoNode) {
      ++s.counts.idle_steps;
      return {};
    }
    if (const NodeId along = s.along_locked(id, piece_bytes); along != kNoNode) {
      id = along;
      ++s.counts.nodes_along;
    }
    // What never fits is not begun.
    uint64_t largest = 0;
    s.each_part(id, [&](uint32_t part) {
      if (s.parts[part].status == PartStatus::absent)
        largest = std::max(largest, s.stored_bytes(part) + s.decoding_bytes(part, id));
    });
    if (largest > 0 && s.memory.fixed + s.pinned_bytes + largest > s.memory_bytes) {
      ++s.counts.refused_too_large;
      s.fail_node_locked(id);
      continue;
    }
    if (id != s.last_task) {
      if (s.last_task != kNoNode && s.nodes[index_of(s.last_task)].stage == NodeStage::loading)
        ++s.counts.loads_suspended;
      if (s.nodes[index_of(id)].stage == NodeStage::loading) ++s.counts.loads_resumed;
      s.last_task = id;
    }
    s.begin_loading_locked(id);
    uint32_t next_part = kNoTexture;
    bool leaving = false;
    s.each_part(id, [&](uint32_t part) {
      const PartStatus status = s.parts[part].status;
      leaving = leaving || status == PartStatus::destroying;
      if (next_part == kNoTexture && (status == PartStatus::absent || status == PartStatus::partial)) next_part = part;
    });
    assert(leaving || next_part != kNoTexture);
    if (leaving) return {Next::waiting, kNoNode, 0, 0, {}, {}};  // a texture is just being destroyed
    return s.task_for_locked(id, next_part, piece_bytes);
  }
}

void ResidentSet::finish_read(const Task& task, bool contiguous) {
  State& s = *state_;
  const std::lock_guard lock(s.mutex);
  s.transfers[task.part].read += task.into.size();
  s.counts.bytes_read += task.into.size();
  ++s.counts.pieces;
  if (!contiguous) ++s.counts.reads;
  s.run_bytes = contiguous ? s.run_bytes + task.into.size() : task.into.size();
  s.last_read = task.offset + task.into.size() == s.stored_bytes(task.part) ? task.part : kNoPart;
}

void ResidentSet::finish_mesh(const Task& task, std::unique_ptr<StagedMesh> staged) {
  State& s = *state_;
  const std::lock_guard lock(s.mutex);
  Transfer& transfer = s.transfers[task.part];
  transfer.stored = {};
  // Its size now, and the renderer's copy to come.
  s.set_part_locked(task.part, PartStatus::staged, staged->byte_size() + s.copy_bound(task.part, task.node));
  transfer.mesh = std::move(staged);
  s.ready.push_back(task.part);
  // The mesh is a node's last part: nothing is left to load.
  s.nodes[index_of(task.node)].stage = NodeStage::fetched;
  s.list.set_loaded(task.node, true);
}

void ResidentSet::finish_texture(const Task& task, std::unique_ptr<StagedTexture> staged) {
  State& s = *state_;
  const std::lock_guard lock(s.mutex);
  Transfer& transfer = s.transfers[task.part];
  transfer.stored = {};
  s.set_part_locked(task.part, PartStatus::staged, staged->byte_size() + s.copy_bound(task.part, task.node));
  transfer.texture = std::move(staged);
  s.ready.push_back(task.part);
}

void ResidentSet::fail(const Task& task, const Error& error) {
  State& s = *state_;
  const std::lock_guard lock(s.mutex);
  ++(task.next == Next::read ? s.counts.failed_reads : s.counts.failed_decodes);
  if (s.failures.size() < kFailuresKept) s.failures.push_back(error.message);
  s.drop_part_locked(task.part);
  s.fail_node_locked(task.node);
}

const TextureLimit& ResidentSet::texture_limit() const { return state_->texture_limit; }

uint32_t ResidentSet::texture_of_part(uint32_t part) const { return state_->texture_of_part[part]; }

std::span<const uint8_t> ResidentSet::resident() const { return state_->resident; }

const MemoryBudget& ResidentSet::budget() const { return state_->sizes.budget(); }

MeshHandle ResidentSet::mesh_of(NodeId id) const { return state_->meshes[index_of(id)]; }

ResidentSet::Leaving ResidentSet::refresh() {
  State& s = *state_;
  Leaving leaving;
  const std::lock_guard lock(s.mutex);
  for (const NodeId id : s.arrived) {
    s.resident[index_of(id)] = 1, s.drawn[index_of(id)] = 0;
    s.sizes.learn(id, s.parts[s.mesh_part(id)].bytes);
  }
  s.arrived.clear();
  leaving.nodes.swap(s.evicting);
  for (const NodeId id : leaving.nodes) s.resident[index_of(id)] = 0;
  for (const uint32_t part : s.releasing) {
    if (s.parts[part].status != PartStatus::releasing) continue;  // wanted again meanwhile
    s.set_part_locked(part, PartStatus::destroying, s.parts[part].bytes);
    leaving.textures.push_back(part);
  }
  s.releasing.clear();
  return leaving;
}

void ResidentSet::update(std::span<const PriorityUpdate> updates, const std::function<float(NodeId)>& reprice) {
  State& s = *state_;
  const std::lock_guard lock(s.mutex);
  ++s.epoch;
  s.updates.clear();
  for (const PriorityUpdate& u : updates) {
    NodeState& node = s.nodes[index_of(u.node)];
    node.visited = s.epoch;
    if (node.stage == NodeStage::failed || node.stage == NodeStage::evicting) continue;
    s.updates.push_back(u);
    // A load that nobody wanted for a while is taken up again.
    if (node.stage == NodeStage::loading && s.list.loaded(u.node)) s.list.set_loaded(u.node, false);
  }
  for (NodeId id = s.list.front(); id != kNoNode;) {
    const NodeId next = s.list.after(id);
    NodeState& node = s.nodes[index_of(id)];
    if (node.visited != s.epoch) {
      if (node.stage == NodeStage::absent) {
        s.list.erase(id);
      } else {
        s.updates.push_back({id, reprice(id)});
        // Bytes that have been read are kept while there is room, but no more are read.
        if (node.stage == NodeStage::loading) s.list.set_loaded(id, true);
      }
    }
    id = next;
  }
  s.list.update(s.updates);
}

void ResidentSet::mark_drawn(std::span<const NodeId> front) {
  State& s = *state_;
  for (const NodeId id : front) {
    if (s.drawn[index_of(id)] != 0) continue;
    s.drawn[index_of(id)] = 1;
    const std::lock_guard lock(s.mutex);
    s.each_part(id, [&](uint32_t part) {
      if (s.parts[part].useful) return;
      s.parts[part].useful = true;
      s.counts.bytes_read_useful += s.stored_bytes(part);
    });
  }
}

MemoryUse ResidentSet::memory() const {
  const std::lock_guard lock(state_->mutex);
  return state_->memory;
}

uint64_t ResidentSet::memory_peak_bytes() const {
  const std::lock_guard lock(state_->mutex);
  return state_->memory_peak;
}

LoaderCounts ResidentSet::counts() const {
  const std::lock_guard lock(state_->mutex);
  return state_->counts;
}

std::vector<NodeId> ResidentSet::resident_nodes() const {
  const State& s = *state_;
  const std::lock_guard lock(s.mutex);
  std::vector<NodeId> nodes;
  for (uint32_t i = 0; i < s.nodes.size(); ++i)
    if (s.nodes[i].stage == NodeStage::resident) nodes.push_back(NodeId{i});
  return nodes;
}

std::vector<std::string> ResidentSet::failures() const {
  const std::lock_guard lock(state_->mutex);
  return state_->failures;
}

}  // namespace promenade
