// What the loader is told of besides what a policy visits: nodes that will be wanted where the eye will be a little
// later, after a turn of the head, or in the next cells. Source: [funkhouser1993] section 5.2.2: objects up to the
// level that can be asked for within the horizon.

#include <algorithm>

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
    for (const NodeId root : s_.model.tables.roots) visit({root, s_.vlod == nullptr, s_.view.leaving});
    while (!stack_.empty()) {
      const Visit at = stack_.back();
      stack_.pop_back();
      for (const NodeId child : s_.model.children_of(at.node)) visit({child, at.seen_whole, at.soon_whole});
    }
  }

 private:
  struct Visit {
    NodeId node;
    bool seen_whole, soon_whole;  ///< this cell's vLOD, or the next ones', has it or an ancestor
  };

  void visit(Visit at) {
    const bool soon = soon_ != nullptr && soon_->leads_to_some(at.node);
    if (!at.seen_whole && !at.soon_whole && !s_.may_be_seen(at.node) && !soon) return;
    at.seen_whole = at.seen_whole || (s_.vlod != nullptr && s_.vlod->has(at.node));
    at.soon_whole = at.soon_whole || (soon && soon_->has(at.node));
    const NodeRecord& n = s_.node(at.node);
    if (s_.foresee(at.node)) ++s_.out.nodes_foreseen;
    if (n.child_count == 0 || ends_here(at)) return;
    const double distance_m = priority_distance(n, s_.sight, s_.options);
    if (frustum_visibility(n, s_.sight, s_.options, distance_m) > 0) stack_.push_back(at);
  }

  bool ends_here(const Visit& at) const {
    if (s_.options.policy == Policy::vlod && s_.vlod != nullptr && !s_.view.leaving) {
      const bool finer_soon = soon_ != nullptr && soon_->leads_below(at.node);
      return !finer_soon && (at.seen_whole || !s_.vlod->leads_to_some(at.node));
    }
    const NodeRecord& n = s_.node(at.node);
    const float distance_m = std::min(n.box.distance(s_.sight.eye), n.box.distance(later_));
    const double error = error_m(n, s_.options.error_kind);
    return screen_error_px(error, double(distance_m), s_.sight.pixels_per_radian) <= s_.bound_px();
  }

  Selecting& s_;
  const SoonMarks* soon_;
  glm::vec3 later_;
  std::vector<Visit> stack_;
};

}  // namespace

void look_ahead(Selecting& selecting) { LookingAhead(selecting).run(); }

}  // namespace promenade
