#pragma once
// Four lanes in the compilers' own vector types: any processor.
// The three simd_*.h files define the same names; raster/kernel.inl is written once on top of them. Every operation is
// exact or rounds as IEEE 754 says, so all widths give the same bits.

#include <cstdint>

#define PROMENADE_INLINE [[gnu::always_inline]] inline

namespace promenade::simd_portable {

constexpr int kLanes = 4;
using FloatBits = float __attribute__((vector_size(16)));
using IntBits = int32_t __attribute__((vector_size(16)));
using ByteBits = uint8_t __attribute__((vector_size(16)));
using WordBits = uint32_t __attribute__((vector_size(16)));  // wraps, as the processors' integers do

struct F {
  FloatBits v;
};
struct I {
  IntBits v;
};
/// A lane's choice: all bits set, or none.
struct M {
  IntBits v;
};

PROMENADE_INLINE F splat(float a) { return {FloatBits{a, a, a, a}}; }
PROMENADE_INLINE I splat(int32_t a) { return {IntBits{a, a, a, a}}; }
PROMENADE_INLINE F load(const float* p) {
  F r;
  __builtin_memcpy(&r, p, sizeof r);
  return r;
}
PROMENADE_INLINE I load(const int32_t* p) {
  I r;
  __builtin_memcpy(&r, p, sizeof r);
  return r;
}
PROMENADE_INLINE I load(const uint16_t* p) { return {IntBits{p[0], p[1], p[2], p[3]}}; }
PROMENADE_INLINE I load(const uint8_t* p) { return {IntBits{p[0], p[1], p[2], p[3]}}; }
PROMENADE_INLINE void store(float* p, F a) { __builtin_memcpy(p, &a, sizeof a); }
PROMENADE_INLINE void store(int32_t* p, I a) { __builtin_memcpy(p, &a, sizeof a); }

PROMENADE_INLINE F operator+(F a, F b) { return {a.v + b.v}; }
PROMENADE_INLINE F operator-(F a, F b) { return {a.v - b.v}; }
PROMENADE_INLINE F operator*(F a, F b) { return {a.v * b.v}; }
PROMENADE_INLINE F operator/(F a, F b) { return {a.v / b.v}; }
PROMENADE_INLINE I operator+(I a, I b) { return {IntBits(WordBits(a.v) + WordBits(b.v))}; }
PROMENADE_INLINE I operator-(I a, I b) { return {IntBits(WordBits(a.v) - WordBits(b.v))}; }
PROMENADE_INLINE I operator*(I a, I b) { return {IntBits(WordBits(a.v) * WordBits(b.v))}; }
PROMENADE_INLINE I operator&(I a, I b) { return {a.v & b.v}; }
PROMENADE_INLINE I operator|(I a, I b) { return {a.v | b.v}; }
PROMENADE_INLINE M operator&(M a, M b) { return {a.v & b.v}; }
PROMENADE_INLINE M operator|(M a, M b) { return {a.v | b.v}; }
template <int Bits>
PROMENADE_INLINE I shift_right(I a) {
  return {a.v >> Bits};
}
template <int Bits>
PROMENADE_INLINE I shift_left(I a) {
  return {IntBits(WordBits(a.v) << Bits)};
}

PROMENADE_INLINE M operator<(F a, F b) { return {a.v < b.v}; }
PROMENADE_INLINE M operator<=(F a, F b) { return {a.v <= b.v}; }
PROMENADE_INLINE M operator>(F a, F b) { return {a.v > b.v}; }
PROMENADE_INLINE M operator>=(F a, F b) { return {a.v >= b.v}; }
PROMENADE_INLINE M operator<(I a, I b) { return {a.v < b.v}; }
PROMENADE_INLINE M operator>(I a, I b) { return {a.v > b.v}; }
PROMENADE_INLINE M equal(I a, I b) { return {a.v == b.v}; }
PROMENADE_INLINE M less_unsigned(I a, I b) {
  const IntBits flip = splat(INT32_MIN).v;
  return {(a.v ^ flip) < (b.v ^ flip)};
}

PROMENADE_INLINE F select(M m, F a, F b) {
  return {
      reinterpret_cast<FloatBits>((reinterpret_cast<IntBits>(a.v) & m.v) | (reinterpret_cast<IntBits>(b.v) & ~m.v))};
}
PROMENADE_INLINE I select(M m, I a, I b) { return {(a.v & m.v) | (b.v & ~m.v)}; }
PROMENADE_INLINE F min(F a, F b) { return select(a < b, a, b); }
PROMENADE_INLINE F max(F a, F b) { return select(a > b, a, b); }
PROMENADE_INLINE I min(I a, I b) { return select(a < b, a, b); }
PROMENADE_INLINE I max(I a, I b) { return select(a > b, a, b); }
/// Of each byte, unsigned.
PROMENADE_INLINE I max_bytes(I a, I b) {
  const ByteBits x = reinterpret_cast<ByteBits>(a.v), y = reinterpret_cast<ByteBits>(b.v);
  const ByteBits more = reinterpret_cast<ByteBits>(x > y);
  return {reinterpret_cast<IntBits>((x & more) | (y & ~more))};
}
PROMENADE_INLINE I difference_of_bytes(I a, I b) {
  const ByteBits x = reinterpret_cast<ByteBits>(a.v), y = reinterpret_cast<ByteBits>(b.v);
  const ByteBits more = reinterpret_cast<ByteBits>(x > y);
  return {reinterpret_cast<IntBits>(((x - y) & more) | ((y - x) & ~more))};
}
PROMENADE_INLINE F abs(F a) {
  return {reinterpret_cast<FloatBits>(reinterpret_cast<IntBits>(a.v) & splat(INT32_MAX).v)};
}
PROMENADE_INLINE I abs(I a) { return select(a < splat(0), splat(0) - a, a); }

/// The chosen lanes to p; the others stay.
PROMENADE_INLINE void store_chosen(int32_t* p, M m, I a) { store(p, select(m, a, load(p))); }

PROMENADE_INLINE uint32_t bits(M m) {
  return (uint32_t(m.v[0]) & 1U) | (uint32_t(m.v[1]) & 2U) | (uint32_t(m.v[2]) & 4U) | (uint32_t(m.v[3]) & 8U);
}
PROMENADE_INLINE M mask_of(uint32_t b) {
  return {IntBits{-int32_t(b & 1U), -int32_t(b >> 1 & 1U), -int32_t(b >> 2 & 1U), -int32_t(b >> 3 & 1U)}};
}

PROMENADE_INLINE F to_float(I a) { return {__builtin_convertvector(a.v, FloatBits)}; }
/// To the nearest, ties to even; |a| <= 2^22.
PROMENADE_INLINE I round_to_int(F a) {
  const FloatBits magic = splat(12582912.0F).v;  // 1.5 * 2^23: the sum's last bit is worth 1
  return {reinterpret_cast<IntBits>(a.v + magic) - reinterpret_cast<IntBits>(magic)};
}
PROMENADE_INLINE I as_int(F a) { return {reinterpret_cast<IntBits>(a.v)}; }
PROMENADE_INLINE F as_float(I a) { return {reinterpret_cast<FloatBits>(a.v)}; }

PROMENADE_INLINE F sqrt(F a) {
  return {
      FloatBits{__builtin_sqrtf(a.v[0]), __builtin_sqrtf(a.v[1]), __builtin_sqrtf(a.v[2]), __builtin_sqrtf(a.v[3])}};
}
/// Rounded down; |a| < 2^31.
PROMENADE_INLINE F floor(F a) {
  const IntBits whole = __builtin_convertvector(a.v, IntBits);
  const FloatBits back = __builtin_convertvector(whole, FloatBits);
  return {__builtin_convertvector(whole + (back > a.v), FloatBits)};  // a true comparison is -1
}
/// Towards zero.
PROMENADE_INLINE I truncate(F a) { return {__builtin_convertvector(a.v, IntBits)}; }
PROMENADE_INLINE I shift_right_by(I a, I by) { return {a.v >> by.v}; }

/// A table of 16, 32 or 64 floats, looked up by smaller numbers.
template <int Entries>
struct Table {
  const float* p;
  explicit Table(const float* table) : p(table) {}
  F operator[](I i) const { return {FloatBits{p[i.v[0]], p[i.v[1]], p[i.v[2]], p[i.v[3]]}}; }
};
using Table64 = Table<64>;

/// A table of sixteen, looked up by indices 0 to 15.
struct Table16 {
  const int32_t* p;
  explicit Table16(const uint32_t* table) : p(reinterpret_cast<const int32_t*>(table)) {}
  I operator[](I i) const { return {IntBits{p[i.v[0]], p[i.v[1]], p[i.v[2]], p[i.v[3]]}}; }
};

/// The chosen lanes, packed together, to p; what follows them up to p + kLanes is overwritten.
PROMENADE_INLINE void pack(float* p, M m, F a) {
  for (int i = 0; i < kLanes; ++i) *p = a.v[i], p += m.v[i] != 0;
}
PROMENADE_INLINE void pack(int32_t* p, M m, I a) {
  for (int i = 0; i < kLanes; ++i) *p = a.v[i], p += m.v[i] != 0;
}
/// The other way: the chosen lanes get what lies at p, one after the other, the others 0. Reads up to p + kLanes.
PROMENADE_INLINE F unpack(const float* p, M m) {
  F r = splat(0.0F);
  for (int i = 0; i < kLanes; ++i)
    if (m.v[i] != 0) r.v[i] = *p++;
  return r;
}

/// kLanes pairs, one after the other in memory: their first and their second halves.
PROMENADE_INLINE void load_pairs(const uint64_t* p, I& first, I& second) {
  IntBits a, b;
  __builtin_memcpy(&a, p, sizeof a), __builtin_memcpy(&b, p + 2, sizeof b);
  first = {__builtin_shufflevector(a, b, 0, 2, 4, 6)};
  second = {__builtin_shufflevector(a, b, 1, 3, 5, 7)};
}

}  // namespace promenade::simd_portable
