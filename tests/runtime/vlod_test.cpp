// View cells at run time: where the eye is, what is read, what is marked, what is drawn.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "runtime/cursor.h"
#include "runtime/flight.h"
#include "runtime/loader.h"
#include "runtime/policy.h"
#include "runtime/range_cells.h"
#include "runtime/soon_marks.h"
#include "runtime/texture_limit.h"
#include "runtime/vlod_marks.h"
#include "runtime/vlod_store.h"
#include "tests/layout/cell_fixtures.h"
#include "tests/runtime/forest.h"
#include "tests/runtime/null_renderer.h"
#include "tests/runtime/scenes.h"

namespace promenade {
namespace {

using forest::Forest;
using testing::ElementsAre, testing::IsEmpty, testing::UnorderedElementsAre;

// --- cursor -------------------------------------------------------------------------------------------------------

TEST(Cursor, steps_across_faces_leaves_and_returns) {
  const CellTables tables = three_cells();
  Cursor cursor(&tables);
  EXPECT_EQ(cursor.move_to({1, 1, 9}), Cursor::Move::outside);
  EXPECT_EQ(cursor.cell(), std::nullopt);
  EXPECT_THAT(cursor.neighbours(), IsEmpty());
  EXPECT_EQ(cursor.move_to({1, 0.5, 1}), Cursor::Move::jumped);
  EXPECT_EQ(cursor.cell(), CellId{0});
  EXPECT_EQ(cursor.move_to({1.9, 0.5, 1}), Cursor::Move::stayed);
  EXPECT_THAT(cursor.neighbours(), ElementsAre(CellId{1}, CellId{2})) << "the nearest first";
  EXPECT_EQ(cursor.move_to({2.1, 0.5, 1}), Cursor::Move::stepped);
  EXPECT_EQ(cursor.cell(), CellId{1});
  EXPECT_EQ(cursor.move_to({2.1, 1.5, 1}), Cursor::Move::stepped);
  EXPECT_EQ(cursor.cell(), CellId{2});
  EXPECT_EQ(cursor.move_to({-3, 0, 0}), Cursor::Move::left);
  EXPECT_EQ(cursor.move_to({-3, 0, 0}), Cursor::Move::outside);
  EXPECT_EQ(cursor.move_to({3, 1.5, 1}), Cursor::Move::jumped);
}

TEST(Cursor, without_cells_is_always_outside) {
  Cursor cursor(nullptr);
  EXPECT_EQ(cursor.move_to({1, 1, 1}), Cursor::Move::outside);
}

TEST(Cursor, follows_a_random_walk_as_the_tree_would) {
  const CellTables tables = three_cells();
  Cursor cursor(&tables);
  std::mt19937 random(9);
  std::uniform_real_distribution<double> step(-0.4, 0.4);
  glm::dvec3 eye(1, 1, 1);
  for (int i = 0; i < 5000; ++i) {
    eye = glm::clamp(eye + glm::dvec3(step(random), step(random), step(random)), glm::dvec3(-0.5), glm::dvec3(4.5));
    cursor.move_to(eye);
    ASSERT_EQ(cursor.cell(), cell_at(tables, eye));
  }
}

// --- cells that the eye may soon be in ----------------------------------------------------------------------------

std::vector<CellId> ids_of(const std::vector<RangeCell>& range) {
  std::vector<CellId> ids;
  ids.reserve(range.size());
  for (const RangeCell& cell : range) ids.push_back(cell.cell);
  return ids;
}

TEST(RangeCells, come_by_the_time_to_their_doors) {
  const CellTables tables = three_cells();
  RangeOptions options;
  options.horizon_s = 10;
  options.least_speed_m = 1;
  options.cull = RangeCull::any;
  const auto range = [&](const glm::dvec3& eye, const glm::dvec3& velocity) {
    return range_cells(tables, CellId{0}, eye, velocity, options);
  };
  const std::vector<RangeCell> standing = range({1, 0.25, 1}, {0, 0, 0});
  EXPECT_THAT(ids_of(standing), ElementsAre(CellId{1}, CellId{2}));
  EXPECT_NEAR(standing[0].seconds, 1, 1e-9) << "a metre to the door at a metre a second";
  EXPECT_NEAR(standing[1].seconds, std::min(std::hypot(1, 0.75), 1.75), 1e-9);
  EXPECT_NEAR(range({1, 0.25, 1}, {4, 0, 0})[0].seconds, 0.25, 1e-9);
  options.horizon_s = 1.1;
  EXPECT_THAT(ids_of(range({1, 0.25, 1}, {0, 0, 0})), ElementsAre(CellId{1}));
  options.horizon_s = 10;
  options.most_cells = 1;
  EXPECT_THAT(ids_of(range({1, 1.75, 1}, {0, 0, 0})), ElementsAre(CellId{2}));
}

TEST(RangeCells, directions_cull_what_lies_behind) {
  const CellTables tables = three_cells();
  RangeOptions options;
  options.horizon_s = 10;
  const auto range = [&](const glm::dvec3& velocity) {
    return ids_of(range_cells(tables, CellId{0}, {1, 0.25, 1}, velocity, options));
  };
  options.cull = RangeCull::plane;
  EXPECT_THAT(range({1, 0, 0}), ElementsAre(CellId{1}, CellId{2}));
  EXPECT_THAT(range({-1, 0, 0}), IsEmpty());
  EXPECT_THAT(range({0, 0, 0}), ElementsAre(CellId{1}, CellId{2})) << "standing: anywhere";
  options.cull = RangeCull::direction;
  EXPECT_THAT(range({1, 0, 0}), ElementsAre(CellId{1}));
  EXPECT_THAT(range({1, 1, 0}), ElementsAre(CellId{2})) << "met at (2, 1.25)";
}

TEST(RangeCells, walls_without_doors_are_not_walked_through) {
  CellTables tables = three_cells();
  tables.faces[0].portal_count = 0;
  RangeOptions options;
  options.horizon_s = 10;
  options.least_speed_m = 1;
  const std::vector<RangeCell> range = range_cells(tables, CellId{0}, {1, 0.25, 1}, {0, 0, 0}, options);
  ASSERT_THAT(ids_of(range), ElementsAre(CellId{2}, CellId{1})) << "by the other room";
  EXPECT_NEAR(range[1].seconds, std::hypot(1, 0.75), 1e-9) << "the doors meet in a corner";
}

TEST(SoonMarks, are_the_union_of_what_the_next_cells_see) {
  Forest model;
  model.grow(model.root({{10, -8, -1}, {10.5F, 8, 1}}, 2), 3, 2);  // ids: 0, then 1 2 3 with their children after
  SoonMarks soon(model.model());
  const auto set = [](std::vector<NodeId> nodes) { return std::make_shared<const Vlod>(Vlod{std::move(nodes), 0}); };
  const NodeId leaf = model.model().children_of(NodeId{1}).front();
  soon.change_to({{CellId{1}, set({leaf})}, {CellId{2}, set({NodeId{2}})}});
  EXPECT_TRUE(soon.has(leaf) && soon.has(NodeId{2}));
  EXPECT_TRUE(soon.leads_to_some(NodeId{0}) && soon.leads_to_some(NodeId{1}));
  EXPECT_FALSE(soon.has(NodeId{1}) || soon.leads_to_some(NodeId{3}));
  soon.change_to({{CellId{2}, set({NodeId{2}})}});
  EXPECT_FALSE(soon.leads_to_some(NodeId{1}) || soon.leads_to_some(leaf));
  EXPECT_TRUE(soon.has(NodeId{2}) && soon.leads_to_some(NodeId{0}));
}

/// Grows a tree of which a cell sees the node 2 and what is under it; returns a leaf of the rest.
NodeId grow_half_hidden(Forest& model) {
  model.grow(model.root({{10, -8, -1}, {10.5F, 8, 1}}, 2), 3, 2);
  return model.model().children_of(NodeId{3}).front();
}

/// Into that tree, under a policy.
struct HalfHiddenChoice {
  HalfHiddenChoice(const Forest& model, Policy policy) : marks(model.model()) {
    marks.change_to(std::vector<NodeId>{NodeId{2}});
    options.policy = policy;
    options.pixel_error = 0.1;
    view.camera = scenes::looking_along_x();
    view.vlod = &marks;
  }
  HalfHiddenChoice(const HalfHiddenChoice&) = delete;
  HalfHiddenChoice& operator=(const HalfHiddenChoice&) = delete;
  /// Whether the node is among what is to be loaded.
  bool asks_for(const Forest& model, NodeId node) {
    const std::vector<uint8_t> resident(model.model().tables.nodes.size(), 1);
    select(model.model(), view, resident, options, state, selection);
    return std::any_of(selection.updates.begin(), selection.updates.end(),
                       [node](const PriorityUpdate& u) { return u.node == node; });
  }

