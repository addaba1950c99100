#include "runtime/resident_set.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <chrono>
#include <deque>
#include <memory>
#include <unordered_map>

#include "runtime/decode_part.h"

namespace promenade {
namespace {

/// Part of the bound kept free by evicting what the last selection did not visit, or matters so much less that it is
/// only foreseen, so that the loader seldom waits a frame for the render thread.
constexpr uint64_t kSlackDivisor = 16;
constexpr double kMuchLess = 1e-6;
constexpr size_t kFailuresKept = 16;
/// After so many bytes in a row the most important node has its turn, wherever it lies.
constexpr uint64_t kLongestRun = uint64_t(512) << 10;
constexpr uint32_t kNoPart = 0xffffffffU;

enum class PartStatus : uint8_t {
  absent,
  partial,  ///< being read
  decoding,
  staged,  ///< waiting for upload
  uploading,
  uploaded,
  releasing,  ///< a texture that nobody refers to: destroyed when the render thread next begins a frame
  destroying,
};

/// A segment's way through memory.
struct Part {
  uint64_t bytes = 0;       ///< reserved
  uint32_t references = 0;  ///< of nodes being loaded or loaded; textures only
  PartStatus status = PartStatus::absent;
  bool useful = false;  ///< drawn since it was read
};

enum class NodeStage : uint8_t { absent, loading, fetched, resident, evicting, failed };

struct NodeState {
  uint32_t visited = 0;  ///< the update that named it last
  NodeStage stage = NodeStage::absent;
  bool pinned = false;  ///< a root
};

/// What the loader holds of a part.
struct Transfer {
  std::vector<std::byte> stored;
  uint64_t read = 0;
  std::unique_ptr<StagedMesh> mesh;
  std::unique_ptr<StagedTexture> texture;
  NodeId node = kNoNode;
};

double now_ms() {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace

/// Everything is guarded by `mutex` but for what says otherwise. Functions ending in _locked are called with it held.
struct ResidentSet::State {
  State(const ModelSource& from, const Renderer& draws_with, uint64_t bound, uint64_t fixed, double margin,
        double along, const TextureLimit& pictures)
      : source(from),
        model(from.model()),
        renderer(draws_with),
        memory_bytes(bound),
        eviction_margin(margin),
        along_share(along),
        texture_limit(pictures),
        list(static_cast<uint32_t>(model.tables.nodes.size())),
        nodes(model.tables.nodes.size()),
        parts(model.tables.segments.size()),
        texture_of_part(model.tables.segments.size(), kNoTexture),
        textures(model.tables.textures.size(), kNoTextureHandle),
        meshes(model.tables.nodes.size(), kNoMeshHandle),
        resident(model.tables.nodes.size(), 0),
        drawn(model.tables.nodes.size(), 0) {
    for (size_t i = 0; i < model.tables.textures.size(); ++i)
      texture_of_part[model.tables.textures[i].segment] = static_cast<uint32_t>(i);
    for (const NodeId root : model.tables.roots) nodes[index_of(root)].pinned = true;
    if (along_share > 0) find_order();
    memory.fixed = fixed + behind.capacity() * sizeof(NodeId) + list.byte_size() +
                   nodes.size() * (sizeof(NodeState) + sizeof(MeshHandle) + sizeof(NodeId) + 2) +
                   parts.size() * (sizeof(Part) + sizeof(uint32_t)) + textures.size() * sizeof(TextureHandle);
    memory_peak = memory.total();
  }

  /// Which node's mesh lies behind each segment.
  void find_order() {
    std::vector<uint32_t> order;
    order.reserve(nodes.size());
    for (uint32_t i = 0; i < nodes.size(); ++i) order.push_back(i);
    const auto place = [this](uint32_t node) {
      const SegmentRecord& s = model.tables.segments[model.tables.nodes[node].segment];
      return std::pair(s.file, s.offset);
    };
    std::sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) { return place(a) < place(b); });
    behind.assign(parts.size(), kNoNode);
    for (size_t i = 1; i < order.size(); ++i) {
      const SegmentRecord& before = model.tables.segments[model.tables.nodes[order[i - 1]].segment];
      if (place(order[i]) == std::pair(before.file, before.offset + before.stored_bytes))
        behind[model.tables.nodes[order[i - 1]].segment] = NodeId{order[i]};
    }
  }

  // --- sizes ---
  uint64_t stored_bytes(uint32_t part) const { return model.tables.segments[part].stored_bytes; }
  /// Room that decoding takes beside the stored bytes, and then the way from staged to uploaded.
  uint64_t decoding_bytes(uint32_t part, NodeId node) const;
  uint64_t staged_bound(uint32_t part, NodeId node) const;
  /// What the renderer takes for a part besides what was staged.
  uint64_t copy_bound(uint32_t part, NodeId node) const {
    return renderer.copies_staged() ? staged_bound(part, node) : 0;
  }

  // --- accounts ---
  void set_part_locked(uint32_t part, PartStatus status, uint64_t bytes);
  void count_locked(PartStatus status, uint64_t bytes, bool add);

