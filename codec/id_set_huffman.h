#pragma once
// (gap, run) by adaptive Huffman codes of their lengths in bits: what [chhugani2003] section 2.4 uses for large sets.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "geometry/result.h"

namespace promenade {

/// See IdSetCodec.
void encode_huffman(std::span<const uint32_t> ids, uint32_t universe, std::vector<std::byte>& bytes);
Result<size_t> decode_huffman(std::span<const std::byte> bytes, uint32_t universe, std::span<uint32_t> into);

/// The delimiter code on runs for small sets and adaptive Huffman for large ones, told apart by the first byte: the
/// paper's choice. The shorter of the two is taken.
void encode_paper(std::span<const uint32_t> ids, uint32_t universe, std::vector<std::byte>& bytes);
Result<size_t> decode_paper(std::span<const std::byte> bytes, uint32_t universe, std::span<uint32_t> into);

}  // namespace promenade
