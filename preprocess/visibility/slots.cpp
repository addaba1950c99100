#include "preprocess/visibility/slots.h"

#include <algorithm>

namespace promenade {
namespace {

constexpr uint32_t kMostSteps = 256;  // bounds the stack: so many thin rooms in a row are no slot

class SlotFinder {
 public:
  SlotFinder(const Rooms& rooms, float least_m)
      : rooms_(rooms), least_m_(least_m), open_(rooms.space.faces.size()), reach_m_(6 * rooms.space.cells.size(), -1) {
    const size_t count = rooms.space.cells.size();
    for (uint32_t room = 0; room < count; ++room)
      for (uint32_t axis = 0; axis < 3; ++axis)
        for (const bool up : {false, true})
          for (const RoomExit& exit : rooms.exits_of(room, axis, up))
            if (is_open(exit, axis)) ++open_[exit.face];
  }

  bool is_slot(uint32_t room) {
    for (uint32_t axis = 0; axis < 3; ++axis) {
      const float own = length(room, axis);
      if (own < least_m_ && own + reach(room, axis, false, 0) + reach(room, axis, true, 0) < least_m_) return true;
    }
    return false;
  }

 private:
  float length(uint32_t room, uint32_t axis) const {
    return rooms_.space.cells[room].box.size()[static_cast<int>(axis)];
  }

  /// Whether somebody passes that way.
  bool is_open(const RoomExit& exit, uint32_t axis) const {
    const int u = static_cast<int>(axis + 1) % 3, v = static_cast<int>(axis + 2) % 3;
    const glm::vec3 face = rectangle_of(rooms_.space, rooms_.space.faces[exit.face]).size();
    float open_m2 = 0;
    for (const Box& opening : rooms_.openings_of(exit)) {
      const glm::vec3 size = opening.size();
      if (size[u] >= least_m_ && size[v] >= least_m_) return true;
      open_m2 += size[u] * size[v];
    }
    return open_m2 >= face[u] * face[v] / 2;
  }

  /// How far it goes on beyond a room's faces, as far as that matters. Rooms that way lie ever farther along the axis.
  float reach(uint32_t room, uint32_t axis, bool up, uint32_t steps) {
    if (steps == kMostSteps) return least_m_;
    float& known = reach_m_[6 * size_t(room) + 2 * axis + (up ? 1 : 0)];
    if (known >= 0) return known;
    float most = 0;
    for (const RoomExit& exit : rooms_.exits_of(room, axis, up)) {
      if (open_[exit.face] < 2 || most >= least_m_) continue;  // both ways
      const float next = length(exit.to, axis);
      most = std::max(most, next >= least_m_ ? next : next + reach(exit.to, axis, up, steps + 1));
    }
    return known = most;
  }

  const Rooms& rooms_;
  float least_m_;
  std::vector<uint8_t> open_;   ///< by face: the ways in which somebody passes
  std::vector<float> reach_m_;  ///< by room, axis and way; negative: not known yet
};

}  // namespace

std::vector<uint8_t> find_slots(const Rooms& rooms, float least_m) {
  SlotFinder finder(rooms, least_m);
  std::vector<uint8_t> slots(rooms.space.cells.size());
  for (uint32_t room = 0; room < slots.size(); ++room) slots[room] = finder.is_slot(room) ? 1 : 0;
  return slots;
}

}  // namespace promenade
