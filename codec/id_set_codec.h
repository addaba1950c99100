#pragma once
// Ways to store a set of ids, one interface for all: bytes from ids and back. FORMAT.md has the bytes of each. What a
// model stores is written by id_set_block.h; these are measured against it (`promenade study codecs`).

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "geometry/result.h"

namespace promenade {

/// One way. Functions are pure; any thread.
struct IdSetCodec {
  std::string_view name;  ///< as the study prints it
  std::string_view what;  ///< in a few words

  /// Appends the set. ids: strictly ascending, each below universe.
  void (*encode)(std::span<const uint32_t> ids, uint32_t universe, std::vector<std::byte>& bytes);

  /// Writes the ids to the front of `into`, strictly ascending, each below universe, and returns how many. bytes: the
  /// whole of what encode appended. Allocates nothing unless the codec says so. Safe on any bytes: an Error when they
  /// are not the set of any ids or there is no room for them.
  Result<size_t> (*decode)(std::span<const std::byte> bytes, uint32_t universe, std::span<uint32_t> into);
};

/// All that code a set by itself, raw first.
std::span<const IdSetCodec> id_set_codecs();

/// The one with that name; null: there is none.
const IdSetCodec* find_id_set_codec(std::string_view name);

}  // namespace promenade
