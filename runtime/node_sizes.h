#pragma once
// How large nodes are in memory, as far as those tell that have been there.

#include "runtime/memory_fit.h"
#include "runtime/renderer.h"
#include "runtime/texture_limit.h"

namespace promenade {

/// A renderer's bounds are several times what meshes take: what has not been in memory is taken to be as much below
/// its bound as what has. One thread.
class NodeSizes {
 public:
  NodeSizes(const Model& model, const Renderer& renderer, const TextureLimit& limit);

  /// For all nodes together.
  void set_budget(uint64_t bytes) { budget_.bytes = bytes; }
  /// What its mesh took. A node's size does not change.
  void learn(NodeId id, uint64_t bytes);
  const MemoryBudget& budget() const { return budget_; }
  uint64_t byte_size() const { return budget_.byte_size() + known_.capacity() * sizeof(uint8_t); }

 private:
  uint32_t bound_of(NodeId id) const;
  void guess_unknown();

  const Model& model_;
  const Renderer& renderer_;
  MemoryBudget budget_;
  std::vector<uint8_t> known_;  ///< by node
  uint64_t known_nodes_ = 0, guess_at_ = 1;
  double known_bytes_ = 0, known_bounds_ = 0;
};

}  // namespace promenade
