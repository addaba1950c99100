#pragma once
// The visibility stage of a build: from a staged model to its view cells and what each of them sees.

#include <cstdint>
#include <vector>

#include "layout/model_io.h"
#include "preprocess/visibility/cell_options.h"
#include "preprocess/visibility/cell_units.h"
#include "preprocess/visibility/view_volume.h"

namespace promenade {

struct VisibilityFigures {
  uint64_t cells = 0;
  double vlod_nodes_mean = 0, vlod_triangles_mean = 0;
  double front_nodes_mean = 0, front_triangles_mean = 0;  ///< before hiding
  CellStyle style = CellStyle::none;                      ///< what automatic came to
  double roofed_share = 0;                                ///< of the space under roofs: what is open
  double ms_per_cell = 0;                                 ///< of one core
  CellUnitCounts units;
};

struct Visibility {
  CellTables cells;
  std::vector<CodedVlod> vlods;  ///< by CellId
  VisibilityFigures figures;
};

/// Where somebody may be, and how that is divided.
struct ViewSpace {
  ViewVolume volume;
  CellStyle style = CellStyle::none;  ///< what automatic comes to
};

/// Errors: reading the model, cancellation.
Result<ViewSpace> survey_view_space(const ModelReader& reader, const CellOptions& options, JobMonitor& monitor);

/// Divides viewing space, evenly or along walls, and computes what is seen from each part. Cells that see more than
/// cell_triangles are divided, those first where it takes most away, while it helps: while cell_gain times less is seen
/// from the smallest part. hash: of the model's bytes and all that hiders depend on. Same result at any thread count
/// and after any interruption. Errors: reading the model, a hider's, the disk's, cancellation. Source: [chhugani2003]
/// section 2.1.
Result<Visibility> compute_visibility(const ModelReader& reader, const ViewSpace& space, HiderChain hiders,
                                      const CellOptions& options, uint64_t hash, const WorkFolder& folder,
                                      JobMonitor& monitor);

}  // namespace promenade
