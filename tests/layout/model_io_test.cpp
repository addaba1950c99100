#include "layout/model_io.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "tests/layout/faulty_file_system.h"
#include "tests/layout/model_fixtures.h"
#include "tests/temporary_folder.h"

namespace promenade {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// The version that the model at a path says; or the error.
std::string version_at(const fs::path& path) {
  const Result<ModelReader> reader = ModelReader::open(path);
  if (!reader) return "error: " + reader.error().message;
  const Status sound = [&] {
    JobMonitor monitor;
    return verify_checksums(*reader, monitor);
  }();
  return sound ? reader->model().manifest.tool_version : "error: " + sound.error().message;
}

void flip_byte(const fs::path& path, std::streamoff at) {
  std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
  file.seekg(at);
  const auto byte = static_cast<char>(file.get() ^ 1);
  file.seekp(at);
  file.put(byte);
}

TEST(Model, reads_back_what_was_written) {
  TemporaryFolder folder;
  const Status written = write_squares(folder / "m.prom");
  ASSERT_TRUE(written) << written.error().message;
  EXPECT_THAT(folder.names(), ElementsAre("m.prom"));
  const Result<ModelReader> reader = ModelReader::open((folder / "m.prom").string() + "/");
  ASSERT_TRUE(reader) << reader.error().message;
  const ModelTables expected = root_and_two_leaves();
  EXPECT_EQ(reader->model().tables.nodes, expected.nodes);
  EXPECT_EQ(reader->model().children_of(NodeId{0}).size(), 2U);
  EXPECT_EQ(reader->model().manifest.settings, manifest_of_squares().settings);
  const Result<Mesh> mesh = reader->read_mesh(NodeId{2});
  ASSERT_TRUE(mesh) << mesh.error().message;
  EXPECT_EQ(bounds(*mesh), (Box{{2, 0, 0}, {3, 1, 0}}));
  EXPECT_EQ(mesh->materials, (std::vector<uint32_t>{1, 1}));
  const Result<Image> image = reader->read_texture(0);
  ASSERT_TRUE(image) << image.error().message;
  EXPECT_EQ(image->pixels, two_by_one().pixels);
}

TEST(Model, reads_pieces_that_make_the_segment) {
  TemporaryFolder folder;
  ASSERT_TRUE(write_squares(folder / "m"));
  const Result<ModelReader> reader = ModelReader::open(folder / "m");
  ASSERT_TRUE(reader);
  const Result<std::vector<std::byte>> whole = reader->read_segment(1);
  ASSERT_TRUE(whole);
  std::vector<std::byte> pieces(whole->size());
  for (size_t at = 0; at < pieces.size(); at += 10)
    ASSERT_TRUE(reader->read_piece(1, at, std::span(pieces).subspan(at, std::min<size_t>(10, pieces.size() - at))));
  EXPECT_EQ(pieces, *whole);
  EXPECT_TRUE(reader->check_segment(1, pieces));
  pieces[3] ^= std::byte{1};
  EXPECT_THAT(reader->check_segment(1, pieces).error().message, HasSubstr("geometry.bin: segment 1 @"));
  EXPECT_FALSE(reader->read_piece(1, 5, pieces));
  EXPECT_FALSE(reader->read_piece(1, ~uint64_t(0), pieces));
}

TEST(Model, is_the_same_bytes_each_time) {
  TemporaryFolder folder;
  ASSERT_TRUE(write_squares(folder / "a") && write_squares(folder / "b"));
  for (const char* name : {"manifest.json", "tables.bin", "geometry.bin", "textures.bin"})
    EXPECT_EQ(*read_file(folder / "a" / name), *read_file(folder / "b" / name)) << name;
}

TEST(ModelWriter, replaces_a_model_only_when_finished) {
  TemporaryFolder folder;
  ASSERT_TRUE(write_squares(folder / "m", real_file_system(), "old"));
  {
    Result<ModelWriter> writer = ModelWriter::create(folder / "m");
    ASSERT_TRUE(writer);
    ASSERT_TRUE(append_squares(*writer));
    EXPECT_EQ(version_at(folder / "m"), "old");
  }
  EXPECT_THAT(folder.names(), ElementsAre("m"));
  ASSERT_TRUE(write_squares(folder / "m", real_file_system(), "new"));
  EXPECT_EQ(version_at(folder / "m"), "new");
  EXPECT_THAT(folder.names(), ElementsAre("m"));
}

TEST(ModelWriter, refuses_to_replace_what_is_no_model) {
  TemporaryFolder folder;
  fs::create_directory(folder / "photos");
  ASSERT_TRUE(write_file(folder / "photos" / "a.jpg", std::string_view("kept")));
  EXPECT_THAT(ModelWriter::create(folder / "photos").error().message, HasSubstr("exists and is no model"));
  EXPECT_THAT(ModelWriter::create(folder / "photos" / "a.jpg").error().message, HasSubstr("exists and is no model"));
  fs::rename(folder / "photos", folder / "m.partial");
  EXPECT_THAT(ModelWriter::create(folder / "m").error().message, HasSubstr("no part of a model; move them away"));
  EXPECT_TRUE(fs::exists(folder / "m.partial" / "a.jpg"));
  EXPECT_THAT(ModelWriter::create("").error().message, HasSubstr("is no name for a model"));
}

TEST(ModelWriter, is_alone_at_its_path) {
  TemporaryFolder folder;
  const Result<ModelWriter> first = ModelWriter::create(folder / "m");
  ASSERT_TRUE(first);
  EXPECT_THAT(ModelWriter::create(folder / "m").error().message, HasSubstr("is in use by another process"));
  EXPECT_TRUE(ModelWriter::create(folder / "other"));
}

TEST(ModelWriter, refuses_unsound_tables) {
  TemporaryFolder folder;
  {
    Result<ModelWriter> writer = ModelWriter::create(folder / "m");
    ASSERT_TRUE(writer && append_squares(*writer));
    ModelTables tables = root_and_two_leaves();
    tables.nodes[1].segment = 17;
    EXPECT_THAT(writer->finish(tables, manifest_of_squares()).error().message, HasSubstr("segment 17 is no mesh"));
  }
  EXPECT_THAT(folder.names(), IsEmpty());
}

TEST(ModelWriter, keeps_the_old_model_or_brings_the_new_one_whichever_call_fails) {
  TemporaryFolder folder;
  FaultyFileSystem sound;
  ASSERT_TRUE(write_squares(folder / "m", sound, "old"));
  sound.calls = 0;
  ASSERT_TRUE(write_squares(folder / "m", sound, "new"));
  const uint64_t calls = sound.calls;
  ASSERT_GT(calls, 30U);
  for (const bool ever_after : {false, true}) {
    for (uint64_t call = 0; call < calls; ++call) {
      FaultyFileSystem faultless;
      ASSERT_TRUE(write_squares(folder / "m", faultless, "old"));
      FaultyFileSystem files;
      files.failing_call = call;
      files.fails_ever_after = ever_after;
      const Status status = write_squares(folder / "m", files, "new");
      const std::string version = version_at(folder / "m");
      EXPECT_TRUE(version == "new" || (version == "old" && !status)) << call << ": " << version;
      ASSERT_TRUE(write_squares(folder / "m", faultless, "next")) << call;
      EXPECT_THAT(folder.names(), ElementsAre("m")) << call;
    }
  }
}

TEST(ModelWriter, leaves_nothing_when_the_disk_fills_up_at_any_byte) {
  TemporaryFolder folder;
  ASSERT_TRUE(write_squares(folder / "m"));
  uint64_t all = 0;
  for (const auto& entry : fs::directory_iterator(folder / "m")) all += entry.file_size();
  fs::remove_all(folder / "m");
  for (uint64_t free_bytes = 0; free_bytes < all; free_bytes += 97) {
    FaultyFileSystem files;
    files.free_bytes = free_bytes;
    const Status status = write_squares(folder / "m", files);
    ASSERT_FALSE(status);
    EXPECT_THAT(status.error().message, HasSubstr("free some space"));
    EXPECT_THAT(folder.names(), IsEmpty());
  }
}

// --- far pictures ---------------------------------------------------------------------------------------------------

/// A hundred cells, each with two sides of 40 bytes; in no order of places.
FarCellSource a_hundred_far_cells(int* batches = nullptr, int failing_batch = -1) {
  auto batch = std::make_shared<int>(0);
  return [=]() -> Result<std::vector<StoredFarCell>> {
    if (batches != nullptr) *batches = *batch;
    if (*batch == failing_batch) return Error{"the source fails"};
    std::vector<StoredFarCell> cells;
    for (int i = 0; i < 10 && *batch < 10; ++i) {
      const auto place = static_cast<uint64_t>(99 - 10 * *batch - i);
      const std::vector<std::byte> bytes(40, std::byte(place));
      cells.push_back({place, 0.01F, {{0, 2, bytes}, {3, 7, bytes}}});
    }
    ++*batch;
    return cells;
  };
}

FarTables a_hundred_places() {
  FarTables tables;
  tables.bound_rad = 0.02, tables.box_m = 100, tables.cell_m = 10;
  tables.counts = {10, 10, 1}, tables.face_levels = 3;
  return tables;
}

Status write_squares_with_far(const fs::path& path, FileSystem& files, const FarCellSource& cells) {
  Result<ModelWriter> writer = ModelWriter::create(path, files);
  if (!writer) return writer.error();
  PROMENADE_TRY(append_squares(*writer));
  PROMENADE_TRY(writer->stage(root_and_two_leaves(), manifest_of_squares()));
  PROMENADE_TRY(writer->add_far(a_hundred_places(), cells));
  return writer->publish();
}

Status extend_with_far(const fs::path& path, FileSystem& files, const FarCellSource& cells) {
  Result<ModelWriter> writer = ModelWriter::extend(path, {{"far-bound", "1"}}, files);
  if (!writer) return writer.error();
  PROMENADE_TRY(writer->add_far(a_hundred_places(), cells));
  return writer->publish();
}

TEST(FarPicturesOfAModel, come_in_any_order_and_are_found_by_place) {
  TemporaryFolder folder;
  const Status written = write_squares_with_far(folder / "m", real_file_system(), a_hundred_far_cells());
  ASSERT_TRUE(written) << written.error().message;
  const Result<ModelReader> reader = ModelReader::open(folder / "m");
  ASSERT_TRUE(reader) << reader.error().message;
  const FarTables& tables = reader->far()->tables();
  for (uint64_t place = 0; place < 100; ++place) {
    const std::optional<FarCellId> cell = far_cell_of_place(tables, place);
    ASSERT_TRUE(cell);
    const uint32_t first = tables.cells[index_of(*cell)].first_face;
    EXPECT_EQ(*reader->far()->read_face(first + 1), std::vector<std::byte>(40, std::byte(place)));
  }
}

TEST(FarPicturesOfAModel, leave_nothing_when_the_disk_fills_up_or_the_source_fails) {
  TemporaryFolder folder;
  ASSERT_TRUE(write_squares_with_far(folder / "m", real_file_system(), a_hundred_far_cells()));
  uint64_t all = 0;
  for (const auto& entry : fs::directory_iterator(folder / "m")) all += entry.file_size();
  fs::remove_all(folder / "m");
  for (uint64_t free_bytes = 0; free_bytes < all; free_bytes += 331) {
    FaultyFileSystem files;
    files.free_bytes = free_bytes;
    const Status status = write_squares_with_far(folder / "m", files, a_hundred_far_cells());
    ASSERT_FALSE(status);
    EXPECT_THAT(status.error().message, HasSubstr("free some space"));
    EXPECT_THAT(folder.names(), IsEmpty());
  }
  EXPECT_FALSE(write_squares_with_far(folder / "m", real_file_system(), a_hundred_far_cells(nullptr, 4)));
  EXPECT_THAT(folder.names(), IsEmpty());
}

TEST(FarPicturesOfAModel, added_leave_the_old_model_or_bring_the_new_one_whichever_call_fails) {
  for (const bool has_links : {true, false}) {
    TemporaryFolder folder;
    FaultyFileSystem sound;
    sound.has_links = has_links;
    ASSERT_TRUE(write_squares(folder / "m", sound, "old"));
    sound.calls = 0;
    const Status extended = extend_with_far(folder / "m", sound, a_hundred_far_cells());
    ASSERT_TRUE(extended) << extended.error().message;
    const uint64_t calls = sound.calls;
    ASSERT_GT(calls, 30U);
    for (const bool ever_after : {false, true})
      for (uint64_t call = 0; call < calls; call += 3) {
        FaultyFileSystem faultless;
        ASSERT_TRUE(write_squares(folder / "m", faultless, "old"));
        FaultyFileSystem files;
        files.has_links = has_links, files.failing_call = call, files.fails_ever_after = ever_after;
        const Status status = extend_with_far(folder / "m", files, a_hundred_far_cells());
        EXPECT_EQ(version_at(folder / "m"), "old") << call << ": whole, with far pictures or without";
        const Result<ModelReader> reader = ModelReader::open(folder / "m");
        if (status) {
          EXPECT_NE(reader->far(), nullptr) << call;
        }
        ASSERT_TRUE(extend_with_far(folder / "m", faultless, a_hundred_far_cells())) << call;
        EXPECT_THAT(folder.names(), ElementsAre("m")) << call;
        EXPECT_EQ(ModelReader::open(folder / "m")->far()->tables().cells.size(), 100U);
      }
  }
}

TEST(FarPicturesOfAModel, killed_half_way_are_made_anew_over_what_was_left) {
  TemporaryFolder folder;
  ASSERT_TRUE(write_squares(folder / "m", real_file_system(), "old"));
  const std::vector<std::byte> half(1000, std::byte{1});
  fs::create_directory(folder / "m.partial");
  for (const char* name : {"tables.bin", ".far.bin.partial", "manifest.json"})
    ASSERT_TRUE(write_file(folder / "m.partial" / name, half));
  EXPECT_EQ(version_at(folder / "m"), "old");
  ASSERT_TRUE(extend_with_far(folder / "m", real_file_system(), a_hundred_far_cells()));
  EXPECT_THAT(folder.names(), ElementsAre("m"));
  EXPECT_EQ(version_at(folder / "m"), "old");
  EXPECT_NE(ModelReader::open(folder / "m")->far(), nullptr);
}

TEST(FarPicturesOfAModel, refuse_what_is_no_model) {
  TemporaryFolder folder;
  EXPECT_FALSE(extend_with_far(folder / "none", real_file_system(), a_hundred_far_cells()));
  EXPECT_THAT(folder.names(), IsEmpty());
}

TEST(ModelWriter, survives_short_writes_and_interrupts) {
  TemporaryFolder folder;
  FaultyFileSystem files;
  files.largest_transfer_bytes = 13;
  files.interrupts = true;
  const Status status = write_squares(folder / "m", files);
  ASSERT_TRUE(status) << status.error().message;
  EXPECT_EQ(version_at(folder / "m"), "0.0.1");
}

TEST(Model, is_found_after_a_crash_between_the_two_renames) {
  TemporaryFolder folder;
  ASSERT_TRUE(write_squares(folder / "m", real_file_system(), "old"));
  fs::rename(folder / "m", folder / "m.old");
  EXPECT_EQ(version_at(folder / "m"), "old");
  { ASSERT_TRUE(ModelWriter::create(folder / "m")); }
  EXPECT_THAT(folder.names(), ElementsAre("m"));
  EXPECT_EQ(version_at(folder / "m"), "old");
}

TEST(ModelReader, says_what_it_cannot_open) {
  TemporaryFolder folder;
  EXPECT_THAT(version_at(folder / "none"), HasSubstr("there is no such model"));
  ASSERT_TRUE(write_file(folder / "file", std::string_view("x")));
  EXPECT_THAT(version_at(folder / "file"), HasSubstr("is a file, not a model"));
  fs::create_directory(folder / "empty");
  EXPECT_THAT(version_at(folder / "empty"), HasSubstr("has no manifest.json"));
}

TEST(ModelReader, reports_a_damaged_byte_of_any_file_by_file_and_place) {
  for (const char* name : {"manifest.json", "tables.bin", "geometry.bin", "textures.bin"}) {
    TemporaryFolder folder;
    ASSERT_TRUE(write_squares(folder / "m"));
    flip_byte(folder / "m" / name, static_cast<std::streamoff>(fs::file_size(folder / "m" / name) / 2));
    const std::string message = version_at(folder / "m");
    EXPECT_THAT(message, testing::StartsWith("error: ")) << name;
    EXPECT_THAT(message, HasSubstr(name));
  }
}

TEST(ModelReader, rejects_truncated_files_and_files_of_two_builds) {
  for (const char* name : {"manifest.json", "tables.bin", "geometry.bin", "textures.bin"}) {
    TemporaryFolder folder;
    ASSERT_TRUE(write_squares(folder / "m"));
    fs::resize_file(folder / "m" / name, fs::file_size(folder / "m" / name) - 1);
    EXPECT_THAT(version_at(folder / "m"), HasSubstr(name));
    fs::remove(folder / "m" / name);
    EXPECT_THAT(version_at(folder / "m"), testing::StartsWith("error: ")) << name;
  }
  TemporaryFolder folder;
  ASSERT_TRUE(write_squares(folder / "m"));
  ModelTables other = root_and_two_leaves();
  other.materials[0].color = {1, 2, 3, 255};
  {
    Result<ModelWriter> writer = ModelWriter::create(folder / "n");
    ASSERT_TRUE(writer && append_squares(*writer) && writer->finish(other, manifest_of_squares()));
  }
  fs::copy_file(folder / "n" / "tables.bin", folder / "m" / "tables.bin", fs::copy_options::overwrite_existing);
  EXPECT_THAT(version_at(folder / "m"), HasSubstr("the files are not of one build"));
}

TEST(ModelReader, fails_cleanly_whichever_call_fails) {
  TemporaryFolder folder;
  ASSERT_TRUE(write_squares(folder / "m"));
  FaultyFileSystem sound;
  ASSERT_TRUE(ModelReader::open(folder / "m", sound));
  for (uint64_t call = 0; call < sound.calls; ++call) {
    FaultyFileSystem files;
    files.failing_call = call;
    const auto reader = ModelReader::open(folder / "m", files);
    ASSERT_FALSE(reader) << call;
    EXPECT_THAT(reader.error().message, HasSubstr("m"));
  }
}

TEST(VerifyChecksums, stops_when_asked) {
  TemporaryFolder folder;
  ASSERT_TRUE(write_squares(folder / "m"));
  const Result<ModelReader> reader = ModelReader::open(folder / "m");
  ASSERT_TRUE(reader);
  class Impatient : public JobMonitor {
    bool cancelled() const override { return true; }
  } monitor;
  EXPECT_EQ(verify_checksums(*reader, monitor).error().message, "interrupted");
}

}  // namespace
}  // namespace promenade
