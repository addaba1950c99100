#pragma once
// Eight lanes of AVX2; see simd_portable.h. Include only from a file compiled for AVX2.

#include <immintrin.h>

#include <cstdint>

#define PROMENADE_INLINE [[gnu::always_inline]] inline

namespace promenade::simd_avx2 {

constexpr int kLanes = 8;
struct F {
  __m256 v;
};
struct I {
  __m256i v;
};
struct M {
  __m256i v;
};

PROMENADE_INLINE F splat(float a) { return {_mm256_set1_ps(a)}; }
PROMENADE_INLINE I splat(int32_t a) { return {_mm256_set1_epi32(a)}; }
PROMENADE_INLINE F load(const float* p) { return {_mm256_loadu_ps(p)}; }
PROMENADE_INLINE I load(const int32_t* p) { return {_mm256_loadu_si256(reinterpret_cast<const __m256i*>(p))}; }
PROMENADE_INLINE I load(const uint16_t* p) {
  return {_mm256_cvtepu16_epi32(_mm_loadu_si128(reinterpret_cast<const __m128i*>(p)))};
}
PROMENADE_INLINE I load(const uint8_t* p) {
  return {_mm256_cvtepu8_epi32(_mm_loadl_epi64(reinterpret_cast<const __m128i*>(p)))};
}
PROMENADE_INLINE void store(float* p, F a) { _mm256_storeu_ps(p, a.v); }
PROMENADE_INLINE void store(int32_t* p, I a) { _mm256_storeu_si256(reinterpret_cast<__m256i*>(p), a.v); }

PROMENADE_INLINE F operator+(F a, F b) { return {_mm256_add_ps(a.v, b.v)}; }
PROMENADE_INLINE F operator-(F a, F b) { return {_mm256_sub_ps(a.v, b.v)}; }
PROMENADE_INLINE F operator*(F a, F b) { return {_mm256_mul_ps(a.v, b.v)}; }
PROMENADE_INLINE F operator/(F a, F b) { return {_mm256_div_ps(a.v, b.v)}; }
PROMENADE_INLINE I operator+(I a, I b) { return {_mm256_add_epi32(a.v, b.v)}; }
PROMENADE_INLINE I operator-(I a, I b) { return {_mm256_sub_epi32(a.v, b.v)}; }
PROMENADE_INLINE I operator*(I a, I b) { return {_mm256_mullo_epi32(a.v, b.v)}; }
PROMENADE_INLINE I operator&(I a, I b) { return {_mm256_and_si256(a.v, b.v)}; }
PROMENADE_INLINE I operator|(I a, I b) { return {_mm256_or_si256(a.v, b.v)}; }
PROMENADE_INLINE M operator&(M a, M b) { return {_mm256_and_si256(a.v, b.v)}; }
PROMENADE_INLINE M operator|(M a, M b) { return {_mm256_or_si256(a.v, b.v)}; }
template <int Bits>
PROMENADE_INLINE I shift_right(I a) {
  return {_mm256_srai_epi32(a.v, Bits)};
}
template <int Bits>
PROMENADE_INLINE I shift_left(I a) {
  return {_mm256_slli_epi32(a.v, Bits)};
}

PROMENADE_INLINE M operator<(F a, F b) { return {_mm256_castps_si256(_mm256_cmp_ps(a.v, b.v, _CMP_LT_OQ))}; }
PROMENADE_INLINE M operator<=(F a, F b) { return {_mm256_castps_si256(_mm256_cmp_ps(a.v, b.v, _CMP_LE_OQ))}; }
PROMENADE_INLINE M operator>(F a, F b) { return {_mm256_castps_si256(_mm256_cmp_ps(a.v, b.v, _CMP_GT_OQ))}; }
PROMENADE_INLINE M operator>=(F a, F b) { return {_mm256_castps_si256(_mm256_cmp_ps(a.v, b.v, _CMP_GE_OQ))}; }
PROMENADE_INLINE M operator<(I a, I b) { return {_mm256_cmpgt_epi32(b.v, a.v)}; }
PROMENADE_INLINE M operator>(I a, I b) { return {_mm256_cmpgt_epi32(a.v, b.v)}; }
PROMENADE_INLINE M equal(I a, I b) { return {_mm256_cmpeq_epi32(a.v, b.v)}; }
PROMENADE_INLINE M less_unsigned(I a, I b) {
  const __m256i flip = _mm256_set1_epi32(INT32_MIN);
  return {_mm256_cmpgt_epi32(_mm256_xor_si256(b.v, flip), _mm256_xor_si256(a.v, flip))};
}

PROMENADE_INLINE F select(M m, F a, F b) { return {_mm256_blendv_ps(b.v, a.v, _mm256_castsi256_ps(m.v))}; }
PROMENADE_INLINE I select(M m, I a, I b) { return {_mm256_blendv_epi8(b.v, a.v, m.v)}; }
PROMENADE_INLINE F min(F a, F b) { return {_mm256_min_ps(a.v, b.v)}; }
PROMENADE_INLINE F max(F a, F b) { return {_mm256_max_ps(a.v, b.v)}; }
PROMENADE_INLINE I min(I a, I b) { return {_mm256_min_epi32(a.v, b.v)}; }
PROMENADE_INLINE I max(I a, I b) { return {_mm256_max_epi32(a.v, b.v)}; }
PROMENADE_INLINE I max_bytes(I a, I b) { return {_mm256_max_epu8(a.v, b.v)}; }
PROMENADE_INLINE I difference_of_bytes(I a, I b) {
  return {_mm256_or_si256(_mm256_subs_epu8(a.v, b.v), _mm256_subs_epu8(b.v, a.v))};
}
PROMENADE_INLINE F abs(F a) { return {_mm256_and_ps(a.v, _mm256_castsi256_ps(_mm256_set1_epi32(INT32_MAX)))}; }
PROMENADE_INLINE I abs(I a) { return {_mm256_abs_epi32(a.v)}; }

/// The chosen lanes to p; the others stay.
PROMENADE_INLINE void store_chosen(int32_t* p, M m, I a) { store(p, select(m, a, load(p))); }

PROMENADE_INLINE uint32_t bits(M m) { return static_cast<uint32_t>(_mm256_movemask_ps(_mm256_castsi256_ps(m.v))); }
PROMENADE_INLINE M mask_of(uint32_t b) {
  const __m256i bit = _mm256_setr_epi32(1, 2, 4, 8, 16, 32, 64, 128);
  return {_mm256_cmpeq_epi32(_mm256_and_si256(_mm256_set1_epi32(static_cast<int>(b)), bit), bit)};
}

PROMENADE_INLINE F to_float(I a) { return {_mm256_cvtepi32_ps(a.v)}; }
PROMENADE_INLINE I round_to_int(F a) { return {_mm256_cvtps_epi32(a.v)}; }
PROMENADE_INLINE I as_int(F a) { return {_mm256_castps_si256(a.v)}; }
PROMENADE_INLINE F as_float(I a) { return {_mm256_castsi256_ps(a.v)}; }

PROMENADE_INLINE F sqrt(F a) { return {_mm256_sqrt_ps(a.v)}; }
PROMENADE_INLINE F floor(F a) { return {_mm256_floor_ps(a.v)}; }
PROMENADE_INLINE I truncate(F a) { return {_mm256_cvttps_epi32(a.v)}; }
PROMENADE_INLINE I shift_right_by(I a, I by) { return {_mm256_srav_epi32(a.v, by.v)}; }

template <int Entries>
struct Table {
  const float* p;
  explicit Table(const float* table) : p(table) {}
  PROMENADE_INLINE F operator[](I i) const {
    if constexpr (Entries > 32) return {_mm256_i32gather_ps(p, i.v, 4)};
    const F low = eight(0, i), high = eight(8, i);
    const __m256 upper = _mm256_castsi256_ps(_mm256_slli_epi32(i.v, 28));  // bit 3 chooses
    const __m256 half = _mm256_blendv_ps(low.v, high.v, upper);
    if constexpr (Entries <= 16) return {half};
    const __m256 other = _mm256_blendv_ps(eight(16, i).v, eight(24, i).v, upper);
    return {_mm256_blendv_ps(half, other, _mm256_castsi256_ps(_mm256_slli_epi32(i.v, 27)))};
  }

