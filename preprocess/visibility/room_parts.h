#pragma once
// What of each node lies in each room.

#include <span>
#include <vector>

#include "preprocess/visibility/rooms.h"

namespace promenade {

/// Which way some triangles face: from where they may show their fronts.
struct Facing {
  static constexpr uint8_t kNoAxis = 6;
  uint8_t octants = 0xff;  ///< bit o: to lines that go down along the axes whose bits o has, and up along the others
  uint8_t axis = kNoAxis;  ///< 2 axis (+ 1 where they face down along it), if they all face that way exactly

  /// normal: of a one-sided triangle; 0: it shows its front to all.
  static Facing of(const glm::vec3& normal);
  bool shows_front_to(uint32_t octant) const { return (octants >> octant & 1U) != 0; }
  /// False only if no eye in the cell is before the triangles, which lie in the box.
  bool shows_front_to(const Box& cell, const Box& box) const;
  auto operator<=>(const Facing&) const = default;
};

/// Some of a node's triangles, as far as they lie in a room and show their front there.
struct RoomPart {
  Box box;
  NodeId node;
  Facing facing;
};

constexpr float kMostErrorM = 0.25F;

/// By room, then node.
struct RoomParts {
  std::vector<RoomPart> parts;
  std::vector<size_t> first;      ///< by room, and the end
  std::vector<uint8_t> anywhere;  ///< by node: 1: its error is so large that it is in no room; never hidden

  std::span<const RoomPart> of(uint32_t room) const {
    return {parts.data() + first[room], first[room + 1] - first[room]};
  }
};

/// Reads every node's mesh, several at once; the same for any number of threads. A triangle is in each room that it
/// comes near: by the rooms' slack, and by the error of what is drawn, by which it may stand off the source's wall.
/// Nodes with an error above kMostErrorM are left out: they would be in all rooms, and only who is far away is shown
/// them. Errors: reading the model, "interrupted".
Result<RoomParts> find_room_parts(const ModelReader& reader, const Rooms& rooms, JobMonitor& monitor);

}  // namespace promenade
