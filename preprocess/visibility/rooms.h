#pragma once
// A model cut along its axial walls into rooms, and what is open between them.

#include <cstdint>
#include <span>
#include <vector>

#include "geometry/job_monitor.h"
#include "layout/cells.h"
#include "layout/model_io.h"

namespace promenade {

struct RoomOptions {
  /// A plane cuts a room when surfaces cover this part of the room's cross-section. Less: more rooms, more walls that
  /// hide, more time a cell.
  double least_cover = 0.2;
  double step_m = 0.02;  ///< what openings are rounded to, outwards (a 4096th of the wall's piece, if that is more)
  uint64_t most_triangles = uint64_t(1) << 23U;  ///< of walls, held at once: for more, leaves are read more often
};

/// What leads from one room to another, in one direction: everything that is not proven to be covered by opaque
/// surfaces that show their front to those who come that way.
struct RoomExit {
  uint32_t to = 0;    ///< room
  uint32_t face = 0;  ///< both directions' number
  uint32_t first_opening = 0, opening_count = 0;
};

/// Rooms are boxes that fill all space around the model: rooms proper, the insides of walls, air.
struct Rooms {
  /// Surfaces this near to a room's plane count as in it; openings are as thick, to both sides, and as much wider, so
  /// that nobody slips past behind a surface that is a little off.
  static constexpr float kSlackM = 0.002F;

  CellTables space;                            ///< cells are rooms; portals are not used
  std::vector<RoomExit> exits;                 ///< by room, then way
  std::vector<uint32_t> first_exit;            ///< by room * 6 + way, and the end; way: 2 axis, and 1 for upwards
  std::vector<Box> openings;                   ///< with their slack
  std::vector<NodeId> walls;                   ///< leaves of the tree whose triangles close a face or end at its rim
  std::vector<uint32_t> first_wall;            ///< by face, and the end
  std::array<std::vector<uint32_t>, 8> order;  ///< by octant of directions: rooms, each before those behind it
  double closed_m2 = 0, open_m2 = 0;           ///< of faces that some surface lies in, both directions

  std::span<const RoomExit> exits_of(uint32_t room, uint32_t axis, bool up) const {
    const size_t i = size_t(room) * 6 + 2 * axis + (up ? 1 : 0);
    return {exits.data() + first_exit[i], first_exit[i + 1] - first_exit[i]};
  }
  std::span<const Box> openings_of(const RoomExit& exit) const {
    return {openings.data() + exit.first_opening, exit.opening_count};
  }
  std::span<const NodeId> walls_of(uint32_t face) const {
    return {walls.data() + first_wall[face], first_wall[face + 1] - first_wall[face]};
  }
};

/// Calls visit(room) for every room that the box touches.
template <class Visit>
void for_each_room(const Rooms& rooms, const Box& box, const Visit& visit) {
  std::vector<uint32_t> open = {0};
  while (!open.empty()) {
    const CellTreeNode& node = rooms.space.tree[open.back()];
    open.pop_back();
    if (node.axis == CellTreeNode::kLeaf) {
      if (node.below != index_of(kNoCell)) visit(node.below);
      continue;
    }
    const int axis = static_cast<int>(node.axis);
    if (box.min[axis] <= node.split_m) open.push_back(node.below);
    if (box.max[axis] >= node.split_m) open.push_back(node.above);
  }
}

/// Reads every leaf three times or more, several at once; the same for any number of threads. Errors: reading the
/// model, "interrupted".
Result<Rooms> find_rooms(const ModelReader& reader, const RoomOptions& options, JobMonitor& monitor);

/// The same where space is divided already: every leaf of its tree is a room. order is left empty.
Result<Rooms> find_rooms_in(const ModelReader& reader, CellTables space, const RoomOptions& options,
                            JobMonitor& monitor);

}  // namespace promenade
