#pragma once
// In which order nodes' meshes lie on disk, so that a step between cells reads few runs of bytes.

#include <filesystem>
#include <string>
#include <string_view>

#include "geometry/job_monitor.h"
#include "layout/order.h"
#include "preprocess/visibility/visibility.h"
#include "preprocess/work_folder.h"

namespace promenade {

struct NodeOrderOptions {
  std::string name = "tour";   ///< of order_names(), or "file"
  std::filesystem::path file;  ///< with "file": a node's number a line
};

/// Of a name, or of "file:FILE". Error: neither.
Result<NodeOrderOptions> parse_node_order(const std::string& text);

struct NodeOrder {
  ColumnOrder order;          ///< nodes by their places
  double delta_ids_mean = 0;  ///< nodes that leave or enter across a face
};

/// The input's order instead of any other but "file" that has more runs than it. The tour's work goes in units: a
/// search for near neighbours for each random order of the rows, then the tour itself; what the folder has of them is
/// not done again. Errors: the file's; a vLOD that cannot be decoded; the disk's; cancellation. Source: [chhugani2003]
/// section 3.
Result<NodeOrder> node_order(const Model& model, const Visibility& visibility, const NodeOrderOptions& options,
                             const WorkFolder& folder, JobMonitor& monitor);

}  // namespace promenade
