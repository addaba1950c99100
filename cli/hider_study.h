#pragma once
// What each chain of hiders costs and is worth in cells of one model: the sums that `study hiders` tells.

#include <algorithm>
#include <filesystem>
#include <memory>
#include <random>
#include <span>
#include <string>
#include <vector>

#include "geometry/job_monitor.h"
#include "layout/cell_front.h"
#include "layout/model_io.h"
#include "preprocess/visibility/audit.h"
#include "preprocess/visibility/hider.h"
#include "preprocess/visibility/node_meshes.h"

namespace promenade {

struct HiderStudyOptions {
  /// aimed_views: at nodes that the last chain keeps and no other picture shows; what they show is seen, too.
  LookOptions looks;
  double pixel_error = 1;         ///< of the cells' fronts, at 1280 x 720, 60 degrees
  uint32_t eyes = 0;              ///< in each cell, for what an eye sees
  std::filesystem::path picture;  ///< plan of the first cell with the last chain; empty: none
};

/// Nodes and triangles drawn: mean and most of several.
struct Drawn {
  uint64_t count = 0, nodes = 0, triangles = 0, most_nodes = 0, most_triangles = 0;
  void add(const Model& model, std::span<const NodeId> front, std::span<const uint8_t> hidden);
};

/// One cell as the last chain leaves it.
struct StudiedCell {
  Box box;
  uint64_t eyes = 0;    ///< that looked around in it
  CellVerdict verdict;  ///< of the last chain
  double ratio() const {
    return double(verdict.kept_triangles) / double(std::max<uint64_t>(verdict.seen_triangles, 1));
  }
};

/// Over the cells. ms: processor time of one thread.
struct ChainSums {
  double ms = 0, ratio_sum = 0, hidden_share_sum = 0;
  uint64_t false_hidden_nodes = 0, false_hidden_pixels = 0, kept_nodes = 0, kept_triangles = 0;
};

/// A chain with its sums.
struct ChainRow : ChainSums {
  std::string name;
  std::vector<std::unique_ptr<Hider>> hiders;
  bool conservative = true, is_default = false;
  double prepare_s = 0;
  void restart() { static_cast<ChainSums&>(*this) = {}; }
};

/// Chains by their lists of names; no list: no hider, each hider of the chain that a build of this model uses, and
/// that chain. Errors: a name, the model.
Result<std::vector<ChainRow>> make_chains(std::vector<std::string> lists, const ModelReader& reader,
                                          JobMonitor& monitor);

/// For each cell the reference's time, the truth, and each chain against it.
class HiderStudy {
 public:
  /// All that is passed must outlive it; rows' sums are added to.
  HiderStudy(const HiderStudyOptions& options, const NodeMeshes& meshes, std::vector<ChainRow>& rows);

  /// Cells in which nobody can stand are left out. Errors: reading the model, the picture.
  Status add(const Box& cell);

  uint64_t cells = 0, eyes = 0, pixels = 0, front_nodes = 0, seen_nodes = 0;
  double reference_ms = 0, eye_ms = 0;
  Drawn cell_to_object, in_view, eye_to_object;  ///< in_view: of the first, what the eye's view pyramid meets
  std::vector<StudiedCell> studied;

 private:
  Status ask(ChainRow& row, const Box& cell, std::span<const NodeId> front, std::span<uint8_t> hidden_by);
  Status aim(const Box& cell, std::span<const NodeId> front, std::span<const uint8_t> hidden_by, Looks& looks) const;
  Status judge_chain(ChainRow& row, const Box& cell, std::span<const NodeId> front, std::span<const uint8_t> hidden_by,
                     const Looks& looks);
  Status see_from_eyes(const ChainRow& row, const Box& cell, std::span<const NodeId> front,
                       std::span<const uint8_t> hidden);
  Status draw_plan(const Box& cell, std::span<const NodeId> front, std::span<const uint8_t> hidden_by,
                   const Looks& looks) const;

  const HiderStudyOptions& options_;
  const NodeMeshes& meshes_;
  std::vector<ChainRow>& rows_;
  std::unique_ptr<Hider> reference_;
  FrontBound bound_;
  std::mt19937_64 random_{1};
};

}  // namespace promenade
