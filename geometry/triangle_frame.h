#pragma once
// Distances to triangles that lie in frames of their own, four at a time.

#include <smmintrin.h>

namespace promenade {

// Four lanes at once. g++ and clang give __m128 the arithmetic operators; neither turns the plain loops into vector
// code.
using Lanes = __m128;

inline Lanes lower(Lanes a, Lanes b) { return _mm_min_ps(a, b); }
inline Lanes upper(Lanes a, Lanes b) { return _mm_max_ps(a, b); }
inline Lanes clamp01(Lanes t) { return lower(upper(t, _mm_setzero_ps()), _mm_set1_ps(1)); }

/// Squared distances of points to four triangles, each in its triangle's frame: origin at a corner, x along an edge of
/// length `base`, y across it towards the apex (apex_x, apex_y >= 0), z along the normal. The inverses are those of the
/// squared lengths of the edges origin-apex and base-apex, 0 for an edge without length. Inside is judged strictly: a
/// flat triangle has none.
inline Lanes distance2_in_frame(Lanes x, Lanes y, Lanes z, Lanes base, Lanes apex_x, Lanes apex_y, Lanes inverse_left2,
                                Lanes inverse_right2) {
  const Lanes base_dx = x - lower(upper(x, _mm_setzero_ps()), base);
  const Lanes base2 = base_dx * base_dx + y * y;

  const Lanes left_t = clamp01((x * apex_x + y * apex_y) * inverse_left2);
  const Lanes left_dx = x - left_t * apex_x;
  const Lanes left_dy = y - left_t * apex_y;
  const Lanes left2 = left_dx * left_dx + left_dy * left_dy;

  const Lanes from_base = x - base;
  const Lanes edge_x = apex_x - base;
  const Lanes right_t = clamp01((from_base * edge_x + y * apex_y) * inverse_right2);
  const Lanes right_dx = from_base - right_t * edge_x;
  const Lanes right_dy = y - right_t * apex_y;
  const Lanes right2 = right_dx * right_dx + right_dy * right_dy;

  const Lanes left_side = apex_y * x - apex_x * y;
  const Lanes right_side = edge_x * y - apex_y * from_base;
  const Lanes inside = _mm_cmpgt_ps(lower(lower(left_side, right_side), y), _mm_setzero_ps());
  return _mm_andnot_ps(inside, lower(lower(base2, left2), right2)) + z * z;
}

}  // namespace promenade
