#pragma once
// The work units of the HLOD tree: one per chunk, each from its spilled triangles to its root, and one for the nodes
// above them.

#include <functional>
#include <vector>

#include "geometry/job_monitor.h"
#include "preprocess/chunk_tree.h"
#include "preprocess/memory_budget.h"
#include "preprocess/node_unit.h"
#include "preprocess/spill.h"

namespace promenade {

struct TreeOptions {
  uint32_t node_triangles = 2250;
  LevelFactors level_factors;
  uint64_t hash = 0;           ///< of all that the units depend on
  bool named_classes = false;  ///< leaves keep how much of them is of which class
};

struct TreeUnits {
  std::vector<NodeUnit> chunks;   ///< by chunk
  std::vector<NodeUnit> objects;  ///< that move; not build_tree's
  NodeUnit top;                   ///< empty when the tree's root is a chunk's
  uint64_t resumed = 0;           ///< units found done
};

/// Builds all units, several chunks at once as far as memory goes. Each is published as it is done. Errors: the disk,
/// cancellation (between nodes).
Result<TreeUnits> build_tree(const SpillIndex& spill, const ChunkTree& tree, const NodeBuilder& builder,
                             const TreeOptions& options, const MemoryBudget& budget, const WorkFolder& folder,
                             JobMonitor& monitor);

/// The triangles of an object that moves, in its own space.
struct ObjectMesh {
  Mesh mesh;
  std::vector<ClassRun> classes;
};
/// The unit of one such object.
Result<NodeUnit> build_object(ObjectMesh object, const NodeBuilder& builder, const TreeOptions& options,
                              const WorkFolder& folder, const std::string& name, JobMonitor& monitor);

}  // namespace promenade
