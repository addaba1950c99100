#pragma once
// The work units of visibility: batches of cells, each published when all of its cells are done.

#include <cstdint>
#include <string>
#include <vector>

#include "geometry/job_monitor.h"
#include "preprocess/visibility/cell_vlod.h"
#include "preprocess/work_folder.h"

namespace promenade {

/// A cell's vLOD as it waits for the model's file.
struct CodedVlod {
  std::vector<std::byte> ids;  ///< an id set of codec/
  uint32_t nodes = 0;
  uint64_t triangles = 0;
  uint32_t front_nodes = 0;
  uint64_t front_triangles = 0;
};

/// The nodes of a coded vLOD of a model with so many nodes.
Result<std::vector<NodeId>> decoded(const CodedVlod& vlod, uint32_t nodes);

struct CellUnitCounts {
  uint64_t total = 0, resumed = 0;  ///< units
  uint64_t cells = 0;               ///< computed now, not resumed
  double busy_ms = 0;               ///< of all threads, for these
};

/// Computes the vLODs of many cells, several at once.
class CellUnits {
 public:
  /// hash: of all that vLODs depend on besides the cells' boxes. All that is passed must outlive it.
  CellUnits(const Model& model, HiderChain hiders, const FrontBound& bound, uint64_t hash, const WorkFolder& folder,
            JobMonitor& monitor)
      : model_(model), hiders_(hiders), bound_(bound), hash_(hash), folder_(folder), monitor_(monitor) {}

  /// By cell. name: of this batch of batches, unlike any other's. Errors: a hider's, the disk's, cancellation.
  Result<std::vector<CodedVlod>> run(const std::string& name, const std::vector<Box>& cells);
  const CellUnitCounts& counts() const { return counts_; }

 private:
  const Model& model_;
  HiderChain hiders_;
  FrontBound bound_;
  uint64_t hash_;
  const WorkFolder& folder_;
  JobMonitor& monitor_;
  CellUnitCounts counts_;
  uint64_t asked_ = 0;  ///< cells, of all batches
};

}  // namespace promenade
