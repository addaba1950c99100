#pragma once
// Sets of node ids as bytes: runs of neighbours and the gaps between them. FORMAT.md has the bytes.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "geometry/result.h"

namespace promenade {

/// ids: strictly ascending. About a byte for each run's length and one or two for each gap.
std::vector<std::byte> encode_ids(std::span<const uint32_t> ids);

/// Strictly ascending ids, each below `limit`. Safe on any bytes: takes memory for at most `limit` ids. An error says
/// at which byte, what was found and the limit.
Result<std::vector<uint32_t>> decode_ids(std::span<const std::byte> bytes, uint32_t limit);

/// What is in one of two ascending sets but not in both, ascending: the difference between two neighbours, and, with
/// one of them, the other.
std::vector<uint32_t> symmetric_difference(std::span<const uint32_t> a, std::span<const uint32_t> b);

}  // namespace promenade
