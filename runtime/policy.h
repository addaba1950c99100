#pragma once
// Selection: which nodes to draw now, and how much every node matters for loading. Pure functions of model, view,
// residency and a state that the caller keeps from frame to frame: no disk, no GPU, no clock.

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "geometry/camera.h"
#include "layout/cell_front.h"
#include "runtime/draw_costs.h"
#include "runtime/memory_fit.h"
#include "runtime/priority_list.h"
#include "runtime/soon_marks.h"
#include "runtime/vlod_marks.h"

namespace promenade {

enum class Policy : uint8_t {
  none,          ///< no detail elision: every leaf in the frustum
  static_error,  ///< "static": the coarsest front whose projected error stays within pixel_error
  feedback,      ///< static with a bound that follows the last frames' times ([funkhouser1993] section 4.2.2)
  /// The front of the most benefit that fits into target_ms, never refined beyond pixel_error; hidden nodes are left
  /// out where a vLOD is there ([funkhouser1993] section 4.2.3, from chains of levels to the tree).
  cost_benefit,
  time_slices,  ///< [lakhia2004] section 4.2, never refined beyond pixel_error
  lakhia,       ///< [lakhia2004] section 4.2 as published: refines as long as time is left
  front,        ///< the front of the eye's cell, nothing hidden; outside the cells: static
  vlod,         ///< the vLOD of the eye's cell [chhugani2003]; outside the cells: static
  /// Time slices over what the vLOD says can be seen (the default); outside the cells: time_slices. The cell tells what
  /// is hidden, the eye how fine the rest must be.
  vlod_time_slices,
  /// Near geometry, far pictures [xiong1996]: static within the box around the eye's far cell; where no picture is
  /// there, static everywhere. Only in models with far pictures.
  stratified,
  /// The same over what the vLOD says can be seen, and at its detail.
  vlod_stratified,
};
/// "none", "static", "feedback", "cost-benefit", "time-slices", "lakhia", "front", "vlod", "vlod-time-slices",
/// "stratified", "vlod-stratified".
std::string_view name_of(Policy policy);
std::optional<Policy> policy_named(std::string_view name);
/// All names, for usage texts: "none, static, time-slices, ...".
std::string policy_names();
/// Every policy, the default first: for menus.
std::span<const Policy> all_policies();
/// Whether the policy asks what the eye's cell sees.
constexpr bool uses_vlod(Policy policy) {
  return policy == Policy::vlod || policy == Policy::vlod_time_slices || policy == Policy::cost_benefit ||
         policy == Policy::vlod_stratified;
}
/// Whether the policy draws pictures of what is far.
constexpr bool uses_far(Policy policy) { return policy == Policy::stratified || policy == Policy::vlod_stratified; }
/// Whether the policy shares out frame time.
constexpr bool uses_time(Policy policy) {
  return policy == Policy::time_slices || policy == Policy::lakhia || policy == Policy::vlod_time_slices;
}

/// Constants of [lakhia2004]; names and values of table 6.1 unless a reason is given.
struct TimeSliceOptions {
  double target_ms = 30;  ///< c_targetTime
  /// c_textured: weight of a textured triangle, 1 - it of an untextured one. The table's 0.127 was measured on a
  /// GeForce4, where untextured triangles cost seven times as much; here both cost about the same.
  double textured_weight = 0.5;
  double visibility_weight = 1.275;      ///< c_vis
  double foreshortening_weight = 0.450;  ///< c_fore
  /// c_hystSwitch and c_hystLimit. A counter falls by at most 1 a frame, so that the table's 1500 and 4510 would take
  /// 45 seconds to coarsen anything, against the paper's own figures (6.6). Here a three-hundredth: a sixth of a second
  /// at 30 frames. Larger ones flicker more, not less: the share's feedback loop then swings (tests: loops_settle).
  double hysteresis_switch = 5;
  double hysteresis_limit = 15.03;
  bool hysteresis = true;  ///< false: the simpler rule, shareTime > sum of timeNeeded
  /// Refine only when all children are resident, not only the visible ones: later detail, less flicker (section 5.2).
  bool all_children_resident = true;
  bool time_feedback = true;       ///< v_time follows measured frame times
  bool share_feedback = true;      ///< shareTime of the roots follows the use of target_ms
  double time_gain = 0.1;          ///< part of v_time's error corrected a frame, (0, 1]
  double share_gain = 0.01;        ///< change of shareTime a frame, (0, 1)
  double share_tolerance = 0.1;    ///< "substantially" above or below target_ms, as a part of it
  double share_factor_max = 1000;  ///< shareTime stays within target_ms / this and target_ms * this
};

/// What an object's drawing is worth, [funkhouser1993] section 4.2.3: size x accuracy x importance x focus x motion x
/// hysteresis, each factor in [0, 1] but the size in pixels. A weight of 0 switches its factor off.
struct BenefitOptions {
  /// Error at which a picture tells half of what the ideal one would, pixels. The paper's accuracy counts samples; here
  /// a node's error is known: accuracy = 1 / (1 + error / this).
  double half_error_px = 4;
  double focus_weight = 0.5;       ///< lost at the corners of the picture
  double motion_weight = 0.5;      ///< of the speed on the screen over the size of a triangle, both pixels a frame
  double hysteresis_weight = 0.1;  ///< lost by a level that was not drawn in the frame before
  double importance_weight = 1;    ///< of SelectView::importance
  double frame_s = 1.0 / 30;       ///< in which motion blurs
};

struct SelectOptions {
  Policy policy = Policy::vlod_time_slices;
  double pixel_error = 1;                   ///< pixels; static, time_slices and vlod_time_slices
  ErrorKind error_kind = ErrorKind::bound;  ///< what pixel_error is compared with
  /// A node that was refined in the last frame stays so until its error is this part below pixel_error: finer than
  /// asked for, never coarser. Without it an eye that stands on the line between two levels flickers.
  double error_hysteresis = 0.1;
  /// Of what the eye's cell sees, leave out what this eye does not, for models that say what is open in their walls.
  bool eye_culling = false;
  /// Where what is wanted does not fit into memory, pixel_error gives way as far as it must (memory_fit.h). Not for the
  /// policies none, lakhia and front, nor with far pictures, nor for a bound of 0. false: what does not fit is asked
  /// for in vain.
  bool fit_memory = true;
  TimeSliceOptions time;
  BenefitOptions benefit;
  /// The eye is taken where it will be this much later, for priorities only ("slightly adjusted based on the user's
  /// velocity").
  double look_ahead_s = 0.25;
  /// What will be wanted so much later on the way is loaded beforehand; 0: only what is wanted now, and its children.
  double prefetch_s = 1;
  /// A node this many times its distance outside the frustum has frustumVis 0; linear between.
  double visibility_falloff = 0.5;
  /// A node's distance is at least this and this part of its box's diagonal, so that the eye may be inside it.
  double distance_min_m = 1;
  double distance_min_diagonals = 0.25;
};

/// Whatever is asked for now goes before all that is only foreseen, and that before what is just still there:
/// priorities are scaled by these. Without the gap, what lies behind the eye, or is foreseen close by, would drive out
/// what is seen far away, since priorities fall with the square of the distance.
constexpr float kForeseenPriority = 1e-12F, kRememberedPriority = 1e-24F;

/// What a selection sees.
struct SelectView {
  Camera camera;
  glm::dvec3 velocity_m_per_s{0};
  double turn_rad_per_s = 0;  ///< how fast the view direction changes
  /// Milliseconds of target_ms that are spoken for: uploads, what fades.
  double reserved_ms = 0;
  /// By node, in [0, 1]; empty: all 1. [funkhouser1993]'s semantics.
  std::span<const float> importance;
  /// The vLOD of the eye's cell; null: outside the cells, or not read yet: the tree alone serves.
  const VlodMarks* vlod = nullptr;
  /// The model with the boxes that moving objects sweep, for what is foreseen; null: nothing moves.
  const Model* swept = nullptr;
  const SoonMarks* soon = nullptr;       ///< what the next cells see; null: not known
  bool leaving = false;                  ///< the eye may soon be outside the cells, where everything may be seen
  const Box* cell = nullptr;             ///< the eye's cell; null: outside
  const FrontBound* bound = nullptr;     ///< of the cells' fronts; not null where `cell` is not
  const MemoryBudget* memory = nullptr;  ///< null: there is enough
  bool jumped = false;                   ///< the eye was elsewhere a frame ago
  /// What meets one of these boxes is drawn as geometry, the rest is in a far picture; empty: everything is geometry.
  std::span<const Box> near;
};

/// What a selection remembers. Sized to the model on first use; byte_size counts it.
struct SelectState {
  struct Node {
    float hysteresis = 0;
    uint32_t visited = 0, drawn = 0, refined = 0;  ///< frame of the last time, 0: never
    uint32_t priced = 0;                           ///< the same
    uint32_t lacked = 0;                           ///< the same, drawn because finer nodes were wanted but not resident
    uint32_t toggled = 0;                          ///< the same, of a toggle up or down
  };
  std::vector<Node> nodes;
  uint32_t frame = 0;
  double ms_per_cost = 0;        ///< v_time; 0: not known yet
  double first_ms_per_cost = 0;  ///< v_time as first measured: the estimate without feedback
  uint32_t measured_frames = 0;
  double overhead_ms = 0;  ///< of a frame that draws the roots alone
  double share_ms = 0;     ///< shareTime of the roots; 0: not set yet
  /// What drawing costs; then it and not v_time foretells. nullopt: v_time, as published.
  std::optional<CostModel> costs;
  double feedback_pixel_error = 0;  ///< policy feedback's bound now; 0: not set yet
  /// Nodes on the way of a selection, parents before children; scratch.
  struct Visit {
    NodeId node = kNoNode;
    uint32_t parent = 0xffffffffU;  ///< index of a visit
    uint32_t uncovered_children = 0;
    bool wanted = false;  ///< the chosen front has it; else it is on the way there
  };
  std::vector<Visit> visits;
  MemoryFit fit;
  const Box* fit_cell = nullptr;  ///< the eye's cell when `fit` was last brought up to date; null: outside
  std::vector<AheadNode> ahead, ahead_textures;  ///< scratch
  uint64_t byte_size() const {
    return nodes.capacity() * sizeof(Node) + visits.capacity() * sizeof(Visit) +
           (ahead.capacity() + ahead_textures.capacity()) * sizeof(AheadNode);
  }
};

/// What a selection comes to.
struct SelectionSums {
  static constexpr uint32_t kBackFrames = 30;  ///< a second, about
  uint64_t triangles = 0;
  uint64_t nodes_missing = 0;       ///< nodes of the chosen front that were not resident: an ancestor stands in
  uint64_t toggles_up = 0;          ///< nodes drawn last frame, now refined ([lakhia2004] section 6.5)
  uint64_t toggles_down = 0;        ///< nodes refined last frame, now drawn
  uint64_t toggles_loading = 0;     ///< of both: because finer nodes came into memory or left it
  uint64_t toggles_back = 0;        ///< of both: undoing one of the same node kBackFrames ago at most
  uint64_t loaded_rejected = 0;     ///< sibling sets that were resident but had no time
  uint64_t nodes_foreseen = 0;      ///< priced because they may be wanted soon, not now
  uint64_t optimisation_steps = 0;  ///< cost_benefit: levels changed on the way from the last frame's front
  double coarser = 1;               ///< the factor on pixel_error that memory asks for
  double cost = 0;                  ///< sum of the front's cost_n
  DrawLoad load;                    ///< of the front, with the picture's
  double estimated_ms = 0;          ///< of drawing: by SelectState::costs, else overhead + v_time x cost
  double estimated_without_feedback_ms = 0;
};

struct Selection : SelectionSums {
  std::vector<NodeId> front;             ///< to draw, all resident, nearest first
  std::vector<PriorityUpdate> updates;   ///< every node visited, each once
  std::vector<uint32_t> nodes_by_level;  ///< of the front, by NodeRecord::level
};

/// resident: one flag a node; roots must be set. Every visible path from root to leaf meets the front exactly once.
/// `selection` is overwritten; its vectors' memory is used again.
void select(const Model& model, const SelectView& view, std::span<const uint8_t> resident, const SelectOptions& options,
            SelectState& state, Selection& selection);

/// The feedback loops, once a frame after drawing. draw_ms: drawing (without a cost model selection, too), what
/// estimated_ms is to foretell;
/// frame_ms: all that the frame took, what shareTime is to keep near target_ms.
void feed_back(const SelectionSums& selection, double draw_ms, double frame_ms, const TimeSliceOptions& options,
               SelectState& state);

/// cost_n, equation 3.1. Triangles, weighted.
double node_cost(const NodeRecord& node, const TimeSliceOptions& options);
/// The priority that a selection gives a node, for nodes that it did not visit.
float node_priority(const Model& model, NodeId node, const SelectView& view, const SelectOptions& options);

/// The same for many nodes of one frame. model and options must outlive it.
class NodePricer {
 public:
  NodePricer(const Model& model, const SelectView& view, const SelectOptions& options);
  float operator()(NodeId node) const;

 private:
  const Model& model_;
  const SelectOptions& options_;
  std::shared_ptr<const void> sight_;  ///< what of the view does not depend on the node
};

}  // namespace promenade
