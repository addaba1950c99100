// What the loader is told of besides what a policy visits: nodes that will be wanted where the eye will be a little
// later, after a turn of the head, or in the next cells. Source: [funkhouser1993] section 5.2.2: objects up to the
// level that can be asked for within the horizon.

#include <algorithm>
#include <limits>

#include "runtime/selecting.h"

namespace promenade {
namespace {

class LookingAhead {
 public:
  explicit LookingAhead(Selecting& selecting)
      : s_(selecting),
        soon_(selecting.vlod == nullptr ? nullptr : selecting.view.soon),
        later_(glm::dvec3(selecting.sight.eye) + selecting.view.velocity_m_per_s * selecting.options.prefetch_s) {}

  void run() {
    s_.state.ahead.clear();
    for (const NodeId root : s_.model.tables.roots) visit({root, s_.vlod == nullptr, s_.view.leaving, true, kAlways});
    while (!stack_.empty()) {
      const Visit at = stack_.back();
      stack_.pop_back();
      const bool in_view = at.in_view && s_.visible(at.node);
      for (const NodeId child : s_.model.children_of(at.node))
        visit({child, at.seen_whole, at.soon_whole, in_view, at.until});
    }
  }

 private:
  static constexpr float kAlways = std::numeric_limits<float>::max();
  struct Visit {
    NodeId node;
    bool seen_whole, soon_whole;  ///< this cell's vLOD, or the next ones', has it or an ancestor
    bool in_view;                 ///< what it was refined from is
    float until;                  ///< as AheadNode's
  };

  void visit(Visit at) {
    const bool soon = soon_ != nullptr && soon_->leads_to_some(at.node);
    const bool here = at.seen_whole || s_.may_be_seen(at.node);
    if (!here && !at.soon_whole && !soon) return;
    at.seen_whole = at.seen_whole || (s_.vlod != nullptr && s_.vlod->has(at.node));
    at.soon_whole = at.soon_whole || (soon && soon_->has(at.node));
    const AskedBy by = !here ? AskedBy::elsewhere : at.in_view ? AskedBy::view : AskedBy::cell;
    s_.state.ahead.push_back({at.node, at.until, by});
    const NodeRecord& n = s_.node(at.node);
    if (n.child_count == 0) return;
    at.until = std::min(at.until, static_cast<float>(finer_until(at)));
    if (at.until <= 1) return;
    const double distance_m = priority_distance(n, s_.sight, s_.options);
    if (frustum_visibility(n, s_.sight, s_.options, distance_m) > 0) stack_.push_back(at);
  }

  /// The factor on the bound from which on the node is fine enough; <= 1: it is as the bound is.
  double finer_until(const Visit& at) const {
    const NodeRecord& n = s_.node(at.node);
    const float distance_m = std::min(n.box.distance(s_.sight.eye), n.box.distance(later_));
    const double error =
        screen_error_px(error_m(n, s_.options.error_kind), double(distance_m), s_.sight.pixels_per_radian);
    const double bound = s_.wished_px();
    const double factor = error <= bound ? 1 : error / std::max(bound * s_.tolerance(at.node), 1e-9);
    if (s_.options.policy != Policy::vlod || s_.vlod == nullptr || s_.view.leaving) return factor;
    const bool finer_soon = soon_ != nullptr && soon_->leads_below(at.node);
    const bool ends_here = !finer_soon && (at.seen_whole || !s_.vlod->leads_to_some(at.node));
    return ends_here ? 1 : std::max(factor, kJustFiner);
  }
  static constexpr double kJustFiner = 1 + 1e-6;  ///< a cell's front is finer than what the eye asks for

  Selecting& s_;
  const SoonMarks* soon_;
  glm::vec3 later_;
  std::vector<Visit> stack_;
};

}  // namespace

void look_ahead(Selecting& selecting) { LookingAhead(selecting).run(); }

void fit_into_memory(Selecting& selecting) {
  SelectState& state = selecting.state;
  const SelectView& view = selecting.view;
  MemoryFit& fit = state.fit;
  const bool waits_for_vlod = uses_vlod(selecting.options.policy) && view.cell != nullptr && view.vlod == nullptr;
  if (!waits_for_vlod) {  // until it is read everything would seem to be wanted
    const BytesAsked asked = bytes_asked(selecting.model, *view.memory, state.ahead, state.ahead_textures);
    fit.follow(asked, view.memory->bytes, view.cell != state.fit_cell, view.jumped);
    state.fit_cell = view.cell;
  }
  selecting.out.coarser = fit.drawn;
}

void foresee(Selecting& selecting) {
  const MemoryFit& fit = selecting.state.fit;
  for (const AheadNode& n : selecting.state.ahead)
    if (double(n.until) > fit.of(n.by) && selecting.foresee(n.node)) ++selecting.out.nodes_foreseen;
}

}  // namespace promenade
