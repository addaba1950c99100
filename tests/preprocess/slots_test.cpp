#include "preprocess/visibility/slots.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "layout/cell_faces.h"

namespace promenade {
namespace {

using testing::ElementsAre;

/// Rooms in a row along x, 4 m wide and 3 m high, ending at these places; what is open of each wall between two.
struct Row {
  Rooms rooms;
  explicit Row(const std::vector<float>& ends) {
    CellTables& space = rooms.space;
    space.box = {{0, 0, 0}, {ends.back(), 4, 3}};
    float from = 0;
    for (size_t i = 0; i < ends.size(); ++i) {
      const auto at = static_cast<uint32_t>(space.tree.size());
      if (i + 1 < ends.size()) space.tree.push_back({0, ends[i], at + 1, at + 2});
      space.tree.push_back({CellTreeNode::kLeaf, 0, static_cast<uint32_t>(i), 0});
      space.cells.push_back({{{from, 0, 0}, {ends[i], 4, 3}}, 0, 0});
      from = ends[i];
    }
    EXPECT_TRUE(find_faces(space));
  }
  /// openings[face][way]
  std::vector<uint8_t> slots(const std::vector<std::array<std::vector<Box>, 2>>& openings, float least_m = 0.2F) {
    for (uint32_t room = 0; room < rooms.space.cells.size(); ++room)
      for (uint32_t way = 0; way < 6; ++way) {
        rooms.first_exit.push_back(static_cast<uint32_t>(rooms.exits.size()));
        for (uint32_t face = 0; face < rooms.space.faces.size(); ++face) {
          const CellFace& f = rooms.space.faces[face];
          const bool up = index_of(f.below) == room;
          if ((!up && index_of(f.above) != room) || way != (up ? 1U : 0U) || openings[face][way].empty()) continue;
          rooms.exits.push_back({index_of(f.other(CellId{room})), face, static_cast<uint32_t>(rooms.openings.size()),
                                 static_cast<uint32_t>(openings[face][way].size())});
          for (const Box& box : openings[face][way]) rooms.openings.push_back(box);
        }
      }
    rooms.first_exit.push_back(static_cast<uint32_t>(rooms.exits.size()));
    return find_slots(rooms, least_m);
  }
};

const std::vector<Box> no_way;
std::vector<Box> door_at(float x) { return {{{x, 1, 0}, {x, 2, 2}}}; }
std::vector<Box> all_open_at(float x) { return {{{x, 0, 0}, {x, 4, 3}}}; }
std::vector<Box> crack_at(float x) { return {{{x, 0, 0}, {x, 0.05F, 3}}}; }

TEST(Slots, between_two_closed_walls_is_one) {
  EXPECT_THAT(Row({4, 4.1F, 8}).slots({{no_way, no_way}, {no_way, no_way}}), ElementsAre(0, 1, 0));
}

TEST(Slots, a_doorway_is_none) {
  EXPECT_THAT(Row({4, 4.1F, 8}).slots({{door_at(4), door_at(4)}, {door_at(4.1F), door_at(4.1F)}}),
              ElementsAre(0, 0, 0));
  EXPECT_THAT(Row({4, 4.1F, 8}).slots({{door_at(4), door_at(4)}, {no_way, no_way}}), ElementsAre(0, 0, 0)) << "a niche";
}

TEST(Slots, open_one_way_is_the_back_of_a_wall) {
  EXPECT_THAT(Row({4, 4.1F, 8}).slots({{all_open_at(4), no_way}, {no_way, all_open_at(4.1F)}}), ElementsAre(0, 1, 0));
}

TEST(Slots, a_crack_leads_nowhere) {
  EXPECT_THAT(Row({4, 4.1F, 8}).slots({{crack_at(4), crack_at(4)}, {no_way, no_way}}), ElementsAre(0, 1, 0));
}

TEST(Slots, thin_parts_of_a_room_are_as_wide_as_the_room) {
  const auto open = [](float x) { return std::array<std::vector<Box>, 2>{all_open_at(x), all_open_at(x)}; };
  const std::array<std::vector<Box>, 2> closed;
  EXPECT_THAT(Row({0.1F, 0.2F, 0.3F, 0.4F}).slots({open(0.1F), open(0.2F), closed}), ElementsAre(0, 0, 0, 1))
      << "0.3 m together, and a slot of 0.1";
  EXPECT_THAT(Row({0.05F, 0.1F, 0.3F, 0.4F}).slots({open(0.05F), closed, closed}), ElementsAre(1, 1, 0, 1))
      << "0.1 m together; 0.2 are enough";
}

TEST(Slots, none_without_a_least_width) {
  EXPECT_THAT(Row({4, 4.1F, 8}).slots({{no_way, no_way}, {no_way, no_way}}, 0), ElementsAre(0, 0, 0));
}

}  // namespace
}  // namespace promenade
