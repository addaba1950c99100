// Lines of sight walk from room to room, away from the cell, through what is open between them. In one sector of
// directions every step leads up or down the same way along each axis, so no line comes to a room twice, and the rooms
// can be done one by one in an order in which each stands before those behind it: all beams into a room are known when
// its turn comes, and where they are many, those most alike become one. [funkhouser1993] section 4.1 follows each
// sequence of portals apart (cell-to-cell), which open plans make exponentially many.
//
// What is drawn for a wall may stand off it by its error: openings in it are so much larger.

#include "preprocess/visibility/hiders/portals.h"

#include <algorithm>
#include <limits>

#include "preprocess/visibility/line_beam.h"

namespace promenade {
namespace {

constexpr uint32_t kNotInFront = 0xffffffffU;

/// One cell's question in work.
class CellWork {
 public:
  CellWork(const Model& model, const Rooms& rooms, const RoomParts& parts, const PortalsOptions& options,
           const HiderQuestion& question, std::span<uint8_t> hidden)
      : model_(model), rooms_(rooms), parts_(parts), options_(options), question_(question), hidden_(hidden) {}

  void run() {
    if (!rooms_.space.box.contains(question_.cell)) return;
    gather_front();
    find_start();
    arrived_.resize(rooms_.space.cells.size());
    growth_m_.assign(rooms_.space.faces.size(), -1);
    for (uint32_t number = 0; number < LineSector::kCount && open_ > 0; ++number) {
      walk(number, LineSector(number, glm::dvec3(question_.cell.center())));
      if (steps_ > options_.most_steps) return;
    }
    for (size_t i = 0; i < state_.size(); ++i)
      if (state_[i] == State::open) hidden_[i] = 1;
  }

 private:
  enum class State : uint8_t { open, seen };
  using Beams = std::vector<LineBeam>;

  void gather_front() {
    place_in_front_.assign(model_.tables.nodes.size(), kNotInFront);
    state_.assign(question_.front.size(), State::open);
    for (uint32_t i = 0; i < question_.front.size(); ++i) {
      place_in_front_[index_of(question_.front[i])] = i;
      // Nothing to prove; what is set already stays.
      if (hidden_[i] != 0 || parts_.anywhere[index_of(question_.front[i])] != 0) state_[i] = State::seen;
      open_ += state_[i] == State::open ? 1U : 0U;
    }
  }

  /// The rooms that the cell reaches into, and what of it lies there. A cell ends at walls, and its face is as exact as
  /// they are: what reaches into a room by less than the slack is counted as the other's.
  void find_start() {
    const Box& cell = question_.cell;
    const float slack = Rooms::kSlackM;
    const auto depth = [&](const Box& room, int i) {
      return std::min(cell.max[i], room.max[i]) - std::max(cell.min[i], room.min[i]);
    };
    for (const bool all : {false, true}) {
      for_each_room(rooms_, cell, [&](uint32_t room) {
        const Box& box = rooms_.space.cells[room].box;
        bool reaches = true;
        for (int i = 0; i < 3; ++i) reaches &= all || depth(box, i) > std::min(slack, cell.size()[i] / 2);
        const Box wide = box.grown(slack);
        if (reaches) start_.push_back({room, {glm::max(cell.min, wide.min), glm::min(cell.max, wide.max)}});
      });
      if (!start_.empty()) return;
    }
  }

  void see(uint32_t place) {
    if (state_[place] == State::seen) return;
    state_[place] = State::seen;
    --open_;
  }

  bool shows_front(const RoomPart& part, uint32_t octant) const {
    return part.facing.shows_front_to(octant) && part.facing.shows_front_to(question_.cell, part.box);
  }

  void walk(uint32_t number, const LineSector& sector) {
    const uint32_t octant = number / 3;
    for (const auto& [room, box] : start_) {
      arrived_[room].emplace_back(sector, sector.placed({box.min, box.max}));
      for (const RoomPart& part : parts_.of(room))
        if (const uint32_t place = place_in_front_[index_of(part.node)]; place != kNotInFront)
          if (shows_front(part, octant)) see(place);
    }
    for (const uint32_t room : rooms_.order[octant]) {
      if (arrived_[room].empty()) continue;
      if (steps_ > options_.most_steps) return;
      Beams beams;
      beams.swap(arrived_[room]);
      unite(beams, options_.most_beams);
      look_at_parts(room, octant, sector, beams);
      for (uint32_t axis = 0; axis < 3; ++axis)
        for (const RoomExit& exit : rooms_.exits_of(room, axis, (octant >> axis & 1U) == 0)) leave(exit, sector, beams);
    }
  }

