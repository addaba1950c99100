#include "layout/cells_io.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "codec/frame.h"
#include "layout/cell_faces.h"
#include "layout/cells_codec.h"
#include "layout/model_io.h"
#include "tests/layout/cell_fixtures.h"
#include "tests/layout/model_fixtures.h"
#include "tests/temporary_folder.h"

namespace promenade {
namespace {

using testing::ElementsAre, testing::HasSubstr, testing::IsEmpty;

constexpr CellsOwner kOwner{0x1122334455667788U, 100};

std::vector<NodeId> nodes(const std::vector<uint32_t>& ids) {
  std::vector<NodeId> result;
  result.reserve(ids.size());
  for (const uint32_t id : ids) result.push_back(NodeId{id});
  return result;
}

Result<std::vector<NodeId>> vlod_of_three(CellId cell) {
  const std::vector<std::vector<uint32_t>> sets = {{}, {3, 4, 5, 6, 50, 51, 90, 99}, {3, 4, 5, 6, 50, 90, 99}};
  return nodes(sets[index_of(cell)]);
}

class CellsIo : public testing::Test {
 protected:
  void SetUp() override { ASSERT_TRUE(write_cells(path, three_cells(), kOwner, flat_forest(100), vlod_of_three)); }
  std::string error_of(std::span<const std::byte> bytes) {
    const auto changed = folder.path() / "changed.bin";
    EXPECT_TRUE(write_file(changed, bytes));
    const Result<CellsReader> reader = CellsReader::open(changed, kOwner, flat_forest(100));
    if (!reader) return reader.error().message;
    for (uint32_t i = 0; i < 3; ++i)
      if (const Result<Vlod> vlod = reader->read_vlod(CellId{i}); !vlod) return vlod.error().message;
    return "";
  }

