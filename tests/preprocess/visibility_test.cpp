#include "preprocess/visibility/visibility.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <atomic>

#include "codec/frame.h"
#include "preprocess/visibility/view_volume.h"
#include "tests/preprocess/build_fixtures.h"
#include "tests/preprocess/surfaces.h"

namespace promenade {
namespace {

using testing::HasSubstr;

/// A box's faces, each divided so that leaves are small; outwards, or inwards as a room's.
Mesh house(const Box& box, bool inwards) {
  constexpr int kSteps = 6;
  Mesh mesh;
  for (int axis = 0; axis < 3; ++axis)
    for (const bool upper : {false, true})
      for (int i = 0; i < kSteps; ++i)
        for (int j = 0; j < kSteps; ++j) {
          const int u = (axis + 1) % 3, v = (axis + 2) % 3;
          const auto corner = [&](int a, int b) {
            glm::vec3 p(0);
            p[axis] = upper ? box.max[axis] : box.min[axis];
            p[u] = box.min[u] + box.size()[u] * float(a) / kSteps;
            p[v] = box.min[v] + box.size()[v] * float(b) / kSteps;
            return p;
          };
          const auto base = static_cast<uint32_t>(mesh.positions.size());
          for (const glm::vec3& p : {corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)})
            mesh.positions.push_back(p);
          const bool flip = upper == inwards;
          for (const uint32_t k : {0U, 1U, 2U, 0U, 2U, 3U}) mesh.indices.push_back(base + (flip ? (6 - k) % 4 : k));
        }
  return mesh;
}

/// Ground of 40 x 20 m that shows its front upwards.
Mesh ground() {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {40, 0, 0}, {40, 20, 0}, {0, 20, 0}};
  mesh.indices = {0, 1, 2, 0, 2, 3};
  return mesh;
}

/// Hides whatever is farther from the cell than `reach_m`.
class HidesFar : public Hider {
 public:
  HidesFar(const Model& model, float reach_m) : model_(model), reach_m_(reach_m) {}
  std::string_view name() const override { return "far"; }
  Status hide(const HiderQuestion& question, std::span<uint8_t> hidden) const override {
    ++asked;
    for (size_t i = 0; i < question.front.size(); ++i)
      if (distance_m(question.cell, model_.tables.nodes[index_of(question.front[i])].box) > double(reach_m_))
        hidden[i] = 1;
    return Done{};
  }
  mutable std::atomic<int> asked = 0;

 private:
  const Model& model_;
  float reach_m_;
};

class Fails : public Hider {
 public:
  std::string_view name() const override { return "fails"; }
  Status hide(const HiderQuestion&, std::span<uint8_t>) const override { return Error{"this hider always fails"}; }
};

class Seen : public testing::Test {
 protected:
  /// Builds the model without cells and opens it.
  const ModelReader& model_of(const Mesh& mesh, uint32_t node_triangles = 300) {
    const auto source = folder.write("source.obj", obj_text(mesh));
    BuildOptions options = small_build(source, folder.path() / "model.prom");
    options.node_triangles = node_triangles;
    const Result<BuildFigures> figures = build_model(options, monitor);
    EXPECT_TRUE(figures.ok()) << figures.error().message;
    Result<ModelReader> opened = ModelReader::open(options.model);
    EXPECT_TRUE(opened.ok());
    reader.emplace(std::move(*opened));
    return *reader;
  }
  Result<Visibility> seen_by(const std::vector<std::unique_ptr<Hider>>& hiders, const CellOptions& options,
                             int threads = 2) {
    Result<WorkFolder> work = WorkFolder::open(folder.path() / "work", real_file_system());
    const tbb::global_control most(tbb::global_control::max_allowed_parallelism, 4);
    tbb::task_arena arena(threads);
    return arena.execute([&]() -> Result<Visibility> {
      const Result<ViewSpace> space = survey_view_space(*reader, options, monitor);
      if (!space) return space.error();
      return compute_visibility(*reader, *space, hiders, options, 7, *work, monitor);
    });
  }

  TemporaryFolder folder;
  JobMonitor monitor;
  std::optional<ModelReader> reader;
};

