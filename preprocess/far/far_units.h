#pragma once
// The work units of far pictures: groups of view cells, each published when all of its cells are done.

#include "geometry/job_monitor.h"
#include "layout/far_io.h"
#include "layout/model_io.h"
#include "preprocess/far/far_options.h"
#include "preprocess/work_folder.h"

namespace promenade {

struct FarShellFigures {
  double box_m = 0, cell_m = 0;
  uint64_t cells = 0, faces = 0, bytes = 0;
};

struct FarFigures {
  uint64_t cells = 0, cells_with_pictures = 0, faces = 0;
  uint64_t faces_told = 0;  ///< against a neighbour's
  double cell_m = 0, box_m = 0;
  uint32_t side_px = 0;
  double parallax_max_rad = 0;  ///< of all cells, measured
  double triangles_mean = 0;    ///< of a cell with pictures
  double bytes_mean = 0;        ///< the same
  double texel_bytes_mean = 0;  ///< the same, uncompressed: three bytes a texel
  double ms_per_cell = 0;       ///< of one core; of those computed now
  uint64_t units = 0, units_resumed = 0, cells_computed = 0;
  std::vector<FarShellFigures> shells;  ///< from within outwards
};

struct FarUnits {
  FarTables tables;  ///< without cells and faces
  FarFigures figures;
  std::vector<uint64_t> unit_hashes;  ///< of the finished units, in order
};

/// Chooses the view cells and makes their pictures, several at once. hash: of the model's bytes and of what else units
/// depend on besides the options. memory_bytes: for meshes and textures while drawing. Same units at any thread count
/// and after any interruption. Errors: more cells than options allow (the message says how many), reading the model,
/// the disk's, cancellation.
Result<FarUnits> make_far(const ModelReader& reader, const FarOptions& options, uint64_t hash, uint64_t memory_bytes,
                          const WorkFolder& folder, JobMonitor& monitor);

/// The cells of the finished units, a unit at a time, in no order of places.
FarCellSource cells_of(const FarUnits& units, const WorkFolder& folder);

}  // namespace promenade
