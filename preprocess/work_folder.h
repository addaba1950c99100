#pragma once
// MODEL.work: what a build has done so far. Each work unit leaves one file there, published whole; a build that was
// stopped finds it and goes on.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "geometry/result.h"
#include "layout/file_io.h"

namespace promenade {

/// A folder of finished work units. A unit's file holds the hash of everything that its content depends on (input,
/// settings, tool version); a unit with another hash, or damaged, counts as not done. Any thread, different units.
class WorkFolder {
 public:
  /// Makes the folder if need be.
  static Result<WorkFolder> open(const std::filesystem::path& path, FileSystem& files);

  /// The unit's payload if it is done and sound.
  std::optional<std::vector<std::byte>> load(const std::string& unit, uint64_t hash) const;
  Status store(const std::string& unit, uint64_t hash, std::span<const std::byte> payload) const;
  /// Bytes of a stored unit's payload, without checking the whole. Offsets count from the payload's start.
  Result<std::vector<std::byte>> read(const RandomAccessFile& file, uint64_t offset, uint64_t bytes) const;
  Result<RandomAccessFile> open_unit(const std::string& unit) const;

  const std::filesystem::path& path() const { return path_; }
  std::filesystem::path path_of(const std::string& unit) const { return path_ / unit; }
  FileSystem& files() const { return *files_; }
  /// The work is over.
  Status remove() const;

 private:
  WorkFolder(std::filesystem::path path, FileSystem& files) : path_(std::move(path)), files_(&files) {}
  std::filesystem::path path_;
  FileSystem* files_;
};

}  // namespace promenade
