#pragma once
// A model's bounds held against its untouched source: random points of either surface and how far they lie from the
// other.

#include <filesystem>
#include <vector>

#include "cli/command.h"
#include "layout/model_io.h"
#include "preprocess/import.h"

namespace promenade {

struct VerifyPointsOptions {
  std::vector<std::filesystem::path> sources;
  ImportOptions import;
  uint64_t points = 0;  ///< half of them on the source, half on the nodes, each as many; 0: none
  uint64_t seed = 1;
};

/// Adds to the figures and prints a summary. A point of the source is held against every node from the leaf that it is
/// nearest to (the nearest that may be that far off, where there is one) up to the root, less what that leaf may be off
/// by there. Holds the whole source in memory, twice. Objects that move are left out. Errors: reading the model or the
/// source; a source that is not the model's (another number of triangles).
Status verify_points(const VerifyPointsOptions& options, const ModelReader& reader, JobMonitor& monitor, Json& figures);

}  // namespace promenade