/// A place in world coordinates to one of the model.
glm::vec3 placed(const ModelReader& reader, const glm::dvec3& world) { return world - reader.model().manifest.origin; }

Box around(const glm::vec3& p) { return {p - 0.25F, p + 0.25F}; }

TEST_F(Seen, solid_house_on_ground_is_dead_inside) {
  Mesh mesh = ground();
  append(mesh, house({{10, 5, 0}, {20, 15, 8}}, false));
  const ModelReader& model = model_of(mesh);
  const Result<ViewVolume> volume =
      survey_volume(model, {placed(model, {0, 0, 0}), placed(model, {40, 20, 12})}, 200000, monitor);
  ASSERT_TRUE(volume) << volume.error().message;
  EXPECT_FALSE(volume->is_open(around(placed(model, {15, 10, 4}))));
  EXPECT_TRUE(volume->is_open(around(placed(model, {5, 10, 4}))));
  EXPECT_TRUE(volume->is_open(around(placed(model, {15, 10, 10})))) << "above the roof";
  EXPECT_TRUE(volume->is_open({placed(model, {15, 10, 4}), placed(model, {25, 11, 5})})) << "half of it is outside";
}

TEST_F(Seen, room_whose_walls_face_inwards_is_open_though_closed) {
  Mesh mesh = ground();
  append(mesh, house({{10, 5, 0}, {20, 15, 8}}, false));
  append(mesh, house({{10.5F, 5.5F, 0.5F}, {19.5F, 14.5F, 7.5F}}, true));
  const ModelReader& model = model_of(mesh);
  const Result<ViewVolume> volume =
      survey_volume(model, {placed(model, {0, 0, 0}), placed(model, {40, 20, 12})}, 400000, monitor);
  ASSERT_TRUE(volume) << volume.error().message;
  EXPECT_TRUE(volume->is_open(around(placed(model, {15, 10, 4}))));
}

TEST_F(Seen, house_wall_to_wall_with_others_is_dead_inside) {
  // Slits of 0.2 m, narrower than the survey's cubes, with a board on each neighbour's wall: outside of the house there
  // are more fronts than it has backs.
  Mesh mesh = ground();
  const glm::vec3 low(10, 5, 0), high(20, 15, 8);
  append(mesh, house({low, high}, false));
  for (const float slit_m : {0.1F, 0.2F}) {
    append(mesh, house({{low.x, high.y + slit_m, 0}, {high.x, 18 + slit_m, 8}}, false));
    append(mesh, house({{low.x, 2 - slit_m, 0}, {high.x, low.y - slit_m, 8}}, false));
    append(mesh, house({{high.x + slit_m, low.y, 0}, {25 + slit_m, high.y, 8}}, false));
    append(mesh, house({{5 - slit_m, low.y, 0}, {low.x - slit_m, high.y, 8}}, false));
  }
  const ModelReader& model = model_of(mesh);
  const Result<ViewVolume> volume =
      survey_volume(model, {placed(model, {0, 0, 0}), placed(model, {40, 20, 12})}, 200000, monitor);
  ASSERT_TRUE(volume) << volume.error().message;
  EXPECT_FALSE(volume->is_open(around(placed(model, {15, 10, 4}))));
  EXPECT_FALSE(volume->is_open(around(placed(model, {22.5F, 10, 4}))));
  EXPECT_TRUE(volume->is_open(around(placed(model, {30, 10, 4}))));
}

TEST_F(Seen, below_ground_is_dead) {
  const Mesh mesh = test::hills(40);
  const ModelReader& model = model_of(mesh);
  Box box = model.model().tables.nodes[0].box;
  const float low = box.min.z;
  box.min.z -= box.size().x / 4, box.max.z += box.size().x / 4;
  const Result<ViewVolume> volume = survey_volume(model, box, 100000, monitor);
  ASSERT_TRUE(volume) << volume.error().message;
  const float step = volume->grid().step_m;
  const glm::vec2 middle = glm::vec2(box.center());
  EXPECT_FALSE(volume->is_open({glm::vec3(middle, box.min.z), glm::vec3(middle + step, low - 2 * step)}));
  EXPECT_TRUE(volume->is_open({glm::vec3(middle, box.max.z - step), glm::vec3(middle + step, box.max.z)}));
}

