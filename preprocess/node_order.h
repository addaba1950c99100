#pragma once
// In which order nodes' meshes lie on disk, so that a step between cells reads few runs of bytes.

#include <filesystem>
#include <string>
#include <string_view>

#include "layout/order.h"
#include "preprocess/visibility/visibility.h"

namespace promenade {

struct NodeOrderOptions {
  std::string name = "tour";   ///< of order_names(), or "file"
  std::filesystem::path file;  ///< with "file": a node's number a line
};

/// Of a name, or of "file:FILE". Error: neither.
Result<NodeOrderOptions> parse_node_order(const std::string& text);

/// Nodes by their places. The input's order instead of any other but "file" that has more runs than it. Errors: the
/// file's; a vLOD that cannot be decoded. Source: [chhugani2003] section 3.
Result<ColumnOrder> node_order(const Model& model, const Visibility& visibility, const NodeOrderOptions& options);

}  // namespace promenade
