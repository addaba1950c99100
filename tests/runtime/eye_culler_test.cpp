#include "runtime/eye_culler.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geometry/random.h"
#include "layout/cell_faces.h"

namespace promenade {
namespace {

using testing::ElementsAre, testing::IsEmpty;

/// Space cut by planes, with walls in all of them but for holes.
struct Plan {
  Model model;
  Openings openings;

  explicit Plan(const Box& box) {
    openings.regions.box = box;
    openings.regions.bound = {1, pixel_scale(1280, 720, 60)};
    openings.regions.tree.push_back({CellTreeNode::kLeaf, 0, index_of(kNoCell), 0});
  }
  uint32_t split(uint32_t leaf, uint32_t axis, float at_m) {
    const auto below = static_cast<uint32_t>(openings.regions.tree.size());
    openings.regions.tree.push_back({CellTreeNode::kLeaf, 0, index_of(kNoCell), 0});
    openings.regions.tree.push_back({CellTreeNode::kLeaf, 0, index_of(kNoCell), 0});
    openings.regions.tree[leaf] = {axis, at_m, below, below + 1};
    return below;
  }
  /// holes(face, up): what is open of it.
  template <class Holes>
  void wall_up(const Holes& holes) {
    openings.regions = *regions_of(openings.regions);
    openings.first.assign(1, 0);
    openings.boxes.clear();
    for (uint32_t face = 0; face < openings.regions.faces.size(); ++face)
      for (const bool up : {false, true}) {
        for (const Box& hole : holes(face, up)) openings.boxes.push_back(hole.grown(kOpeningSlackM));
        openings.first.push_back(static_cast<uint32_t>(openings.boxes.size()));
      }
  }
  NodeId node(const Box& box) {
    NodeRecord record;
    record.box = box;
    model.tables.nodes.push_back(record);
    return NodeId{static_cast<uint32_t>(model.tables.nodes.size() - 1)};
  }
};

std::vector<NodeId> seen_from(const Plan& plan, const glm::dvec3& eye) {
  std::vector<NodeId> all;
  for (uint32_t i = 0; i < plan.model.tables.nodes.size(); ++i) all.push_back(NodeId{i});
  EyeCuller culler(plan.model, plan.openings);
  const std::span<const NodeId> seen = culler.seen(eye, all);
  const std::vector<NodeId> once(seen.begin(), seen.end());
  const std::span<const NodeId> again = culler.seen(eye, all);
  EXPECT_TRUE(std::equal(again.begin(), again.end(), once.begin(), once.end())) << "nothing is left of the first time";
  return once;
}

Box thing_at(float x, float y) { return {{x - 0.2F, y - 0.2F, 0.8F}, {x + 0.2F, y + 0.2F, 1.2F}}; }

/// Two rooms side by side along x, 10 m each, and a door of 1 m in the middle of the wall between.
struct TwoRooms : Plan {
  TwoRooms() : Plan({{0, 0, 0}, {20, 10, 3}}) {
    split(0, 0, 10);
    wall_up([](uint32_t, bool) { return std::vector<Box>{{{10, 4.5F, 0}, {10, 5.5F, 2}}}; });
    here = node(thing_at(8, 9)), ahead = node(thing_at(19, 5)), aside = node(thing_at(19, 9));
  }
  NodeId here, ahead, aside;
};

TEST(EyeCuller, two_rooms_one_door) {
  const TwoRooms rooms;
  EXPECT_THAT(seen_from(rooms, {2, 5, 1}), ElementsAre(rooms.here, rooms.ahead));
  EXPECT_THAT(seen_from(rooms, {2, 1.5, 1}), ElementsAre(rooms.here, rooms.aside))
      << "aslant through the door the far corner is seen, what is ahead of it is not";
  EXPECT_THAT(seen_from(rooms, {15, 1, 1}), ElementsAre(rooms.ahead, rooms.aside));
}

TEST(EyeCuller, who_stands_in_the_door_sees_both_rooms) {
  const TwoRooms rooms;
  for (const double x : {9.9985, 10.0, 10.0015})
    EXPECT_THAT(seen_from(rooms, {x, 5, 1}), ElementsAre(rooms.here, rooms.ahead, rooms.aside));
}

TEST(EyeCuller, eyes_outside_see_all) {
  const TwoRooms rooms;
  EXPECT_EQ(seen_from(rooms, {-1, 5, 1}).size(), 3U);
  EXPECT_EQ(seen_from(rooms, {0, 5, 1}).size(), 3U) << "on the rim";
}

TEST(EyeCuller, a_surface_may_close_one_way_only) {
  Plan plan({{0, 0, 0}, {20, 10, 3}});
  plan.split(0, 0, 10);
  plan.wall_up([&](uint32_t face, bool up) {
    return up ? std::vector<Box>()
              : std::vector<Box>{rectangle_of(plan.openings.regions, plan.openings.regions.faces[face])};
  });
  const NodeId left = plan.node(thing_at(5, 5)), right = plan.node(thing_at(15, 5));
  EXPECT_THAT(seen_from(plan, {2, 5, 1}), ElementsAre(left));
  EXPECT_THAT(seen_from(plan, {18, 5, 1}), ElementsAre(left, right));
}

TEST(EyeCuller, a_row_of_doors_shows_only_what_is_in_line) {
  Plan plan({{0, 0, 0}, {40, 10, 3}});
  plan.split(plan.split(plan.split(0, 0, 10) + 1, 0, 20) + 1, 0, 30);
  plan.wall_up([&](uint32_t face, bool) {
    const float x = rectangle_of(plan.openings.regions, plan.openings.regions.faces[face]).min.x;
    return std::vector<Box>{{{x, 4.5F, 0}, {x, 5.5F, 2}}};
  });
  const NodeId in_line = plan.node(thing_at(38, 5));
  plan.node(thing_at(38, 9));
  EXPECT_THAT(seen_from(plan, {2, 5, 1}), ElementsAre(in_line));
  EXPECT_THAT(seen_from(plan, {2, 9.5, 1}), IsEmpty());
}

TEST(EyeCuller, what_reaches_beyond_the_regions_is_always_seen) {
  TwoRooms rooms;
  const NodeId out = rooms.node({{19, 8, 0}, {25, 9, 1}});
  EXPECT_THAT(seen_from(rooms, {2, 9, 1}), ElementsAre(rooms.here, out));
}

TEST(EyeCuller, holes_grow_by_what_far_walls_may_be_off) {
  // The thing is 5 cm beside the line through the hole's rim, 300 m away: walls there are drawn half a metre off.
  const auto seen_at = [](float scale) {
    Plan plan({{-1, -100 * scale, 0}, {400 * scale, 100 * scale, 3}});
    plan.split(0, 0, 300 * scale);
    plan.wall_up([&](uint32_t, bool) { return std::vector<Box>{{{300 * scale, 0, 0}, {300 * scale, 1, 2}}}; });
    plan.node({{300 * scale + 0.1F, 1.05F, 0.9F}, {300 * scale + 0.2F, 1.1F, 1.1F}});
    return seen_from(plan, {0, 0.5, 1}).size();
  };
  EXPECT_EQ(seen_at(1), 1U);
  EXPECT_EQ(seen_at(0.03F), 0U);
}

/// Whether the straight way from one point to another passes through holes only.
class Way {
 public:
  Way(const Plan& plan, const std::vector<std::vector<Box>>& holes) : space_(plan.openings.regions), holes_(holes) {}