  // --- nodes ---
  template <class F>
  void each_part(NodeId id, F&& f) const {
    for (const uint32_t texture : model.textures_of(id)) f(model.tables.textures[texture].segment);
    f(model.tables.nodes[index_of(id)].segment);
  }
  uint32_t mesh_part(NodeId id) const { return model.tables.nodes[index_of(id)].segment; }
  void begin_loading_locked(NodeId id);
  void release_texture_locked(uint32_t part);
  void drop_part_locked(uint32_t part);
  void drop_node_locked(NodeId id);
  void fail_node_locked(NodeId id);
  void evict_locked(NodeId id);
  bool may_evict_locked(NodeId id) const;

  enum class Room : uint8_t { granted, pending, refused };
  Room make_room_locked(uint64_t bytes, NodeId candidate);
  void make_slack_locked(NodeId candidate);

  NodeId along_locked(NodeId most_important, uint64_t piece_bytes) const;
  bool waits_for_disk_locked(NodeId id) const;
  Task task_for_locked(NodeId id, uint32_t part, uint64_t piece_bytes);
  Task task_without_room_locked(Room room);
  bool upload_part(uint32_t part, Renderer& target);
  Status load_root(NodeId root, Renderer& target);

  const ModelSource& source;
  const Model& model;
  const Renderer& renderer;
  const uint64_t memory_bytes;
  const double eviction_margin, along_share;
  const TextureLimit texture_limit;

  mutable std::mutex mutex;
  PriorityList list;
  std::vector<NodeState> nodes;
  std::vector<Part> parts;                ///< by segment
  std::vector<uint32_t> texture_of_part;  ///< constant
  std::unordered_map<uint32_t, Transfer> transfers;
  std::deque<uint32_t>
      ready;  ///< staged parts in the order of their decoding: textures before the meshes that need them
  std::vector<NodeId> arrived;  ///< uploaded since the last refresh(), in that order
  std::vector<NodeId> evicting;
  std::vector<uint32_t> releasing;
  uint64_t pending_bytes = 0;  ///< held by `evicting` and `releasing`
  uint64_t pinned_bytes = 0;
  MemoryUse memory;
  uint64_t memory_peak = 0;
  LoaderCounts counts;
  std::vector<std::string> failures;
  NodeId last_task = kNoNode;
  uint32_t last_read = kNoPart;  ///< the part that was read to its end last
  uint64_t run_bytes = 0;        ///< of parts read one behind the other, up to that
  std::vector<NodeId> behind;    ///< constant, by part: the node whose mesh follows on disk
  uint32_t epoch = 0;
  std::vector<PriorityUpdate> updates;  ///< scratch

