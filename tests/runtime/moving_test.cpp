// What moves, selected and drawn where it is.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "runtime/cpu_renderer.h"
#include "runtime/importance.h"
#include "runtime/posed_model.h"
#include "runtime/session.h"
#include "tests/runtime/forest.h"
#include "tests/runtime/null_renderer.h"

namespace promenade {
namespace {

using forest::Forest;
using testing::Contains, testing::ElementsAre, testing::Not;

/// A wall 10 m ahead, and a square before it that goes from 6 m on the right (-y) to 6 m on the left in ten seconds.
struct Street : Forest {
  Street() {
    wall = root({{10, -20, -1}, {10.5F, 20, 1}}, 0, 2);
    car = root({{9, -7, -1}, {10, 7, 1}}, 0, 2);
    ModelObjects& objects = edit().objects;
    objects.animation.times = {0, 10};
    objects.animation.values = {-1, -6, 0, -1, 6, 0};
    objects.animation.tracks = {{AnimationTrack::Way::linear, 3, 0, 0, 2, 10}};
    AnimationJoint joint;
    joint.tracks[AnimationJoint::translation_slot] = 0;
    objects.animation.joints = {joint};
    objects.moving = {{0, car, glm::dmat4(1)}};
    objects.moving_nodes = {{0, {{10, -1, -1}, {10, 1, 1}}}};  // Forest draws squares at x = 10
  }
  /// The square's mesh is in its own space.
  Result<Mesh> decode_mesh(NodeId id, std::span<const std::byte> stored) const override {
    Result<Mesh> mesh = Forest::decode_mesh(id, stored);
    if (mesh && id == car)
      for (glm::vec3& p : mesh->positions) p.y /= 7;
    return mesh;
  }
  NodeId wall = kNoNode, car = kNoNode;
};

Camera looking_east() { return {{}, 64, 64, 90, 0.1}; }

TEST(PosedModel, has_boxes_where_things_are) {
  const Street street;
  PosedModel posed(street.model());
  posed.set_time(2.5);
  const Box& now = posed.now().tables.nodes[index_of(street.car)].box;
  EXPECT_NEAR(now.min.y, -4, 1e-5);
  EXPECT_NEAR(now.max.y, -2, 1e-5);
  EXPECT_NEAR(now.min.x, 9, 1e-5);
  EXPECT_EQ(posed.now().tables.nodes[index_of(street.wall)].box, street.model().tables.nodes[0].box);
  EXPECT_EQ(posed.matrix_of(street.wall), glm::mat4(1));
}

TEST(PosedModel, of_a_model_in_which_nothing_moves_is_the_model) {
  Forest still;
  still.root({{0, 0, 0}, {1, 1, 1}}, 0);
  const PosedModel posed(still.model());
  EXPECT_EQ(&posed.now(), &still.model());
}

SessionOptions with(Policy policy) {
  SessionOptions options;
  options.select.policy = policy;
  options.loader_thread = false;
  options.fade_frames = 0;
  options.loader.memory_bytes = uint64_t(64) << 20;
  return options;
}

/// Column of the middle of what the node covers; negative: it is not there.
double column_of(NodeId node, const std::vector<uint32_t>& nodes, uint32_t width) {
  double sum = 0, count = 0;
  for (size_t i = 0; i < nodes.size(); ++i)
    if (nodes[i] == index_of(node)) sum += double(i % width) + 0.5, ++count;
  return count > 0 ? sum / count : -1;
}

TEST(MovingObjects, are_drawn_where_they_are_at_the_frames_time_by_every_policy) {
  for (const Policy policy : all_policies()) {
    if (uses_far(policy)) continue;  // far_test.cpp: only in models with far pictures
    const Street street;
    const std::unique_ptr<Renderer> renderer = create_cpu_renderer();
    Result<Session> session = Session::open(street, *renderer, with(policy));
    ASSERT_TRUE(session) << session.error().message;
    for (const double time_s : {1.0, 4.0, 9.0, 12.0}) {
      session->set_time(time_s);
      const Result<FrameRow> row = session->settle(looking_east());
      ASSERT_TRUE(row);
      const double y = -6 + 1.2 * std::fmod(time_s, 10);
      const double due = 32 - 32 * y / 9;  // 90 degrees across 64 pixels, 9 m away
      EXPECT_NEAR(column_of(street.car, *renderer->read_nodes(), 64), due, 0.6) << name_of(policy) << " at " << time_s;
    }
  }
}

TEST(MovingObjects, that_have_left_the_picture_are_not_drawn_though_what_they_sweep_is_in_it) {
  const Street street;
  NullRenderer renderer;
  Result<Session> session = Session::open(street, renderer, with(Policy::vlod_time_slices));
  ASSERT_TRUE(session);
  Camera left = looking_east();
  left.pose.yaw_deg = 40;
  left.vertical_fov_deg = 40;
  session->set_time(0.5);
  ASSERT_TRUE(session->settle(left));
  EXPECT_THAT(renderer.drawn, Not(Contains(street.car)));
  session->set_time(9.9);
  ASSERT_TRUE(session->settle(left));
  EXPECT_THAT(renderer.drawn, Contains(street.car));
}

/// Two leaves, of one and of two classes.
struct Room : Forest {
  Room() {
    top = root({{10, -4, -1}, {10.5F, 4, 1}}, 2);
    leaves = split(top, 2, 0);
    edit().objects.classes = {"", "chair", "wall"};
    edit().objects.class_shares = {{leaves[0], 2, 3}, {leaves[1], 1, 1}, {leaves[1], 2, 1}};
  }
  NodeId top = kNoNode;
  std::vector<NodeId> leaves;
};

TEST(ImportanceOf, is_the_mean_of_classes_by_their_area) {
  const Room room;
  EXPECT_THAT(importance_of(room.model(), {{"chair", 0.5}}), ElementsAre(0.9F, 1, 0.75F));
  EXPECT_THAT(importance_of(room.model(), {{"wall", 0}, {"chair", 7}}), ElementsAre(0.2F, 0, 0.5F));
}

TEST(ImportanceOf, is_nothing_where_nothing_is_weighted) {
  const Room room;
  EXPECT_TRUE(importance_of(room.model(), {}).empty());
  EXPECT_TRUE(importance_of(room.model(), {{"table", 0.5}}).empty());
}

/// A room in halves, one of chairs and one of walls.
struct TwoHalves : Forest {
  TwoHalves() {
    halves = split(root({{10, -4, -1}, {10.5F, 4, 1}}, 8), 2, 4);
    for (const NodeId half : halves) parts.push_back(split(half, 2, 0, 100'000));
    edit().objects.classes = {"chair", "wall"};
    for (uint32_t i = 0; i < 4; ++i) edit().objects.class_shares.push_back({parts[i / 2][i % 2], i / 2, 1});
  }
  std::vector<NodeId> halves;
  std::vector<std::vector<NodeId>> parts;
};

TEST(Importance, decides_what_is_refined_when_time_is_short) {
  const TwoHalves room;
  const std::vector<uint8_t> resident(room.model().tables.nodes.size(), 1);
  for (const size_t dear : {0U, 1U}) {
    SelectOptions options;
    options.policy = Policy::cost_benefit;
    options.time.target_ms = 30;
    DrawCosts costs;
    costs.ms[DrawLoad::triangles] = 1e-4;  // a half refined takes 20 ms: there is time for one of them
    SelectState state;
    state.costs.emplace(costs);
    const std::vector<float> importance = importance_of(room.model(), {{dear == 0 ? "wall" : "chair", 0.1}});
    SelectView view;
    view.camera = looking_east();
    view.importance = importance;
    Selection selection;
    select(room.model(), view, resident, options, state, selection);
    EXPECT_THAT(selection.front,
                testing::UnorderedElementsAre(room.parts[dear][0], room.parts[dear][1], room.halves[1 - dear]));
  }
}

}  // namespace
}  // namespace promenade
