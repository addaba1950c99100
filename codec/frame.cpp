#include "codec/frame.h"

#include <fmt/format.h>
#include <xxhash.h>
#include <zstd.h>

#include <algorithm>

namespace promenade {

uint64_t checksum(std::span<const std::byte> bytes, uint64_t seed) {
  return XXH3_64bits_withSeed(bytes.data(), bytes.size(), seed);
}

std::vector<std::byte> compress_frame(std::span<const std::byte> bytes, int level) {
  std::vector<std::byte> frame(ZSTD_compressBound(bytes.size()));
  // Cannot fail: the room is enough for the worst case, and levels out of range are clamped.
  frame.resize(ZSTD_compress(frame.data(), frame.size(), bytes.data(), bytes.size(), std::clamp(level, 1, 19)));
  return frame;
}

Result<std::vector<std::byte>> decompress_frame(std::span<const std::byte> bytes, uint64_t max_bytes) {
  const size_t frame_bytes = ZSTD_findFrameCompressedSize(bytes.data(), bytes.size());
  if (ZSTD_isError(frame_bytes))
    return Error{fmt::format("no whole zstd frame in {} bytes: {}", bytes.size(), ZSTD_getErrorName(frame_bytes))};
  if (frame_bytes != bytes.size())
    return Error{fmt::format("zstd frame: ends at byte {}, {} bytes follow", frame_bytes, bytes.size() - frame_bytes)};
  const uint64_t content_bytes = ZSTD_getFrameContentSize(bytes.data(), bytes.size());
  if (content_bytes == ZSTD_CONTENTSIZE_ERROR || content_bytes == ZSTD_CONTENTSIZE_UNKNOWN)
    return Error{"zstd frame: no content size in its header"};
  if (content_bytes > max_bytes)
    return Error{fmt::format("zstd frame: claims {} bytes, at most {} are allowed here", content_bytes, max_bytes)};
  std::vector<std::byte> content(content_bytes);
  const size_t result = ZSTD_decompress(content.data(), content.size(), bytes.data(), bytes.size());
  if (ZSTD_isError(result)) return Error{fmt::format("zstd frame: {}", ZSTD_getErrorName(result))};
  if (result != content_bytes)
    return Error{fmt::format("zstd frame: holds {} bytes, its header says {}", result, content_bytes)};
  return content;
}

}  // namespace promenade
