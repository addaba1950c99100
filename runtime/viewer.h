#pragma once
// The window of `promenade view`: walk and fly by mouse and keys.

#include <filesystem>
#include <optional>
#include <string>

#include "geometry/path.h"
#include "runtime/session.h"

namespace promenade {

struct ViewerOptions {
  SessionOptions session;
  RendererKind renderer = RendererKind::automatic;
  uint32_t width_px = 1280, height_px = 720;
  double vertical_fov_deg = 60;
  double near_m = 0.1;
  std::optional<Pose> start;           ///< nullopt: before the model, looking at its middle
  std::filesystem::path folder = ".";  ///< where screenshots and recorded paths go
  std::string title = "Promenade";
  uint32_t max_frames = 0;  ///< stop after so many; 0: when the window is closed
  CameraPath replay;        ///< played at once, and by L; empty: none
  /// What the window remembers (viewer_settings.h); empty: nothing. Bookmarks are kept by the model's name.
  std::filesystem::path settings_file;
  std::string model_name;
  /// Take what the window had when it was last closed; false: the session's.
  bool keep_policy = false, keep_pixel_error = false, keep_target = false;
};

/// What view() did.
struct ViewerReport {
  uint32_t frames = 0;
  double frame_ms_mean = 0;
  double response_ms_mean = 0;  ///< from asking for keys and mouse to the picture in the window
  std::vector<std::filesystem::path> screenshots, paths;
};

/// Opens a window and returns when it is closed. Left mouse button: look; double click: go there; W A S D, arrows,
/// space and C: move; G: on foot (ground, stairs, walls) or flying; Q E: roll; wheel: speed; F: straighten; Home: back
/// to the start; 1 to 9: to a bookmark, with Control set it; B: bird's eye; V: boxes of nodes in false colours; T: what
/// moves stops, or goes on; H: panel; P: screenshot; R: record a path, and stop; L: replay it; Escape: leave. Errors:
/// no display; those of Session. Thread: the main one.
Result<ViewerReport> view(const ModelSource& source, const ViewerOptions& options);

}  // namespace promenade
