#pragma once
// What a ResidentSet remembers, for the files that it is written in: resident_state.cpp has the ways of parts and nodes
// through memory, resident_room.cpp what is read next and what makes room for it, resident_upload.cpp what the render
// thread does, resident_set.cpp the rest.

#include <deque>
#include <memory>
#include <mutex>
#include <unordered_map>

#include "runtime/node_sizes.h"
#include "runtime/resident_set.h"

namespace promenade {
namespace residency {

/// Part of the bound kept free by evicting what the last selection did not visit, or matters so much less that it is
/// only foreseen, so that the loader seldom waits a frame for the render thread.
constexpr uint64_t kSlackDivisor = 16;
constexpr size_t kFailuresKept = 16;
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

}  // namespace residency

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
        drawn(model.tables.nodes.size(), 0),
        sizes(model, draws_with, pictures) {
    for (size_t i = 0; i < model.tables.textures.size(); ++i)
      texture_of_part[model.tables.textures[i].segment] = static_cast<uint32_t>(i);
    for (const NodeId root : model.tables.roots) nodes[index_of(root)].pinned = true;
    if (along_share > 0) find_order();
    memory.fixed = fixed + behind.capacity() * sizeof(NodeId) + list.byte_size() +
                   nodes.size() * (sizeof(residency::NodeState) + sizeof(MeshHandle) + sizeof(NodeId) + 2) +
                   parts.size() * (sizeof(residency::Part) + sizeof(uint32_t)) +
                   textures.size() * sizeof(TextureHandle) + sizes.byte_size();
    const uint64_t not_for_nodes = memory.fixed + memory_bytes / residency::kSlackDivisor;
    sizes.set_budget(memory_bytes - std::min(memory_bytes, not_for_nodes));
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
  void set_part_locked(uint32_t part, residency::PartStatus status, uint64_t bytes);
  void count_locked(residency::PartStatus status, uint64_t bytes, bool add);

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
  std::vector<residency::NodeState> nodes;
  std::vector<residency::Part> parts;     ///< by segment
  std::vector<uint32_t> texture_of_part;  ///< constant
  std::unordered_map<uint32_t, residency::Transfer> transfers;
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
  uint32_t last_read = residency::kNoPart;  ///< the part that was read to its end last
  uint64_t run_bytes = 0;                   ///< of parts read one behind the other, up to that
  std::vector<NodeId> behind;               ///< constant, by part: the node whose mesh follows on disk
  uint32_t epoch = 0;
  std::vector<PriorityUpdate> updates;  ///< scratch

  // Render thread's own.
  std::vector<TextureHandle> textures;
  /// Others may read those of nodes whose flag is set: nobody writes them then.
  std::vector<MeshHandle> meshes;
  // Of the thread that chooses.
  std::vector<uint8_t> resident, drawn;
  NodeSizes sizes;
};

}  // namespace promenade
