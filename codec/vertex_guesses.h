#pragma once
// Where a vertex is expected: what is known of the triangle that it completes and of the one beside that.
// Source: Touma and Gotsman, Triangle Mesh Compression, 1998.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "geometry/result.h"

namespace promenade {

/// Vertices known when a new one is met: a + b - c, or a, or nothing.
struct Guess {
  uint32_t a = 0, b = 0, c = 0;
  uint8_t known = 0;  ///< 0, 1 or 3
};

/// A guess for every vertex, in order. Fails where the triangles do not meet vertices in order, or not all of them.
Result<std::vector<Guess>> guess_vertices(std::span<const uint32_t> indices, size_t vertices);

/// The same guesses without parallelograms, for what does not continue linearly.
std::vector<Guess> without_parallelograms(std::vector<Guess> guesses);

/// What is expected of one component, modulo 2^32.
template <class Vec>
uint32_t expected(const std::vector<Vec>& values, const Guess& guess, int i) {
  const auto at = [&](uint32_t v) { return static_cast<uint32_t>(values[v][i]); };
  if (guess.known == 0) return 0;
  return guess.known == 3 ? at(guess.a) + at(guess.b) - at(guess.c) : at(guess.a);
}

/// Three vertices that a new one may be like: a, b and c, or else the last three, where there are so many: below v.
inline std::array<uint32_t, 3> likely_vertices(const Guess& guess, uint32_t v) {
  if (guess.known == 3) return {guess.a, guess.b, guess.c};
  return {v - 1, v - 2, v - 3};
}

/// Differences of 16 or 32 bits, small ones of either sign small.
inline uint32_t folded(uint32_t difference, bool wide) {
  if (!wide) difference = static_cast<uint32_t>(static_cast<int32_t>(static_cast<int16_t>(difference & 0xffffU)));
  return (difference << 1U) ^ (0U - (difference >> 31U));
}
inline uint32_t unfolded(uint32_t code) { return (code >> 1U) ^ (0U - (code & 1U)); }

}  // namespace promenade
