#include "layout/file_io.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>
#include <optional>
#include <string>

#include "tests/layout/faulty_file_system.h"
#include "tests/temporary_folder.h"

namespace promenade {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

std::string text_of(const fs::path& path) {
  Result<std::string> text = read_text_file(path);
  return text ? *text : "error: " + text.error().message;
}

std::span<const std::byte> bytes_of(std::string_view text) { return std::as_bytes(std::span(text)); }

/// Writes in many small pieces and one that is larger than the buffer, then changes the beginning.
Status write_in_pieces(const fs::path& path, FileSystem& files) {
  Result<AtomicFile> file = AtomicFile::create(path, files);
  if (!file) return file.error();
  for (int i = 0; i < 100; ++i) PROMENADE_TRY(file->write(bytes_of("0123456789")));
  PROMENADE_TRY(file->write(bytes_of(std::string(300000, 'x'))));
  PROMENADE_TRY(file->write(bytes_of("end")));
  PROMENADE_TRY(file->write_at(2, bytes_of("AB")));
  return file->commit();
}

std::string text_in_pieces() {
  std::string text;
  for (int i = 0; i < 100; ++i) text += "0123456789";
  text += std::string(300000, 'x') + "end";
  text.replace(2, 2, "AB");
  return text;
}

TEST(AtomicFile, holds_all_pieces_and_the_changed_bytes) {
  TemporaryFolder folder;
  ASSERT_TRUE(write_in_pieces(folder / "a", real_file_system()));
  EXPECT_EQ(text_of(folder / "a"), text_in_pieces());
  EXPECT_THAT(folder.names(), ElementsAre("a"));
}

TEST(AtomicFile, is_not_seen_before_commit_and_leaves_nothing_without_it) {
  TemporaryFolder folder;
  {
    Result<AtomicFile> file = AtomicFile::create(folder / "a");
    ASSERT_TRUE(file);
    ASSERT_TRUE(file->write(bytes_of("half")));
    EXPECT_FALSE(fs::exists(folder / "a"));
  }
  EXPECT_THAT(folder.names(), IsEmpty());
}

TEST(AtomicFile, replaces_a_file_only_at_commit) {
  TemporaryFolder folder;
  ASSERT_TRUE(write_file(folder / "a", std::string_view("old")));
  Result<AtomicFile> file = AtomicFile::create(folder / "a");
  ASSERT_TRUE(file);
  ASSERT_TRUE(file->write(bytes_of("new")));
  EXPECT_EQ(text_of(folder / "a"), "old");
  ASSERT_TRUE(file->commit());
  EXPECT_EQ(text_of(folder / "a"), "new");
}

TEST(AtomicFile, refuses_to_change_bytes_that_are_not_written_yet) {
  TemporaryFolder folder;
  Result<AtomicFile> file = AtomicFile::create(folder / "a");
  ASSERT_TRUE(file);
  ASSERT_TRUE(file->write(bytes_of("0123")));
  EXPECT_TRUE(file->write_at(2, bytes_of("xy")));
  EXPECT_FALSE(file->write_at(3, bytes_of("xy")));
  EXPECT_FALSE(file->write_at(~uint64_t(0), bytes_of("xy")));
}

TEST(AtomicFile, refuses_a_folder_and_a_missing_folder_with_one_line) {
  TemporaryFolder folder;
  EXPECT_THAT(write_file(folder.path(), std::string_view("x")).error().message, HasSubstr("is a folder"));
  EXPECT_THAT(write_file(folder / "no" / "file", std::string_view("x")).error().message,
              testing::AllOf(HasSubstr("no/file: cannot create"), HasSubstr("check the name")));
}

TEST(AtomicFile, survives_short_writes_and_interrupts) {
  TemporaryFolder folder;
  FaultyFileSystem files;
  files.largest_transfer_bytes = 777;
  files.interrupts = true;
  ASSERT_TRUE(write_in_pieces(folder / "a", files));
  EXPECT_EQ(text_of(folder / "a"), text_in_pieces());
}

TEST(AtomicFile, keeps_the_old_file_whichever_call_fails) {
  TemporaryFolder folder;
  FaultyFileSystem sound;
  ASSERT_TRUE(write_in_pieces(folder / "count", sound));
  ASSERT_GT(sound.calls, 6U);
  // Call 0 asks whether the name is a folder: a failure there shows when the file is opened. The last two sync the
  // folder: the new file is published and whole by then.
  for (uint64_t call = 1; call < sound.calls; ++call) {
    ASSERT_TRUE(write_file(folder / "a", std::string_view("old")));
    FaultyFileSystem files;
    files.failing_call = call;
    const Status status = write_in_pieces(folder / "a", files);
    ASSERT_FALSE(status) << call;
    EXPECT_THAT(status.error().message, HasSubstr("Input/output error"));
    EXPECT_EQ(text_of(folder / "a"), call + 2 < sound.calls ? "old" : text_in_pieces()) << call;
    EXPECT_THAT(folder.names(), ElementsAre("a", "count"));
  }
}

TEST(AtomicFile, leaves_nothing_when_the_disk_fills_up_at_any_byte) {
  TemporaryFolder folder;
  const uint64_t all = text_in_pieces().size();
  for (const uint64_t free_bytes : {uint64_t(0), uint64_t(1), uint64_t(999), uint64_t(1000), all - 1, all, all + 1}) {
    FaultyFileSystem files;
    files.free_bytes = free_bytes;
    const Status status = write_in_pieces(folder / "a", files);
    ASSERT_FALSE(status) << free_bytes;  // all + 2 are needed: two bytes are written twice
    EXPECT_THAT(status.error().message, testing::AllOf(HasSubstr("No space left"), HasSubstr("free some space")));
    EXPECT_THAT(folder.names(), IsEmpty());
  }
}

TEST(ReadFile, reports_what_it_cannot_read) {
  TemporaryFolder folder;
  ASSERT_TRUE(write_file(folder / "ten", std::string_view("0123456789")));
  EXPECT_THAT(read_file(folder / "none").error().message, HasSubstr("none: cannot open: No such file"));
  EXPECT_THAT(read_file(folder.path()).error().message, HasSubstr("is a folder"));
  EXPECT_THAT(read_file(folder / "ten", 9).error().message, HasSubstr("has 10 bytes, more than the 9"));
  EXPECT_TRUE(read_file(folder / "ten", 10));
  ASSERT_EQ(::mkfifo((folder / "pipe").c_str(), 0600), 0);
  EXPECT_THAT(read_file(folder / "pipe").error().message, HasSubstr("is no regular file"));
}

TEST(ReadFile, fails_cleanly_whichever_call_fails) {
  TemporaryFolder folder;
  ASSERT_TRUE(write_file(folder / "ten", std::string_view("0123456789")));
  FaultyFileSystem sound;
  ASSERT_TRUE(read_file(folder / "ten", 100, sound));
  for (uint64_t call = 0; call < sound.calls; ++call) {
    FaultyFileSystem files;
    files.failing_call = call;
    const auto bytes = read_file(folder / "ten", 100, files);
    ASSERT_FALSE(bytes);
    EXPECT_THAT(bytes.error().message, HasSubstr("the disk reports a fault"));
  }
}

TEST(RandomAccessFile, reads_any_piece_through_short_reads_and_interrupts) {
  TemporaryFolder folder;
  ASSERT_TRUE(write_file(folder / "ten", std::string_view("0123456789")));
  FaultyFileSystem files;
  files.largest_transfer_bytes = 2;
  files.interrupts = true;
  Result<RandomAccessFile> file = RandomAccessFile::open(folder / "ten", files);
  ASSERT_TRUE(file);
  EXPECT_EQ(file->size(), 10U);
  std::string piece(5, ' ');
  ASSERT_TRUE(file->read(3, std::as_writable_bytes(std::span(piece))));
  EXPECT_EQ(piece, "34567");
  const Status beyond = file->read(6, std::as_writable_bytes(std::span(piece)));
  ASSERT_FALSE(beyond);
  EXPECT_THAT(beyond.error().message, HasSubstr("ends at byte 10, 1 more bytes"));
}

TEST(FileLock, is_held_by_one_at_a_time_and_leaves_no_file) {
  TemporaryFolder folder;
  std::optional<FileLock> first;
  {
    Result<FileLock> lock = FileLock::acquire(folder / "lock", "model city.prom");
    ASSERT_TRUE(lock);
    first.emplace(std::move(*lock));
  }
  const Result<FileLock> second = FileLock::acquire(folder / "lock", "model city.prom");
  ASSERT_FALSE(second);
  EXPECT_THAT(second.error().message, HasSubstr("model city.prom: is in use by another process"));
  first.reset();
  EXPECT_THAT(folder.names(), IsEmpty());
  EXPECT_TRUE(FileLock::acquire(folder / "lock", "model city.prom"));
}

TEST(FileLock, keeps_a_file_that_holds_something) {
  TemporaryFolder folder;
  ASSERT_TRUE(write_file(folder / "state", std::string_view("kept")));
  { ASSERT_TRUE(FileLock::acquire(folder / "state", "state")); }
  EXPECT_EQ(text_of(folder / "state"), "kept");
}

}  // namespace
}  // namespace promenade
