#pragma once
// Sixteen lanes of AVX-512 (F, BW, DQ, VL, CD); see simd_portable.h. Include only from a file compiled for it.

#include <immintrin.h>

#include <cstdint>

#define PROMENADE_INLINE [[gnu::always_inline]] inline

namespace promenade::simd_avx512 {

constexpr int kLanes = 16;
struct F {
  __m512 v;
};
struct I {
  __m512i v;
};
struct M {
  __mmask16 v;
};

PROMENADE_INLINE F splat(float a) { return {_mm512_set1_ps(a)}; }
PROMENADE_INLINE I splat(int32_t a) { return {_mm512_set1_epi32(a)}; }
PROMENADE_INLINE F load(const float* p) { return {_mm512_loadu_ps(p)}; }
PROMENADE_INLINE I load(const int32_t* p) { return {_mm512_loadu_si512(p)}; }
PROMENADE_INLINE I load(const uint16_t* p) {
  return {_mm512_cvtepu16_epi32(_mm256_loadu_si256(reinterpret_cast<const __m256i*>(p)))};
}
PROMENADE_INLINE I load(const uint8_t* p) {
  return {_mm512_cvtepu8_epi32(_mm_loadu_si128(reinterpret_cast<const __m128i*>(p)))};
}
PROMENADE_INLINE void store(float* p, F a) { _mm512_storeu_ps(p, a.v); }
PROMENADE_INLINE void store(int32_t* p, I a) { _mm512_storeu_si512(p, a.v); }

PROMENADE_INLINE F operator+(F a, F b) { return {_mm512_add_ps(a.v, b.v)}; }
PROMENADE_INLINE F operator-(F a, F b) { return {_mm512_sub_ps(a.v, b.v)}; }
PROMENADE_INLINE F operator*(F a, F b) { return {_mm512_mul_ps(a.v, b.v)}; }
PROMENADE_INLINE F operator/(F a, F b) { return {_mm512_div_ps(a.v, b.v)}; }
PROMENADE_INLINE I operator+(I a, I b) { return {_mm512_add_epi32(a.v, b.v)}; }
PROMENADE_INLINE I operator-(I a, I b) { return {_mm512_sub_epi32(a.v, b.v)}; }
PROMENADE_INLINE I operator*(I a, I b) { return {_mm512_mullo_epi32(a.v, b.v)}; }
PROMENADE_INLINE I operator&(I a, I b) { return {_mm512_and_si512(a.v, b.v)}; }
PROMENADE_INLINE I operator|(I a, I b) { return {_mm512_or_si512(a.v, b.v)}; }
PROMENADE_INLINE M operator&(M a, M b) { return {static_cast<__mmask16>(a.v & b.v)}; }
PROMENADE_INLINE M operator|(M a, M b) { return {static_cast<__mmask16>(a.v | b.v)}; }
template <int Bits>
PROMENADE_INLINE I shift_right(I a) {
  return {_mm512_srai_epi32(a.v, Bits)};
}
template <int Bits>
PROMENADE_INLINE I shift_left(I a) {
  return {_mm512_slli_epi32(a.v, Bits)};
}

PROMENADE_INLINE M operator<(F a, F b) { return {_mm512_cmp_ps_mask(a.v, b.v, _CMP_LT_OQ)}; }
PROMENADE_INLINE M operator<=(F a, F b) { return {_mm512_cmp_ps_mask(a.v, b.v, _CMP_LE_OQ)}; }
PROMENADE_INLINE M operator>(F a, F b) { return {_mm512_cmp_ps_mask(a.v, b.v, _CMP_GT_OQ)}; }
PROMENADE_INLINE M operator>=(F a, F b) { return {_mm512_cmp_ps_mask(a.v, b.v, _CMP_GE_OQ)}; }
PROMENADE_INLINE M operator<(I a, I b) { return {_mm512_cmplt_epi32_mask(a.v, b.v)}; }
PROMENADE_INLINE M operator>(I a, I b) { return {_mm512_cmpgt_epi32_mask(a.v, b.v)}; }
PROMENADE_INLINE M equal(I a, I b) { return {_mm512_cmpeq_epi32_mask(a.v, b.v)}; }
PROMENADE_INLINE M less_unsigned(I a, I b) { return {_mm512_cmplt_epu32_mask(a.v, b.v)}; }

PROMENADE_INLINE F select(M m, F a, F b) { return {_mm512_mask_blend_ps(m.v, b.v, a.v)}; }
PROMENADE_INLINE I select(M m, I a, I b) { return {_mm512_mask_blend_epi32(m.v, b.v, a.v)}; }
PROMENADE_INLINE F min(F a, F b) { return {_mm512_min_ps(a.v, b.v)}; }
PROMENADE_INLINE F max(F a, F b) { return {_mm512_max_ps(a.v, b.v)}; }
PROMENADE_INLINE I min(I a, I b) { return {_mm512_min_epi32(a.v, b.v)}; }
PROMENADE_INLINE I max(I a, I b) { return {_mm512_max_epi32(a.v, b.v)}; }
PROMENADE_INLINE I max_bytes(I a, I b) { return {_mm512_max_epu8(a.v, b.v)}; }
PROMENADE_INLINE I difference_of_bytes(I a, I b) {
  return {_mm512_or_si512(_mm512_subs_epu8(a.v, b.v), _mm512_subs_epu8(b.v, a.v))};
}
PROMENADE_INLINE F abs(F a) { return {_mm512_abs_ps(a.v)}; }
PROMENADE_INLINE I abs(I a) { return {_mm512_abs_epi32(a.v)}; }

/// The chosen lanes to p; the others stay.
PROMENADE_INLINE void store_chosen(int32_t* p, M m, I a) { _mm512_mask_storeu_epi32(p, m.v, a.v); }

/// By an instruction of its own: where GCC 12 widens a mask itself, it may spill 16 bits of it and read back 32.
PROMENADE_INLINE uint32_t bits(M m) {
  uint32_t b;
  asm("kmovw %1, %0" : "=r"(b) : "k"(m.v));
  return b;
}
PROMENADE_INLINE M mask_of(uint32_t b) { return {static_cast<__mmask16>(b)}; }

PROMENADE_INLINE F to_float(I a) { return {_mm512_cvtepi32_ps(a.v)}; }
PROMENADE_INLINE I round_to_int(F a) { return {_mm512_cvtps_epi32(a.v)}; }
PROMENADE_INLINE I as_int(F a) { return {_mm512_castps_si512(a.v)}; }
PROMENADE_INLINE F as_float(I a) { return {_mm512_castsi512_ps(a.v)}; }

PROMENADE_INLINE F sqrt(F a) { return {_mm512_sqrt_ps(a.v)}; }
PROMENADE_INLINE F floor(F a) { return {_mm512_roundscale_ps(a.v, _MM_FROUND_TO_NEG_INF | _MM_FROUND_NO_EXC)}; }
PROMENADE_INLINE I truncate(F a) { return {_mm512_cvttps_epi32(a.v)}; }
PROMENADE_INLINE I shift_right_by(I a, I by) { return {_mm512_srav_epi32(a.v, by.v)}; }

/// Held in registers: at most two permutes and a blend, where a gather would cost ten times as much.
template <int Entries>
struct Table;
template <>
struct Table<16> {
  __m512 a;
  explicit Table(const float* p) : a(_mm512_loadu_ps(p)) {}
  PROMENADE_INLINE F operator[](I i) const { return {_mm512_permutexvar_ps(i.v, a)}; }
};
template <>
struct Table<32> {
  __m512 a, b;
  explicit Table(const float* p) : a(_mm512_loadu_ps(p)), b(_mm512_loadu_ps(p + 16)) {}
  PROMENADE_INLINE F operator[](I i) const { return {_mm512_permutex2var_ps(a, i.v, b)}; }
};
template <>
struct Table<64> {
  __m512 a, b, c, d;
  explicit Table(const float* p)
      : a(_mm512_loadu_ps(p)), b(_mm512_loadu_ps(p + 16)), c(_mm512_loadu_ps(p + 32)), d(_mm512_loadu_ps(p + 48)) {}
  PROMENADE_INLINE F operator[](I i) const {
    const __mmask16 upper = _mm512_test_epi32_mask(i.v, _mm512_set1_epi32(32));
    return {_mm512_mask_blend_ps(upper, _mm512_permutex2var_ps(a, i.v, b), _mm512_permutex2var_ps(c, i.v, d))};
  }
};
using Table64 = Table<64>;

/// Sixteen numbers in a register, looked up by indices 0 to 15.
struct Table16 {
  __m512i v;
  explicit Table16(const uint32_t* p) : v(_mm512_loadu_si512(p)) {}
  PROMENADE_INLINE I operator[](I i) const { return {_mm512_permutexvar_epi32(i.v, v)}; }
};

/// The chosen lanes, packed together, to p; what follows them up to p + kLanes is overwritten.
PROMENADE_INLINE void pack(float* p, M m, F a) { _mm512_storeu_ps(p, _mm512_maskz_compress_ps(m.v, a.v)); }
PROMENADE_INLINE void pack(int32_t* p, M m, I a) { _mm512_storeu_si512(p, _mm512_maskz_compress_epi32(m.v, a.v)); }
/// The other way: the chosen lanes get what lies at p, one after the other, the others 0. Reads up to p + kLanes.
PROMENADE_INLINE F unpack(const float* p, M m) { return {_mm512_maskz_expand_ps(m.v, _mm512_loadu_ps(p))}; }

/// kLanes pairs, one after the other in memory: their first and their second halves.
PROMENADE_INLINE void load_pairs(const uint64_t* p, I& first, I& second) {
  const __m512i a = _mm512_loadu_si512(p), b = _mm512_loadu_si512(p + 8);
  const __m512i even = _mm512_setr_epi32(0, 2, 4, 6, 8, 10, 12, 14, 16, 18, 20, 22, 24, 26, 28, 30);
  first = {_mm512_permutex2var_epi32(a, even, b)};
  second = {_mm512_permutex2var_epi32(a, _mm512_or_si512(even, _mm512_set1_epi32(1)), b)};
}

}  // namespace promenade::simd_avx512
