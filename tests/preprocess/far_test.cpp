// Far pictures as a build makes them, against rays through the source.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <cstdlib>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <optional>

#include "codec/far_mesh.h"
#include "geometry/cube_side.h"
#include "geometry/random.h"
#include "preprocess/far/far_build.h"
#include "preprocess/far/far_groups.h"
#include "preprocess/far/far_scene.h"
#include "preprocess/far/far_shape.h"
#include "tests/preprocess/build_fixtures.h"

namespace promenade {
namespace {

using testing::HasSubstr;

void add_box(Mesh& mesh, const glm::vec3& low, const glm::vec3& high) {
  const auto first = static_cast<uint32_t>(mesh.positions.size());
  for (uint32_t i = 0; i < 8; ++i)
    mesh.positions.emplace_back((i & 1U) != 0 ? high.x : low.x, (i & 2U) != 0 ? high.y : low.y,
                                (i & 4U) != 0 ? high.z : low.z);
  for (const uint32_t corner : {0U, 2U, 3U, 0U, 3U, 1U, 4U, 5U, 7U, 4U, 7U, 6U, 0U, 1U, 5U, 0U, 5U, 4U,
                                2U, 6U, 7U, 2U, 7U, 3U, 0U, 4U, 6U, 0U, 6U, 2U, 1U, 3U, 7U, 1U, 7U, 5U})
    mesh.indices.push_back(first + corner);
}

/// Towers of random heights on a plain of 400 m, around a square of 100 m that is free.
Mesh towers_around_a_square() {
  Random random(4);
  Mesh mesh;
  add_box(mesh, {-200, -200, -1}, {200, 200, 0});
  for (int x = -5; x < 5; ++x)
    for (int y = -5; y < 5; ++y) {
      const glm::vec3 at(float(x) * 40 + 8, float(y) * 40 + 8, 0);
      if (std::abs(at.x + 12) < 60 && std::abs(at.y + 12) < 60) continue;
      add_box(mesh, at, at + glm::vec3(24, 24, random.range(8.0F, 60.0F)));
    }
  return mesh;
}

class FarPictures : public testing::Test {
 protected:
  BuildOptions options(bool depth) {
    BuildOptions o = small_build(source, folder.path() / (depth ? "depth.prom" : "flat.prom"));
    o.far.pictures = true, o.far.depth = depth;
    o.far.bound_deg = depth ? 1.5 : 4, o.far.box_m = 120, o.far.side_px = 65;
    o.far.along = {{0, 0, 3}, {5, -8, 3}, {-14, 2, 20}};
    return o;
  }
  Result<ModelReader> built(const BuildOptions& o) {
    figures = build_model(o, monitor);
    EXPECT_TRUE(figures.ok()) << figures.error().message;
    Result<ModelReader> reader = ModelReader::open(o.model);
    EXPECT_TRUE(reader.ok()) << reader.error().message;
    return reader;
  }