TEST_F(Seen, walkers_stand_near_surfaces) {
  Mesh mesh = ground();
  append(mesh, house({{10, 5, 0}, {20, 15, 8}}, false));
  const ModelReader& model = model_of(mesh);
  Result<ViewVolume> volume =
      survey_volume(model, {placed(model, {0, 0, 0}), placed(model, {40, 20, 20})}, 200000, monitor);
  ASSERT_TRUE(volume);
  volume->keep_walkable(2);
  EXPECT_TRUE(volume->is_open(around(placed(model, {30, 10, 1}))));
  EXPECT_FALSE(volume->is_open(around(placed(model, {30, 10, 4}))));
  EXPECT_TRUE(volume->is_open(around(placed(model, {15, 10, 9})))) << "on the roof";
  volume->keep_inside({{placed(model, {0, 0, 0}), placed(model, {5, 5, 5})}});
  EXPECT_FALSE(volume->is_open(around(placed(model, {30, 10, 1}))));
  EXPECT_TRUE(volume->is_open(around(placed(model, {2, 2, 1}))));
}

class SeenHills : public Seen {
 protected:
  void SetUp() override {
    model_of(test::hills(100));
    const Model& model = reader->model();
    const Box& box = model.tables.nodes[0].box;
    hiders.push_back(std::make_unique<HidesFar>(model, box.diagonal() / 20));
    options.cells = CellStyle::octree;
    options.cell_triangles = 500;
    options.smallest_cell_m = double(box.diagonal()) / 200;
    options.max_cells = 200;
  }
  std::vector<std::unique_ptr<Hider>> hiders;
  CellOptions options;
};

TEST_F(SeenHills, cells_see_their_front_less_what_is_hidden) {
  const Result<Visibility> made = seen_by(hiders, options);
  ASSERT_TRUE(made) << made.error().message;
  EXPECT_EQ(find_defect(made->cells), "");
  ASSERT_EQ(made->vlods.size(), made->cells.cells.size());
  EXPECT_GT(made->vlods.size(), 30U);
  EXPECT_LE(made->vlods.size(), 208U);
  const Model& model = reader->model();
  for (uint32_t i = 0; i < made->vlods.size(); ++i) {
    const Result<CellVlod> due = cell_vlod(model, hiders, made->cells.cells[i].box, bound_of(options));
    ASSERT_TRUE(due);
    const auto nodes = decoded(made->vlods[i], static_cast<uint32_t>(model.tables.nodes.size()));
    ASSERT_TRUE(nodes);
    EXPECT_EQ(*nodes, due->nodes);
    EXPECT_EQ(made->vlods[i].triangles, due->triangles);
    EXPECT_LT(due->nodes.size(), due->front_nodes);
  }
  EXPECT_EQ(made->figures.cells, made->vlods.size());
  EXPECT_GT(made->figures.front_triangles_mean, made->figures.vlod_triangles_mean);
}

TEST_F(SeenHills, are_the_same_on_any_number_of_threads) {
  const auto hash = [&](int threads) {
    std::filesystem::remove_all(folder.path() / "work");
    const Result<Visibility> made = seen_by(hiders, options, threads);
    uint64_t sum = 0;
    for (const CodedVlod& vlod : made->vlods) sum = checksum(vlod.ids, sum);
    for (const CellRecord& cell : made->cells.cells) sum = checksum(std::as_bytes(std::span(&cell.box, 1)), sum);
    return sum;
  };
  const uint64_t one = hash(1);
  EXPECT_EQ(hash(2), one);
  EXPECT_EQ(hash(4), one);
}

TEST_F(SeenHills, what_was_done_is_not_done_again) {
  ASSERT_TRUE(seen_by(hiders, options));
  const auto& far = dynamic_cast<const HidesFar&>(*hiders[0]);
  const int asked = far.asked;
  const Result<Visibility> again = seen_by(hiders, options);
  ASSERT_TRUE(again);
  EXPECT_EQ(far.asked, asked);
  EXPECT_EQ(again->figures.units.resumed, again->figures.units.total);
  options.pixel_error = 2;
  ASSERT_TRUE(seen_by(hiders, options));
  EXPECT_GT(far.asked, asked) << "other fronts";
}

