#pragma once
// What the studies of codecs and orders look at: every cell's vLOD and the deltas across faces.

#include <cstdint>
#include <filesystem>
#include <vector>

#include "geometry/job_monitor.h"
#include "layout/model_io.h"

namespace promenade {

using IdSets = std::vector<std::vector<uint32_t>>;

struct StudySets {
  IdSets vlods;   ///< by cell: node ids, ascending
  IdSets deltas;  ///< by face: the ids that are in one of the two vLODs
};

/// Errors: the model has no cells; reading; interruption.
Result<StudySets> read_study_sets(const ModelReader& reader, JobMonitor& monitor);

/// Writes vlods.txt (a cell a line: its nodes), deltas.txt (a face a line: the cells below and above, then the nodes
/// that change) and nodes.txt (a node a line: parent or -1, stored bytes of its mesh, center x y z in metres), numbers
/// in ascending order separated by blanks. Makes the folder.
Status export_study_sets(const std::filesystem::path& folder, const ModelReader& reader, const StudySets& sets);

}  // namespace promenade
