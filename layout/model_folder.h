#pragma once
// The names inside and around a model's folder.

#include <filesystem>

namespace promenade {

constexpr const char* kManifestName = "manifest.json";
constexpr const char* kTablesName = "tables.bin";
constexpr const char* kGeometryName = "geometry.bin";
constexpr const char* kTexturesName = "textures.bin";
constexpr const char* kCellsName = "cells.bin";        ///< only in models with view cells
constexpr const char* kOpeningsName = "openings.bin";  ///< only in models that eyes are culled in
constexpr const char* kObjectsName = "objects.bin";    ///< only in models with objects that move, or classes
constexpr const char* kFarName = "far.bin";            ///< only in models with far pictures

/// "city.prom/" and "city.prom" are one model.
inline std::filesystem::path without_trailing_slash(const std::filesystem::path& path) {
  return path.has_filename() || !path.has_parent_path() ? path : path.parent_path();
}

/// Beside the model: "city.prom.partial" while it is written, "city.prom.old" while a new one takes its place.
inline std::filesystem::path beside(const std::filesystem::path& model, const char* ending) {
  return model.parent_path() / (model.filename().string() + ending);
}

}  // namespace promenade