 private:
  PROMENADE_INLINE F eight(int first, I i) const { return {_mm256_permutevar8x32_ps(_mm256_loadu_ps(p + first), i.v)}; }
};
using Table64 = Table<64>;

struct Table16 {
  const int32_t* p;
  explicit Table16(const uint32_t* table) : p(reinterpret_cast<const int32_t*>(table)) {}
  PROMENADE_INLINE I operator[](I i) const {
    const __m256i low = _mm256_permutevar8x32_epi32(_mm256_loadu_si256(reinterpret_cast<const __m256i*>(p)), i.v);
    const __m256i high = _mm256_permutevar8x32_epi32(_mm256_loadu_si256(reinterpret_cast<const __m256i*>(p + 8)), i.v);
    return {_mm256_blendv_epi8(low, high, _mm256_cmpgt_epi32(i.v, _mm256_set1_epi32(7)))};
  }
};

/// Eight lanes' numbers, a byte each, to a register.
PROMENADE_INLINE __m256i widened(uint64_t bytes) {
  return _mm256_cvtepu8_epi32(_mm_cvtsi64_si128(static_cast<long long>(bytes)));
}
/// A byte of all bits set for each chosen lane.
PROMENADE_INLINE uint64_t bytes_of(M m) { return _pdep_u64(bits(m), 0x0101010101010101U) * 255U; }
constexpr uint64_t kNumbers = 0x0706050403020100U;

/// The chosen lanes, packed together, to p; what follows them up to p + kLanes is overwritten.
PROMENADE_INLINE void pack(float* p, M m, F a) {
  _mm256_storeu_ps(p, _mm256_permutevar8x32_ps(a.v, widened(_pext_u64(kNumbers, bytes_of(m)))));
}
PROMENADE_INLINE void pack(int32_t* p, M m, I a) { pack(reinterpret_cast<float*>(p), m, as_float(a)); }
/// The other way: the chosen lanes get what lies at p, one after the other, the others 0. Reads up to p + kLanes.
PROMENADE_INLINE F unpack(const float* p, M m) {
  const __m256 spread = _mm256_permutevar8x32_ps(_mm256_loadu_ps(p), widened(_pdep_u64(kNumbers, bytes_of(m))));
  return {_mm256_and_ps(spread, _mm256_castsi256_ps(m.v))};
}

/// kLanes pairs, one after the other in memory: their first and their second halves.
PROMENADE_INLINE void load_pairs(const uint64_t* p, I& first, I& second) {
  const float* f = reinterpret_cast<const float*>(p);
  const __m256 low = _mm256_loadu_ps(f), high = _mm256_loadu_ps(f + 8);
  const __m256 a = _mm256_permute2f128_ps(low, high, 0x20), b = _mm256_permute2f128_ps(low, high, 0x31);
  first = {_mm256_castps_si256(_mm256_shuffle_ps(a, b, 0x88))};
  second = {_mm256_castps_si256(_mm256_shuffle_ps(a, b, 0xdd))};
}

}  // namespace promenade::simd_avx2