  VlodMarks marks;
  SelectOptions options;
  SelectView view;
  SelectState state;
  Selection selection;
};

TEST(LookAhead, prices_what_only_the_next_cells_see) {
  Forest model;
  const NodeId leaf = grow_half_hidden(model);
  SoonMarks soon(model.model());
  soon.change_to({{CellId{1}, std::make_shared<const Vlod>(Vlod{{leaf}, 0})}});
  for (const Policy policy : {Policy::vlod, Policy::vlod_time_slices}) {
    HalfHiddenChoice choice(model, policy);
    EXPECT_FALSE(choice.asks_for(model, leaf)) << "hidden from here";
    choice.view.soon = &soon;
    EXPECT_TRUE(choice.asks_for(model, leaf)) << name_of(policy);
    EXPECT_GT(choice.selection.nodes_foreseen, 0U);
    for (const NodeId id : choice.selection.front) {
      EXPECT_NE(id, leaf);
      EXPECT_NE(id, NodeId{3});
    }
  }
}

TEST(LookAhead, what_is_foreseen_goes_after_all_that_is_asked_for) {
  Forest model;
  // Foreseen: a wall close behind the eye. Asked for: one far in front of it.
  model.grow(model.root({{900, -8, -1}, {900.5F, 8, 1}}, 2), 3, 2);
  model.grow(model.root({{-1.5F, -8, -1}, {-1, 8, 1}}, 2), 3, 2);
  const std::vector<uint8_t> resident(model.model().tables.nodes.size(), 1);
  for (const Policy policy : {Policy::static_error, Policy::time_slices, Policy::cost_benefit}) {
    SelectOptions options;
    options.policy = policy;
    options.pixel_error = 1e-3;
    SelectView view;
    view.camera = scenes::looking_along_x();
    SelectState state;
    Selection selection;
    select(model.model(), view, resident, options, state, selection);
    ASSERT_GT(selection.nodes_foreseen, 0U) << name_of(policy);
    const size_t asked_for = selection.updates.size() - selection.nodes_foreseen;
    ASSERT_GT(asked_for, 2U) << name_of(policy);
    float least = 1e30F, most = 0;
    for (size_t i = 0; i < selection.updates.size(); ++i) {
      float& bound = i < asked_for ? least : most;
      bound = i < asked_for ? std::min(bound, selection.updates[i].priority)
                            : std::max(bound, selection.updates[i].priority);
    }
    EXPECT_GT(least, most) << name_of(policy);
  }
}

TEST(LookAhead, an_eye_about_to_leave_the_cells_foresees_what_the_tree_asks_for) {
  Forest model;
  const NodeId leaf = grow_half_hidden(model);
  for (const Policy policy : {Policy::vlod, Policy::vlod_time_slices}) {
    HalfHiddenChoice choice(model, policy);
    EXPECT_FALSE(choice.asks_for(model, leaf)) << "hidden from here";
    choice.view.leaving = true;
    EXPECT_TRUE(choice.asks_for(model, leaf)) << name_of(policy);
    EXPECT_THAT(choice.selection.front, testing::Not(testing::Contains(leaf))) << "not shown before it may be seen";
  }
}

// --- marks --------------------------------------------------------------------------------------------------------

/// Whether the marks say for every node what the set says.
void expect_marks(const VlodMarks& marks, const Model& model, const std::vector<NodeId>& nodes) {
  std::vector<uint8_t> leads(model.tables.nodes.size(), 0);
  for (NodeId id : nodes)
    for (; id != kNoNode; id = model.tables.nodes[index_of(id)].parent) leads[index_of(id)] = 1;
  for (uint32_t i = 0; i < leads.size(); ++i) {
    ASSERT_EQ(marks.leads_to_some(NodeId{i}), leads[i] != 0) << i;
    ASSERT_EQ(marks.has(NodeId{i}), std::binary_search(nodes.begin(), nodes.end(), NodeId{i})) << i;
  }
}

TEST(VlodMarks, after_any_steps_are_those_of_the_last_set) {
  Forest model;
  model.grow(model.root({{10, -8, -1}, {10.5F, 8, 1}}, 8), 3, 4);
  VlodMarks marks(model.model());
  std::mt19937 random(2);
  for (int step = 0; step < 200; ++step) {
    // A random part of a random front.
    std::vector<NodeId> open = {NodeId{0}}, nodes;
    while (!open.empty()) {
      const NodeId id = open.back();
      open.pop_back();
      const auto children = model.model().children_of(id);
      if (children.empty() || random() % 4U == 0) {
        if (random() % 3U != 0) nodes.push_back(id);
      } else {
        open.insert(open.end(), children.begin(), children.end());
      }
    }
    std::sort(nodes.begin(), nodes.end());
    const size_t before = marks.nodes().size();
    const VlodMarks::Change change = marks.change_to(nodes);
    EXPECT_EQ(before + change.entered - change.left, nodes.size());
    expect_marks(marks, model.model(), nodes);
  }
  marks.change_to({});
  expect_marks(marks, model.model(), {});
}

// --- a model with cells ---------------------------------------------------------------------------------------------

/// A tree of 1 + 3 + 9 nodes with the three cells around the camera of the scenes: cell 0 sees the left and the middle
/// ninths, the others nothing.
struct Street : Forest {
  Street() {
    grow(root({{10, -8, -1}, {10.5F, 8, 1}}, 2), 3, 2);
    tables = three_cells();
    vlods = {{NodeId{2}, NodeId{4}, NodeId{10}}, {}, {}};
  }
  const CellTables* cells() const override { return has_cells ? &tables : nullptr; }
  uint32_t vlod_nodes(CellId cell) const override { return static_cast<uint32_t>(vlods[index_of(cell)].size()); }
  Result<Vlod> read_vlod(CellId cell) const override {
    ++vlod_reads;
    if (broken) return Error{"street: broken vLOD"};
    return Vlod{vlods[index_of(cell)], 100};
  }

