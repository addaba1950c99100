#pragma once
// The latest different numbers: what is asked for again is told by its rank.

#include <emmintrin.h>

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
  /// Without a branch: ranks are hard to foretell.
  [[gnu::always_inline]] void use(uint32_t rank) {
    const uint32_t number = numbers_[rank];
    auto* to = reinterpret_cast<__m128i*>(numbers_.data());
    const __m128i last = _mm_set1_epi32(static_cast<int>(rank) + 1);
    for (size_t i = kMost / 4; i-- > 0;) {  // from the last, as each takes one from the four before
      const auto first = static_cast<int>(4 * i);
      const __m128i moves = _mm_cmplt_epi32(_mm_setr_epi32(first, first + 1, first + 2, first + 3), last);
      const __m128i now = _mm_load_si128(to + i);
      const __m128i before = i > 0 ? _mm_loadu_si128(reinterpret_cast<const __m128i*>(numbers_.data() + 4 * i - 1))
                                   : _mm_slli_si128(now, 4);
      _mm_store_si128(to + i, _mm_or_si128(_mm_and_si128(moves, before), _mm_andnot_si128(moves, now)));
    }
    numbers_[0] = number;
  }
  /// One that is not there; the last one leaves.
  [[gnu::always_inline]] void add(uint32_t number) {
    auto* at = reinterpret_cast<__m128i*>(numbers_.data() + 1);  // not one too many: the array has room for it
    const auto* from = reinterpret_cast<const __m128i*>(numbers_.data());
    const __m128i a = _mm_load_si128(from), b = _mm_load_si128(from + 1), c = _mm_load_si128(from + 2),
                  d = _mm_load_si128(from + 3);
    _mm_storeu_si128(at, a), _mm_storeu_si128(at + 1, b), _mm_storeu_si128(at + 2, c), _mm_storeu_si128(at + 3, d);
    numbers_[0] = number;
  }

 private:
  alignas(16) std::array<uint32_t, kMost + 4> numbers_{};
};

}  // namespace promenade