  TemporaryFolder folder;
  Mesh mesh = towers_around_a_square();
  std::filesystem::path source = folder.write("towers.obj", obj_text(mesh));
  JobMonitor monitor;
  Result<BuildFigures> figures = BuildFigures{};
};

/// The first triangle that a ray meets beyond `from`, in lengths of the direction. from_front: whether at its front.
std::optional<double> first_hit(const Mesh& mesh, const glm::dvec3& origin, const glm::dvec3& direction, double from,
                                bool* from_front = nullptr) {
  std::optional<double> nearest;
  for (size_t t = 0; t < mesh.triangle_count(); ++t) {
    const glm::dvec3 a(mesh.positions[mesh.indices[3 * t]]), b(mesh.positions[mesh.indices[3 * t + 1]]),
        c(mesh.positions[mesh.indices[3 * t + 2]]);
    const glm::dvec3 e1 = b - a, e2 = c - a, p = glm::cross(direction, e2);
    const double det = glm::dot(e1, p);
    if (std::abs(det) < 1e-12) continue;
    const glm::dvec3 s = origin - a, q = glm::cross(s, e1);
    const double u = glm::dot(s, p) / det, v = glm::dot(direction, q) / det, at = glm::dot(e2, q) / det;
    constexpr double kRim = -1e-9;
    if (u < kRim || v < kRim || u + v > 1 - kRim || at < from) continue;
    if (nearest && at >= *nearest) continue;
    nearest = at;
    if (from_front != nullptr) *from_front = det > 0;
  }
  return nearest;
}

double angle(const glm::dvec3& a, const glm::dvec3& b) {
  return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
}

/// A cell with its sides as meshes.
struct DrawnCell {
  glm::dvec3 centre{0};
  FarShell shell;
  std::optional<Box> within;  ///< what is beyond it, another shell shows
  std::array<std::optional<Mesh>, 6> sides;
};

/// A side, with what it is told against if it is.
Result<FarFace> decoded_side(const ModelReader& reader, FarCellId id, uint32_t face) {
  const FarTables& tables = reader.far()->tables();
  const std::vector<std::byte> bytes = *reader.far()->read_face(face);
  const std::optional<std::array<int8_t, 3>> places = reference_of_far_face(bytes);
  if (!places) return decode_far_face(bytes);
  const glm::dvec3 steps((*places)[0], (*places)[1], (*places)[2]);
  const std::optional<FarCellId> key = far_cell_at(tables, cell_box(tables, id).center() + steps * tables.cell_m);
  if (!key) return Error{"there is no key"};
  std::array<FarFace, 6> sides;
  FarReference reference;
  reference.offset = offset_from_reference(*places, tables.cell_m, tables.box_m);
  const FarCellRecord& record = tables.cells[index_of(*key)];
  for (uint32_t i = record.first_face; i < record.first_face + record.face_count; ++i) {
    Result<FarFace> side = decode_far_face(*reader.far()->read_face(i));
    if (!side) return side.error();
    sides[tables.faces[i].side] = std::move(*side);
    reference.sides[tables.faces[i].side] = &sides[tables.faces[i].side];
  }
  return decode_far_face(bytes, tables.faces[face].side, &reference);
}

DrawnCell drawn_cell(const ModelReader& reader, FarCellId id) {
  const FarTables& tables = reader.far()->tables();
  DrawnCell cell;
  cell.centre = cell_box(tables, id).center();
  cell.shell = grid_place_of(tables, tables.cells[index_of(id)].place).grid;
  if (const std::vector<FarCellId> chain = chain_of(tables, id); chain.size() > 1)
    cell.within = near_box(tables, chain[1]);
  const FarCellRecord& record = tables.cells[index_of(id)];
  for (uint32_t i = record.first_face; i < record.first_face + record.face_count; ++i) {
    const Result<FarFace> face = decoded_side(reader, id, i);
    EXPECT_TRUE(face.ok());
    cell.sides[tables.faces[i].side] =
        far_mesh(*face, {cell.centre, cell.shell.box_m, tables.faces[i].side, tables.has_depth});
    EXPECT_EQ(cell.sides[tables.faces[i].side]->triangle_count(), tables.faces[i].triangles);
  }
  return cell;
}

/// Random points of the source beyond the box that are seen from the centre, random eyes in the cell: the smallest
/// angle between the point and what is drawn within a texel of its place in the picture.
class Audit {
 public:
  Audit(const ModelReader& reader, const Mesh& source)
      : reader_(reader), tables_(reader.far()->tables()), source_(source) {}

  void run(int points) {
    Random random(8);
    for (uint32_t i = 0; i < tables_.cells.size(); ++i) {
      const DrawnCell cell = drawn_cell(reader_, FarCellId{i});
      for (int k = 0; k < points; ++k) look(cell, random);
    }
  }

  int seen = 0, undrawn = 0, over = 0;
  double largest_rad = 0;

