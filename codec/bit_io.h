#pragma once
// Bits to bytes and back, the highest bit of a byte first.

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace promenade {

/// Appends bits to a run of bytes; what is missing in the last byte is zero.
class BitWriter {
 public:
  explicit BitWriter(std::vector<std::byte>& bytes) : bytes_(bytes) {}

  /// The lowest `count` bits of value, count <= 32, the highest of them first.
  void put(uint32_t value, unsigned count) {
    for (unsigned i = count; i-- > 0;) {
      if (used_ == 0) bytes_.push_back(std::byte{0});
      if ((value >> i & 1U) != 0) bytes_.back() |= static_cast<std::byte>(0x80U >> used_);
      used_ = (used_ + 1) % 8;
    }
  }
  /// count ones and a zero.
  void put_unary(uint32_t count) {
    for (; count >= 32; count -= 32) put(~0U, 32);
    put(static_cast<uint32_t>((uint64_t(1) << count) - 1), count);
    put(0, 1);
  }

 private:
  std::vector<std::byte>& bytes_;
  unsigned used_ = 0;  ///< bits of the last byte
};

/// Reads bits from a run of bytes. Past the end there are zeros, and overrun() is true: check it before using what was
/// read.
class BitReader {
 public:
  explicit BitReader(std::span<const std::byte> bytes) : bytes_(bytes) {}

  /// The next 32 bits or more at the top of the word, without taking them.
  uint64_t peek() const {
    const size_t byte = at_ / 8;
    uint64_t word = 0;
    if (byte + sizeof(word) <= bytes_.size()) {
      for (size_t i = 0; i < sizeof(word); ++i) word = word << 8 | std::to_integer<uint64_t>(bytes_[byte + i]);
    } else {
      for (size_t i = 0; i < sizeof(word); ++i)
        word = word << 8 | (byte + i < bytes_.size() ? std::to_integer<uint64_t>(bytes_[byte + i]) : 0);
    }
    return word << (at_ % 8);
  }
  void skip(uint64_t count) { at_ += count; }
  /// count <= 32.
  uint32_t get(unsigned count) {
    if (count == 0) return 0;
    const auto value = static_cast<uint32_t>(peek() >> (64 - count));
    at_ += count;
    return value;
  }
  /// The ones before the next zero, and the zero. Ends with the bytes, whatever they are.
  uint64_t get_unary() {
    uint64_t ones = 0;
    while (true) {
      constexpr unsigned kSure = 56;  // bits of a peek that are not shifted in
      const auto run = std::min<unsigned>(static_cast<unsigned>(std::countl_one(peek())), kSure);
      ones += run;
      at_ += run;
      if (run < kSure) break;
    }
    at_ += 1;
    return ones;
  }

  uint64_t bits_left() const { return at_ >= bytes_.size() * 8 ? 0 : bytes_.size() * 8 - at_; }
  bool overrun() const { return at_ > bytes_.size() * 8; }
  /// Whether what is left is less than a byte, and zeros.
  bool at_padding() const { return !overrun() && bits_left() < 8 && peek() == 0; }

 private:
  std::span<const std::byte> bytes_;
  uint64_t at_ = 0;
};

}  // namespace promenade