  TemporaryFolder folder;
  std::filesystem::path path = folder.path() / "cells.bin";
};

TEST_F(CellsIo, come_back) {
  const Result<CellsReader> reader = CellsReader::open(path, kOwner, flat_forest(100));
  ASSERT_TRUE(reader) << reader.error().message;
  const CellTables due = three_cells();
  EXPECT_EQ(reader->tables().bound, due.bound);
  EXPECT_EQ(reader->tables().box, due.box);
  EXPECT_EQ(reader->tables().tree, due.tree);
  EXPECT_EQ(reader->tables().cells, due.cells);
  EXPECT_EQ(reader->tables().faces, due.faces);
  EXPECT_EQ(reader->tables().faces_of_cells, due.faces_of_cells);
  EXPECT_EQ(reader->tables().portals, due.portals);
  for (uint32_t i = 0; i < 3; ++i) {
    const Result<Vlod> vlod = reader->read_vlod(CellId{i});
    ASSERT_TRUE(vlod) << vlod.error().message;
    EXPECT_EQ(vlod->nodes, *vlod_of_three(CellId{i}));
  }
}

TEST_F(CellsIo, neighbours_are_read_together) {
  const Result<CellsReader> reader = CellsReader::open(path, kOwner, flat_forest(100));
  ASSERT_TRUE(reader);
  ASSERT_EQ(reader->blocks().size(), 1U);
  EXPECT_EQ(reader->blocks()[0].cells, 3U);
  EXPECT_EQ(reader->vlod_nodes(CellId{2}), 7U);
  EXPECT_EQ(reader->read_vlod(CellId{2})->bytes_read, reader->blocks()[0].stored_bytes);
  EXPECT_EQ(reader->read_vlod(CellId{1})->bytes_read, 0U) << "it came along";
}

TEST_F(CellsIo, nodes_keep_their_ids_whatever_their_place_in_the_tree) {
  NodeForest forest;
  // Node 2 is the root of 0 and 4, node 3 of 1.
  forest.by_rank.subtree_end = {3, 2, 3, 5, 5};
  forest.node_of_rank = {2, 4, 0, 3, 1};
  const CellsOwner owner{kOwner.tables_checksum, 5};
  const auto vlod_of = [](CellId cell) -> Result<std::vector<NodeId>> {
    const std::vector<std::vector<uint32_t>> sets = {{2, 3}, {0, 3, 4}, {0, 1, 4}};
    return nodes(sets[index_of(cell)]);
  };
  const auto other = folder.path() / "other.bin";
  ASSERT_TRUE(write_cells(other, three_cells(), owner, forest, vlod_of));
  const Result<CellsReader> reader = CellsReader::open(other, owner, forest);
  ASSERT_TRUE(reader) << reader.error().message;
  for (uint32_t i = 0; i < 3; ++i) EXPECT_EQ(reader->read_vlod(CellId{i})->nodes, *vlod_of(CellId{i}));
  const auto with_ancestor = [](CellId) -> Result<std::vector<NodeId>> { return nodes({0, 2}); };
  EXPECT_FALSE(write_cells(other, three_cells(), owner, forest, with_ancestor));
}

TEST_F(CellsIo, every_truncation_is_an_error) {
  const auto whole = *read_file(path);
  for (size_t size = 0; size < whole.size(); ++size)
    EXPECT_NE(error_of(std::span(whole).first(size)), "") << size << " bytes";
}

TEST_F(CellsIo, every_changed_byte_is_an_error) {
  auto whole = *read_file(path);
  for (size_t i = 0; i < whole.size(); ++i) {
    whole[i] ^= std::byte{0x10};
    const std::string error = error_of(whole);
    // Zeros that fill up to a multiple of 8 mean nothing.
    if (error.empty()) {
      EXPECT_EQ(whole[i], std::byte{0x10}) << "byte " << i;
    }
    whole[i] ^= std::byte{0x10};
  }
}

TEST_F(CellsIo, faces_that_follow_from_the_boxes_take_no_bytes_and_others_come_back) {
  CellsFile file{kOwner, three_cells(), {1, 1, 1}, {{312, 1, 3, 0}}};
  ASSERT_TRUE(faces_follow(file.tables));
  const auto back = [](const CellsFile& f) {
    const EncodedCells encoded = encode_cells(f, 320);
    const Result<CellsFile> read = decode_cells(encoded.header, encoded.sections, 320 + encoded.sections.size());
    EXPECT_TRUE(read) << read.error().message;
    EXPECT_EQ(read->tables.faces, f.tables.faces);
    EXPECT_EQ(read->tables.portals, f.tables.portals);
    EXPECT_EQ(read->tables.cells, f.tables.cells);
    return encoded.sections.size();
  };
  const size_t without = back(file);
  file.tables.portals[1].max.z = 1;  // a low window
  ASSERT_FALSE(faces_follow(file.tables));
  EXPECT_GT(back(file), without);
}

TEST_F(CellsIo, more_neighbours_than_cells_have_are_refused) {
  // Two hundred slabs under two hundred that cross them: each touches each.
  constexpr uint32_t kSlabs = 200;
  CellTables tables;
  tables.bound = one_pixel();
  tables.box = {{0, 0, 0}, {kSlabs, kSlabs, 2}};
  tables.tree = {{2, 1, 1, 2}, {}, {}};
  for (const uint32_t side : {0U, 1U}) {
    uint32_t at = 1 + side;
    for (uint32_t i = 0; i < kSlabs; ++i) {
      Box box = tables.box;
      const int axis = int(side);
      box.min[axis] = float(i), box.max[axis] = float(i + 1);
      box.min.z = float(side), box.max.z = float(side + 1);
      const auto cell = static_cast<uint32_t>(tables.cells.size()), next = static_cast<uint32_t>(tables.tree.size());
      tables.cells.push_back({box});
      if (i + 1 == kSlabs) {
        tables.tree[at] = {CellTreeNode::kLeaf, 0, cell, 0};
        break;
      }
      tables.tree[at] = {side, float(i + 1), next, next + 1};
      tables.tree.push_back({CellTreeNode::kLeaf, 0, cell, 0});
      tables.tree.emplace_back();
      at = next + 1;
    }
  }
  ASSERT_THAT(find_defect(tables), IsEmpty());
  const Status found = find_faces(tables);
  ASSERT_FALSE(found);
  EXPECT_THAT(found.error().message, HasSubstr("too many neighbours"));
}

TEST_F(CellsIo, trailing_byte_is_an_error) {
  auto whole = *read_file(path);
  whole.push_back(std::byte{0});
  EXPECT_THAT(error_of(whole), HasSubstr("1 bytes follow"));
}

TEST_F(CellsIo, tables_of_many_cells_take_a_part_of_their_bytes) {
  CellsFile file{kOwner, {}, {}, {}};
  for (int i = 0; i < 1000; ++i) file.tables.portals.push_back({{float(i), 0, 0}, {float(i), 2, 3}});
  const EncodedCells encoded = encode_cells(file, 320);
  EXPECT_LT(encoded.sections.size(), 1000 * 24 / 3);
}

TEST_F(CellsIo, a_frame_that_claims_too_much_takes_no_memory) {
  // A frame of 256 MiB of zeros in place of the tables, under a sound checksum of the header.
  CellsFile file{kOwner, three_cells(), {1, 1, 1}, {{312, 1, 2, 0}, {312, 1, 1, 0}}};
  const EncodedCells encoded = encode_cells(file, 320);
  const std::vector<std::byte> bomb = compress_frame(std::vector<std::byte>(size_t(1) << 28), 1);
  const auto result = decode_cells(encoded.header, bomb, 320 + bomb.size());
  ASSERT_FALSE(result);
  EXPECT_THAT(result.error().message, HasSubstr("claims"));
}

TEST_F(CellsIo, another_version_and_other_files_are_told) {
  auto whole = *read_file(path);
  whole[8] = std::byte{9};
  EXPECT_THAT(error_of(whole), HasSubstr("version 9"));
  whole[0] = std::byte{'X'};
  EXPECT_THAT(error_of(whole), HasSubstr("no cells of a model"));
}

TEST_F(CellsIo, cells_of_another_build_are_told) {
  const Result<CellsReader> reader =
      CellsReader::open(path, {kOwner.tables_checksum + 1, kOwner.nodes}, flat_forest(100));
  ASSERT_FALSE(reader);
  EXPECT_THAT(reader.error().message, HasSubstr("not of one build"));
}

TEST_F(CellsIo, unsound_cells_with_sound_checksums_are_told) {
  const auto decoded = [](const std::function<void(CellsFile&)>& change) {
    CellsFile file{kOwner, three_cells(), {1, 1, 1}, {{312, 1, 2, 0}, {312, 1, 1, 0}}};
    change(file);
    const EncodedCells encoded = encode_cells(file, 320);
    const auto result = decode_cells(encoded.header, encoded.sections, 320 + encoded.sections.size());
    return result ? "" : result.error().message;
  };
  EXPECT_THAT(decoded([](CellsFile&) {}), IsEmpty());
  EXPECT_THAT(decoded([](CellsFile& f) { f.tables.tree[2].below = 0; }), HasSubstr("tree node 2"));
  EXPECT_THAT(decoded([](CellsFile& f) { f.vlod_nodes.pop_back(); }), HasSubstr("3 cells with 2 vLODs"));
  EXPECT_THAT(decoded([](CellsFile& f) { f.vlod_nodes[1] = 101; }), HasSubstr("vLOD 1: 101 of 100 nodes"));
  EXPECT_THAT(decoded([](CellsFile& f) { f.blocks[0].offset = 311; }), HasSubstr("vLOD block 0"));
  EXPECT_THAT(decoded([](CellsFile& f) { f.blocks[0].stored_bytes = 9; }), HasSubstr("vLOD block 0"));
  EXPECT_THAT(decoded([](CellsFile& f) { f.blocks[1].cells = 2; }), HasSubstr("vLOD block 1: 2 cells, at most 1"));
  EXPECT_THAT(decoded([](CellsFile& f) { f.blocks[1].cells = 0; }), HasSubstr("vLOD block 1: 0 cells"));
  EXPECT_THAT(decoded([](CellsFile& f) { f.blocks.pop_back(); }), HasSubstr("hold 2 of 3 cells"));
}

TEST_F(CellsIo, sets_that_do_not_ascend_are_refused) {
  const auto twice = [](CellId) -> Result<std::vector<NodeId>> { return nodes({4, 4}); };
  EXPECT_FALSE(write_cells(folder.path() / "other.bin", three_cells(), kOwner, flat_forest(100), twice));
  const auto beyond = [](CellId) -> Result<std::vector<NodeId>> { return nodes({100}); };
  EXPECT_FALSE(write_cells(folder.path() / "other.bin", three_cells(), kOwner, flat_forest(100), beyond));
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "other.bin"));
}

