// Far pictures at run time: which are loaded, which are drawn, what is near besides.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "codec/far_face.h"
#include "geometry/cube_side.h"
#include "raster/view.h"
#include "runtime/cpu_renderer.h"
#include "runtime/far_follower.h"
#include "runtime/far_stage.h"
#include "runtime/far_store.h"
#include "runtime/session.h"
#include "tests/runtime/forest.h"
#include "tests/runtime/null_renderer.h"
#include "tests/runtime/scenes.h"

namespace promenade {
namespace {

using forest::Forest;
using testing::ElementsAre;

/// A row of cells of 10 m along y from -50 to 50, at x and z from -5 to 5; boxes of 60 m. From each a plain picture
/// along +x, and below it some other side, is seen; from the last nothing.
class FarForest : public Forest {
 public:
  FarForest() {
    tables_.bound_rad = 0.1, tables_.box_m = 60, tables_.cell_m = 10;
    tables_.origin = {-5, -50, -5}, tables_.counts = {1, 10, 1};
    tables_.face_levels = 3, tables_.has_depth = true;
    for (uint32_t i = 0; i < 10; ++i) {
      const uint32_t sides = i == 9 ? 0 : 2;
      tables_.cells.push_back({i, static_cast<uint32_t>(tables_.faces.size()), sides, 0.05F});
      for (uint32_t s = 0; s < sides; ++s) tables_.faces.push_back({0, 100, s * 5, 2, 0});
    }
    face_.grid.levels = 3;
    face_.colors = scenes::filled(9, {200, 100, 50, 255});
    face_.kept.assign(81, 0);
    close_halvings(face_.grid, face_.kept);
    face_.depth.assign(81, 0);
    for (const uint32_t at : {0U, 8U, 72U, 80U}) face_.depth[at] = FarFace::kNearest / 2;
    bytes_ = *encode_far_face(face_, {0});
    const FarFace decoded = *decode_far_face(bytes_);
    FarReference reference;
    reference.sides[0] = reference.sides[5] = &decoded;
    reference.places = {0, -1, 0};
    reference.offset = offset_from_reference(reference.places, tables_.cell_m, tables_.box_m);
    for (const uint32_t side : {0U, 5U})
      told_bytes_[side] = *encode_far_delta(face_, {90}, side, reference, FarForetelling::warped);
  }
  /// A shell around: two cells of 50 m with a side each.
  void surround() {
    tables_.outer = {{150, 5}};
    for (uint32_t i = 0; i < 2; ++i) {
      tables_.cells.push_back({10 + i, static_cast<uint32_t>(tables_.faces.size()), 1, 0.05F});
      tables_.faces.push_back({0, 100, 0, 2, 0});
    }
  }
  const FarTables* far() const override { return &tables_; }
  Result<std::vector<std::byte>> read_far_face(uint32_t face) const override {
    ++reads;
    if (broken.contains(face)) return Error{"far forest: unreadable"};
    return told.contains(face) ? told_bytes_.at(tables_.faces[face].side) : bytes_;
  }
  std::set<uint32_t> broken;
  std::set<uint32_t> told;  ///< against the same side of the cell before
  mutable int reads = 0;

