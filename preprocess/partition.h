#pragma once
// The second look at a source: every triangle to its chunk.

#include "preprocess/chunk_tree.h"
#include "preprocess/spill.h"
#include "preprocess/survey.h"

namespace promenade {

/// Flattens all instances, a slice of one at a time, and spills their triangles to the chunks of the tree, materials
/// renumbered to the survey's table. Instances are never in memory all together. Frees the survey's cached scenes. A
/// partition that was finished before, from the same input (hash), is taken as it is. Errors: import's, the disk,
/// cancellation.
Result<SpillIndex> partition_source(Survey& survey, const ChunkTree& tree, const ImportOptions& options,
                                    const MemoryBudget& budget, const WorkFolder& folder, uint64_t hash,
                                    JobMonitor& monitor);

/// Sends the triangles of a mesh in model space down the tree; the mesh grows by what is cut. Returns the pieces by
/// chunk, ascending.
std::vector<std::pair<uint32_t, Mesh>> route(Mesh mesh, const ChunkTree& tree);

}  // namespace promenade
