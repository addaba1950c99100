#include "preprocess/visibility/find_openings.h"

#include "preprocess/visibility/rooms.h"

namespace promenade {

static_assert(kOpeningSlackM == Rooms::kSlackM);

Result<Openings> find_openings(const ModelReader& reader, const CellTables& cells, JobMonitor& monitor) {
  Result<CellTables> regions = regions_of(cells);
  if (!regions) return regions.error();
  Result<Rooms> rooms = find_rooms_in(reader, std::move(*regions), RoomOptions(), monitor);
  if (!rooms) return rooms.error();
  const size_t ways = 2 * rooms->space.faces.size();
  std::vector<std::span<const Box>> by_way(ways);
  for (uint32_t room = 0; room < rooms->space.cells.size(); ++room)
    for (uint32_t axis = 0; axis < 3; ++axis)
      for (const bool up : {false, true})
        for (const RoomExit& exit : rooms->exits_of(room, axis, up))
          by_way[2 * size_t(exit.face) + (up ? 1 : 0)] = rooms->openings_of(exit);
  Openings openings;
  openings.first.reserve(ways + 1), openings.boxes.reserve(rooms->openings.size());
  openings.first.push_back(0);
  for (const std::span<const Box> boxes : by_way) {
    openings.boxes.insert(openings.boxes.end(), boxes.begin(), boxes.end());
    openings.first.push_back(static_cast<uint32_t>(openings.boxes.size()));
  }
  openings.regions = std::move(rooms->space);
  return openings;
}

}  // namespace promenade
