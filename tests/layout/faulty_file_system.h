#pragma once
// A file system that fails on demand, over the real one.

#include <cerrno>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <span>

#include "layout/file_system.h"

namespace promenade {

/// Fails the n-th call, runs out of space, reads and writes in small pieces, is interrupted by signals. One thread.
class FaultyFileSystem : public FileSystem {
 public:
  /// Counting from 0, removals and closes not counted (they are how a failure is cleaned up).
  uint64_t failing_call = std::numeric_limits<uint64_t>::max();
  int failure = EIO;
  bool fails_ever_after = false;  ///< and every counted call after it
  uint64_t free_bytes = std::numeric_limits<uint64_t>::max();
  size_t largest_transfer_bytes = std::numeric_limits<size_t>::max();
  bool interrupts = false;  ///< every other call answers -EINTR
  bool has_links = true;
  uint64_t calls = 0;

  int open(const std::filesystem::path& path, int flags) override {
    const int fault = next_fault();
    return fault != 0 ? fault : FileSystem::open(path, flags);
  }
  int64_t read_at(int descriptor, uint64_t offset, std::span<std::byte> into) override {
    const int fault = next_fault();
    if (fault != 0) return fault;
    return FileSystem::read_at(descriptor, offset, into.first(std::min(into.size(), largest_transfer_bytes)));
  }
  int64_t write_at(int descriptor, uint64_t offset, std::span<const std::byte> bytes) override {
    const int fault = next_fault();
    if (fault != 0) return fault;
    if (free_bytes == 0) return -ENOSPC;
    const size_t n = std::min({bytes.size(), largest_transfer_bytes, static_cast<size_t>(free_bytes)});
    free_bytes -= n;
    return FileSystem::write_at(descriptor, offset, bytes.first(n));
  }
  /// Nobody pulls the plug during a test: real syncs would only make it slow.
  int sync(int) override { return next_fault(); }
  int info(int descriptor, FileInfo& info) override {
    const int fault = next_fault();
    return fault != 0 ? fault : FileSystem::info(descriptor, info);
  }
  int info(const std::filesystem::path& path, FileInfo& info) override {
    const int fault = next_fault();
    return fault != 0 ? fault : FileSystem::info(path, info);
  }
  int rename(const std::filesystem::path& from, const std::filesystem::path& to) override {
    const int fault = next_fault();
    return fault != 0 ? fault : FileSystem::rename(from, to);
  }
  int link(const std::filesystem::path& from, const std::filesystem::path& to) override {
    const int fault = next_fault();
    return fault != 0 ? fault : has_links ? FileSystem::link(from, to) : -EPERM;
  }
  int make_folder(const std::filesystem::path& path) override {
    const int fault = next_fault();
    return fault != 0 ? fault : FileSystem::make_folder(path);
  }

 private:
  int next_fault() {
    if (interrupts && !interrupted_) {
      interrupted_ = true;
      return -EINTR;
    }
    interrupted_ = false;
    const uint64_t call = calls++;
    return call == failing_call || (fails_ever_after && call > failing_call) ? -failure : 0;
  }

  bool interrupted_ = false;
};

}  // namespace promenade
