#pragma once
// Which hiders of a chain a model repays.

#include <memory>
#include <vector>

#include "preprocess/visibility/hider_chain.h"
#include "preprocess/visibility/visibility.h"

namespace promenade {

/// The hiders that names stand for in a model: those, or for kAutoHiders those of the style's chain that it repays:
/// the first, and each that hides a hundredth of the triangles in trial cells.
/// Errors: unknown names; reading the model; "interrupted".
Result<std::vector<std::unique_ptr<Hider>>> make_hiders_for(const std::vector<std::string>& names,
                                                            const ModelReader& reader, const ViewSpace& space,
                                                            const CellOptions& cells, HiderMaker& maker,
                                                            JobMonitor& monitor);

/// How viewing space is divided, and who hides in it.
struct ViewPlan {
  ViewSpace space;
  std::vector<std::unique_ptr<Hider>> hiders;
};

/// What a build of the model does. Where both the style of the cells and the hiders are left to it, cells lie along
/// walls only if a tenth of the triangles in trial cells is hidden there: else walls give many thin cells that all see
/// the same, and those of an octree lie in the open. Errors: reading the model, a hider's; "interrupted".
Result<ViewPlan> plan_views(const std::vector<std::string>& names, const ModelReader& reader, const CellOptions& cells,
                            const HiderBuildOptions& options, JobMonitor& monitor);

/// The names, or for kAutoHiders those of the hiders that a build of the model would use. Errors: reading the model;
/// "interrupted".
Result<std::vector<std::string>> chain_for_model(const std::vector<std::string>& names, const ModelReader& reader,
                                                 JobMonitor& monitor);

}  // namespace promenade
