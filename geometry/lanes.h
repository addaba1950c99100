#pragma once
// Eight floats at once: as one AVX register where the file is compiled for AVX2, else as two SSE ones. Both compute the
// same bits.

#include <immintrin.h>

#define PROMENADE_INLINE [[gnu::always_inline]] inline

namespace promenade {

#ifdef __AVX2__
namespace lanes_avx2 {

struct Lanes {
  __m256 v;
};
PROMENADE_INLINE Lanes splat(float a) { return {_mm256_set1_ps(a)}; }
PROMENADE_INLINE Lanes load(const float* p) { return {_mm256_load_ps(p)}; }
/// From any address.
PROMENADE_INLINE Lanes load_any(const float* p) { return {_mm256_loadu_ps(p)}; }
PROMENADE_INLINE void store(float* p, Lanes a) { _mm256_store_ps(p, a.v); }
PROMENADE_INLINE Lanes operator+(Lanes a, Lanes b) { return {_mm256_add_ps(a.v, b.v)}; }
PROMENADE_INLINE Lanes operator-(Lanes a, Lanes b) { return {_mm256_sub_ps(a.v, b.v)}; }
PROMENADE_INLINE Lanes operator*(Lanes a, Lanes b) { return {_mm256_mul_ps(a.v, b.v)}; }
PROMENADE_INLINE Lanes operator/(Lanes a, Lanes b) { return {_mm256_div_ps(a.v, b.v)}; }
PROMENADE_INLINE Lanes lower(Lanes a, Lanes b) { return {_mm256_min_ps(a.v, b.v)}; }
PROMENADE_INLINE Lanes upper(Lanes a, Lanes b) { return {_mm256_max_ps(a.v, b.v)}; }
PROMENADE_INLINE Lanes root(Lanes a) { return {_mm256_sqrt_ps(a.v)}; }
PROMENADE_INLINE Lanes less(Lanes a, Lanes b) { return {_mm256_cmp_ps(a.v, b.v, _CMP_LT_OQ)}; }
PROMENADE_INLINE Lanes less_or_equal(Lanes a, Lanes b) { return {_mm256_cmp_ps(a.v, b.v, _CMP_LE_OQ)}; }
/// value where the mask is set, else 0; and the other way round.
PROMENADE_INLINE Lanes where(Lanes mask, Lanes value) { return {_mm256_and_ps(mask.v, value.v)}; }
PROMENADE_INLINE Lanes where_not(Lanes mask, Lanes value) { return {_mm256_andnot_ps(mask.v, value.v)}; }
PROMENADE_INLINE Lanes selected(Lanes mask, Lanes yes, Lanes no) { return {_mm256_blendv_ps(no.v, yes.v, mask.v)}; }
/// A bit a lane.
PROMENADE_INLINE unsigned bits(Lanes mask) { return static_cast<unsigned>(_mm256_movemask_ps(mask.v)); }
/// The least lane; none may be NaN.
PROMENADE_INLINE float least(Lanes a) {
  const __m128 four = _mm_min_ps(_mm256_castps256_ps128(a.v), _mm256_extractf128_ps(a.v, 1));
  const __m128 two = _mm_min_ps(four, _mm_movehl_ps(four, four));
  return _mm_cvtss_f32(_mm_min_ss(two, _mm_movehdup_ps(two)));
}

}  // namespace lanes_avx2
#else
namespace lanes_sse {

struct Lanes {
  __m128 low, high;
};
PROMENADE_INLINE Lanes splat(float a) { return {_mm_set1_ps(a), _mm_set1_ps(a)}; }
PROMENADE_INLINE Lanes load(const float* p) { return {_mm_load_ps(p), _mm_load_ps(p + 4)}; }
/// From any address.
PROMENADE_INLINE Lanes load_any(const float* p) { return {_mm_loadu_ps(p), _mm_loadu_ps(p + 4)}; }
PROMENADE_INLINE void store(float* p, Lanes a) { _mm_store_ps(p, a.low), _mm_store_ps(p + 4, a.high); }
PROMENADE_INLINE Lanes operator+(Lanes a, Lanes b) { return {_mm_add_ps(a.low, b.low), _mm_add_ps(a.high, b.high)}; }
PROMENADE_INLINE Lanes operator-(Lanes a, Lanes b) { return {_mm_sub_ps(a.low, b.low), _mm_sub_ps(a.high, b.high)}; }
PROMENADE_INLINE Lanes operator*(Lanes a, Lanes b) { return {_mm_mul_ps(a.low, b.low), _mm_mul_ps(a.high, b.high)}; }
PROMENADE_INLINE Lanes operator/(Lanes a, Lanes b) { return {_mm_div_ps(a.low, b.low), _mm_div_ps(a.high, b.high)}; }
PROMENADE_INLINE Lanes lower(Lanes a, Lanes b) { return {_mm_min_ps(a.low, b.low), _mm_min_ps(a.high, b.high)}; }
PROMENADE_INLINE Lanes upper(Lanes a, Lanes b) { return {_mm_max_ps(a.low, b.low), _mm_max_ps(a.high, b.high)}; }
PROMENADE_INLINE Lanes root(Lanes a) { return {_mm_sqrt_ps(a.low), _mm_sqrt_ps(a.high)}; }
PROMENADE_INLINE Lanes less(Lanes a, Lanes b) { return {_mm_cmplt_ps(a.low, b.low), _mm_cmplt_ps(a.high, b.high)}; }
PROMENADE_INLINE Lanes less_or_equal(Lanes a, Lanes b) {
  return {_mm_cmple_ps(a.low, b.low), _mm_cmple_ps(a.high, b.high)};
}
/// value where the mask is set, else 0; and the other way round.
PROMENADE_INLINE Lanes where(Lanes mask, Lanes value) {
  return {_mm_and_ps(mask.low, value.low), _mm_and_ps(mask.high, value.high)};
}
PROMENADE_INLINE Lanes where_not(Lanes mask, Lanes value) {
  return {_mm_andnot_ps(mask.low, value.low), _mm_andnot_ps(mask.high, value.high)};
}
PROMENADE_INLINE Lanes selected(Lanes mask, Lanes yes, Lanes no) {
  return {_mm_blendv_ps(no.low, yes.low, mask.low), _mm_blendv_ps(no.high, yes.high, mask.high)};
}
/// A bit a lane.
PROMENADE_INLINE unsigned bits(Lanes mask) {
  return static_cast<unsigned>(_mm_movemask_ps(mask.low)) | static_cast<unsigned>(_mm_movemask_ps(mask.high)) << 4U;
}
/// The least lane; none may be NaN.
PROMENADE_INLINE float least(Lanes a) {
  const __m128 four = _mm_min_ps(a.low, a.high);
  const __m128 two = _mm_min_ps(four, _mm_movehl_ps(four, four));
  return _mm_cvtss_f32(_mm_min_ss(two, _mm_movehdup_ps(two)));
}

}  // namespace lanes_sse
#endif

}  // namespace promenade