  bool is_free(const glm::dvec3& from, const glm::dvec3& to) const {
    std::optional<CellId> at = cell_at(space_, from);
    const glm::dvec3 way = to - from;
    for (double done = 0; at;) {
      const Box& box = space_.cells[index_of(*at)].box;
      int across = -1;
      double end = 1;
      for (int axis = 0; axis < 3; ++axis) {
        if (way[axis] == 0) continue;
        const double t = (double(way[axis] > 0 ? box.max[axis] : box.min[axis]) - from[axis]) / way[axis];
        if (t < end) end = t, across = axis;
      }
      if (across < 0) return true;
      if (end < done) return false;  // rounding at an edge: no claim
      done = end;
      at = step(*at, across, way[across] > 0, from + way * end);
    }
    return false;
  }

 private:
  std::optional<CellId> step(CellId at, int across, bool up, const glm::dvec3& point) const {
    for (const uint32_t number : space_.faces_of(at)) {
      const CellFace& face = space_.faces[number];
      if (static_cast<int>(face.axis) != across || (face.below == at) != up) continue;
      for (const Box& hole : holes_[2 * number + (up ? 1 : 0)]) {
        bool within = true;
        for (int axis = 0; axis < 3; ++axis)
          within &= axis == across || (point[axis] >= double(hole.min[axis]) && point[axis] <= double(hole.max[axis]));
        if (within) return face.other(at);
      }
    }
    return std::nullopt;
  }

