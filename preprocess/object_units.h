#pragma once
// The work units of objects that move: each has a tree of its own, outside that of what stands still.

#include <vector>

#include "preprocess/survey.h"
#include "preprocess/tree_units.h"

namespace promenade {

/// One unit an object of the survey, in their order, several at once. A part's scene is in memory while its objects are
/// built. Errors: import's, the disk's, cancellation.
Result<std::vector<NodeUnit>> build_objects(const Survey& survey, const ImportOptions& import,
                                            const NodeBuilder& builder, const TreeOptions& options,
                                            const WorkFolder& folder, JobMonitor& monitor);

}  // namespace promenade
