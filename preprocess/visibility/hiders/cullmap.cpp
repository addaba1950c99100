// Two maps: of all that is asked about, and of a quarter of it around the cell, where pixels are as much smaller.

#include "preprocess/visibility/hiders/cullmap.h"

#include <algorithm>
#include <array>

#include "preprocess/visibility/cull_map.h"
#include "preprocess/visibility/hiders/upright_cell.h"

namespace promenade {
namespace {

constexpr float kNearPart = 0.25F;

class CellWork : UprightCell {
 public:
  using UprightCell::UprightCell;

  void run(const std::vector<UsableOccluder>& occluders) {
    gather_targets();
    gather_occluders(occluders);
    if (usable_.empty() || targets_.empty()) return;
    place_maps();
    draw();
    for (size_t i = 0; i < targets_.size(); ++i)
      if (state_[targets_[i].node] == State::open && !hides(boxes_[targets_[i].node]) && !hides(targets_[i].box))
        state_[targets_[i].node] = State::seen;
    hide_open();
  }

 private:
  bool hides(const Box& box) const {
    return std::any_of(maps_.begin(), maps_.end(), [&](const CullMap& map) { return map.hides(box); });
  }

  void place_maps() {
    Box all;
    for (const Box& box : boxes_) all.add(box);
    all = all.grown(1);  // a hair more than what is asked
    const glm::vec2 middle(cell_.center()), half = (glm::vec2(all.max) - glm::vec2(all.min)) * (kNearPart / 2);
    maps_[0].reset(cell_, glm::vec2(all.min), glm::vec2(all.max));
    maps_[1].reset(cell_, middle - half, middle + half);
  }

  void draw() {
    for (size_t i = 0; i < usable_.size(); ++i) {
      const UsableOccluder& usable = usable_[i];
      const ErodedLoops loops = eroded_loops(set_, usable, 0);
      // What is hidden itself hides next to nothing more.
      if (loops.loops.empty() || hides(usable.occluder->box) || is_slipped_under(i)) continue;
      // What is drawn may lie so much nearer than the loop: no eye is within.
      const Box clear = cell_.grown(usable.error_m);
      for (const OccluderLoop& loop : loops.loops) {
        if (loop.is_hole) continue;
        const bool whole =
            std::none_of(loops.loops.begin(), loops.loops.end(), [](const auto& l) { return l.is_hole; });
        const std::span<const glm::vec2> points = set_.points_of(loop);
        const float top_m = loop.top_m - usable.error_m;
        for (CullMap& map : maps_)
          if (whole)
            map.add_solid(points, top_m, clear);
          else
            for (size_t p = 0; p < points.size(); ++p)
              map.add_wall(points[p], points[(p + 1) % points.size()], top_m, clear);
      }
    }
  }

  std::array<CullMap, 2> maps_;
};

}  // namespace

std::unique_ptr<Hider> make_cullmap_hider(const Model& model, const NodeParts& parts, const OccluderSet& occluders) {
  return std::make_unique<UprightHider<CellWork>>("cullmap", model, parts, occluders);
}

}  // namespace promenade
