#pragma once
// The window of `promenade view`: walk and fly by mouse and keys.

#include <filesystem>
#include <optional>
#include <string>

#include "geometry/camera.h"
#include "geometry/result.h"
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
};

/// What view() did.
struct ViewerReport {
  uint32_t frames = 0;
  double frame_ms_mean = 0;
  std::vector<std::filesystem::path> screenshots, paths;
};

/// Opens a window and returns when it is closed. Left mouse button: look; W A S D, arrows, space and C: move; Q E:
/// roll; wheel: speed; F: straighten; H: panel; P: screenshot; R: record a path, and stop; Escape: leave.
/// Errors: no display; those of Session. Thread: the main one.
Result<ViewerReport> view(const ModelSource& source, const ViewerOptions& options);

}  // namespace promenade
