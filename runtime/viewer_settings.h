#pragma once
// What the window remembers from one visit to the next.

#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include "geometry/camera.h"
#include "geometry/result.h"

namespace promenade {

struct ViewerSettings {
  std::optional<double> speed_m_per_s;
  std::optional<bool> on_foot, panel, textures;
  std::optional<std::string> policy;
  std::optional<double> pixel_error, target_ms;
  std::map<int, Pose> bookmarks;  ///< 1 to 9, of one model
};

/// $XDG_CONFIG_HOME/promenade/viewer.json, or below ~/.config; empty where there is neither.
std::filesystem::path viewer_settings_file();

/// What was stored, with the bookmarks of `model` (its absolute path). What is missing, broken or out of range counts
/// as not stored.
ViewerSettings read_viewer_settings(const std::filesystem::path& file, const std::string& model);

/// Stores them in one step; the bookmarks of other models stay.
Status write_viewer_settings(const ViewerSettings& settings, const std::filesystem::path& file,
                             const std::string& model);

}  // namespace promenade
