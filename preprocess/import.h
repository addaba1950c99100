#pragma once
// Reading sources: which files make one, and each file into a scene.

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "geometry/job_monitor.h"
#include "geometry/result.h"
#include "preprocess/scene.h"

namespace promenade {

enum class UpAxis : uint8_t { y, z };

struct ImportOptions {
  /// Metres per unit of the source. nullopt: what the format says (FBX, COLLADA, IFC: in the file; others: 1).
  std::optional<double> unit_m;
  /// nullopt: what the format says (glTF: y; CityJSON: z; OBJ, 3DS, FBX...: y unless the file says otherwise; PLY, STL,
  /// OFF: z).
  std::optional<UpAxis> up;
  /// Vertices farther than this from the source's middle are taken for broken and dropped with their faces (counted).
  double max_extent_m = 1e7;
  bool repair = true;  ///< degenerate and duplicate faces, inconsistent orientation, non-planar polygons
};

/// One file of a source, imported as a unit: a source larger than memory comes as several.
struct SourcePart {
  std::filesystem::path path;
  std::string name;  ///< file name relative to what the user gave: for messages and the manifest
  uint64_t bytes = 0;
};

/// Files and folders (every readable model file in them, sorted by name, recursively) to parts. Errors: nothing there,
/// unreadable, unknown format, each naming the path and the formats known.
Result<std::vector<SourcePart>> list_source(std::span<const std::filesystem::path> paths);

/// Reads one part. Safe on any bytes. Errors name file and place. An empty scene (no triangle left) is not an error
/// here: the caller decides over all parts.
Result<Scene> import_part(const SourcePart& part, const ImportOptions& options, JobMonitor& monitor);

/// The mesh of an instance in model space (world minus origin), mirrored transforms handled.
Mesh flattened(const Scene& scene, const SceneInstance& instance, const glm::dvec3& model_origin);

}  // namespace promenade