  void look_at_parts(uint32_t room, uint32_t octant, const LineSector& sector, const Beams& beams) {
    for (const RoomPart& part : parts_.of(room)) {
      const uint32_t place = place_in_front_[index_of(part.node)];
      if (place == kNotInFront || state_[place] == State::seen || !shows_front(part, octant)) continue;
      const DBox box = sector.placed({part.box.min, part.box.max});
      steps_ += beams.size();
      if (std::any_of(beams.begin(), beams.end(), [&](const LineBeam& beam) { return beam.touches(box); })) see(place);
    }
  }

  void leave(const RoomExit& exit, const LineSector& sector, const Beams& beams) {
    const double growth = double(growth_of(exit.face));
    Beams& into = arrived_[exit.to];
    for (const Box& opening : rooms_.openings_of(exit)) {
      const DBox box = sector.placed({glm::dvec3(opening.min) - growth, glm::dvec3(opening.max) + growth});
      steps_ += beams.size();
      for (const LineBeam& beam : beams) {
        LineBeam through = beam;
        through.keep_touching(box);
        if (!through.empty()) arrive(through, into);
      }
    }
  }

  void arrive(LineBeam beam, Beams& into) {
    steps_ += into.size();
    for (const LineBeam& other : into)
      if (other.contains(beam)) return;
    into.push_back(beam);
    if (into.size() > 2 * options_.most_beams) unite(into, options_.most_beams);
  }

  void unite(Beams& beams, size_t most) {
    while (beams.size() > most) {
      steps_ += beams.size() * beams.size() / 2;
      size_t first = 0, second = 1;
      double least = std::numeric_limits<double>::infinity();
      LineBeam best = beams[0];
      for (size_t i = 0; i < beams.size(); ++i)
        for (size_t k = i + 1; k < beams.size(); ++k) {
          LineBeam both = beams[i];
          both.add(beams[k]);
          const double more = both.volume() - beams[i].volume() - beams[k].volume();
          if (more < least) least = more, first = i, second = k, best = both;
        }
      beams[first] = best;
      beams.erase(beams.begin() + static_cast<std::ptrdiff_t>(second));
    }
  }

  /// The greatest error of what is drawn for the walls in a face.
  float growth_of(uint32_t face) {
    float& growth = growth_m_[face];
    if (growth >= 0) return growth;
    growth = 0;
    for (const NodeId wall : rooms_.walls_of(face))
      for (NodeId id = wall; id != kNoNode; id = model_.tables.nodes[index_of(id)].parent)
        if (place_in_front_[index_of(id)] != kNotInFront) {
          if (id != wall) growth = std::max(growth, model_.tables.nodes[index_of(id)].error_m);
          break;
        }
    return growth;
  }

  const Model& model_;
  const Rooms& rooms_;
  const RoomParts& parts_;
  const PortalsOptions& options_;
  const HiderQuestion& question_;
  std::span<uint8_t> hidden_;
  std::vector<uint32_t> place_in_front_;  ///< by node
  std::vector<State> state_;              ///< by place in the front
  size_t open_ = 0;
  uint64_t steps_ = 0;
  std::vector<std::pair<uint32_t, Box>> start_;
  std::vector<Beams> arrived_;   ///< by room, of the sector in work
  std::vector<float> growth_m_;  ///< by face; negative: not known yet
};

class PortalsHider : public Hider {
 public:
  PortalsHider(const Model& model, const Rooms& rooms, const RoomParts& parts, const PortalsOptions& options)
      : model_(model), rooms_(rooms), parts_(parts), options_(options) {}

  std::string_view name() const override { return "portals"; }

  Status hide(const HiderQuestion& question, std::span<uint8_t> hidden) const override {
    CellWork(model_, rooms_, parts_, options_, question, hidden).run();
    return Done{};
  }

 private:
  const Model& model_;
  const Rooms& rooms_;
  const RoomParts& parts_;
  PortalsOptions options_;
};

}  // namespace

std::unique_ptr<Hider> make_portals_hider(const Model& model, const Rooms& rooms, const RoomParts& parts,
                                          const PortalsOptions& options) {
  return std::make_unique<PortalsHider>(model, rooms, parts, options);
}

}  // namespace promenade
