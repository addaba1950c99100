#pragma once
// Bytes that wait on disk until their place in a file is known.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "geometry/result.h"

namespace promenade {

/// A nameless file in a folder: it takes bytes at its end, gives them back in order, and is gone with its owner (even
/// one that was killed). One thread.
class GlbSpool {
 public:
  /// beside: the file whose folder takes the bytes, named in messages.
  static Result<GlbSpool> create(const std::filesystem::path& beside);
  GlbSpool(GlbSpool&& other) noexcept;
  GlbSpool& operator=(GlbSpool&& other) noexcept;
  ~GlbSpool();

  /// Appends; buffered.
  Status write(std::span<const std::byte> bytes);
  uint64_t size() const { return written_ + buffer_.size(); }
  /// Everything written so far, in pieces.
  Status read_back(const std::function<Status(std::span<const std::byte>)>& take);

 private:
  GlbSpool(int descriptor, std::string name);
  Status flush();

  int descriptor_ = -1;
  std::string name_;
  uint64_t written_ = 0;
  std::vector<std::byte> buffer_;
};

}  // namespace promenade
