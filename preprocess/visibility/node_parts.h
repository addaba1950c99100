#pragma once
// Nodes cut into a few parts each: a node stays as long as one of its parts may be seen, and the box of a part is far
// tighter than the node's.

#include <span>
#include <vector>

#include "geometry/cone.h"
#include "geometry/job_monitor.h"
#include "layout/model_io.h"

namespace promenade {

/// Some triangles of a node.
struct NodePart {
  Box box;          ///< of the triangles themselves, metres, model space
  NormalCone cone;  ///< cos -1 if any of them is two-sided
};

class NodeParts {
 public:
  static constexpr uint32_t kMostParts = 48;  // of a node; measured: study hiders

  /// Reads every mesh once, on all threads of the arena. Errors: reading the model; "interrupted".
  static Result<NodeParts> make(const ModelReader& model, JobMonitor& monitor);

  /// Together they hold all triangles of the node's own mesh. Empty: the node draws nothing.
  std::span<const NodePart> of(NodeId id) const { return by_node_[index_of(id)]; }

 private:
  std::vector<std::vector<NodePart>> by_node_;  ///< a list each: in one row they would stand twice while it is made
};

/// The parts of one mesh, no more than so many, about equally large; triangles that are large themselves may lie in
/// several. Pure.
std::vector<NodePart> cut_into_parts(const Mesh& mesh, std::span<const Material> materials, uint32_t most_parts);

/// True only if every triangle of the part shows its back to every eye in the cell. Exact but for rounding: triangles
/// face away from e when n (p - e) >= 0; over all normals of a cone that is a convex set of p - e, so the corners of
/// the box of all p - e decide. Source: [chhugani2003] section 5.3.
bool faces_away_from_cell(const NormalCone& cone, const Box& box, const Box& cell);

}  // namespace promenade
