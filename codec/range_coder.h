#pragma once
// Adaptive binary range coding: decisions to bytes and back, each at the cost of its surprise. FORMAT.md says how.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "codec/adaptive_models.h"

namespace promenade {

/// Source of the arithmetic: G. N. N. Martin, Range encoding, 1979; here with 64 bits, of which 32 leave at once.
class RangeEncoder {
 public:
  explicit RangeEncoder(std::vector<std::byte>& bytes) : bytes_(bytes), begin_(bytes.size()) {}

  void put(BitModel& model, uint32_t bit) {
    const uint64_t bound = (range_ >> kChanceBits) * model.zero<kChanceBits>();
    if (bit == 0) {
      range_ = bound;
    } else {
      add(bound);
      range_ -= bound;
    }
    model.update(bit);
    if (range_ < kLeastRange) {
      put_word();
      range_ <<= kWordBits;
    }
  }

  /// Nothing may be put after it. Zeros at the end are not stored: a decoder finds them there.
  void finish() {
    // Of all numbers that tell the decisions, one with few digits.
    for (unsigned bits = 63; bits > 0; --bits) {
      const uint64_t mask = (uint64_t(1) << bits) - 1, up = (mask - (low_ & mask) + 1) & mask;
      if (up >= range_) continue;
      add(up);
      break;
    }
    put_word();
    put_word();
    while (bytes_.size() > begin_ && bytes_.back() == std::byte{0}) bytes_.pop_back();
  }

  static constexpr uint64_t kLeastRange = uint64_t(1) << 32;
  static constexpr unsigned kWordBits = 32, kChanceBits = 12;

 private:
  void add(uint64_t value) {
    low_ += value;
    if (low_ >= value) return;
    // A carry. It never leaves the first byte: all that was put is a number below one.
    size_t at = bytes_.size();
    while (bytes_[--at] == std::byte{0xff}) bytes_[at] = std::byte{0};
    bytes_[at] = static_cast<std::byte>(std::to_integer<uint32_t>(bytes_[at]) + 1);
  }
  void put_word() {
    for (int i = 0; i < 4; ++i, low_ <<= 8) bytes_.push_back(static_cast<std::byte>(low_ >> 56));
  }

  std::vector<std::byte>& bytes_;
  size_t begin_;
  uint64_t low_ = 0;
  uint64_t range_ = ~uint64_t(0);
};

/// Past the end there are zeros, and overrun() tells of it.
class RangeDecoder {
 public:
  explicit RangeDecoder(std::span<const std::byte> bytes) : at_(bytes.data()), end_(at_ + bytes.size()) {
    get_word();
    get_word();
  }

  [[gnu::always_inline]] uint32_t get(BitModel& model) {
    const uint64_t bound = (range_ >> RangeEncoder::kChanceBits) * model.zero<RangeEncoder::kChanceBits>();
    const uint32_t bit = code_ >= bound ? 1 : 0;
    if (bit == 0) {
      range_ = bound;
    } else {
      code_ -= bound;
      range_ -= bound;
    }
    model.update(bit);
    if (range_ < RangeEncoder::kLeastRange) {
      get_word();
      range_ <<= RangeEncoder::kWordBits;
    }
    return bit;
  }

  /// Whether more was read than the bytes and as many zeros again as an encoder may have left out.
  bool overrun() const { return missing_ > kMostMissing; }

 private:
  static constexpr uint64_t kMostMissing = uint64_t(1) << 16;  // an encoder that leaves out more had nothing to tell

  [[gnu::always_inline]] void get_word() {
    uint32_t word = 0;
    if (end_ - at_ >= 4) {
      for (int i = 0; i < 4; ++i) word = word << 8 | std::to_integer<uint32_t>(*at_++);
    } else {
      for (int i = 0; i < 4; ++i) {
        word <<= 8;
        if (at_ != end_)
          word |= std::to_integer<uint32_t>(*at_++);
        else
          ++missing_;
      }
    }
    code_ = code_ << RangeEncoder::kWordBits | word;
  }

  const std::byte* at_;
  const std::byte* end_;
  uint64_t range_ = ~uint64_t(0);
  uint64_t code_ = 0;
  uint64_t missing_ = 0;
};

}  // namespace promenade