TEST_F(SeenHills, without_hiders_cells_see_their_fronts) {
  const Result<Visibility> made = seen_by({}, options);
  ASSERT_TRUE(made);
  for (const CodedVlod& vlod : made->vlods) EXPECT_EQ(vlod.nodes, vlod.front_nodes);
  EXPECT_LE(made->vlods.size(), 208U);
}

TEST_F(SeenHills, a_hiders_failure_is_the_stages) {
  hiders.push_back(std::make_unique<Fails>());
  const Result<Visibility> made = seen_by(hiders, options);
  ASSERT_FALSE(made);
  EXPECT_THAT(made.error().message, HasSubstr("always fails"));
}

TEST_F(SeenHills, cells_in_boxes_only) {
  const DBox& world = reader->model().manifest.world_box;
  options.inside = {{world.min, world.center()}};
  const Result<Visibility> made = seen_by(hiders, options);
  ASSERT_TRUE(made);
  EXPECT_GT(made->vlods.size(), 0U);
  const glm::vec3 far = placed(*reader, world.max);
  EXPECT_EQ(cell_at(made->cells, far), std::nullopt);
}

// --- buildings ----------------------------------------------------------------------------------------------------

/// Two rooms of 4 x 4 x 3 m side by side behind walls of 0.2 m, with a door of 1 x 2 m between them.
Mesh two_rooms_one_door() {
  Mesh mesh;
  const auto wall = [&mesh](const glm::vec3& min, const glm::vec3& max) { append(mesh, house({min, max}, false)); };
  wall({0, 0, 0}, {8.6F, 4.4F, 0.2F});           // floor
  wall({0, 0, 3.2F}, {8.6F, 4.4F, 3.4F});        // ceiling
  wall({0, 0, 0.2F}, {0.2F, 4.4F, 3.2F});        // left
  wall({8.4F, 0, 0.2F}, {8.6F, 4.4F, 3.2F});     // right
  wall({0.2F, 0, 0.2F}, {8.4F, 0.2F, 3.2F});     // front
  wall({0.2F, 4.2F, 0.2F}, {8.4F, 4.4F, 3.2F});  // back
  wall({4.2F, 0.2F, 0.2F}, {4.4F, 1.7F, 3.2F});  // between, beside the door
  wall({4.2F, 2.7F, 0.2F}, {4.4F, 4.2F, 3.2F});
  wall({4.2F, 1.7F, 2.2F}, {4.4F, 2.7F, 3.2F});  // above it
  return mesh;
}

TEST_F(Seen, two_rooms_one_door_are_three_cells_and_the_door_is_their_portal) {
  const ModelReader& model = model_of(two_rooms_one_door());
  CellOptions options;
  options.cells = CellStyle::automatic;
  options.cell_triangles = 1 << 30;
  const Result<Visibility> made = seen_by({}, options);
  ASSERT_TRUE(made) << made.error().message;
  EXPECT_EQ(made->figures.style, CellStyle::kd);
  EXPECT_GT(made->figures.roofed_share, 0.5);
  const CellTables& tables = made->cells;
  EXPECT_EQ(find_defect(tables), "");
  const auto at = [&](const glm::dvec3& world) { return cell_at(tables, world - model.model().manifest.origin); };
  const auto left = at({2, 2, 1.5}), right = at({6, 2, 1.5}), door = at({4.3, 2.2, 1});
  ASSERT_TRUE(left && right && door);
  EXPECT_NE(*left, *right);
  EXPECT_NE(*left, *door);
  EXPECT_EQ(at({4.3, 1, 1}), std::nullopt) << "in the wall";
  EXPECT_EQ(at({4.3, 2.2, 3}), std::nullopt) << "above the door";
  EXPECT_EQ(at({2, 2, 3.3}), std::nullopt) << "in the ceiling";
  // A step may touch a wall's edge: cells that share but an edge are no neighbours.
  const auto portal = [&](CellId a, CellId b) -> std::optional<Box> {
    for (const uint32_t face : tables.faces_of(a))
      if (tables.faces[face].other(a) == b) return tables.portals_of(tables.faces[face])[0];
    return std::nullopt;
  };
  EXPECT_EQ(portal(*left, *right), std::nullopt);
  const std::optional<Box> opening = portal(*left, *door);
  ASSERT_TRUE(opening);
  EXPECT_NEAR(double(opening->size().y), 1, 2e-3);
  EXPECT_NEAR(double(opening->size().z), 2, 2e-3);
  EXPECT_TRUE(portal(*door, *right));
}

