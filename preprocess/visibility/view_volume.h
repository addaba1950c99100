#pragma once
// Where somebody may stand: the open air and the rooms of a model, told from the solid inside of its walls, houses and
// ground. Decides which cells exist, never what is hidden: where it errs, a cell is made for nothing, or the tree alone
// serves.

#include <cstdint>
#include <vector>

#include "geometry/job_monitor.h"
#include "layout/model_io.h"
#include "preprocess/visibility/voxel_grid.h"

namespace promenade {

/// Cubes of viewing space, each a surface's, open or solid. A connected space between surfaces is open when it reaches
/// the top of viewing space, or when more of the surface around it shows its front than its back: a room. Else it is
/// solid: one is inside a wall or below the ground. Two-sided surfaces show a front to either side.
class ViewVolume {
 public:
  enum class Kind : uint8_t { unknown, surface, open, solid };  ///< unknown: nobody is to stand there

  ViewVolume(const VoxelGrid& grid, std::vector<Kind> kinds) : grid_(grid), kinds_(std::move(kinds)) {}

  const VoxelGrid& grid() const { return grid_; }
  Kind kind(const glm::ivec3& at) const { return kinds_[grid_.index(at)]; }

  /// Whether somebody may stand somewhere in the box. A surface's cube counts as open when one beside it is: a part of
  /// it is before the surface.
  bool is_open(const Box& box) const;
  /// Keeps open only what is at most height_m above a surface that one may stand on: for people who walk.
  void keep_walkable(float height_m);
  /// Keeps open only what lies in one of the boxes.
  void keep_inside(const std::vector<Box>& boxes);

 private:
  bool may_stand(const glm::ivec3& at) const;

  VoxelGrid grid_;
  std::vector<Kind> kinds_;
};

/// Surveys the leaves of a model over `space`. Reads every leaf's mesh, several at once. Takes up to 9 bytes a
/// cube. Errors: reading the model, cancellation.
Result<ViewVolume> survey_volume(const ModelReader& reader, const Box& space, uint64_t max_voxels, JobMonitor& monitor);

}  // namespace promenade
