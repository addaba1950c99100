#pragma once
// How likely choices are, learned from those that went before in the same context: fast at first. FORMAT.md says how.

#include <emmintrin.h>

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

namespace promenade {

/// Of a choice between 0 and 1.
class BitModel {
 public:
  /// The chance of a 0 in 1 / 2^Bits: never 0, never certain. Bits: 12 to 16.
  template <unsigned Bits>
  [[gnu::always_inline]] uint32_t zero() const {
    return state_ >> (32 - Bits);
  }
  [[gnu::always_inline]] void update(uint32_t bit) {
    const uint32_t seen = state_ & kSeen, p = state_ >> 16;
    const unsigned rate = kRates[seen];
    const uint32_t next = bit == 0 ? p + ((0x10000U - p) >> rate) : p - (p >> rate);
    state_ = next << 16 | (seen + (seen < kSeen ? 1 : 0));
  }

 private:
  /// Shares of the way to certainty, as powers of two. At rate 5 both ends stay away from certainty by 31 / 65536.
  static constexpr std::array<uint8_t, 16> kRates = {1, 2, 2, 3, 3, 3, 4, 4, 4, 4, 4, 4, 4, 4, 4, 5};
  static constexpr uint32_t kSeen = 15;
  uint32_t state_ = 0x80000000U;  ///< the chance of a 0 in 1 / 65536, and in the last bits how often it was asked
};

/// Of a choice among 16 symbols, told and learned at once. Every x86-64 has the vectors that it takes.
class NibbleModel {
 public:
  static constexpr unsigned kBits = 14;  ///< chances are in 1 / 2^kBits
  static constexpr uint32_t kSymbols = 16;

  /// The first `likely` symbols as likely as each other, the others as unlikely as can be. likely: a power of two, 1
  /// to 16.
  constexpr explicit NibbleModel(uint32_t likely = kSymbols) {
    const uint32_t each = (kWhole - (kSymbols - likely) * kLeast) / likely;
    for (uint32_t i = 0; i <= kSymbols; ++i)
      starts_[i] = static_cast<int16_t>(i < likely ? i * each : kWhole - (kSymbols - i) * kLeast);
  }
  /// Where the symbol's share of the 2^kBits begins, and so where that of the one before ends. symbol: 0 to 16.
  [[gnu::always_inline]] uint32_t start(uint32_t symbol) const { return static_cast<uint32_t>(starts_[symbol]); }
  /// The symbol whose share holds a place below 2^kBits.
  [[gnu::always_inline]] uint32_t find(uint32_t place) const {
    const __m128i at = _mm_set1_epi16(static_cast<int16_t>(place));
    const __m128i behind = _mm_packs_epi16(_mm_cmpgt_epi16(half(0), at), _mm_cmpgt_epi16(half(1), at));
    const auto first_behind = static_cast<uint32_t>(_mm_movemask_epi8(behind)) | 1U << kSymbols;
    return static_cast<uint32_t>(std::countr_zero(first_behind)) - 1;
  }
  [[gnu::always_inline]] void update(uint32_t symbol) {
    const __m128i rate = _mm_cvtsi32_si128(kRates[seen_]);
    for (size_t i = 0; i < 2; ++i) {
      const __m128i goal = _mm_load_si128(reinterpret_cast<const __m128i*>(kGoals[symbol].starts.data()) + i);
      const __m128i now = half(i), next = _mm_add_epi16(now, _mm_sra_epi16(_mm_sub_epi16(goal, now), rate));
      _mm_store_si128(reinterpret_cast<__m128i*>(starts_.data()) + i, next);
    }
    seen_ += seen_ + 1 < kRates.size() ? 1 : 0;
  }

 private:
  /// The shares if a symbol were all but certain.
  struct alignas(16) Goal {
    std::array<int16_t, kSymbols> starts;
  };
  static constexpr uint32_t kWhole = 1U << kBits, kLeast = 2;
  [[gnu::always_inline]] __m128i half(size_t i) const {
    return _mm_load_si128(reinterpret_cast<const __m128i*>(starts_.data()) + i);
  }

  static constexpr std::array<Goal, kSymbols> kGoals = [] {
    std::array<Goal, kSymbols> goals{};
    for (uint32_t symbol = 0; symbol < kSymbols; ++symbol)
      for (uint32_t i = 0; i < kSymbols; ++i)
        goals[symbol].starts[i] = static_cast<int16_t>(i <= symbol ? i * kLeast : kWhole - (kSymbols - i) * kLeast);
    return goals;
  }();
  /// Shares of the way to the goal, as powers of two. No symbol's share ever vanishes: rounding down takes less than
  /// the goal's own shares bring.
  static constexpr std::array<uint8_t, 16> kRates = {1, 2, 2, 3, 3, 3, 4, 4, 4, 4, 4, 4, 4, 4, 4, 5};
  alignas(16) std::array<int16_t, kSymbols + 1> starts_{};  ///< ascending, from 0 to 2^kBits
  uint32_t seen_ = 0;
};

}  // namespace promenade
