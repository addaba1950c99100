#pragma once
// Nodes cut into a few parts each: a node stays as long as one of its parts may be seen, and the box of a part is far
// tighter than the node's.

#include <filesystem>
#include <optional>
#include <span>
#include <vector>

#include "geometry/cone.h"
#include "geometry/job_monitor.h"
#include "geometry/paged_array.h"
#include "layout/file_io.h"
#include "layout/model_io.h"

namespace promenade {

/// Some triangles of a node.
struct NodePart {
  Box box;          ///< of the triangles themselves, metres, model space
  NormalCone cone;  ///< cos -1 if any of them is two-sided
};

/// The parts of some nodes.
class HeldParts {
 public:
  /// Together they hold all triangles of the i-th node's own mesh. Empty: the node draws nothing, or was left out.
  std::span<const NodePart> of(size_t i) const { return by_node_[i]; }

 private:
  friend class NodeParts;
  std::vector<std::span<const NodePart>> by_node_;
  PagedArray<NodePart> read_;  ///< what they refer to, where it was read
};

struct NodePartsOptions {
  uint64_t memory_bytes = uint64_t(128) << 20;  ///< when they might take more, they lie on the disk
  std::filesystem::path folder;                 ///< where; empty: in memory whatever they take
  FileSystem* files = nullptr;                  ///< the folder's; nullptr: the real one
};

/// Of all nodes of a model. Any thread.
class NodeParts {
 public:
  static constexpr uint32_t kMostParts = 48;  // of a node; measured: study hiders

  /// Reads every mesh once, on all threads of the arena. Errors: reading the model; the disk's; "interrupted".
  static Result<NodeParts> make(const ModelReader& model, JobMonitor& monitor, const NodePartsOptions& options = {});

  /// Those of some nodes, but for the ones that are left out (not 0, or beyond the end). Must not outlive this. Errors:
  /// the disk's.
  Result<HeldParts> hold(std::span<const NodeId> nodes, std::span<const uint8_t> left_out = {}) const;

  bool on_disk() const { return file_.has_value(); }

 private:
  class Maker;
  struct Range {
    uint64_t first = 0;
    uint32_t count = 0;
  };
  std::vector<Range> by_node_;
  PagedArray<NodePart> parts_;  ///< empty when they lie on the disk
  std::optional<RandomAccessFile> file_;
};

/// The parts of one mesh, no more than so many, about equally large; triangles that are large themselves may lie in
/// several. Pure.
std::vector<NodePart> cut_into_parts(const Mesh& mesh, std::span<const Material> materials, uint32_t most_parts);

/// True only if every triangle of the part shows its back to every eye in the cell. Exact but for rounding: triangles
/// face away from e when n (p - e) >= 0; over all normals of a cone that is a convex set of p - e, so the corners of
/// the box of all p - e decide. Source: [chhugani2003] section 5.3.
bool faces_away_from_cell(const NormalCone& cone, const Box& box, const Box& cell);

}  // namespace promenade
