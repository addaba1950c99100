#pragma once
// A model being looked at: resident set, loader, policy and renderer, a frame at a time. What `fly`, `view` and `render
// MODEL` have in common. The stages of a frame: ask() reads pose and settings; choosing (frame_chooser.h) runs in
// draw_next(), or beside it for frames ahead (choosing_thread.h); draw_next() uploads and draws.

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "geometry/result.h"
#include "runtime/frame.h"
#include "runtime/importance.h"
#include "runtime/loader.h"
#include "runtime/model_source.h"
#include "runtime/policy.h"
#include "runtime/range_cells.h"
#include "runtime/renderer.h"

namespace promenade {

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
  /// Frames that are chosen while earlier ones are drawn, [funkhouser1993] chapter 6: more frames a second where a
  /// processor is free to choose them, each shown that much later after its pose was read. 0: one after the other.
  uint32_t frames_ahead = 0;
  ClassWeights class_weights;  ///< how much what the source calls so matters; by default all alike
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

  /// Asks for a frame as the settings are now, to be drawn after those asked for before; no more than
  /// SessionOptions::frames_ahead + 1 at once. dt_s: path time since the last frame, for the velocity; 0 at first.
  /// read: when the pose was read; nullopt: now.
  void ask(const Camera& camera, double dt_s, std::optional<std::chrono::steady_clock::time_point> read = {});
  uint32_t frames_asked() const;  ///< and not drawn yet
  uint32_t frames_ahead() const;
  /// Uploads what the loader brought; chooses the frame asked for first (unless that has been done beside the last one)
  /// and hands its priorities to the loader; draws. There must be a frame asked for.
  Result<FrameRow> draw_next();
  /// Both, after drawing those asked for before: the row of this one.
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

  /// Of the frame drawn last.
  const Selection& selection() const;
  const Camera& camera_drawn() const;
  LoaderCounts loader_counts() const;
  /// Messages of the first few segments that could not be read, decoded or uploaded.
  std::vector<std::string> failures() const;
  /// Nodes that may be drawn now.
  std::vector<NodeId> resident_nodes() const;
  uint64_t resident_bytes() const;
  uint64_t resident_bytes_peak() const;
  /// To what side shared pictures are halved: LoaderOptions::texture_side, or what the bound asks for; kAnySide: none
  /// is.
  uint32_t texture_side_px() const;
  /// Of what moves. This and all settings: hold from the next ask() on, and may be changed between two.
  void set_time(double time_s);
  /// The model with what moves where it was drawn last.
  const Model& model_now() const;
  const ClassWeights& class_weights() const;
  void set_class_weight(const std::string& class_name, double weight);  ///< in [0, 1]
  SelectOptions& select_options();
  bool has_openings() const;  ///< SelectOptions::eye_culling has an effect
  FrameView& frame_view();    ///< light and background
  uint32_t& fade_frames();
  FarStyle& far_style();

 private:
  struct State;
  explicit Session(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace promenade
