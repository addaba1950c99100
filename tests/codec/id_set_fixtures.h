#pragma once
// Sets of ids, forests, and fronts that wander through them.

#include <algorithm>
#include <cstdint>
#include <random>
#include <vector>

#include "codec/id_forest.h"
#include "codec/id_set_block.h"

namespace promenade {

/// Numbers of 32 bits, the same everywhere.
class Random {
 public:
  explicit Random(uint32_t seed) : engine_(seed) {}
  uint32_t operator()() { return static_cast<uint32_t>(engine_()); }

 private:
  std::mt19937 engine_;
};

/// About `count` ids in runs of `run` on average.
inline std::vector<uint32_t> random_ids(Random& random, uint32_t universe, uint32_t count, uint32_t run) {
  std::vector<uint32_t> ids;
  while (ids.size() < count) {
    uint64_t id = random() % universe;
    for (uint32_t length = 1 + random() % (2 * run); length > 0 && id < universe; --length)
      ids.push_back(static_cast<uint32_t>(id++));
  }
  std::sort(ids.begin(), ids.end());
  ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
  return ids;
}

/// A forest of that many nodes or a few less, with up to eight children a node.
inline IdForest random_forest(Random& random, uint32_t nodes) {
  IdForest forest;
  const auto grow = [&](const auto& self, uint32_t below) -> void {
    const size_t node = forest.subtree_end.size();
    forest.subtree_end.push_back(0);
    const uint32_t children = below > 4 ? 2 + random() % 7 : 0;
    for (uint32_t i = 0; i < children; ++i)
      if ((below - 1) / children > 0) self(self, (below - 1) / children);
    forest.subtree_end[node] = forest.size();
  };
  while (forest.size() < nodes) grow(grow, std::min(nodes - forest.size(), 1 + random() % nodes));
  return forest;
}

/// A part of a front: every node refines with a chance of refine / 256 and is hidden with one of hide / 256. Each
/// node's chances are its own, so that sets with like numbers are alike.
inline std::vector<uint32_t> front_part(const IdForest& forest, uint32_t refine, uint32_t hide) {
  std::vector<uint32_t> set;
  for (uint32_t node = 0; node < forest.size();) {
    const uint32_t luck = node * 2654435761U;
    if (!forest.is_leaf(node) && (luck >> 24) < refine) {
      ++node;
      continue;
    }
    if ((luck >> 16 & 0xffU) >= hide) set.push_back(node);
    node = forest.subtree_end[node];
  }
  return set;
}

/// Sets along a walk.
inline IdSetBlock random_block(const IdForest& forest, Random& random, size_t sets) {
  IdSetBlock block;
  uint32_t refine = random() % 300, hide = random() % 256;
  for (size_t i = 0; i < sets; ++i) {
    if (random() % 4 != 0) refine = std::min<uint32_t>(refine + random() % 9, 300), hide += random() % 5;
    if (random() % 16 == 0) refine = random() % 300, hide = random() % 300;
    const std::vector<uint32_t> set = front_part(forest, refine, hide);
    block.ids.insert(block.ids.end(), set.begin(), set.end());
    block.ends.push_back(static_cast<uint32_t>(block.ids.size()));
  }
  return block;
}

}  // namespace promenade
