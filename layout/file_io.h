#pragma once
// The one way in which bytes reach the disk: every write, sync and close is checked, and a file appears under its final
// name whole or not at all.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "geometry/result.h"

namespace promenade {

/// The calls to the operating system that may fail, so that tests can make them fail (disk full, read errors): see
/// file_system.h. Thread-safe.
class FileSystem;
/// The real one; process-wide.
FileSystem& real_file_system();

/// A file that is written under a temporary name beside its final one (".NAME.partial") and published by commit():
/// written, synced, closed, renamed, folder synced. Destroyed without commit: the temporary file is removed. One
/// thread.
class AtomicFile {
 public:
  static Result<AtomicFile> create(const std::filesystem::path& final_path, FileSystem& files = real_file_system());
  AtomicFile(AtomicFile&&) noexcept;
  AtomicFile& operator=(AtomicFile&&) noexcept;
  ~AtomicFile();

  /// Appends; buffered.
  Status write(std::span<const std::byte> bytes);
  /// Overwrites bytes that were written already (a header whose counts are known last).
  Status write_at(uint64_t offset, std::span<const std::byte> bytes);
  uint64_t size() const;
  /// Once. On an error nothing new bears the final name, and what bore it is as it was; except when only the last sync,
  /// of the folder, fails: then the whole new file is there and a power cut may still undo its name.
  Status commit();

 private:
  struct State;
  explicit AtomicFile(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

/// A whole file at once, atomically.
Status write_file(const std::filesystem::path& path, std::span<const std::byte> bytes,
                  FileSystem& files = real_file_system());
Status write_file(const std::filesystem::path& path, std::string_view text, FileSystem& files = real_file_system());

/// A whole file; refuses one larger than max_bytes, a folder, an unreadable one, each with a message that names it.
Result<std::vector<std::byte>> read_file(const std::filesystem::path& path, uint64_t max_bytes = uint64_t(1) << 34,
                                         FileSystem& files = real_file_system());
Result<std::string> read_text_file(const std::filesystem::path& path, uint64_t max_bytes = uint64_t(1) << 30);

/// An open file for reading at offsets, from any thread at once (pread).
class RandomAccessFile {
 public:
  static Result<RandomAccessFile> open(const std::filesystem::path& path, FileSystem& files = real_file_system());
  RandomAccessFile(RandomAccessFile&&) noexcept;
  RandomAccessFile& operator=(RandomAccessFile&&) noexcept;
  ~RandomAccessFile();

  uint64_t size() const;
  /// Fills `into` from `offset`; a file too short is an error.
  Status read(uint64_t offset, std::span<std::byte> into) const;

 private:
  struct State;
  explicit RandomAccessFile(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

/// An exclusive advisory lock (flock) on a file that is made if need be: two builds into one model at once. Released on
/// destruction; the file goes too if it is empty. Also released when the process dies, whatever kills it (an empty file
/// may stay then, which hinders nobody).
class FileLock {
 public:
  /// Error when somebody else holds it: `what` says what is being protected ("model city.prom").
  static Result<FileLock> acquire(const std::filesystem::path& path, const std::string& what);
  FileLock(FileLock&&) noexcept;
  FileLock& operator=(FileLock&&) noexcept;
  ~FileLock();

 private:
  explicit FileLock(int descriptor, std::filesystem::path path);
  int descriptor_ = -1;
  std::filesystem::path path_;
};

}  // namespace promenade
