#pragma once
// The calls to the operating system behind file_io.h: a seam at which tests make them fail.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

#include "geometry/result.h"

namespace promenade {

/// What is under a name.
struct FileInfo {
  uint64_t bytes = 0;
  bool regular = false;
  bool folder = false;
};

/// The operating system's calls. Each returns a value >= 0, or minus an errno; may be interrupted (-EINTR) and may read
/// or write less than asked: callers go on. The base class makes the real calls. Thread-safe.
class FileSystem {
 public:
  FileSystem() = default;
  FileSystem(const FileSystem&) = delete;
  FileSystem& operator=(const FileSystem&) = delete;
  virtual ~FileSystem() = default;

  /// flags as in open(2); a descriptor, not inherited by child processes.
  virtual int open(const std::filesystem::path& path, int flags);
  virtual int64_t read_at(int descriptor, uint64_t offset, std::span<std::byte> into);
  virtual int64_t write_at(int descriptor, uint64_t offset, std::span<const std::byte> bytes);
  virtual int sync(int descriptor);
  virtual int close(int descriptor);
  virtual int info(int descriptor, FileInfo& info);
  virtual int info(const std::filesystem::path& path, FileInfo& info);
  virtual int rename(const std::filesystem::path& from, const std::filesystem::path& to);
  /// A second name for a file.
  virtual int link(const std::filesystem::path& from, const std::filesystem::path& to);
  virtual int make_folder(const std::filesystem::path& path);
  /// A file, or an empty folder.
  virtual int remove(const std::filesystem::path& path);
};

/// "PATH: cannot ACTION: REASON; REMEDY" for an errno.
Error file_error(const std::filesystem::path& path, std::string_view action, int error_number);

/// Makes renames and removals in a folder durable. Filesystems that cannot sync a folder count as done.
Status sync_folder(const std::filesystem::path& folder, FileSystem& files);

/// The folder that a path lies in; "." for a bare name.
std::filesystem::path folder_of(const std::filesystem::path& path);

}  // namespace promenade