TEST(ModelWithCells, opens_with_them_and_only_with_its_own) {
  const TemporaryFolder folder;
  const auto model = folder.path() / "squares.prom";
  Result<ModelWriter> writer = ModelWriter::create(model);
  ASSERT_TRUE(writer);
  ASSERT_TRUE(append_squares(*writer));
  ASSERT_TRUE(writer->stage(root_and_two_leaves(), manifest_of_squares()));
  EXPECT_TRUE(ModelReader::open(writer->staged_folder())) << "a whole model, if not under its name";
  const auto vlod_of = [](CellId) -> Result<std::vector<NodeId>> { return nodes({1, 2}); };
  ASSERT_TRUE(writer->add_cells(three_cells(), vlod_of));
  ASSERT_TRUE(writer->publish());
  const Result<ModelReader> reader = ModelReader::open(model);
  ASSERT_TRUE(reader) << reader.error().message;
  ASSERT_NE(reader->cells(), nullptr);
  EXPECT_EQ(reader->cells()->tables().cells.size(), 3U);
  EXPECT_THAT(reader->cells()->read_vlod(CellId{1})->nodes, ElementsAre(NodeId{1}, NodeId{2}));
  JobMonitor monitor;
  EXPECT_TRUE(verify_checksums(*reader, monitor));

  const auto other = folder.path() / "other.prom";
  ASSERT_TRUE(write_squares(other));
  EXPECT_EQ(ModelReader::open(other)->cells(), nullptr);
  std::filesystem::remove(model / "cells.bin");
  const Result<ModelReader> without = ModelReader::open(model);
  ASSERT_FALSE(without);
  EXPECT_THAT(without.error().message, HasSubstr("cells.bin"));
}

