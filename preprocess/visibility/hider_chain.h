#pragma once
// The hiders by name, and chains of them.

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "geometry/job_monitor.h"
#include "layout/model_io.h"
#include "preprocess/visibility/cell_options.h"
#include "preprocess/visibility/hider.h"

namespace promenade {

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

/// Prepares hiders for a model, in the order of their names; that is the order in which a cell should ask them. What
/// they share is made once and lives as long as any of them. The model must outlive them. Runs on the threads of the
/// arena. Errors: unknown names; reading the model; "interrupted".
Result<std::vector<std::unique_ptr<Hider>>> make_hiders(std::span<const std::string> names, const ModelReader& model,
                                                        const HiderBuildOptions& options, JobMonitor& monitor);

}  // namespace promenade