 private:
  void look(const DrawnCell& cell, Random& random) {
    const uint32_t side = random.below(6);
    const double texel = 2.0 / (1U << tables_.face_levels);
    const double x = random.range(-1.0, 1.0), y = random.range(-1.0, 1.0), half_box_m = cell.shell.box_m / 2;
    // The back of a triangle is the inside of what the box cuts: its near part hides it.
    bool from_front = false;
    const std::optional<double> hit = first_hit(source_, cell.centre, ray(side, x, y) * half_box_m, 1, &from_front);
    if (!hit || !from_front) return;
    const glm::dvec3 point = ray(side, x, y) * half_box_m * *hit;
    if (cell.within && !cell.within->contains(glm::vec3(cell.centre + point))) return;
    ++seen;
    const double half_cell_m = cell.shell.cell_m / 2;
    const glm::dvec3 eye(random.range(-half_cell_m, half_cell_m), random.range(-half_cell_m, half_cell_m),
                         random.range(-half_cell_m, half_cell_m));
    double least = 4;
    const auto compare = [&](double at_x, double at_y) {
      if (!cell.sides[side]) return;
      const std::optional<glm::dvec3> drawn =
          drawn_at(*cell.sides[side], std::clamp(at_x, -1.0, 1.0), std::clamp(at_y, -1.0, 1.0));
      if (drawn) least = std::min(least, angle(point - eye, *drawn - cell.centre - eye));
    };
    for (const double dx : {0.0, -texel, texel})
      for (const double dy : {0.0, -texel, texel}) compare(x + dx, y + dy);
    // The pixels around it. Where the box cuts a wall that leads away from the eye, one of them alone saw the wall.
    for (const double px : {std::floor(x / texel), std::ceil(x / texel)})
      for (const double py : {std::floor(y / texel), std::ceil(y / texel)}) compare(px * texel, py * texel);
    if (least > 3) {
      ++undrawn;
      return;
    }
    largest_rad = std::max(largest_rad, least);
    // A texel aside is seen under somewhat more than its own angle from an eye nearer to it.
    if (least > tables_.bound_rad + 1e-9) ++over;
  }

  /// Where a place of the picture is drawn, as renderers do: between corners, straight in space and in the texture.
  std::optional<glm::dvec3> drawn_at(const Mesh& mesh, double x, double y) const {
    const double side = (1U << tables_.face_levels) + 1, texels = side - 1;
    const glm::dvec2 at((texels * (1 + x) / 2 + 0.5) / side, (texels * (1 - y) / 2 + 0.5) / side);
    for (size_t t = 0; t < mesh.triangle_count(); ++t) {
      std::array<glm::dvec2, 3> uv;
      std::array<glm::dvec3, 3> p;
      for (size_t k = 0; k < 3; ++k) {
        uv[k] = glm::dvec2(mesh.texcoords[mesh.indices[3 * t + k]]);
        p[k] = glm::dvec3(mesh.positions[mesh.indices[3 * t + k]]);
      }
      const auto cross = [](const glm::dvec2& a, const glm::dvec2& b) { return a.x * b.y - a.y * b.x; };
      const double area = cross(uv[1] - uv[0], uv[2] - uv[0]);
      const double wa = cross(uv[1] - at, uv[2] - at) / area, wb = cross(uv[2] - at, uv[0] - at) / area,
                   wc = 1 - wa - wb;
      constexpr double kHair = -1e-6;
      if (wa >= kHair && wb >= kHair && wc >= kHair) return wa * p[0] + wb * p[1] + wc * p[2];
    }
    return std::nullopt;
  }

  static glm::dvec3 ray(uint32_t side, double x, double y) {
    const CubeSide axes = cube_side(side);
    return axes.forward + x * axes.right + y * axes.up;
  }