TEST(ModelWithCells, has_its_meshes_in_the_order_that_was_asked_for) {
  const TemporaryFolder folder;
  const auto model = folder.path() / "squares.prom", plain = folder.path() / "plain.prom";
  ASSERT_TRUE(write_squares(plain));
  Result<ModelWriter> writer = ModelWriter::create(model);
  ASSERT_TRUE(writer);
  ASSERT_TRUE(append_squares(*writer));
  ASSERT_TRUE(writer->stage(root_and_two_leaves(), manifest_of_squares()));
  EXPECT_FALSE(writer->reorder(std::vector<uint32_t>{2, 0})) << "a mesh is missing";
  ASSERT_TRUE(writer->reorder(std::vector<uint32_t>{2, 0, 1}));
  const auto vlod_of = [](CellId) -> Result<std::vector<NodeId>> { return nodes({1, 2}); };
  ASSERT_TRUE(writer->add_cells(three_cells(), vlod_of));
  ASSERT_TRUE(writer->publish());
  const Result<ModelReader> reader = ModelReader::open(model), before = ModelReader::open(plain);
  ASSERT_TRUE(reader) << reader.error().message;
  ASSERT_TRUE(before);
  JobMonitor monitor;
  EXPECT_TRUE(verify_checksums(*reader, monitor));
  const ModelTables& tables = reader->model().tables;
  const auto offset = [&](uint32_t node) { return tables.segments[tables.nodes[node].segment].offset; };
  EXPECT_EQ(offset(2), 0U);
  EXPECT_LT(offset(0), offset(1));
  for (uint32_t node = 0; node < 3; ++node)
    EXPECT_EQ(*reader->read_segment(tables.nodes[node].segment),
              *before->read_segment(before->model().tables.nodes[node].segment));
}

}  // namespace
}  // namespace promenade
