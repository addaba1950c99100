#pragma once
// The delimiter code for short lists of small numbers. Source: [chhugani2003] section 2.4. FORMAT.md has the rules.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "codec/bit_io.h"
#include "geometry/result.h"

namespace promenade {

/// Appends the code of the numbers, each at least 1.
void encode_delimited(std::span<const uint32_t> numbers, std::vector<std::byte>& bytes);

/// Reads delimited numbers one by one. Allocates nothing; safe on any bytes.
class DelimitedReader {
 public:
  explicit DelimitedReader(std::span<const std::byte> bytes) : bits_(bytes) {}

  enum class Next : uint8_t { number, end, broken };
  /// The next number, at least 1.
  Next next(uint32_t& number);

 private:
  Next read_word(uint32_t& number);
  BitReader bits_;
  bool started_ = false;
  uint64_t ones_left_ = 0;  ///< numbers 1 that a run of ones still stands for
  unsigned word_ones_ = 0;  ///< ones that the word begins with: already taken
};

/// By the ids' gaps, and by (gap, run): see IdSetCodec.
void encode_delimiter_ids(std::span<const uint32_t> ids, uint32_t universe, std::vector<std::byte>& bytes);
Result<size_t> decode_delimiter_ids(std::span<const std::byte> bytes, uint32_t universe, std::span<uint32_t> into);
void encode_delimiter_runs(std::span<const uint32_t> ids, uint32_t universe, std::vector<std::byte>& bytes);
Result<size_t> decode_delimiter_runs(std::span<const std::byte> bytes, uint32_t universe, std::span<uint32_t> into);

}  // namespace promenade
