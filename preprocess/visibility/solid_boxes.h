#pragma once
// Boxes along the axes that lie in what is solid: what hides in any world, on the ground or not.

#include <vector>

#include "geometry/job_monitor.h"
#include "layout/model_io.h"

namespace promenade {

struct SolidBoxOptions {
  double column_m = 0.25;        ///< finest gap that is seen, at most; models smaller than most_columns of it: finer
  uint32_t most_columns = 1024;  ///< along a model's longer side, until columns are column_m wide
  uint32_t tile_columns = 1024;  ///< the model is worked through in squares of so many ...
  uint32_t margin_columns = 64;  ///< ... with so many around them: what is longer falls apart at their borders
};

/// Each box is solid: a ray from the air that gets into it crosses an opaque surface of the source from its front. They
/// may overlap. By tile, then from the inside of what is solid outwards. Reads every leaf, some times over, tile by
/// tile on the threads of the arena; the same at any number of threads. Errors: reading the model; "interrupted".
Result<std::vector<Box>> find_solid_boxes(const ModelReader& model, const SolidBoxOptions& options,
                                          JobMonitor& monitor);

}  // namespace promenade
