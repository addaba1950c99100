#include "layout/far_io.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <utility>

#include <cmath>
#include <fstream>

#include "layout/model_io.h"
#include "tests/layout/model_fixtures.h"
#include "tests/temporary_folder.h"

namespace promenade {
namespace {

using testing::HasSubstr;

constexpr CellsOwner kOwner{0x1122334455667788U, 100};

std::vector<std::byte> some_bytes(size_t count, int first) {
  std::vector<std::byte> bytes(count);
  for (size_t i = 0; i < count; ++i) bytes[i] = std::byte(first + int(i));
  return bytes;
}

/// A grid of 4 x 3 x 2 cells of 10 m, whose boxes have 100 m.
FarTables grid() {
  FarTables tables;
  tables.bound_rad = 0.02, tables.box_m = 100, tables.cell_m = 10;
  tables.origin = {-20, 0, 5}, tables.counts = {4, 3, 2};
  tables.face_levels = 3, tables.has_depth = true;
  return tables;
}

/// Three cells, in two batches; the second sees nothing.
FarCellSource three_far_cells() {
  auto batch = std::make_shared<int>(0);
  return [batch]() -> Result<std::vector<StoredFarCell>> {
    switch ((*batch)++) {
      case 0:
        return std::vector<StoredFarCell>{{2, 0.01F, {{0, 2, some_bytes(9, 1)}, {3, 7, some_bytes(30, 50)}}},
                                          {5, 0, {}}};
      case 1:
        return std::vector<StoredFarCell>{{23, 0.015F, {{5, 128, some_bytes(3, 90)}}}};
      default:
        return std::vector<StoredFarCell>{};
    }
  };
}

class FarIo : public testing::Test {
 protected:
  void SetUp() override {
    const Result<uint64_t> bytes = write_far(path, grid(), kOwner, three_far_cells());
    ASSERT_TRUE(bytes) << bytes.error().message;
  }
  std::string error_of(std::span<const std::byte> bytes) {
    const auto changed = folder.path() / "changed.bin";
    // Not synced: there are many.
    std::ofstream(changed, std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()), std::streamsize(bytes.size()));
    const Result<FarReader> reader = FarReader::open(changed, kOwner);
    if (!reader) return reader.error().message;
    for (uint32_t i = 0; i < reader->tables().faces.size(); ++i)
      if (const auto face = reader->read_face(i); !face) return face.error().message;
    return "";
  }