 private:
  FarTables tables_;
  FarFace face_;
  std::vector<std::byte> bytes_;
  std::map<uint32_t, std::vector<std::byte>> told_bytes_;
};

// --- follower -----------------------------------------------------------------------------------------------------

class Follower : public testing::Test {
 protected:
  void go(double y, uint32_t frames = 4) {
    follower.follow({0, y, 0}, frames, [this](FarCellId cell) { return ready.contains(index_of(cell)); });
  }
  FarForest source;
  FarFollower follower{*source.far()};
  std::set<uint32_t> ready = {0, 1, 2};
};

TEST_F(Follower, fades_across_a_border_and_keeps_both_boxes_near_meanwhile) {
  go(-45);
  ASSERT_EQ(follower.layers().size(), 1U);
  EXPECT_EQ(follower.layers()[0].cell, FarCellId{0});
  float last = 0;
  for (int frame = 0; frame < 3; ++frame) {
    go(-35);
    ASSERT_EQ(follower.layers().size(), 2U);
    EXPECT_EQ(follower.layers()[0].cell, FarCellId{1});
    EXPECT_EQ(follower.layers()[1].cell, FarCellId{0});
    EXPECT_EQ(follower.layers()[0].from, 0);
    EXPECT_EQ(follower.layers()[0].to, follower.layers()[1].from) << "each pixel to one side";
    EXPECT_EQ(follower.layers()[1].to, 1);
    EXPECT_GT(follower.layers()[0].to, last);
    last = follower.layers()[0].to;
    EXPECT_EQ(follower.near().size(), 2U);
  }
  go(-35);
  ASSERT_EQ(follower.layers().size(), 1U);
  EXPECT_EQ(follower.layers()[0].to, 1);
  EXPECT_EQ(follower.near()[0], near_box(*source.far(), FarCellId{1}));
}

TEST_F(Follower, shows_the_last_picture_while_the_next_is_late_and_then_geometry) {
  go(-25);
  ready.erase(3);
  go(-15);
  ASSERT_EQ(follower.layers().size(), 1U);
  EXPECT_EQ(follower.layers()[0].cell, FarCellId{2});
  EXPECT_TRUE(follower.is_late());
  go(-5);
  EXPECT_TRUE(follower.layers().empty()) << "too far away";
  EXPECT_TRUE(follower.near().empty()) << "everything is geometry";
  EXPECT_TRUE(follower.is_missing());
  ready.insert(4);
  go(-5);
  ASSERT_EQ(follower.layers().size(), 1U);
  EXPECT_FALSE(follower.is_missing());
}

TEST_F(Follower, outside_draws_geometry_and_calls_nothing_missing) {
  go(-25);
  go(400);
  EXPECT_TRUE(follower.layers().empty());
  EXPECT_FALSE(follower.is_missing());
}

TEST_F(Follower, wants_where_the_eye_goes_first_and_what_is_beside) {
  EXPECT_THAT(follower.wanted({0, 1, 0}, {0, 0, 0}), ElementsAre(FarCellId{5}, FarCellId{4}, FarCellId{6}));
  EXPECT_THAT(follower.wanted({0, 1, 0}, {0, 20, 0}),
              ElementsAre(FarCellId{5}, FarCellId{6}, FarCellId{7}, FarCellId{8}, FarCellId{9}, FarCellId{4}));
  EXPECT_TRUE(follower.wanted({0, 1, 900}, {0, 0, 0}).empty());
  EXPECT_THAT(
      follower.wanted({0, -45, 0}, {0, 4000, 0}),
      ElementsAre(FarCellId{0}, FarCellId{1}, FarCellId{2}, FarCellId{3}, FarCellId{4}, FarCellId{5}, FarCellId{6}))
      << "every cell on the way, however fast";
}

TEST_F(Follower, wants_the_shells_around_each_cell_right_after_it) {
  source.surround();
  EXPECT_THAT(follower.wanted({0, 1, 0}, {0, 0, 0}),
              ElementsAre(FarCellId{5}, FarCellId{11}, FarCellId{4}, FarCellId{10}, FarCellId{6}));
}

// --- store --------------------------------------------------------------------------------------------------------

std::vector<FarCellId> cells(std::initializer_list<uint32_t> ids) {
  std::vector<FarCellId> list;
  list.reserve(ids.size());
  for (const uint32_t id : ids) list.push_back(FarCellId{id});
  return list;
}

/// Loads and uploads until nothing is left to do.
void work(FarStore& store, NullRenderer& renderer) {
  for (int i = 0; i < 200; ++i) {
    store.let_go(store.take_leaving(), renderer);
    store.upload(renderer, 0);
    static_cast<void>(store.load_next());
    EXPECT_LE(store.bytes(), store.bound_bytes());
    EXPECT_LE(renderer.bytes(), store.bound_bytes());
  }
}

TEST(FarStore, brings_what_is_wanted_in_order_within_its_bound) {
  const FarForest source;
  NullRenderer renderer;
  FarStore store(source, renderer, 1000);  // little: room for three cells, no more
  store.want(cells({3, 4, 5, 6}));
  work(store, renderer);
  EXPECT_TRUE(store.find(FarCellId{3}));
  EXPECT_TRUE(store.find(FarCellId{4}));
  EXPECT_EQ(store.find(FarCellId{3})->meshes.size(), 2U);
  EXPECT_EQ(store.find(FarCellId{3})->triangles, 4U);
  store.want(cells({6, 5}));
  work(store, renderer);
  EXPECT_TRUE(store.find(FarCellId{6}));
  EXPECT_TRUE(store.find(FarCellId{5}));
  EXPECT_FALSE(store.find(FarCellId{3}) && store.find(FarCellId{4}));
  store.clear(renderer);
  EXPECT_EQ(renderer.bytes(), 0U);
  EXPECT_EQ(store.bytes(), 0U);
}

TEST(FarStore, has_at_once_what_sees_nothing) {
  const FarForest source;
  NullRenderer renderer;
  const FarStore store(source, renderer, 1 << 20);
  ASSERT_TRUE(store.find(FarCellId{9}));
  EXPECT_TRUE(store.find(FarCellId{9})->meshes.empty());
}

TEST(FarStore, gives_up_a_cell_that_cannot_be_read_or_uploaded) {
  FarForest source;
  source.broken = {7};  // cell 3's second side
  NullRenderer renderer;
  FarStore store(source, renderer, 1 << 20);
  store.want(cells({3, 4}));
  work(store, renderer);
  EXPECT_FALSE(store.find(FarCellId{3}));
  EXPECT_TRUE(store.find(FarCellId{4}));
  EXPECT_EQ(store.failures().size(), 1U);
  renderer.fail_uploads = true;
  store.want(cells({5}));
  work(store, renderer);
  EXPECT_FALSE(store.find(FarCellId{5}));
  store.clear(renderer);
  EXPECT_EQ(renderer.bytes(), 0U);
}

TEST(FarStore, brings_sides_that_are_told_against_a_neighbours_reading_that_once) {
  FarForest source;
  source.told = {8, 9};  // both sides of cell 4
  NullRenderer renderer;
  FarStore store(source, renderer, 1 << 20);
  store.want(cells({4}));
  work(store, renderer);
  ASSERT_TRUE(store.find(FarCellId{4}));
  EXPECT_EQ(store.find(FarCellId{4})->triangles, 4U);
  EXPECT_EQ(source.reads, 2 + 2);
  EXPECT_TRUE(store.failures().empty());
}

TEST(FarStore, gives_up_a_side_told_against_one_that_is_told_itself_or_is_not_there) {
  FarForest source;
  source.told = {0, 1, 6, 7, 8, 9};  // the first cell has none before it
  NullRenderer renderer;
  FarStore store(source, renderer, 1 << 20);
  store.want(cells({4, 0, 3}));
  work(store, renderer);
  EXPECT_FALSE(store.find(FarCellId{4}));
  EXPECT_FALSE(store.find(FarCellId{0}));
  EXPECT_TRUE(store.find(FarCellId{3}));
  EXPECT_EQ(store.failures().size(), 2U);
}

// --- session ------------------------------------------------------------------------------------------------------

SessionOptions stratified() {
  SessionOptions options;
  options.select.policy = Policy::stratified;
  options.select.prefetch_s = 0;
  options.loader_thread = false;
  options.loader.memory_bytes = 64 << 20;
  options.fade_frames = 0;
  return options;
}

Camera wide_from(const glm::dvec3& eye) {
  Camera camera = scenes::looking_along_x();
  camera.pose.eye = eye;
  camera.vertical_fov_deg = 170;
  return camera;
}

/// Sixteen leaves along y from -80 to 80, at x = 10.
void plant(FarForest& source) { source.grow(source.root({{10, -80, -4}, {11, 80, 4}}, 8), 2, 4, 10); }

TEST(StratifiedSession, draws_near_nodes_and_the_picture_and_geometry_where_none_is) {
  FarForest source;
  plant(source);
  NullRenderer renderer;
  Result<Session> session = Session::open(source, renderer, stratified());
  ASSERT_TRUE(session.ok()) << session.error().message;
  Camera camera = wide_from({0, -20, 0});
  const Result<FrameRow> first = session->frame(camera, 0);
  EXPECT_EQ(first->far_layers, 0U);
  EXPECT_TRUE(first->far_missing);
  ASSERT_TRUE(session->settle(camera).ok());
  const Result<FrameRow> row = session->frame(camera, 0);
  EXPECT_EQ(row->far_layers, 1U);
  EXPECT_FALSE(row->far_missing);
  EXPECT_EQ(row->far_triangles, 4U);
  // The box reaches from y = -45 to 15: 6 leaves of 10 m, and those that touch it.
  for (const NodeId id : session->selection().front) {
    const Box near = near_box(*source.far(), FarCellId{3});
    EXPECT_TRUE(near.overlaps(source.node(id).box));
  }
  EXPECT_LT(session->selection().front.size(), 16U);
  EXPECT_EQ(renderer.drawn.size(), session->selection().front.size() + 2);
  session->far_style() = FarStyle::near_only;
  ASSERT_TRUE(session->frame(camera, 0).ok());
  EXPECT_EQ(renderer.drawn.size(), session->selection().front.size());
  session->far_style() = FarStyle::far_only;
  ASSERT_TRUE(session->frame(camera, 0).ok());
  EXPECT_EQ(renderer.drawn.size(), 2U);
}

TEST(StratifiedSession, draws_the_pictures_of_all_shells_or_geometry) {
  FarForest source;
  plant(source);
  source.surround();
  NullRenderer renderer;
  Result<Session> session = Session::open(source, renderer, stratified());
  ASSERT_TRUE(session.ok()) << session.error().message;
  Camera camera = wide_from({0, -20, 0});
  ASSERT_TRUE(session->settle(camera).ok());
  const Result<FrameRow> row = session->frame(camera, 0);
  EXPECT_EQ(row->far_layers, 1U);
  EXPECT_EQ(row->far_triangles, 6U);
  EXPECT_EQ(row->far_cell, FarCellId{3});
  EXPECT_EQ(renderer.drawn.size(), session->selection().front.size() + 3);
  // The one around the next cells cannot be read: none of the two is shown.
  source.broken = {19};
  camera.pose.eye = {0, 20, 0};
  ASSERT_TRUE(session->settle(camera).ok());
  const Result<FrameRow> beyond = session->frame(camera, 0);
  EXPECT_TRUE(beyond->far_missing);
  EXPECT_EQ(beyond->far_layers, 0U);
}

TEST(StratifiedSession, without_far_pictures_says_so) {
  Forest source;
  source.grow(source.root({{10, -8, -8}, {11, 8, 8}}, 8), 2, 2, 10);
  NullRenderer renderer;
  const Result<Session> session = Session::open(source, renderer, stratified());
  ASSERT_FALSE(session.ok());
  EXPECT_THAT(session.error().message, testing::HasSubstr("--far-pictures"));
}

TEST(StratifiedSession, keeps_the_memory_bound_with_pictures) {
  FarForest source;
  plant(source);
  NullRenderer renderer;
  SessionOptions options = stratified();
  options.loader.memory_bytes = 200 << 10;
  Result<Session> session = Session::open(source, renderer, options);
  ASSERT_TRUE(session.ok()) << session.error().message;
  Camera camera = scenes::looking_along_x();
  for (int i = 0; i < 100; ++i) {
    camera.pose.eye = {0, -49 + i, 0};
    ASSERT_TRUE(session->frame(camera, 1.0 / 30).ok());
    session->run_loader(5);
    EXPECT_LE(session->resident_bytes(), options.loader.memory_bytes);
  }
}

// --- look ---------------------------------------------------------------------------------------------------------

TEST(FarStage, looks_as_it_was_drawn_whatever_faces_the_sun) {
  const FarForest source;
  const std::unique_ptr<Renderer> renderer = create_cpu_renderer();
  FarKey key;
  const Result<StagedFarSide> side = stage_far_side(source, *renderer, FarCellId{0}, 0, key);
  ASSERT_TRUE(side.ok()) << side.error().message;
  const Result<TextureHandle> texture = renderer->create_texture(*side->texture);
  const Result<MeshHandle> mesh = renderer->create_mesh(*side->mesh, std::span(&*texture, 1));
  FrameView view;
  view.camera = scenes::looking_along_x();
  view.camera.vertical_fov_deg = 80;
  view.camera.pose.eye = cell_box(*source.far(), FarCellId{0}).center();
  const std::vector<DrawItem> items = {{*mesh, kNoNode}};
  ASSERT_TRUE(renderer->draw(view, items).ok());
  const Result<Image> picture = renderer->read_color();
  for (const glm::u8vec4& p : picture->pixels) {
    ASSERT_NEAR(p.r, 200, 2);
    ASSERT_NEAR(p.g, 100, 2);
    ASSERT_NEAR(p.b, 50, 2);
  }
  const Result<std::vector<float>> depth = renderer->read_depth();
  EXPECT_NEAR((*depth)[0], 60, 0.5) << "twice as far as the box";
}

TEST(FarStage, of_a_told_side_looks_as_the_same_side_alone) {
  FarForest source;
  const std::unique_ptr<Renderer> renderer = create_cpu_renderer();
  FarKey key;
  const Result<StagedFarSide> alone = stage_far_side(source, *renderer, FarCellId{4}, 8, key);
  source.told = {8};
  const Result<StagedFarSide> told = stage_far_side(source, *renderer, FarCellId{4}, 8, key);
  ASSERT_TRUE(told.ok()) << told.error().message;
  EXPECT_EQ(told->triangles, alone->triangles);
  std::array<glm::u8vec4, 2> middle{};
  for (const StagedFarSide* side : {&*alone, &*told}) {
    const Result<TextureHandle> texture = renderer->create_texture(*side->texture);
    const Result<MeshHandle> mesh = renderer->create_mesh(*side->mesh, std::span(&*texture, 1));
    FrameView view;
    view.camera = scenes::looking_along_x();
    view.camera.pose.eye = cell_box(*source.far(), FarCellId{4}).center();
    const std::vector<DrawItem> items = {{*mesh, kNoNode}};
    ASSERT_TRUE(renderer->draw(view, items).ok());
    const Result<Image> picture = renderer->read_color();
    middle[side == &*told ? 1 : 0] = picture->at(picture->width / 2, picture->height / 2);
  }
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(middle[0][c], middle[1][c], 3);
}

TEST(CubeSide, is_what_the_rasteriser_draws) {
  for (uint32_t side = 0; side < 6; ++side) {
    const RasterView view = cube_face_view({0, 0, 0}, static_cast<int>(side), 9, 1);
    EXPECT_EQ(view.forward, cube_side(side).forward);
    EXPECT_EQ(view.right, cube_side(side).right);
    EXPECT_EQ(view.up, cube_side(side).up);
  }
}

}  // namespace
}  // namespace promenade
