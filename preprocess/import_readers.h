#pragma once
// What the readers of single formats give to import_part, which does what is common to all: frame, units, range,
// repair, report.

#include <filesystem>
#include <string>
#include <string_view>

#include "geometry/job_monitor.h"
#include "geometry/result.h"
#include "preprocess/import.h"
#include "preprocess/scene.h"

namespace promenade {

/// A scene in the file's own frame and units. Sizes and indices of every mesh are sound; numbers may be non-finite and
/// faces may be anything.
struct ReadScene {
  Scene scene;
  UpAxis up = UpAxis::z;  ///< what the format, or the file, says
  double unit_m = 1;      ///< metres per unit, by the format or the file
  /// The format says nothing of sides: import makes a material two-sided unless what it covers is closed and
  /// consistently oriented.
  bool sides_unknown = false;
};

/// `name` is what messages call the file. Each is safe on any bytes, and throws nothing.
Result<ReadScene> read_gltf(const std::filesystem::path& path, const std::string& name, JobMonitor& monitor);
Result<ReadScene> read_obj(const std::filesystem::path& path, const std::string& name, JobMonitor& monitor);
Result<ReadScene> read_ply(const std::filesystem::path& path, const std::string& name, JobMonitor& monitor);
Result<ReadScene> read_cityjson(const std::filesystem::path& path, const std::string& name, JobMonitor& monitor);
Result<ReadScene> read_assimp(const std::filesystem::path& path, const std::string& name, JobMonitor& monitor);

}  // namespace promenade