  TemporaryFolder folder;
  std::filesystem::path path = folder.path() / "far.bin";
};

TEST_F(FarIo, come_back) {
  const Result<FarReader> reader = FarReader::open(path, kOwner);
  ASSERT_TRUE(reader) << reader.error().message;
  const FarTables& t = reader->tables();
  EXPECT_EQ(t.bound_rad, 0.02);
  EXPECT_EQ(t.origin, grid().origin);
  EXPECT_EQ(t.counts, grid().counts);
  EXPECT_TRUE(t.has_depth);
  ASSERT_EQ(t.cells.size(), 3U);
  EXPECT_EQ(t.cells[2].parallax_rad, 0.015F);
  ASSERT_EQ(t.faces.size(), 3U);
  EXPECT_EQ(*reader->read_face(1), some_bytes(30, 50));
  EXPECT_EQ(*reader->read_face(2), some_bytes(3, 90));
}

TEST_F(FarIo, finds_cells_by_points) {
  const Result<FarReader> reader = FarReader::open(path, kOwner);
  const FarTables& t = reader->tables();
  EXPECT_EQ(far_cell_at(t, {1, 1, 6}), FarCellId{0});  // place 2
  EXPECT_EQ(far_cell_at(t, {-9, 11, 5}), FarCellId{1});
  EXPECT_EQ(far_cell_at(t, {19, 29, 24.9}), FarCellId{2});
  EXPECT_EQ(far_cell_at(t, {-19, 1, 6}), std::nullopt) << "a place without a cell";
  for (const glm::dvec3& outside : {glm::dvec3(-20.1, 1, 6), glm::dvec3(20, 1, 6), glm::dvec3(1, 1, std::nan("")),
                                    glm::dvec3(1e300, 1, 6), glm::dvec3(1, -1e300, 6)})
    EXPECT_EQ(far_cell_at(t, outside), std::nullopt);
  EXPECT_EQ(cell_box(t, FarCellId{0}).min, glm::dvec3(0, 0, 5));
  EXPECT_EQ(near_box(t, FarCellId{0}).max, glm::vec3(55, 55, 60));
}

TEST_F(FarIo, refuses_every_truncation_and_every_changed_byte) {
  const std::vector<std::byte> bytes = *read_file(path);
  for (size_t size = 0; size < bytes.size(); ++size) EXPECT_NE(error_of(std::span(bytes).first(size)), "") << size;
  for (size_t at = 0; at < bytes.size(); ++at) {
    std::vector<std::byte> changed = bytes;
    changed[at] ^= std::byte{0x41};
    const std::string error = error_of(changed);
    // Zeros between sections are not checked; they mean nothing.
    if (bytes[at] != std::byte{0}) {
      EXPECT_NE(error, "") << at;
    }
  }
  std::vector<std::byte> longer = bytes;
  longer.push_back(std::byte{0});
  EXPECT_THAT(error_of(longer), HasSubstr("follow"));
}

TEST_F(FarIo, of_another_build_are_refused) {
  const Result<FarReader> reader = FarReader::open(path, {kOwner.tables_checksum, 101});
  ASSERT_FALSE(reader);
  EXPECT_THAT(reader.error().message, HasSubstr("not of one build"));
}

/// Around the grid: 2 x 2 x 1 cells of 20 m, around these one of 60 m.
FarTables three_shells() {
  FarTables tables = grid();
  tables.outer = {{250, 2}, {600, 3}};
  return tables;
}

TEST(FarTables, of_several_shells_nest_every_cell_in_one_of_the_next) {
  const FarTables t = three_shells();
  const std::vector<FarShell> shells = shells_of(t);
  ASSERT_EQ(shells.size(), 3U);
  EXPECT_EQ(shells[1].counts, glm::uvec3(2, 2, 1));
  EXPECT_EQ(shells[2].cell_m, 60);
  EXPECT_EQ(shells[2].first_place, 28U);
  EXPECT_EQ(place_around(t, 0), 24U);
  EXPECT_EQ(place_around(t, 23), 27U);
  EXPECT_EQ(place_around(t, 27), 28U);
  EXPECT_EQ(place_around(t, 28), std::nullopt);
  for (uint64_t place = 0; place < 28; ++place) {
    const DBox within = box_of_place(t, place), around = box_of_place(t, *place_around(t, place));
    EXPECT_TRUE(around.grown(1e-9).contains(within)) << place;
  }
  EXPECT_EQ(grid_place_of(t, 27).at, glm::uvec3(1, 1, 0));
}

TEST(FarTables, of_several_shells_come_back_and_chain) {
  const TemporaryFolder folder;
  bool given = false;
  const FarCellSource cells = [&given]() -> Result<std::vector<StoredFarCell>> {
    if (std::exchange(given, true)) return std::vector<StoredFarCell>{};
    return std::vector<StoredFarCell>{{28, 0, {{1, 2, some_bytes(4, 1)}}}, {25, 0, {}}, {2, 0.01F, {}}};
  };
  ASSERT_TRUE(write_far(folder.path() / "far.bin", three_shells(), kOwner, cells));
  const Result<FarReader> reader = FarReader::open(folder.path() / "far.bin", kOwner);
  ASSERT_TRUE(reader) << reader.error().message;
  const FarTables& t = reader->tables();
  EXPECT_EQ(t.outer, three_shells().outer);
  EXPECT_EQ(far_cell_at(t, {1, 1, 6}), FarCellId{0}) << "of the innermost shell";
  EXPECT_EQ(chain_of(t, FarCellId{0}), (std::vector<FarCellId>{FarCellId{0}, FarCellId{1}, FarCellId{2}}));
  EXPECT_EQ(near_box(t, FarCellId{2}).min, glm::vec3(10 - 300, 30 - 300, 35 - 300));
}

TEST(FarTables, of_several_shells_with_a_defect_are_told) {
  const auto defect = [](auto change) {
    FarTables t = three_shells();
    t.cells = {{2, 0, 0, 0.1F}, {25, 0, 0, 0}, {28, 0, 0, 0}};
    change(t);
    return find_defect(t);
  };
  EXPECT_EQ(defect([](FarTables&) {}), "");
  EXPECT_NE(defect([](FarTables& t) { t.outer[0].times = 0; }), "");
  EXPECT_NE(defect([](FarTables& t) { t.outer[1].times = 100; }), "") << "cells as large as their box";
  EXPECT_NE(defect([](FarTables& t) { t.outer[1].box_m = 250; }), "");
  EXPECT_NE(defect([](FarTables& t) { t.outer[1].box_m = std::nan(""); }), "");
  EXPECT_NE(defect([](FarTables& t) { t.outer.assign(8, {1e9, 1}); }), "");
  EXPECT_NE(defect([](FarTables& t) { t.cells[1].place = 24; }), "") << "nothing around the first";
  EXPECT_NE(defect([](FarTables& t) { t.cells.pop_back(); }), "");
  EXPECT_NE(defect([](FarTables& t) { t.cells[2].place = 29; }), "");
}

TEST(FarTables, with_a_defect_are_told) {
  const auto defect = [](auto change) {
    FarTables t = grid();
    t.cells = {{1, 0, 1, 0.1F}, {4, 1, 2, 0}};
    t.faces = {{200, 4, 0, 2, 1}, {204, 4, 1, 2, 1}, {208, 4, 4, 2, 1}};
    change(t);
    return find_defect(t);
  };
  EXPECT_EQ(defect([](FarTables&) {}), "");
  EXPECT_NE(defect([](FarTables& t) { t.cell_m = t.box_m; }), "");
  EXPECT_NE(defect([](FarTables& t) { t.box_m = std::nan(""); }), "");
  EXPECT_NE(defect([](FarTables& t) { t.bound_rad = 0; }), "");
  EXPECT_NE(defect([](FarTables& t) { t.origin.y = INFINITY; }), "");
  EXPECT_NE(defect([](FarTables& t) { t.counts = {0xffffffffU, 0xffffffffU, 0xffffffffU}; }), "");
  EXPECT_NE(defect([](FarTables& t) { t.counts.z = 0; }), "");
  EXPECT_NE(defect([](FarTables& t) { t.face_levels = 11; }), "");
  EXPECT_NE(defect([](FarTables& t) { t.cells[1].place = 1; }), "");
  EXPECT_NE(defect([](FarTables& t) { t.cells[1].place = 24; }), "");
  EXPECT_NE(defect([](FarTables& t) { t.cells[1].first_face = 2; }), "");
  EXPECT_NE(defect([](FarTables& t) { t.cells[1].face_count = 3; }), "");
  EXPECT_NE(defect([](FarTables& t) { t.cells[1].face_count = 1; }), "");
  EXPECT_NE(defect([](FarTables& t) { t.cells[0].parallax_rad = std::nanf(""); }), "");
  EXPECT_NE(defect([](FarTables& t) { t.faces[2].side = 1; }), "");
  EXPECT_NE(defect([](FarTables& t) { t.faces[2].side = 6; }), "");
  EXPECT_NE(defect([](FarTables& t) { t.faces[0].triangles = 129; }), "");
}

TEST(ModelWithFar, comes_back_and_is_verified) {
  TemporaryFolder folder;
  const auto path = folder.path() / "m.prom";
  {
    Result<ModelWriter> writer = ModelWriter::create(path);
    ASSERT_TRUE(writer);
    ASSERT_TRUE(append_squares(*writer));
    ASSERT_TRUE(writer->stage(root_and_two_leaves(), manifest_of_squares()));
    ASSERT_TRUE(writer->add_far(grid(), three_far_cells()));
    ASSERT_TRUE(writer->publish());
  }
  const Result<ModelReader> reader = ModelReader::open(path);
  ASSERT_TRUE(reader) << reader.error().message;
  ASSERT_NE(reader->far(), nullptr);
  EXPECT_EQ(reader->far()->tables().cells.size(), 3U);
  JobMonitor monitor;
  EXPECT_TRUE(verify_checksums(*reader, monitor));
  std::vector<std::byte> bytes = *read_file(path / "far.bin");
  bytes[reader->far()->tables().faces[1].offset] ^= std::byte{1};
  ASSERT_TRUE(write_file(path / "far.bin", bytes));
  const Result<ModelReader> damaged = ModelReader::open(path);
  ASSERT_TRUE(damaged);
  EXPECT_FALSE(verify_checksums(*damaged, monitor));
}

}  // namespace
}  // namespace promenade