  CellTables tables;
  std::vector<std::vector<NodeId>> vlods;
  bool has_cells = true, broken = false;
  mutable std::atomic<int> vlod_reads = 0;
};

// --- pictures
// -------------------------------------------------------------------------------------------------------

/// The street with two shared pictures of 1024 and one of 256 pixels a side, and an atlas; cell 1 sees one of the
/// large.
struct PaintedStreet : Street {
  PaintedStreet() {
    vlods = {{NodeId{2}, NodeId{4}, NodeId{10}}, {NodeId{4}}, {}};
    texture(1024, {NodeId{2}});
    texture(1024, {NodeId{4}});
    texture(256, {NodeId{10}});
    const uint32_t atlas = texture(2048, {NodeId{5}});
    edit().tables.textures[atlas].flags = TextureRecord::kAtlas;
  }
};

TEST(TextureLimit, is_the_largest_at_which_a_cell_s_pictures_fit) {
  PaintedStreet model;
  const auto bytes = [](uint32_t side) { return limited_bytes({side, side, 0, 0}, {}); };
  const uint64_t whole = 2 * bytes(1024) + bytes(256);
  EXPECT_EQ(texture_limit_for(model, whole).side_px, kAnySide);
  EXPECT_EQ(texture_limit_for(model, whole - 1).side_px, 512U);
  EXPECT_EQ(texture_limit_for(model, 2 * bytes(512) + bytes(256)).side_px, 512U);
  EXPECT_EQ(texture_limit_for(model, 3 * bytes(128)).side_px, 128U);
  EXPECT_EQ(texture_limit_for(model, 0).side_px, 64U) << "no smaller";
  model.has_cells = false;
  EXPECT_EQ(texture_limit_for(model, 0).side_px, kAnySide) << "nothing tells what is seen together";
  model.has_cells = true, model.broken = true;
  EXPECT_EQ(texture_limit_for(model, 0).side_px, kAnySide);
}

TEST(TextureLimit, bounds_what_is_loaded_but_atlases) {
  PaintedStreet model;
  NullRenderer renderer;
  const TextureLimit limit{128};
  ResidentSet set(model, renderer, uint64_t(1) << 30, 0, 0, 0, limit);
  ASSERT_TRUE(set.load_roots(renderer));
  Loader loader(model, renderer, set, nullptr, {});
  const std::vector<PriorityUpdate> wanted = {{NodeId{2}, 4}, {NodeId{5}, 3}};
  set.update(wanted, [](NodeId) { return 0.0F; });
  while (loader.step().outcome == Loader::Outcome::worked) {
  }
  set.upload(renderer, 1e9);
  EXPECT_THAT(renderer.textures,
              ElementsAre(renderer.texture_bytes_bound(128, 128), renderer.texture_bytes_bound(2048, 2048)));
  set.clear(renderer);
}

TEST(VlodStore, reads_what_is_wanted_in_that_order_once) {
  Street model;
  VlodStore store(model);
  EXPECT_FALSE(store.load_next().worked);
  store.want(std::vector<CellId>{CellId{0}, CellId{1}});
  EXPECT_EQ(store.find(CellId{0}), nullptr);
  EXPECT_EQ(store.load_next().bytes, 100U);
  ASSERT_NE(store.find(CellId{0}), nullptr);
  EXPECT_EQ(store.find(CellId{0})->nodes, model.vlods[0]);
  EXPECT_EQ(store.find(CellId{1}), nullptr);
  EXPECT_TRUE(store.load_next().worked);
  EXPECT_FALSE(store.load_next().worked);
  store.want(std::vector<CellId>{CellId{1}, CellId{0}});
  EXPECT_FALSE(store.load_next().worked) << "both are there";
  EXPECT_EQ(model.vlod_reads, 2);
}

TEST(VlodStore, keeps_within_its_bound_and_the_most_important) {
  Street model;
  std::vector<NodeId> large(1 << 20);  // 4 MiB: two fit
  for (uint32_t i = 0; i < large.size(); ++i) large[i] = NodeId{i};
  model.vlods = {large, large, large};
  VlodStore store(model);
  store.want(std::vector<CellId>{CellId{0}, CellId{1}, CellId{2}});
  EXPECT_TRUE(store.load_next().worked);
  EXPECT_TRUE(store.load_next().worked);
  EXPECT_FALSE(store.load_next().worked) << "what is there matters more";
  store.want(std::vector<CellId>{CellId{2}, CellId{1}, CellId{0}});
  EXPECT_TRUE(store.load_next().worked);
  EXPECT_NE(store.find(CellId{2}), nullptr);
  EXPECT_EQ(store.find(CellId{0}), nullptr) << "made room";
}

TEST(VlodStore, what_cannot_be_read_is_asked_for_once) {
  Street model;
  model.broken = true;
  VlodStore store(model);
  store.want(std::vector<CellId>{CellId{0}});
  EXPECT_TRUE(store.load_next().worked);
  EXPECT_FALSE(store.load_next().worked);
  EXPECT_EQ(store.find(CellId{0}), nullptr);
  EXPECT_THAT(store.failures(), ElementsAre("street: broken vLOD"));
}

// --- policies -----------------------------------------------------------------------------------------------------

struct StreetView {
  StreetView() : marks(model.model()), resident(model.model().tables.nodes.size(), 1) {
    view.camera = scenes::looking_along_x();
    marks.change_to(model.vlods[0]);
    view.vlod = &marks;
    view.cell = &model.tables.cells[0].box;
    view.bound = &model.tables.bound;
  }
  const Selection& operator()(Policy policy) {
    options.policy = policy;
    select(model.model(), view, resident, options, state, selection);
    return selection;
  }
  Street model;
  VlodMarks marks;
  std::vector<uint8_t> resident;
  SelectView view;
  SelectOptions options;
  SelectState state;
  Selection selection;
};

TEST(Vlod, draws_exactly_the_cells_vlod) {
  StreetView choose;
  EXPECT_THAT(choose(Policy::vlod).front, UnorderedElementsAre(NodeId{2}, NodeId{4}, NodeId{10}));
  EXPECT_EQ(choose.selection.nodes_missing, 0U);
}

TEST(Vlod, does_not_ask_for_what_is_hidden) {
  StreetView choose;
  choose(Policy::vlod);
  for (const PriorityUpdate& update : choose.selection.updates) EXPECT_TRUE(choose.marks.leads_to_some(update.node));
}

TEST(Vlod, missing_node_shows_its_nearest_resident_ancestor) {
  StreetView choose;
  choose.resident[4] = 0;
  const NodeId parent = choose.model.model().tables.nodes[4].parent;
  const Selection& selection = choose(Policy::vlod);
  EXPECT_THAT(selection.front, testing::Contains(parent));
  EXPECT_EQ(selection.nodes_missing, 1U);
}

TEST(Vlod, without_a_vlod_is_static) {
  StreetView choose;
  choose.view.vlod = nullptr;
  choose.options.pixel_error = 3;
  const std::vector<NodeId> drawn = choose(Policy::vlod).front;
  EXPECT_EQ(drawn, choose(Policy::static_error).front);
}

TEST(Vlod, of_nothing_draws_nothing) {
  StreetView choose;
  choose.marks.change_to({});
  EXPECT_THAT(choose(Policy::vlod).front, IsEmpty());
  EXPECT_THAT(choose(Policy::vlod_time_slices).front, IsEmpty());
}

TEST(Front, is_the_cells_front_in_the_frustum) {
  StreetView choose;
  EXPECT_EQ(choose(Policy::front).front.size(),
            cell_front(choose.model.model(), *choose.view.cell, one_pixel()).size());
  choose.view.cell = nullptr;
  choose.options.pixel_error = 1e6;
  EXPECT_THAT(choose(Policy::front).front, ElementsAre(NodeId{0})) << "outside the cells: static";
}

TEST(VlodTimeSlices, refine_only_what_may_be_seen) {
  StreetView choose;
  choose.options.time.target_ms = 1000;
  choose.options.pixel_error = 1e-3;
  for (int i = 0; i < 40; ++i) choose(Policy::vlod_time_slices);
  for (const NodeId drawn : choose.selection.front) {
    bool seen = choose.marks.leads_to_some(drawn);
    for (NodeId up = drawn; up != kNoNode; up = choose.model.model().tables.nodes[index_of(up)].parent)
      seen = seen || choose.marks.has(up);
    EXPECT_TRUE(seen) << index_of(drawn);
  }
  const Selection& selection = choose.selection;
  EXPECT_GE(selection.front.size(), 3U);
  // Without the vLOD everything in view is refined.
  const size_t with = selection.front.size();
  choose.view.vlod = nullptr;
  for (int i = 0; i < 40; ++i) choose(Policy::vlod_time_slices);
  EXPECT_GT(choose.selection.front.size(), with);
}

// --- flying -------------------------------------------------------------------------------------------------------

FlightOptions stepped(Policy policy) {
  FlightOptions options;
  options.session.select.policy = policy;
  options.session.loader_thread = false;
  options.width_px = options.height_px = 64;
  options.vertical_fov_deg = 90;
  options.session.loader.memory_bytes = uint64_t(64) << 20;
  return options;
}

/// From cell 0 into cell 1, and out.
CameraPath walk() {
  CameraPath path;
  path.fps = 10;
  path.keys = {{0, {{0.5, 0.5, 1}}}, {3, {{6.5, 0.5, 1}}}};
  return path;
}

const FrameCallback nothing_there = [](const FrameRow&, Renderer&) -> Status { return Done{}; };

TEST(FlightThroughCells, counts_cells_crossed_and_what_steps_cost) {
  Street model;
  model.vlods[1] = {NodeId{6}};
  NullRenderer renderer;
  JobMonitor monitor;
  const Result<FlightReport> report = fly(model, renderer, walk(), stepped(Policy::vlod), nothing_there, monitor);
  ASSERT_TRUE(report) << report.error().message;
  EXPECT_EQ(report->totals.cells_crossed, 2U);
  EXPECT_EQ(report->totals.delta_bytes_mean, 100);
  EXPECT_EQ(report->totals.delta_nodes_mean, (3 + 4) / 2.0) << "three came; three went and one came";
  EXPECT_EQ(report->totals.vlods_missing, 1U) << "the first frame's; the neighbours' are read ahead";
  EXPECT_EQ(report->rows.front().cell, CellId{0});
  EXPECT_EQ(report->rows.back().cell, std::nullopt);
  EXPECT_EQ(report->loader.vlods_loaded, 3U);
}

TEST(FlightThroughCells, a_broken_vlod_leaves_the_tree) {
  Street model, without;
  model.broken = true, without.has_cells = false;
  NullRenderer renderer;
  JobMonitor monitor;
  const auto broken = fly(model, renderer, walk(), stepped(Policy::vlod), nothing_there, monitor);
  const auto plain = fly(without, renderer, walk(), stepped(Policy::static_error), nothing_there, monitor);
  ASSERT_TRUE(broken && plain);
  EXPECT_EQ(broken->rows[10].nodes_drawn, plain->rows[10].nodes_drawn);
  EXPECT_GT(broken->totals.vlods_missing, 10U);
}

TEST(FlightThroughCells, memory_for_cells_is_within_the_bound) {
  Street model;
  NullRenderer renderer;
  JobMonitor monitor;
  for (const bool thread : {false, true}) {
    FlightOptions options = stepped(Policy::vlod_time_slices);
    options.session.loader_thread = thread;
    const Result<FlightReport> report = fly(model, renderer, walk(), options, nothing_there, monitor);
    ASSERT_TRUE(report) << report.error().message;
    EXPECT_LE(report->totals.resident_bytes_peak, report->totals.memory_bytes);
  }
}

}  // namespace
}  // namespace promenade
