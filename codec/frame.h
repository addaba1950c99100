#pragma once
// Checksummed zstd frames: how any run of bytes goes to disk when it is not coded otherwise.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "geometry/result.h"

namespace promenade {

/// XXH3, 64 bits.
uint64_t checksum(std::span<const std::byte> bytes, uint64_t seed = 0);

/// zstd with the content size in its header. level: 1 to 19.
std::vector<std::byte> compress_frame(std::span<const std::byte> bytes, int level = 9);

/// Refuses anything that is no whole frame or claims more than max_bytes. Safe on any bytes.
Result<std::vector<std::byte>> decompress_frame(std::span<const std::byte> bytes, uint64_t max_bytes);

}  // namespace promenade
