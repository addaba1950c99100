#pragma once
// The untouched source, drawn by brute force: the reference that every picture of a model is held against.

#include <filesystem>
#include <vector>

#include "cli/picture.h"
#include "geometry/camera.h"
#include "geometry/job_monitor.h"
#include "preprocess/import.h"
#include "runtime/renderer.h"

namespace promenade {

struct SourceRenderOptions {
  std::vector<std::filesystem::path> sources;
  ImportOptions import;
  std::vector<Camera> cameras;  ///< all of one size
  Aov aov = Aov::color;         ///< node: the instance's number
  double time_s = 0;            ///< of animated objects
  FrameView look;               ///< light and background; its camera and origin are not used
  uint64_t memory_bytes =
      uint64_t(4) << 30;  ///< for what the renderer holds at a time; a larger source is drawn in portions
};

struct SourceRenderFigures {
  uint64_t triangles = 0;   ///< in the source, instances counted each
  double draw_ms_mean = 0;  ///< of a view, all portions together
};

/// Draws every view; frames in the order of the cameras. A source that does not fit is drawn portion by portion and the
/// pictures are put together by depth (semi-transparent surfaces then hide only what lies in their own portion). Render
/// thread.
Result<std::vector<Frame>> render_source(const SourceRenderOptions& options, Renderer& renderer,
                                         SourceRenderFigures& figures, JobMonitor& monitor);

}  // namespace promenade
