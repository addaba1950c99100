#pragma once
// A model being looked at: resident set, loader, policy and renderer, a frame at a time. What `fly`, `view` and `render
// MODEL` have in common.

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "geometry/result.h"
#include "runtime/cursor.h"
#include "runtime/importance.h"
#include "runtime/loader.h"
#include "runtime/model_source.h"
#include "runtime/policy.h"
#include "runtime/range_cells.h"
#include "runtime/renderer.h"

namespace promenade {

/// What the policies with far pictures draw of the two, [xiong1996] section 5.1.
enum class FarStyle : uint8_t { full, near_only, far_only };
/// "full", "near", "far".
std::string_view name_of(FarStyle style);
std::optional<FarStyle> far_style_named(std::string_view name);

struct SessionOptions {
  SelectOptions select;
  LoaderOptions loader;
  /// Time a frame for handing loaded nodes to the renderer. At least one is handed over, so that loading never stops.
  double upload_budget_ms = 4;
  /// false: the loader runs only inside run_loader(): the same steps in the same order each time.
  bool loader_thread = true;
  /// Counted against the memory bound besides the model: the renderer's framebuffers (Renderer::frame_bytes).
  uint64_t frame_bytes = 0;
  Lighting lighting;
  Background background;
  bool textures = true;
  /// What drawing costs with this renderer (draw_costs_here); nullopt: frame times are foretold by [lakhia2004]'s
  /// v_time.
  std::optional<DrawCosts> draw_costs;
  /// Frames that a switch between levels takes to fade; 0: switches pop. A fade draws both levels: policies that share
  /// out time are charged for it.
  uint32_t fade_frames = 8;
  RangeOptions range;  ///< of the eye: whose cells' vLODs are read beforehand
  FarStyle far_style = FarStyle::full;
  ClassWeights class_weights;  ///< how much what the source calls so matters; by default all alike
};

/// An eye that moves faster has jumped: it has no speed that would tell where it goes next. Faster than airliners.
constexpr double kFastestFlightMPerS = 300;

/// What one frame did. Names as in `fly --json`.
struct FrameRow {
  uint32_t frame = 0;
  double t_s = 0;
  double frame_ms = 0;  ///< select + upload + draw: what the render thread was busy with
  double select_ms = 0, upload_ms = 0, draw_ms = 0;
  double response_ms = 0;  ///< from reading the pose to the finished picture, waiting included
  /// What frame_ms was expected to be when the front had been chosen and drawing began.
  double estimated_ms = 0, estimated_without_feedback_ms = 0;
  double share_ms = 0;  ///< shareTime of the roots
  double moved_m = 0;   ///< since the frame before
  uint64_t triangles_drawn = 0, nodes_drawn = 0, nodes_missing = 0;
  uint64_t toggles = 0, toggles_up = 0, toggles_down = 0;
  uint64_t toggles_loading = 0;  ///< of those up: what came was not there a frame before
  uint64_t nodes_fading = 0;     ///< drawn besides the front, for fades; their triangles are in triangles_drawn
  double pace = 1;               ///< of the machine: how much longer frames take than measured once
  uint64_t resident_bytes = 0;   ///< all that the memory bound counts
  uint64_t bytes_read = 0;       ///< since the frame before
  std::optional<CellId> cell;    ///< the eye's; nullopt: outside
  bool cell_crossed = false;     ///< into another cell than in the frame before
  bool vlod_missing = false;     ///< the policy asks for the cell's vLOD, which is not read yet: the tree alone served
  uint64_t far_layers = 0;       ///< far pictures drawn: 2 while one fades into the next; 0: geometry alone
  uint64_t far_triangles = 0;    ///< of them, in triangles_drawn, too
  bool far_crossed = false;      ///< into another far cell than in the frame before
  bool far_late = false;         ///< the last far cell's picture stood in
  bool far_missing = false;      ///< geometry stood in for a far cell's picture
  uint64_t nodes_foreseen = 0;   ///< that may be wanted soon, besides those that are
  uint64_t range_cells = 0;      ///< that the eye may be in within the horizon
  uint64_t delta_nodes = 0;      ///< that came or went with the vLOD that is now used
  uint64_t delta_bytes = 0;      ///< that it took on disk
  std::vector<uint32_t> nodes_by_level;
  double draw_cpu_ms = 0;  ///< processor time of drawing, all threads but the loader's
  /// What that was expected to be: an estimate that other programs on the machine do not disturb. 0: no cost model.
  double estimated_cpu_ms = 0;
  double redraw_ms = 0;  ///< fly: the same picture drawn again; 0: it was not
  double redraw_cpu_ms = 0;
  /// fly: of the pixels, and by areas (runtime/popping.h)
  std::optional<double> popped_share, popped_area_share;
};

/// One thread (the renderer's).
class Session {
 public:
  /// Loads the roots. source and renderer must outlive the session. Errors: a root that cannot be read; a memory bound
  /// below what tables, roots and one node's loading take (the message says how much is needed); a policy with far
  /// pictures and a model without.
  static Result<Session> open(const ModelSource& source, Renderer& renderer, const SessionOptions& options);
  Session(Session&&) noexcept;
  Session& operator=(Session&&) noexcept;
  ~Session();

  /// Selects, hands priorities to the loader, uploads what it brought, draws. dt_s: path time since the last frame, for
  /// the velocity; 0 at first.
  Result<FrameRow> frame(const Camera& camera, double dt_s);

  /// Gives the loader this much of its own time. With a thread: it may run on beside the caller; without: runs it here.
  void run_loader(double ms);
  /// Waits until the loader has nothing to do or has spent its time. Only with a thread does it wait at all.
  void wait_for_loader();
  /// Repeats frames from where the camera stands until nothing that the policy asks for is missing and loadable, or
  /// max_frames are drawn: a still picture.
  Result<FrameRow> settle(const Camera& camera, uint32_t max_frames = 2000);

  /// Draws the last frame once more, as it was. What two times for one picture differ by is the machine's noise: no
  /// estimate can be better.
  struct Redraw {
    double ms = 0, cpu_ms = 0;  ///< by the clock; of the processor
  };
  Result<Redraw> redraw();
  /// Draws the nodes of the last frame as another camera sees them: what is there, and what is left out.
  Status draw_from(const Camera& camera);

  /// Time of a frame that draws the roots alone: [lakhia2004]'s fixed overhead and the shading of a picture. Draws a
  /// few.
  Status measure_overhead(const Camera& camera);

  const Selection& selection() const;
  const SelectState& select_state() const;
  LoaderCounts loader_counts() const;
  /// Messages of the first few segments that could not be read, decoded or uploaded.
  std::vector<std::string> failures() const;
  /// Nodes that may be drawn now.
  std::vector<NodeId> resident_nodes() const;
  uint64_t resident_bytes() const;
  uint64_t resident_bytes_peak() const;
  /// Of what moves: holds from the next frame on.
  void set_time(double time_s);
  /// The model with what moves where it was drawn last.
  const Model& model_now() const;
  const ClassWeights& class_weights() const;
  void set_class_weight(const std::string& class_name, double weight);  ///< in [0, 1]; may be called between frames
  SelectOptions& select_options();                                      ///< may be changed between frames
  FrameView& frame_view();  ///< light and background; may be changed between frames
  uint32_t& fade_frames();  ///< may be changed between frames
  FarStyle& far_style();    ///< may be changed between frames

 private:
  struct State;
  explicit Session(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace promenade
