#pragma once
// What of a frame is decided before it is drawn: where the eye is among the cells, which nodes are shown, fades, far
// pictures, and what the loader should bring.

#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "runtime/cursor.h"
#include "runtime/eye_culler.h"
#include "runtime/fades.h"
#include "runtime/far_follower.h"
#include "runtime/frame.h"
#include "runtime/model_source.h"
#include "runtime/posed_model.h"
#include "runtime/range_cells.h"
#include "runtime/vlod_store.h"

namespace promenade {

/// What choosing shares with loading and drawing. far and eye may be null.
struct Shared {
  ResidentSet& set;
  VlodStore& vlods;
  FarStore* far;
  EyeCuller* eye;
};

/// One thread at a time: it calls the functions of ResidentSet, VlodStore and FarStore that are marked choose.
class FrameChooser {
 public:
  /// costs: SessionOptions::draw_costs. What is passed must outlive it.
  FrameChooser(const ModelSource& source, const Shared& shared, const std::optional<DrawCosts>& costs,
               const RangeOptions& range);

  /// Selects, lets switches fade, and tells the loader what matters. Frames are drawn in the order in which they are
  /// chosen, each after what it says is leaving has been destroyed.
  void choose(const FrameWish& wish, ChosenFrame& frame);
  /// What a frame took, for the feedback loops: once for each frame, in their order.
  void learn(const FrameTook& took);

  /// Whether drawing is foretold by what it costs on this machine, not by v_time.
  bool has_costs() const { return select_state_.costs.has_value(); }
  /// Time of a frame that draws the roots alone.
  void set_overhead_ms(double ms) { select_state_.overhead_ms = ms; }
  const PosedModel& posed() const { return posed_; }

 private:
  void look_back(const FrameWish& wish, SelectView& seen, FrameRow& row);
  void move_to(const FrameWish& wish, SelectView& seen, FrameRow& row);
  void foresee(CellId cell, const SelectOptions& select, SelectView& seen, FrameRow& row);
  void look_with_eye(SelectView& seen, FrameRow& row);
  void use_vlod(CellId cell, FrameRow& row);
  void follow_far(const FrameWish& wish, SelectView& seen, FrameRow& row);
  void show(const FrameWish& wish, const SelectView& seen, ChosenFrame& frame);
  DrawLoad load_of_fades(const Camera& camera, FrameRow& row) const;
  void put_items(const FrameWish& wish, ChosenFrame& frame) const;

  const ModelSource& source_;
  Shared shared_;
  RangeOptions range_;
  Cursor cursor_;
  std::unique_ptr<VlodMarks> marks_;      ///< null: the model has no cells
  std::unique_ptr<VlodMarks> eye_marks_;  ///< of these, what the eye sees; null: it has not been asked for
  std::unique_ptr<SoonMarks> soon_;       ///< null: the model has no cells
  std::optional<CellId> marked_;          ///< the cell whose vLOD `marks_` has
  std::optional<FarFollower> far_;        ///< nullopt: no far pictures
  std::optional<FarCellId> last_far_;
  std::vector<DrawItem> far_items_;
  SelectState select_state_;
  std::optional<CostModel> cpu_costs_;  ///< the same in processor time; nothing is decided by it
  PosedModel posed_;
  Fades fades_;
  std::vector<FadedNode> faded_;
  double fade_ms_ = 0;  ///< what the last frame's fades are foretold to take
  std::optional<Pose> last_pose_;
};

}  // namespace promenade
