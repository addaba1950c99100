#pragma once
// From a source to a model: the stages of preprocessing in order.

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "codec/geometry_codec.h"
#include "geometry/job_monitor.h"
#include "geometry/result.h"
#include "layout/file_io.h"
#include "preprocess/far/far_units.h"
#include "preprocess/import.h"
#include "preprocess/level_factors.h"
#include "preprocess/node_order.h"
#include "preprocess/visibility/visibility.h"

namespace promenade {

struct BuildOptions {
  std::vector<std::filesystem::path> sources;
  std::filesystem::path model;  ///< directory to publish
  ImportOptions import;
  uint64_t memory_bytes = uint64_t(4) << 30;  ///< hard bound on resident memory
  uint32_t jobs = 0;                          ///< threads; 0: as many as cores
  uint32_t node_triangles = 2250;  ///< most triangles of a node; 100 to 60000. More: fewer draws, coarser culling
  /// About how many children nodes have, and so the ratio of triangles between levels; each 2 to 16. [lakhia2004]: 4
  LevelFactors level_factors;
  uint32_t chunk_triangles = 0;  ///< about the most triangles of a work unit, 1000 or more; 0: what memory allows
  GeometryCodec geometry_codec = GeometryCodec::grown;
  uint32_t max_texture_px = 2048;  ///< longest side of a stored texture; 64 to 16384
  int jpeg_quality = 85;
  CellOptions visibility;
  NodeOrderOptions order;  ///< of meshes on disk, for a model with cells
  FarOptions far;
};

/// What `build --json` prints, besides build_wall_s and peak_rss_bytes.
struct BuildFigures {
  uint64_t triangles_in = 0;
  uint64_t nodes = 0, leaves = 0, levels = 0;
  uint64_t triangles_stored = 0;
  uint64_t spill_bytes_peak = 0;
  uint64_t units_total = 0, units_resumed = 0;
  std::vector<std::string> hiders;                ///< of the cells' chain, in order
  VisibilityFigures visibility;                   ///< zeros without cells
  FarFigures far;                                 ///< zeros without far pictures
  double delta_ids_mean = 0;                      ///< nodes that leave or enter across a face between cells
  double delta_bytes_mean = 0;                    ///< of the coded vLODs, a face: all deltas follow from them
  std::map<std::string, uint64_t> bytes_by_part;  ///< "geometry", "textures", "tables", "cells", "far", "manifest"
  std::map<std::string, double> stage_wall_s;     ///< "survey", "partition", "simplify", ...
  std::map<std::string, uint64_t> stage_peak_rss_bytes;  ///< by stage: of the process until its end
  std::map<std::string, double> node_cpu_s;              ///< processor time of making nodes: NodeProfile's parts
  std::map<std::string, uint64_t> import_counts;
  std::vector<std::string> warnings;
};

/// Runs the whole build. Interrupted or killed: nothing under the model's name; the work done so far stays in
/// MODEL.work and is taken up again by the same command, with the same bytes in the end. Another build into the same
/// model at once is refused.
Result<BuildFigures> build_model(const BuildOptions& options, JobMonitor& monitor,
                                 FileSystem& files = real_file_system());

}  // namespace promenade
