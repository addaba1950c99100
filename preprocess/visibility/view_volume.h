#pragma once
// Where somebody may stand: the open air and the rooms of a model, told from the solid inside of its walls, houses and
// ground. Decides which cells exist, never what is hidden: where it errs, a cell is made for nothing, or the tree alone
// serves.

#include <cstdint>
#include <limits>
#include <vector>

#include "geometry/job_monitor.h"
#include "layout/model_io.h"
#include "preprocess/visibility/voxel_grid.h"

namespace promenade {

/// Cubes of viewing space, each a surface's, open or solid. A connected space between surfaces is open when it reaches
/// the top of viewing space, or when more of the surface that is seen from it along the axes shows its front than its
/// back: a room. Else it is solid: one is inside a wall or below the ground. Fronts and backs are those of the winding,
/// two-sided or not.
class ViewVolume {
 public:
  enum class Kind : uint8_t { unknown, surface, open, solid };  ///< unknown: nobody is to stand there

  /// floors_m: by column (x, then y): the height of the ground below the lowest open cube; kNoFloor where there is
  /// none.
  ViewVolume(const VoxelGrid& grid, std::vector<Kind> kinds, std::vector<float> floors_m)
      : grid_(grid), kinds_(std::move(kinds)), floors_m_(std::move(floors_m)) {}
  static constexpr float kNoFloor = std::numeric_limits<float>::lowest();

  const VoxelGrid& grid() const { return grid_; }
  Kind kind(const glm::ivec3& at) const { return kinds_[grid_.index(at)]; }

  /// Whether somebody may stand somewhere in the box. A surface's cube counts as open when one beside it is: a part of
  /// it is before the surface.
  bool is_open(const Box& box) const;
  /// The same without the surfaces' cubes: for boxes between walls, which the surfaces bound.
  bool holds_open(const Box& box) const;
  /// The part of the space below surfaces that is open: near 1 in a building, near 0 among solid houses and on a
  /// landscape.
  double roofed_share() const;
  /// The box without what of it lies below all ground in it: nobody stands there, and from there one would see under
  /// everything. Not empty.
  Box above_ground(const Box& box) const;
  /// Keeps open only what is at most height_m above a surface that one may stand on: for people who walk.
  void keep_walkable(float height_m);
  /// Keeps open only what lies in one of the boxes.
  void keep_inside(const std::vector<Box>& boxes);

 private:
  bool may_stand(const glm::ivec3& at) const;
  template <class Test>
  bool any_cube(const Box& box, Test test) const;

  VoxelGrid grid_;
  std::vector<Kind> kinds_;
  std::vector<float> floors_m_;
};

/// Surveys the leaves of a model over `space`. Reads every leaf's mesh, several at once. Takes up to 9 bytes a
/// cube. Errors: reading the model, cancellation.
Result<ViewVolume> survey_volume(const ModelReader& reader, const Box& space, uint64_t max_voxels, JobMonitor& monitor);

}  // namespace promenade
