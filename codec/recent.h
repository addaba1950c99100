#pragma once
// The latest different numbers: what is asked for again is told by its rank.

#include <tmmintrin.h>

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "codec/adaptive_models.h"

namespace promenade {

/// The latest first; what is used moves to the front. As many as a NibbleModel tells apart. At first all are 0.
class Recent {
 public:
  static constexpr uint32_t kMost = NibbleModel::kSymbols;
  /// kMost: it is not there.
  uint32_t rank_of(uint32_t number) const {
    const __m128i wanted = _mm_set1_epi32(static_cast<int>(number));
    const auto like = [&](size_t i) {
      return _mm_cmpeq_epi32(_mm_load_si128(reinterpret_cast<const __m128i*>(numbers_.data()) + i), wanted);
    };
    const __m128i all = _mm_packs_epi16(_mm_packs_epi32(like(0), like(1)), _mm_packs_epi32(like(2), like(3)));
    return static_cast<uint32_t>(std::countr_zero(static_cast<uint32_t>(_mm_movemask_epi8(all)) | 1U << kMost));
  }
  /// rank: below kMost.
  uint32_t at(uint32_t rank) const { return numbers_[rank]; }
  /// Without a branch: ranks are hard to foretell. And in whole vectors: what was just written is read so again.
  [[gnu::always_inline]] void use(uint32_t rank) {
    const __m128i last = _mm_set1_epi32(static_cast<int>(rank) + 1);
    __m128i before = _mm_slli_si128(_mm_cvtsi32_si128(static_cast<int>(numbers_[rank])), 12);
    for (int i = 0; i < int(kMost); i += 4) {
      auto* four = reinterpret_cast<__m128i*>(numbers_.data() + i);
      const __m128i moves = _mm_cmplt_epi32(_mm_setr_epi32(i, i + 1, i + 2, i + 3), last);
      const __m128i now = _mm_load_si128(four), moved = _mm_alignr_epi8(now, before, 12);
      _mm_store_si128(four, _mm_or_si128(_mm_and_si128(moves, moved), _mm_andnot_si128(moves, now)));
      before = now;
    }
  }
  /// One that is not there; the last one leaves.
  [[gnu::always_inline]] void add(uint32_t number) {
    __m128i before = _mm_slli_si128(_mm_cvtsi32_si128(static_cast<int>(number)), 12);
    for (size_t i = 0; i < kMost; i += 4) {
      auto* four = reinterpret_cast<__m128i*>(numbers_.data() + i);
      const __m128i now = _mm_load_si128(four);
      _mm_store_si128(four, _mm_alignr_epi8(now, before, 12));
      before = now;
    }
  }

 private:
  alignas(16) std::array<uint32_t, kMost> numbers_{};
};

}  // namespace promenade
