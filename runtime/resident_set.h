#pragma once
// What is in memory of a model, and what should be: node states, shared textures, the priority list, and one hard bound
// over all of it.

#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include "geometry/result.h"
#include "runtime/loader_counts.h"
#include "runtime/model_source.h"
#include "runtime/policy.h"
#include "runtime/priority_list.h"
#include "runtime/renderer.h"
#include "runtime/texture_limit.h"

namespace promenade {

/// Bytes by what holds them. Reserved before they are allocated, so that their sum never exceeds the bound.
struct MemoryUse {
  uint64_t fixed = 0;     ///< tables, node states, priority list, framebuffers
  uint64_t partial = 0;   ///< stored bytes, read or being read
  uint64_t decoding = 0;  ///< decoded but not yet staged
  uint64_t staged = 0;    ///< waiting for upload, and the room that the upload will take
  uint64_t uploaded = 0;  ///< in the renderer
  uint64_t total() const { return fixed + partial + decoding + staged + uploaded; }
};

/// Thread: functions marked render on the render thread only, choose on whichever one thread selects (the render
/// thread, or one beside it), loader on whichever one thread steps the loader; the others from any. Everything shared
/// is guarded by one mutex that is never held while reading, decoding, uploading or drawing.
class ResidentSet {
 public:
  /// along_share: of the largest priority, what a node must have to be read before it because it lies where the last
  /// read ended; 0: none is.
  ResidentSet(const ModelSource& source, const Renderer& renderer, uint64_t memory_bytes, uint64_t fixed_bytes,
              double eviction_margin, double along_share = 0, const TextureLimit& texture_limit = {});
  ~ResidentSet();
  ResidentSet(const ResidentSet&) = delete;
  ResidentSet& operator=(const ResidentSet&) = delete;

  // --- render ---
  /// Loads and uploads every root, synchronously. Errors name the node or the memory that is lacking.
  Status load_roots(Renderer& renderer);
  /// Handles of what is not shown any more, to be destroyed before the frame that is chosen next is drawn, and after
  /// those chosen before it, which may show it. Its bytes count until then.
  struct Leaving {
    std::vector<NodeId> nodes;
    std::vector<uint32_t> textures;  ///< parts
  };
  void let_go(const Leaving& leaving, Renderer& renderer);
  /// Uploads what is staged, most important first, until budget_ms is over (at least one part). Returns how many nodes
  /// may be shown from the next refresh() on.
  uint32_t upload(Renderer& renderer, double budget_ms);
  /// Destroys every handle.
  void clear(Renderer& renderer);

  // --- choose ---
  /// Brings the flags up to date: what has been uploaded may be shown, what the loader wants evicted may not.
  Leaving refresh();
  /// One flag a node, constant between two calls of refresh(): what may be drawn.
  std::span<const uint8_t> resident() const;
  /// What nodes take: as large as they were in memory, or as large as nodes like them. Changes in refresh().
  const MemoryBudget& budget() const;
  /// Of a node whose flag is set.
  MeshHandle mesh_of(NodeId id) const;
  /// Hands over priorities. Nodes listed before and not among `updates` are priced by `reprice` if they hold memory,
  /// else leave the list.
  void update(std::span<const PriorityUpdate> updates, const std::function<float(NodeId)>& reprice);
  /// Counts the bytes of these nodes' segments as useful.
  void mark_drawn(std::span<const NodeId> front);

  // --- loader ---
  enum class Next : uint8_t {
    read,
    decode,
    waiting,  ///< for room that the render thread must first let go
    idle,     ///< nothing is wanted, or nothing that matters more than what is in memory
  };
  struct Task {
    Next next = Next::idle;
    NodeId node = kNoNode;  ///< on whose behalf
    uint32_t part = 0;      ///< segment index
    uint64_t offset = 0;
    std::span<std::byte> into;          ///< read: the next piece's place in the part's buffer
    std::span<const std::byte> stored;  ///< decode: all of it
  };
  /// What to do next for the most important node that is not loaded; makes room for it by evicting less important ones.
  Task next_task(uint64_t piece_bytes);
  void finish_read(const Task& task, bool contiguous);
  void finish_mesh(const Task& task, std::unique_ptr<StagedMesh> staged);
  void finish_texture(const Task& task, std::unique_ptr<StagedTexture> staged);
  /// The part cannot be had: the node is never asked for again.
  void fail(const Task& task, const Error& error);
  const TextureLimit& texture_limit() const;
  /// Texture index of a part, or kNoTexture for a mesh.
  uint32_t texture_of_part(uint32_t part) const;

  // --- any ---
  MemoryUse memory() const;
  uint64_t memory_peak_bytes() const;
  LoaderCounts counts() const;
  /// Nodes that the renderer holds.
  std::vector<NodeId> resident_nodes() const;
  /// First few error messages of parts that failed.
  std::vector<std::string> failures() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace promenade
