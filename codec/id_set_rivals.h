#pragma once
// What others store sets of integers in, [chhugani2003] among them. See IdSetCodec for all of them; FORMAT.md has the
// bytes.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "geometry/result.h"

namespace promenade {

/// Four bytes an id.
void encode_raw(std::span<const uint32_t> ids, uint32_t universe, std::vector<std::byte>& bytes);
Result<size_t> decode_raw(std::span<const std::byte> bytes, uint32_t universe, std::span<uint32_t> into);

/// (gap, run), seven bits a byte.
void encode_varint(std::span<const uint32_t> ids, uint32_t universe, std::vector<std::byte>& bytes);
Result<size_t> decode_varint(std::span<const std::byte> bytes, uint32_t universe, std::span<uint32_t> into);

/// (gap, run) by Golomb-Rice codes, their parameters chosen for the set. Source: R. F. Rice, JPL 79-22, 1979.
void encode_rice(std::span<const uint32_t> ids, uint32_t universe, std::vector<std::byte>& bytes);
Result<size_t> decode_rice(std::span<const std::byte> bytes, uint32_t universe, std::span<uint32_t> into);

/// Low bits as they are, high bits in unary. Source: P. Elias 1974; R. Fano 1971; S. Vigna, Quasi-succinct indices,
/// 2013.
void encode_elias_fano(std::span<const uint32_t> ids, uint32_t universe, std::vector<std::byte>& bytes);
Result<size_t> decode_elias_fano(std::span<const std::byte> bytes, uint32_t universe, std::span<uint32_t> into);

/// (gap, run) by adaptive Huffman codes of their lengths in bits: what [chhugani2003] section 2.4 uses for large sets.
void encode_huffman(std::span<const uint32_t> ids, uint32_t universe, std::vector<std::byte>& bytes);
Result<size_t> decode_huffman(std::span<const std::byte> bytes, uint32_t universe, std::span<uint32_t> into);

/// The delimiter code on runs for small sets and adaptive Huffman for large ones, told apart by the first byte: the
/// paper's choice. The shorter of the two is taken.
void encode_paper(std::span<const uint32_t> ids, uint32_t universe, std::vector<std::byte>& bytes);
Result<size_t> decode_paper(std::span<const std::byte> bytes, uint32_t universe, std::span<uint32_t> into);

/// CRoaring's portable format with runs. Decoding allocates.
void encode_roaring(std::span<const uint32_t> ids, uint32_t universe, std::vector<std::byte>& bytes);
Result<size_t> decode_roaring(std::span<const std::byte> bytes, uint32_t universe, std::span<uint32_t> into);

/// zstd, level 19, over varint. Decoding allocates once a thread.
void encode_zstd(std::span<const uint32_t> ids, uint32_t universe, std::vector<std::byte>& bytes);
Result<size_t> decode_zstd(std::span<const std::byte> bytes, uint32_t universe, std::span<uint32_t> into);

/// Many sets in one zstd frame, level 19, over varint, each after its number of runs: the best that a general
/// compressor does with what the sets have in common. Decodes all of them: the ids one behind the other at the front
/// of `ids`, where each set ends in `ends`. Errors as for IdSetCodec.
std::vector<std::byte> encode_zstd_frame(std::span<const std::vector<uint32_t>> sets);
Status decode_zstd_frame(std::span<const std::byte> bytes, uint32_t universe, std::span<uint32_t> ids,
                         std::span<uint32_t> ends);

}  // namespace promenade
