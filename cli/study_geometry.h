#pragma once
// study geometry: what each way of coding a model's meshes costs, on the model's own nodes.

#include <cstdint>

#include "cli/command.h"
#include "layout/model_io.h"

namespace promenade {

struct StudyGeometryOptions {
  uint32_t nodes = 1000;  ///< how many nodes are coded, evenly spread over the model's; more: slower, steadier figures
};

/// Codes nodes anew with every codec and, around the grid that each node is stored on, finer and coarser grids; prints
/// a table and fills `figures`: `codecs` (a row for each, the model's own marked default), `parts` (what the model's
/// own way spends on positions and triangles, normals, texture coordinates, colours and materials).
Status study_geometry(const ModelReader& reader, const StudyGeometryOptions& options, JobMonitor& monitor,
                      Json& figures);

}  // namespace promenade
