#pragma once
// Flying through a model along a recorded path, with figures for every frame.

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "geometry/job_monitor.h"
#include "geometry/path.h"
#include "runtime/popping.h"
#include "runtime/session.h"
#include "runtime/teleports.h"

namespace promenade {

/// How time passes along the path.
enum class Pacing : uint8_t {
  /// Every frame of the path is drawn, 1/fps apart in path time, however long it takes to draw; for each the loader
  /// gets
  /// exactly 1/fps of its own busy time (reading, the emulated disk included, and decoding; what it does not use is
  /// lost). So a slow machine draws the same frames with the same share of loading as one that keeps up.
  /// Responses count what a frame's stages take, not these turns of the loader.
  every_frame,
  /// The camera moves by the wall clock; a frame shows the pose of the moment it starts, frames that are late fall out.
  real_time,
};

struct FlightOptions {
  SessionOptions session;
  uint32_t width_px = 1280, height_px = 720;
  double vertical_fov_deg = 60;
  double near_m = 0.1;
  Pacing pacing = Pacing::every_frame;
  bool measure_overhead = true;  ///< some frames of the roots alone before the first
  /// Load what the first pose asks for before the first frame: the flight of someone who has stood there for a while.
  bool settle_first = false;
  /// Every so many frames one is drawn twice, to know the machine's noise; 0: none.
  uint32_t redraw_every = 0;
  bool measure_popping = false;  ///< reads every picture back and compares it with the one before; takes time
};

/// The totals of `fly --json`, names as there.
struct FlightTotals {
  uint64_t frames = 0;
  double frame_ms_mean = 0, frame_ms_p50 = 0, frame_ms_p99 = 0, frame_ms_stddev = 0;
  double response_ms_mean = 0, response_ms_p50 = 0, response_ms_p99 = 0;
  double select_ms_mean = 0, upload_ms_mean = 0, draw_ms_mean = 0, wait_ms_mean = 0;  ///< as in FrameRow
  double triangles_drawn_mean = 0, nodes_drawn_mean = 0, nodes_missing_mean = 0;
  double toggles_per_frame = 0;
  uint64_t toggles_loading = 0;  ///< of all toggles: up, because the finer level had just been loaded
  uint64_t toggles_back = 0;     ///< of all toggles: undoing one of the same node within the second before, about
  double nodes_fading_mean = 0;
  /// Deviation of the time for one and the same picture, drawn twice, in percent of it; 0: not measured.
  double frame_noise_percent = 0;
  double frame_cpu_noise_percent = 0;  ///< the same by processor time
  double draw_cpu_ms_mean = 0;
  std::optional<double> popped_share_mean, popped_share_p99;            ///< nullopt: not measured
  std::optional<double> popped_area_share_mean, popped_area_share_p99;  ///< the same by areas of 8 x 8 pixels
  Teleports teleports;
  uint64_t cells_crossed = 0;   ///< 0 without cells
  double delta_bytes_mean = 0;  ///< read for a step into another cell; 0 without cells
  double delta_nodes_mean = 0;  ///< that came or went with a step
  uint64_t vlods_missing = 0;   ///< frames that the tree alone served inside a cell: its vLOD was not read yet
  uint64_t far_crossed = 0, far_late = 0, far_missing = 0;  ///< frames; 0 without far pictures
  double far_triangles_mean = 0;                            ///< of far pictures
  uint64_t bytes_read = 0;
  uint64_t reads = 0;  ///< runs of bytes that lie one behind the other in a file
  uint64_t bytes_read_useful =
      0;  ///< of segments whose node was drawn before it left memory again, and all vLODs and far pictures
  uint64_t resident_bytes_peak = 0;
  uint64_t peak_rss_bytes = 0;                     ///< of the process
  uint64_t stalls = 0;                             ///< frames that took more than twice target_ms
  uint64_t memory_bytes = 0;                       ///< the bound
  double coarsening_mean = 1, coarsening_max = 1;  ///< of the bound in pixels, for what is wanted to fit
  /// To what side shared pictures were halved to fit into it; nullopt: none was.
  std::optional<uint32_t> texture_side_px;
};

struct FlightReport {
  FlightTotals totals;
  std::vector<FrameRow> rows;
  LoaderCounts loader;
};

/// Called after every frame, when the renderer holds its picture. An error ends the flight with it.
using FrameCallback = std::function<Status(const FrameRow& row, Renderer& renderer)>;

/// Flies. Errors: those of Session, of the callback, "interrupted".
Result<FlightReport> fly(const ModelSource& source, Renderer& renderer, const CameraPath& path,
                         const FlightOptions& options, const FrameCallback& on_frame, JobMonitor& monitor);

/// Totals of rows (frame times, triangles, ...; what only the loader knows stays 0).
FlightTotals totals_of(const std::vector<FrameRow>& rows, double target_ms);

}  // namespace promenade
