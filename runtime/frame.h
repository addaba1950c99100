#pragma once
// A frame on its way through the stages: asked for, chosen, drawn. What the stages hand each other.

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string_view>
#include <vector>

#include "geometry/camera.h"
#include "runtime/far_store.h"
#include "runtime/policy.h"
#include "runtime/renderer.h"
#include "runtime/resident_set.h"

namespace promenade {

/// What the policies with far pictures draw of the two, [xiong1996] section 5.1.
enum class FarStyle : uint8_t { full, near_only, far_only };
/// "full", "near", "far".
std::string_view name_of(FarStyle style);
std::optional<FarStyle> far_style_named(std::string_view name);

/// An eye that moves faster has jumped: it has no speed that would tell where it goes next. Faster than airliners.
constexpr double kFastestFlightMPerS = 300;

/// What one frame did. Names as in `fly --json`.
struct FrameRow {
  uint32_t frame = 0;
  double t_s = 0;
  /// What the frame took: select + upload + draw, one after the other; with frames ahead, the time between the end of
  /// the last picture and the end of this one, less what the drawing thread spent elsewhere.
  double frame_ms = 0;
  double select_ms = 0, upload_ms = 0, draw_ms = 0;
  double wait_ms = 0;      ///< of frame_ms, for a frame ahead that was still being chosen
  double response_ms = 0;  ///< from reading the pose to the finished picture, waiting included
  /// What frame_ms was expected to be when the front had been chosen and drawing began.
  double estimated_ms = 0, estimated_without_feedback_ms = 0;
  double share_ms = 0;    ///< shareTime of the roots
  double coarsening = 1;  ///< of the bound in pixels, for what is wanted to fit into memory
  double moved_m = 0;     ///< since the frame before
  uint64_t triangles_drawn = 0, nodes_drawn = 0, nodes_missing = 0;
  uint64_t toggles = 0, toggles_up = 0, toggles_down = 0;
  uint64_t toggles_loading = 0;  ///< of those up: what came was not there a frame before
  uint64_t toggles_back = 0;     ///< of all: undoing one of the same node within the second before, about
  uint64_t nodes_fading = 0;     ///< drawn besides the front, for fades; their triangles are in triangles_drawn
  double pace = 1;               ///< of the machine: how much longer frames take than measured once
  uint64_t resident_bytes = 0;   ///< all that the memory bound counts
  uint64_t bytes_read = 0;       ///< since the frame before
  std::optional<CellId> cell;    ///< the eye's; nullopt: outside
  bool cell_crossed = false;     ///< into another cell than in the frame before
  bool vlod_missing = false;     ///< the policy asks for the cell's vLOD, which is not read yet: the tree alone served
  uint64_t far_layers = 0;       ///< far pictures drawn: 2 while one fades into the next; 0: geometry alone
  uint64_t far_triangles = 0;    ///< of them, in triangles_drawn, too
  std::optional<FarCellId> far_cell;  ///< whose picture was drawn, of the innermost shell
  bool far_crossed = false;           ///< into another far cell than in the frame before
  bool far_late = false;              ///< the last far cell's picture stood in
  bool far_missing = false;           ///< geometry stood in for a far cell's picture
  uint64_t eye_hidden_nodes = 0;      ///< of the cell's vLOD: this eye does not see them (SelectOptions::eye_culling)
  double eye_ms = 0;                  ///< that finding them took, of select_ms
  uint64_t nodes_foreseen = 0;        ///< that may be wanted soon, besides those that are
  uint64_t range_cells = 0;           ///< that the eye may be in within the horizon
  uint64_t delta_nodes = 0;           ///< that came or went with the vLOD that is now used
  uint64_t delta_bytes = 0;           ///< that it took on disk
  std::vector<uint32_t> nodes_by_level;
  double draw_cpu_ms = 0;  ///< processor time of drawing, all threads but those that load and choose
  /// What that was expected to be: an estimate that other programs on the machine do not disturb. 0: no cost model.
  double estimated_cpu_ms = 0;
  double redraw_ms = 0;  ///< fly: the same picture drawn again; 0: it was not
  double redraw_cpu_ms = 0;
  /// fly: of the pixels, and by areas (runtime/popping.h)
  std::optional<double> popped_share, popped_area_share;
};

/// A picture that is asked for, with all that may be set meanwhile for the next one.
struct FrameWish {
  Camera camera;
  double dt_s = 0;    ///< path time since the last one
  double time_s = 0;  ///< of what moves
  SelectOptions select;
  FrameView view;  ///< light and background; the camera is the one above
  uint32_t fade_frames = 0;
  FarStyle far_style = FarStyle::full;
  std::shared_ptr<const std::vector<float>> importance;  ///< by node; empty: all matter alike
  double upload_ms = 0;                                  ///< of target_ms, already spent on this frame
  std::chrono::steady_clock::time_point asked;           ///< when its pose was read
};

/// A frame that is chosen, to be drawn after those chosen before it.
struct ChosenFrame {
  FrameView view;
  std::vector<DrawItem> items;
  Selection selection;            ///< its load and estimates with what fades
  TimeSliceOptions time;          ///< that it was chosen with
  FrameRow row;                   ///< as far as choosing knows it
  ResidentSet::Leaving leaving;   ///< destroyed before it is drawn
  FarStore::Leaving far_leaving;  ///< the same
  std::chrono::steady_clock::time_point asked, chosen;
};

/// What a frame took, for the feedback loops.
struct FrameTook {
  SelectionSums sums;
  TimeSliceOptions time;
  double foretold_ms = 0;  ///< of what the estimate is for
  double frame_ms = 0, draw_cpu_ms = 0;
};

}  // namespace promenade