  // Render thread's own.
  std::vector<TextureHandle> textures;
  /// Others may read those of nodes whose flag is set: nobody writes them then.
  std::vector<MeshHandle> meshes;
  // Of the thread that chooses.
  std::vector<uint8_t> resident, drawn;
};

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

// --- the class's own functions ---------------------------------------------------------------------------------------

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

MeshHandle ResidentSet::mesh_of(NodeId id) const { return state_->meshes[index_of(id)]; }

ResidentSet::Leaving ResidentSet::refresh() {
  State& s = *state_;
  Leaving leaving;
  const std::lock_guard lock(s.mutex);
  for (const NodeId id : s.arrived) s.resident[index_of(id)] = 1, s.drawn[index_of(id)] = 0;
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

void ResidentSet::let_go(const Leaving& leaving, Renderer& renderer) {
  if (leaving.nodes.empty() && leaving.textures.empty()) return;
  State& s = *state_;
  for (const NodeId id : leaving.nodes) {
    renderer.destroy(s.meshes[index_of(id)]);
    s.meshes[index_of(id)] = kNoMeshHandle;
  }
  for (const uint32_t part : leaving.textures) {
    TextureHandle& handle = s.textures[s.texture_of_part[part]];
    renderer.destroy(handle);
    handle = kNoTextureHandle;
  }
  const std::lock_guard lock(s.mutex);
  for (const NodeId id : leaving.nodes) {
    const uint32_t part = s.mesh_part(id);
    s.pending_bytes -= s.parts[part].bytes;
    s.set_part_locked(part, PartStatus::absent, 0);
    s.nodes[index_of(id)].stage = NodeStage::absent;
  }
  for (const uint32_t part : leaving.textures) {
    s.pending_bytes -= s.parts[part].bytes;
    s.set_part_locked(part, PartStatus::absent, 0);
  }
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

/// The part is marked `uploading`: nobody else touches it. True: it was a node's mesh, and the node is there now.
bool ResidentSet::State::upload_part(uint32_t part, Renderer& target) {
  std::unique_ptr<StagedMesh> mesh;
  std::unique_ptr<StagedTexture> texture;
  NodeId id = kNoNode;
  {
    const std::lock_guard lock(mutex);
    Transfer& transfer = transfers[part];
    mesh = std::move(transfer.mesh);
    texture = std::move(transfer.texture);
    id = transfer.node;
  }
  uint64_t bytes = 0;
  std::string problem;
  if (texture) {
    const Result<TextureHandle> handle = target.create_texture(*texture);
    if (handle) {
      textures[texture_of_part[part]] = *handle;
      bytes = target.bytes_of(*handle);
    } else {
      problem = handle.error().message;
    }
  } else {
    const Result<MeshHandle> handle = target.create_mesh(*mesh, textures);
    if (handle) {
      meshes[index_of(id)] = *handle;
      bytes = target.bytes_of(*handle);
    } else {
      problem = handle.error().message;
    }
  }
  const bool is_mesh = mesh != nullptr;
  mesh.reset();
  texture.reset();
  const std::lock_guard lock(mutex);
  transfers.erase(part);
  if (!problem.empty()) {
    ++counts.failed_uploads;
    if (failures.size() < kFailuresKept) failures.push_back(problem);
    set_part_locked(part, PartStatus::absent, 0);
    if (is_mesh) fail_node_locked(id);
    return false;
  }
  set_part_locked(part, PartStatus::uploaded, bytes);
  if (is_mesh) {
    nodes[index_of(id)].stage = NodeStage::resident;
    arrived.push_back(id);
    ++counts.nodes_loaded;
    return true;
  }
  ++counts.textures_loaded;
  if (parts[part].references == 0) {  // its nodes were given up during the upload
    ++parts[part].references;
    release_texture_locked(part);
  }
  return false;
}

uint32_t ResidentSet::upload(Renderer& renderer, double budget_ms) {
  State& s = *state_;
  const double begin = now_ms();
  uint32_t arrived = 0;
  for (bool first = true; first || now_ms() - begin < budget_ms; first = false) {
    uint32_t part = 0;
    {
      const std::lock_guard lock(s.mutex);
      if (s.ready.empty()) break;
      part = s.ready.front();
      s.ready.pop_front();
      s.set_part_locked(part, PartStatus::uploading, s.parts[part].bytes);
    }
    if (s.upload_part(part, renderer)) ++arrived;
  }
  return arrived;
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

Status ResidentSet::State::load_root(NodeId root, Renderer& target) {
  {
    const std::lock_guard lock(mutex);
    begin_loading_locked(root);
  }
  Status outcome = Done{};
  each_part(root, [&](uint32_t part) {
    if (!outcome.ok()) return;
    {
      const std::lock_guard lock(mutex);
      if (parts[part].status == PartStatus::uploaded) return;
      const uint64_t needed = stored_bytes(part) + decoding_bytes(part, root);
      if (memory.total() + needed > memory_bytes) {
        outcome = Error{
            fmt::format("the memory bound of {} bytes is too small: {} bytes are taken by tables and the roots loaded "
                        "so far, and root {} takes {} to load; give more",
                        memory_bytes, memory.total(), index_of(root), needed)};
        return;
      }
      set_part_locked(part, PartStatus::decoding, needed);
      transfers[part].node = root;
      transfers[part].stored.resize(stored_bytes(part));
      parts[part].useful = false;
      counts.bytes_read += stored_bytes(part);
      ++counts.pieces;
      ++counts.reads;
    }
    Transfer& transfer = transfers[part];
    outcome = source.read_piece(part, 0, transfer.stored);
    if (!outcome.ok()) return;
    StagedPart staged;
    outcome = decode_part(source, renderer, root, texture_of_part[part], texture_limit, transfer.stored, staged);
    if (!outcome.ok()) return;
    {
      const std::lock_guard lock(mutex);
      transfer.stored = {};
      transfer.mesh = std::move(staged.mesh);
      transfer.texture = std::move(staged.texture);
      set_part_locked(part, PartStatus::uploading, staged_bound(part, root) + copy_bound(part, root));
    }
    upload_part(part, target);
    if (counts.failed_uploads > 0) outcome = Error{failures.back()};
  });
  if (!outcome.ok()) return Error{fmt::format("root {}: {}", index_of(root), outcome.error().message)};
  const std::lock_guard lock(mutex);
  list.update(root, 0);
  list.set_loaded(root, true);
  return Done{};
}

Status ResidentSet::load_roots(Renderer& renderer) {
  for (const NodeId root : state_->model.tables.roots) PROMENADE_TRY(state_->load_root(root, renderer));
  refresh();  // nothing is leaving yet
  const std::lock_guard lock(state_->mutex);
  state_->pinned_bytes = state_->memory.uploaded;
  return Done{};
}

void ResidentSet::clear(Renderer& renderer) {
  State& s = *state_;
  for (MeshHandle& mesh : s.meshes) {
    if (mesh != kNoMeshHandle) renderer.destroy(mesh);
    mesh = kNoMeshHandle;
  }
  for (TextureHandle& texture : s.textures) {
    if (texture != kNoTextureHandle) renderer.destroy(texture);
    texture = kNoTextureHandle;
  }
  std::fill(s.resident.begin(), s.resident.end(), uint8_t(0));
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