  const ModelReader& reader_;
  const FarTables& tables_;
  const Mesh& source_;
};

/// Points for each cell: PROMENADE_FAR_POINTS, for more than a test has time for.
int audit_points() {
  const char* wanted = std::getenv("PROMENADE_FAR_POINTS");
  return wanted != nullptr ? std::atoi(wanted) : 400;
}

/// Rays through a model's source against its far pictures, whose own figures keep the bound.
Audit audited(const ModelReader& reader, Mesh& source) {
  for (const FarCellRecord& cell : reader.far()->tables().cells)
    EXPECT_LE(double(cell.parallax_rad), reader.far()->tables().bound_rad);
  for (glm::vec3& p : source.positions) p -= glm::vec3(reader.model().manifest.origin);
  Audit audit(reader, source);
  audit.run(audit_points());
  EXPECT_GT(audit.seen, audit_points() / 8);
  EXPECT_EQ(audit.over, 0) << "of " << audit.seen << ", the worst " << glm::degrees(audit.largest_rad) << " degrees";
  return audit;
}

TEST_F(FarPictures, keep_the_bound_at_random_points_and_eyes_with_and_without_depth) {
  for (const bool depth : {false, true}) {
    const Result<ModelReader> reader = built(options(depth));
    ASSERT_TRUE(reader.ok());
    ASSERT_NE(reader->far(), nullptr);
    const FarTables& tables = reader->far()->tables();
    ASSERT_GE(tables.cells.size(), 2U);
    Mesh in_model = mesh;
    const Audit audit = audited(*reader, in_model);
    EXPECT_EQ(audit.undrawn, 0) << "of " << audit.seen;
    RecordProperty(depth ? "points_with_depth" : "points_flat", audit.seen);
    std::printf("%s: %d points, %.3f of %.3f degrees at most, cells of %.2f m\n", depth ? "depth" : "flat", audit.seen,
                glm::degrees(audit.largest_rad), glm::degrees(tables.bound_rad), tables.cell_m);
  }
}

TEST_F(FarPictures, of_several_shells_keep_the_bound_in_each_and_share_the_outer_ones) {
  for (const bool depth : {false, true}) {
    BuildOptions o = options(depth);
    o.far.shells = 2, o.far.box_m = 90, o.far.spacing_factor = 3;
    o.far.side_px = 129;  // rays fall between texels: these must be well below the bound
    const Result<ModelReader> reader = built(o);
    ASSERT_TRUE(reader.ok());
    const FarTables& tables = reader->far()->tables();
    ASSERT_EQ(tables.outer.size(), 1U);
    EXPECT_GE(tables.outer[0].times, 2U);
    ASSERT_EQ(figures->far.shells.size(), 2U);
    EXPECT_LE(figures->far.shells[1].cells, figures->far.shells[0].cells);
    EXPECT_GT(figures->far.shells[1].bytes, 0U);
    Mesh in_model = mesh;
    const Audit audit = audited(*reader, in_model);
    // Beside a tower that the box cuts, a sliver of it may be narrower than a texel: its node, drawn whole, shows it.
    EXPECT_LE(audit.undrawn, audit.seen / 2000) << "of " << audit.seen;
    std::printf("%s, 2 shells: %d points, %.3f of %.3f degrees at most, %zu cells\n", depth ? "depth" : "flat",
                audit.seen, glm::degrees(audit.largest_rad), glm::degrees(tables.bound_rad), tables.cells.size());
  }
}

TEST_F(FarPictures, with_depth_allow_larger_cells_at_the_same_bound) {
  BuildOptions o = options(true);
  const Result<ModelReader> deep = built(o);
  o = options(false), o.far.bound_deg = 1.5, o.far.cell_m = deep->far()->tables().cell_m;
  const Result<BuildFigures> flat = build_model(o, monitor);
  ASSERT_FALSE(flat.ok());
  EXPECT_THAT(flat.error().message, HasSubstr("--far-cell"));
}

TEST(FarShape, keeps_the_bound_where_two_sides_see_different_things_along_their_common_edge) {
  FarTables tables;
  tables.bound_rad = 0.02, tables.box_m = 100, tables.cell_m = 4, tables.face_levels = 4, tables.has_depth = true;
  const uint32_t pixels = 17;
  const auto draw = [&](float rim_m, std::optional<DrawnSide>& to) {
    DrawnSide& side = to.emplace();
    side.colors.width = side.colors.height = pixels;
    side.colors.pixels.resize(pixels * pixels, {90, 90, 90, 255});
    side.depth_m.resize(pixels * pixels, 500);
    for (uint32_t y = 0; y < pixels; ++y)
      for (const uint32_t x : {0U, pixels - 1}) {
        side.depth_m[y * pixels + x] = rim_m;
        if (rim_m < 500) side.colors.at(x, y) = {200, 0, 0, 255};
      }
  };
  std::array<std::optional<DrawnSide>, 6> sides;
  draw(500, sides[0]), draw(51, sides[2]);
  const ShapedFar shaped = shape_far(tables, std::move(sides));
  EXPECT_LE(shaped.parallax_rad, tables.bound_rad);
  uint32_t red = 0;
  for (const glm::u8vec4& p : shaped.faces[0]->colors.pixels) red += p.r == 200 ? 1U : 0U;
  EXPECT_EQ(red, pixels) << "the edge that the two share shows the nearer on both";
}

TEST(FarGroups, hold_each_place_once_the_key_in_the_middle) {
  FarTables tables;
  tables.counts = {7, 4, 5};
  std::vector<uint64_t> places;
  for (uint64_t place = 0; place < 7 * 4 * 5; ++place)
    if (place % 5 != 3) places.push_back(place);
  std::vector<uint64_t> seen;
  for (const FarGroup& group : far_groups(tables, places)) {
    ASSERT_FALSE(group.places.empty());
    const glm::ivec3 key(coordinates_of(tables, group.places[0]));
    for (const uint64_t place : group.places) {
      const glm::ivec3 steps = glm::abs(glm::ivec3(coordinates_of(tables, place)) - key);
      EXPECT_LT(std::max({steps.x, steps.y, steps.z}), int(kFarGroupCells));
      seen.push_back(place);
    }
  }
  std::sort(seen.begin(), seen.end());
  EXPECT_EQ(seen, places);
  const std::vector<uint64_t> row = {0, 1, 2};
  EXPECT_EQ(far_groups(tables, row)[0].places, (std::vector<uint64_t>{1, 0, 2}));
}

TEST_F(FarPictures, have_only_sides_that_see_something) {
  const Result<ModelReader> reader = built(options(true));
  const FarTables& tables = reader->far()->tables();
  for (const FarFaceRecord& face : tables.faces) EXPECT_LT(face.side, 4U) << "nothing is above, and the ground is near";
  EXPECT_EQ(tables.faces.size(), 4 * tables.cells.size());
}

TEST_F(FarPictures, are_the_same_bytes_at_any_thread_count_and_after_an_interruption) {
  BuildOptions o = options(true);
  const Result<ModelReader> two = built(o);
  const std::vector<std::byte> due = *read_file(o.model / "far.bin");
  std::filesystem::remove_all(o.model);
  o.jobs = 1;
  ASSERT_TRUE(built(o).ok());
  EXPECT_EQ(*read_file(o.model / "far.bin"), due);
  std::filesystem::remove_all(o.model);
  class Stop : public JobMonitor {
   public:
    void progress(std::string_view stage, uint64_t, uint64_t) override {
      stopped_ = stopped_ || stage == "far pictures";
    }
    bool cancelled() const override { return stopped_; }

   private:
    std::atomic<bool> stopped_ = false;
  } stop;
  EXPECT_FALSE(build_model(o, stop).ok());
  EXPECT_FALSE(std::filesystem::exists(o.model));
  ASSERT_TRUE(built(o).ok());
  EXPECT_GE(figures->far.units_resumed, 1U);
  EXPECT_EQ(*read_file(o.model / "far.bin"), due);
}

TEST_F(FarPictures, show_no_crack_where_sides_meet) {
  const Result<ModelReader> reader = built(options(true));
  const DrawnCell cell = drawn_cell(*reader, FarCellId{0});
  Mesh all;
  for (const std::optional<Mesh>& side : cell.sides)
    if (side) append(all, *side);
  // Upright edges between neighbouring sides, from random eyes in the cell: what is on both sides of an edge is on it.
  Random random(2);
  const double half_cell_m = reader->far()->tables().cell_m / 2;
  int checked = 0;
  for (int i = 0; i < 300; ++i) {
    const glm::dvec3 eye =
        cell.centre + glm::dvec3(random.range(-half_cell_m, half_cell_m), random.range(-half_cell_m, half_cell_m),
                                 random.range(-half_cell_m, half_cell_m));
    const double turn = glm::radians(45.0 + 90 * random.below(4)), up = random.range(-0.02, 0.08);
    const auto there = [&](double aside) {
      return first_hit(all, eye, {std::cos(turn + aside), std::sin(turn + aside), up}, 0).has_value();
    };
    if (!there(-0.2) || !there(0.2)) continue;
    for (double aside = -0.15; aside <= 0.15; aside += 0.003) {
      EXPECT_TRUE(there(aside)) << aside << " from edge " << glm::degrees(turn);
      ++checked;
    }
  }
  EXPECT_GT(checked, 1000);
}

TEST_F(FarPictures, told_against_neighbours_take_less_and_show_the_same_within_what_coding_loses) {
  for (const bool depth : {true, false}) {
    BuildOptions o = options(depth);
    o.far.side_px = 129, o.far.deltas = true;
    o.far.along = {{0, 0, 3}, {6, 0, 3}, {12, 0, 3}, {18, 0, 3}, {24, 0, 3}, {24, 6, 3}, {24, 12, 3}};
    const Result<ModelReader> told = built(o);
    const FarFigures told_figures = figures->far;
    EXPECT_GT(told_figures.faces_told, told_figures.faces / 4);
    o.far.deltas = false;
    o.model = folder.path() / "alone.prom";
    const Result<ModelReader> alone = built(o);
    EXPECT_EQ(figures->far.faces_told, 0U);
    EXPECT_LT(told_figures.bytes_mean, figures->far.bytes_mean);
    const FarTables& tables = told->far()->tables();
    ASSERT_EQ(tables.cells, alone->far()->tables().cells);
    for (uint32_t cell = 0; cell < tables.cells.size(); ++cell)
      for (uint32_t k = 0; k < tables.cells[cell].face_count; ++k) {
        const uint32_t face = tables.cells[cell].first_face + k;
        const Result<FarFace> a = decoded_side(*alone, FarCellId{cell}, face),
                              b = decoded_side(*told, FarCellId{cell}, face);
        ASSERT_TRUE(a.ok() && b.ok()) << (b.ok() ? a : b).error().message;
        EXPECT_EQ(a->depth, b->depth);
        double sum = 0, count = 0;
        for (size_t i = 0; i < a->colors.pixels.size(); ++i) {
          const glm::u8vec4 &p = a->colors.pixels[i], &q = b->colors.pixels[i];
          ASSERT_EQ(p.a, q.a);
          if (p.a == 0) continue;
          for (int c = 0; c < 3; ++c) sum += std::abs(double(p[c]) - double(q[c])), ++count;
        }
        EXPECT_LT(sum / count, 4);
      }
  }
}

TEST_F(FarPictures, added_to_a_model_are_those_of_its_build) {
  const BuildOptions o = options(true);
  ASSERT_TRUE(built(o).ok());
  const std::vector<std::byte> due = *read_file(o.model / "far.bin");
  BuildOptions without = o;
  without.far.pictures = false, without.model = folder.path() / "later.prom";
  ASSERT_TRUE(built(without).ok());
  const Result<FarFigures> added = add_far_pictures(without.model, o.far, without.memory_bytes, 1, monitor);
  ASSERT_TRUE(added.ok()) << added.error().message;
  const Result<ModelReader> reader = ModelReader::open(without.model);
  ASSERT_TRUE(reader.ok()) << reader.error().message;
  EXPECT_EQ(reader->model().manifest.settings.at("far-bound"), "1.5");
  EXPECT_EQ(*read_file(without.model / "far.bin"), due);
  EXPECT_TRUE(verify_checksums(*reader, monitor));
  EXPECT_FALSE(std::filesystem::exists(without.model.string() + ".work"));
  // Once more, in place of those.
  FarOptions flat = options(false).far;
  ASSERT_TRUE(add_far_pictures(without.model, flat, without.memory_bytes, 2, monitor).ok());
  EXPECT_FALSE(ModelReader::open(without.model)->far()->tables().has_depth);
  EXPECT_FALSE(add_far_pictures(folder.path() / "none.prom", flat, without.memory_bytes, 1, monitor).ok());
}

TEST_F(FarPictures, refuse_what_cannot_be) {
  const auto error_of = [this](auto change) {
    BuildOptions o = options(true);
    change(o.far);
    const Result<BuildFigures> made = build_model(o, monitor);
    return made.ok() ? std::string() : made.error().message;
  };
  EXPECT_THAT(error_of([](FarOptions& f) { f.bound_deg = 0; }), HasSubstr("--far-bound"));
  EXPECT_THAT(error_of([](FarOptions& f) { f.bound_deg = std::nan(""); }), HasSubstr("--far-bound"));
  EXPECT_THAT(error_of([](FarOptions& f) { f.box_m = 1000; }), HasSubstr("--far-box"));
  EXPECT_THAT(error_of([](FarOptions& f) { f.cell_m = 60; }), HasSubstr("--far-cell"));
  EXPECT_THAT(error_of([](FarOptions& f) { f.shells = 9; }), HasSubstr("--far-shells"));
  EXPECT_THAT(error_of([](FarOptions& f) { f.shells = 3, f.spacing_factor = 2; }), HasSubstr("--far-shells"));
  EXPECT_THAT(error_of([](FarOptions& f) { f.spacing_factor = 0.5; }), HasSubstr("--far-factor"));
  EXPECT_THAT(error_of([](FarOptions& f) { f.side_px = 64; }), HasSubstr("--far-side"));
  EXPECT_THAT(error_of([](FarOptions& f) { f.jpeg_quality = 101; }), HasSubstr("--far-quality"));
  EXPECT_THAT(error_of([](FarOptions& f) { f.along = {{1e6, 0, 0}}; }), HasSubstr("--far-path"));
  EXPECT_THAT(error_of([](FarOptions& f) { f.along.clear(), f.max_cells = 3; }), HasSubstr("--far-max-cells 3"));
}

}  // namespace
}  // namespace promenade
