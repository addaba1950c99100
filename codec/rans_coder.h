#pragma once
// Adaptive choices to bytes and back, each at the cost of its surprise. What was put last comes out first, so that the
// encoder keeps all choices and works backwards; a decoder needs no division. FORMAT.md says how.
// Source: J. Duda, Asymmetric numeral systems: entropy coding combining speed of Huffman coding with compression rate
// of arithmetic coding, 2013; the variant with ranges.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "codec/adaptive_models.h"

namespace promenade {

/// Between two choices the state is at least this, and less than 2^32 times this.
constexpr uint64_t kLeastRansState = uint64_t(1) << 24;
constexpr unsigned kRansChanceBits = NibbleModel::kBits, kRansWordBits = 32;

class RansEncoder {
 public:
  void put(BitModel& model, uint32_t bit) {
    const uint32_t zero = model.zero<kRansChanceBits>();
    shares_.push_back(bit == 0 ? Share{0, zero} : Share{zero, (1U << kRansChanceBits) - zero});
    model.update(bit);
  }
  void put(NibbleModel& model, uint32_t symbol) {
    const uint32_t start = model.start(symbol);
    shares_.push_back({start, model.start(symbol + 1) - start});
    model.update(symbol);
  }
  /// The bytes of all that was put.
  std::vector<std::byte> finish() const {
    uint64_t state = kLeastRansState;
    std::vector<uint32_t> words;
    for (size_t i = shares_.size(); i-- > 0;) {
      const auto [start, size] = shares_[i];
      if (state >= (kLeastRansState >> kRansChanceBits << kRansWordBits) * size) {
        words.push_back(static_cast<uint32_t>(state));
        state >>= kRansWordBits;
      }
      state = (state / size << kRansChanceBits) + state % size + start;
    }
    words.push_back(static_cast<uint32_t>(state));
    std::vector<std::byte> bytes;
    bytes.reserve(words.size() * sizeof(uint32_t) + 3);
    for (state >>= kRansWordBits; state != 0; state >>= 8) bytes.push_back(static_cast<std::byte>(state));
    for (size_t i = words.size(); i-- > 0;)
      for (unsigned k = 0; k < sizeof(uint32_t); ++k) bytes.push_back(static_cast<std::byte>(words[i] >> 8 * k));
    return bytes;
  }

 private:
  struct Share {
    uint32_t start, size;
  };
  std::vector<Share> shares_;
};

/// How a decoder chooses between what is as good as random, whether the state has to be filled above all: with
/// branches, where few choices cost much, or without them.
enum class RansWay : uint8_t { with_branches, without_branches };

/// Past the end there are zeros, and overrun() tells of it.
template <RansWay kWay>
class RansDecoderOf {
 public:
  explicit RansDecoderOf(std::span<const std::byte> bytes) : at_(bytes.data()), end_(at_ + bytes.size()) {
    for (size_t k = 0; k < bytes.size() % sizeof(uint32_t); ++k) state_ |= std::to_integer<uint64_t>(*at_++) << 8 * k;
    refill();
  }

  [[gnu::always_inline]] uint32_t get(BitModel& model) {
    const uint64_t place = state_ & kMask, zero = model.zero<kRansChanceBits>();
    const uint32_t bit = place >= zero ? 1 : 0;
    if constexpr (kWay == RansWay::without_branches) {
      const uint64_t is_one = 0 - uint64_t(bit), size = (zero ^ is_one) + (is_one & (kMask + 2));  // or the rest
      state_ = size * (state_ >> kRansChanceBits) + place - (zero & is_one);
    } else if (bit == 0) {
      state_ = zero * (state_ >> kRansChanceBits) + place;
    } else {
      state_ = (kMask + 1 - zero) * (state_ >> kRansChanceBits) + place - zero;
    }
    model.update(bit);
    refill();
    return bit;
  }
  [[gnu::always_inline]] uint32_t get(NibbleModel& model) {
    const auto place = static_cast<uint32_t>(state_ & kMask);
    const uint32_t symbol = model.find(place), start = model.start(symbol);
    state_ = uint64_t(model.start(symbol + 1) - start) * (state_ >> kRansChanceBits) + place - start;
    model.update(symbol);
    refill();
    return symbol;
  }
  /// Whether more was read than there is.
  bool overrun() const { return overrun_; }
  /// Whether all was read that an encoder put, and nothing else is there.
  bool at_end() const { return !overrun_ && at_ == end_ && state_ == kLeastRansState; }

 private:
  static constexpr uint64_t kMask = (uint64_t(1) << kRansChanceBits) - 1;

  [[gnu::always_inline]] void refill() {
    if constexpr (kWay == RansWay::with_branches) {
      if (state_ >= kLeastRansState) return;
    }
    if (end_ - at_ < static_cast<std::ptrdiff_t>(sizeof(uint32_t))) {
      refill_at_end();
      return;
    }
    uint64_t word = 0;
    for (unsigned k = 0; k < sizeof(uint32_t); ++k) word |= std::to_integer<uint64_t>(at_[k]) << 8 * k;
    const uint64_t is_low = kWay == RansWay::with_branches || state_ < kLeastRansState ? ~uint64_t(0) : 0;
    state_ = (state_ << (is_low & kRansWordBits)) | (word & is_low);
    at_ += is_low & sizeof(uint32_t);
  }
  void refill_at_end() {
    if (state_ >= kLeastRansState) return;
    overrun_ = true;
    state_ <<= kRansWordBits;
  }

  const std::byte* at_;
  const std::byte* end_;
  uint64_t state_ = 0;
  bool overrun_ = false;
};

using RansDecoder = RansDecoderOf<RansWay::with_branches>;

}  // namespace promenade
