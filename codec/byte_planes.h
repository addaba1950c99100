#pragma once
// Numbers byte by byte: what is alike stands together.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "codec/byte_io.h"

namespace promenade {

/// One byte of every number after the other, least significant bytes first.
inline void put_planes(const std::vector<uint32_t>& numbers, uint32_t bytes, ByteWriter& writer) {
  std::vector<std::byte> run(numbers.size());
  for (uint32_t plane = 0; plane < bytes; ++plane) {
    for (size_t i = 0; i < run.size(); ++i) run[i] = static_cast<std::byte>((numbers[i] >> (8 * plane)) & 0xffU);
    writer.put_bytes(run);
  }
}

/// As many as there are. False: too few bytes.
inline bool get_planes(ByteReader& reader, uint32_t bytes, std::vector<uint32_t>& numbers) {
  std::fill(numbers.begin(), numbers.end(), 0U);
  for (uint32_t plane = 0; plane < bytes; ++plane) {
    const std::span<const std::byte> run = reader.get_bytes(numbers.size());
    if (run.size() != numbers.size()) return false;
    for (size_t i = 0; i < run.size(); ++i) numbers[i] |= std::to_integer<uint32_t>(run[i]) << (8 * plane);
  }
  return true;
}

}  // namespace promenade