  const CellTables& space_;
  const std::vector<std::vector<Box>>& holes_;
};

std::vector<std::vector<Box>> random_holes(const CellTables& space, Random& random) {
  std::vector<std::vector<Box>> holes(2 * space.faces.size());
  for (size_t i = 0; i < holes.size(); ++i) {
    const Box whole = rectangle_of(space, space.faces[i / 2]);
    for (uint32_t k = random.below(3); k > 0; --k) {
      Box hole = whole;
      for (int axis = 0; axis < 3; ++axis) {
        const float a = random.range(0.0F, 1.0F), b = random.range(0.0F, 1.0F), size = whole.size()[axis];
        hole.min[axis] = whole.min[axis] + size * std::min(a, b),
        hole.max[axis] = whole.min[axis] + size * std::max(a, b);
      }
      holes[i].push_back(hole);
    }
  }
  return holes;
}

TEST(EyeCuller, never_leaves_out_what_a_ray_reaches) {
  uint64_t reached = 0, left_out = 0;
  for (uint64_t seed = 0; seed < 60; ++seed) {
    Random random(seed);
    Plan plan({{0, 0, 0}, {16, 16, 16}});
    for (uint32_t i = 0; i < 24; ++i) {
      std::vector<uint32_t> leaves;
      for (uint32_t n = 0; n < plan.openings.regions.tree.size(); ++n)
        if (plan.openings.regions.tree[n].axis == CellTreeNode::kLeaf) leaves.push_back(n);
      const CellTables now = *regions_of(plan.openings.regions);
      const uint32_t leaf = leaves[random.below(static_cast<uint32_t>(leaves.size()))];
      const Box& box = now.cells[now.tree[leaf].below].box;
      const auto axis = static_cast<uint32_t>(box.longest_axis());
      const int a = static_cast<int>(axis);
      plan.split(leaf, axis, box.min[a] + box.size()[a] * random.range(0.3F, 0.7F));
    }
    std::vector<std::vector<Box>> holes;
    plan.wall_up([&](uint32_t face, bool up) {
      if (holes.empty()) holes = random_holes(plan.openings.regions, random);
      return holes[2 * size_t(face) + (up ? 1 : 0)];
    });
    for (int i = 0; i < 40; ++i) {
      const glm::vec3 low(random.range(0.1F, 14.0F), random.range(0.1F, 14.0F), random.range(0.1F, 14.0F));
      plan.node(
          {low, low + glm::vec3(random.range(0.01F, 1.8F), random.range(0.01F, 1.8F), random.range(0.01F, 1.8F))});
    }
    const Way way(plan, holes);
    for (int e = 0; e < 6; ++e) {
      const glm::dvec3 eye(random.range(0.1, 15.9), random.range(0.1, 15.9), random.range(0.1, 15.9));
      const std::vector<NodeId> seen = seen_from(plan, eye);
      for (uint32_t n = 0; n < plan.model.tables.nodes.size(); ++n) {
        const bool kept = std::binary_search(seen.begin(), seen.end(), NodeId{n});
        left_out += kept ? 0 : 1;
        const Box& box = plan.model.tables.nodes[n].box;
        for (int r = 0; r < 60; ++r) {
          const glm::dvec3 to(random.range(box.min.x, box.max.x), random.range(box.min.y, box.max.y),
                              random.range(box.min.z, box.max.z));
          if (!way.is_free(eye, to)) continue;
          ++reached;
          ASSERT_TRUE(kept) << "seed " << seed << ", node " << n;
        }
      }
    }
  }
  EXPECT_GT(reached, 50000U);
  EXPECT_GT(left_out, 3000U);
}

}  // namespace
}  // namespace promenade
