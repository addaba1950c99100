#pragma once
// What eyes may look through at run time, found in the model.

#include "geometry/job_monitor.h"
#include "layout/model_io.h"
#include "layout/openings.h"

namespace promenade {

/// What axial walls leave open between the regions of the cells' tree. Reads every leaf of the model twice; the same
/// for any number of threads. Errors: reading the model, "interrupted".
Result<Openings> find_openings(const ModelReader& reader, const CellTables& cells, JobMonitor& monitor);

}  // namespace promenade