// --- the stage in a build -----------------------------------------------------------------------------------------

/// Stops the build at the n-th progress of a stage.
class StopAt : public JobMonitor {
 public:
  StopAt(std::string stage, int calls) : stage_(std::move(stage)), calls_(calls) {}
  void progress(std::string_view stage, uint64_t, uint64_t) override {
    if (stage == stage_ && --calls_ == 0) cancelled_ = true;
  }
  bool cancelled() const override { return cancelled_; }

 private:
  std::string stage_;
  std::atomic<int> calls_;
  std::atomic<bool> cancelled_ = false;
};

class BuildWithCells : public testing::Test {
 protected:
  void SetUp() override {
    options = small_build(folder.write("hills.obj", obj_text(test::hills(60))), folder.path() / "model.prom");
    options.visibility.cells = CellStyle::octree;
    options.visibility.cell_triangles = 100;
    options.visibility.smallest_cell_m = 1e-3;
    options.visibility.max_cells = 2000;
  }
  TemporaryFolder folder;
  BuildOptions options;
  JobMonitor monitor;
};

TEST_F(BuildWithCells, leaves_a_model_whose_cells_open) {
  const Result<BuildFigures> figures = build_model(options, monitor);
  ASSERT_TRUE(figures) << figures.error().message;
  const Result<ModelReader> reader = ModelReader::open(options.model);
  ASSERT_TRUE(reader) << reader.error().message;
  ASSERT_NE(reader->cells(), nullptr);
  EXPECT_EQ(reader->cells()->tables().cells.size(), figures->visibility.cells);
  EXPECT_GT(figures->bytes_by_part.at("cells"), 0U);
  EXPECT_TRUE(verify_checksums(*reader, monitor));
}

TEST_F(BuildWithCells, halves_from_which_the_same_is_seen_are_one_cell) {
  options.sources = {folder.write("plate.obj", obj_text(test::flat_grid(2, 9)))};
  const Result<BuildFigures> figures = build_model(options, monitor);
  ASSERT_TRUE(figures) << figures.error().message;
  EXPECT_EQ(figures->visibility.cells, 1U);
}

TEST_F(BuildWithCells, goes_on_after_an_interruption_and_gives_the_same_bytes) {
  ASSERT_TRUE(build_model(options, monitor));
  const auto due = bytes_of(options.model);
  std::filesystem::remove_all(options.model);
  for (const int calls : {1, 120}) {
    StopAt stop("visibility", calls);
    const Result<BuildFigures> stopped = build_model(options, stop);
    ASSERT_FALSE(stopped);
    EXPECT_THAT(stopped.error().message, HasSubstr("interrupted"));
    EXPECT_FALSE(std::filesystem::exists(options.model));
  }
  options.jobs = 1;
  const Result<BuildFigures> again = build_model(options, monitor);
  ASSERT_TRUE(again) << again.error().message;
  EXPECT_GT(again->units_resumed, 0U);
  EXPECT_EQ(bytes_of(options.model), due);
}

TEST_F(BuildWithCells, without_cells_there_is_no_file_for_them) {
  options.visibility.cells = CellStyle::none;
  ASSERT_TRUE(build_model(options, monitor));
  EXPECT_FALSE(std::filesystem::exists(options.model / "cells.bin"));
}

TEST_F(BuildWithCells, refuses_settings_out_of_range) {
  const auto error = [&] {
    const Result<BuildFigures> made = build_model(options, monitor);
    return made ? "" : made.error().message;
  };
  options.visibility.pixel_error = 0;
  EXPECT_THAT(error(), HasSubstr("--pixel-error 0"));
  options.visibility.pixel_error = 1, options.visibility.smallest_cell_m = -1;
  EXPECT_THAT(error(), HasSubstr("--smallest-cell -1"));
}

}  // namespace
}  // namespace promenade
