#pragma once
// The hiders by name, and chains of them.

#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "geometry/job_monitor.h"
#include "layout/model_io.h"
#include "preprocess/visibility/cell_options.h"
#include "preprocess/visibility/hider.h"

namespace promenade {

class NodeMeshes;
class NodeParts;
struct OccluderSet;

struct HiderBuildOptions {
  uint64_t memory_bytes = uint64_t(1) << 30;  ///< for what the hiders prepare and cache, together
  std::filesystem::path folder;               ///< where to put what is too much for that; empty: it stays in memory
  FileSystem* files = nullptr;                ///< the folder's; nullptr: the real one
};

/// Of what in the options the hiders' answers depend on: occluders are looked for in smaller tiles where memory asks
/// for it.
uint64_t hash_of(const HiderBuildOptions& options);

/// Every name that a chain may hold, separated by commas: for usage texts.
std::string_view hider_names();
/// What a build uses unless told otherwise: kAutoHiders alone.
constexpr std::string_view kAutoHiders = "auto";
/// The chain that "auto" stands for in cells of a style.
const std::vector<std::string>& hiders_for(CellStyle style);
/// Names that leave the choice to the build.
bool hiders_are_auto(const std::vector<std::string>& names);
/// The names, or for kAutoHiders the chain for the style.
const std::vector<std::string>& resolved_hiders(const std::vector<std::string>& names, CellStyle style);
/// "backface,horizon" to names, "auto" to that one name; "none" and "" to no names. Errors: a name that no hider has,
/// or one given twice.
Result<std::vector<std::string>> parse_hiders(std::string_view list);

/// Prepares hiders for a model. What several of them need is made once, for the first that asks, and lives as long as
/// the maker or any of them. The model must outlive them all. Runs on the threads of the arena.
class HiderMaker {
 public:
  HiderMaker(const ModelReader& model, HiderBuildOptions options, JobMonitor& monitor);
  /// In the order of their names; that is the order in which a cell should ask them. Errors: unknown names; reading the
  /// model; "interrupted".
  Result<std::vector<std::unique_ptr<Hider>>> make(std::span<const std::string> names);

 private:
  Result<std::unique_ptr<Hider>> make_one(std::string_view name);
  Status need_parts();
  Status need_occluders();
  Status need_solid_boxes();
  Status need_meshes();

  const ModelReader& model_;
  HiderBuildOptions options_;
  JobMonitor& monitor_;
  std::shared_ptr<NodeParts> parts_;
  std::shared_ptr<OccluderSet> occluders_;
  std::shared_ptr<std::vector<Box>> solid_boxes_;
  std::shared_ptr<NodeMeshes> meshes_;
};

}  // namespace promenade
