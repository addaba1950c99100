#include "codec/vertex_guesses.h"

#include <fmt/format.h>

#include <algorithm>

namespace promenade {
namespace {

/// How many triangles back a neighbour is looked for: orders that are good for caches have it within a few.
constexpr size_t kLookBack = 24;

/// The corner of an earlier triangle across the edge between a and b.
bool find_across(std::span<const uint32_t> indices, size_t triangle, Guess& guess) {
  const size_t first = triangle > kLookBack ? triangle - kLookBack : 0;
  for (size_t t = triangle; t-- > first;) {
    const uint32_t* v = &indices[3 * t];
    const auto has = [v](uint32_t i) { return v[0] == i || v[1] == i || v[2] == i; };
    if (!has(guess.a) || !has(guess.b)) continue;
    for (size_t c = 0; c < 3; ++c)
      if (v[c] != guess.a && v[c] != guess.b) {
        guess.c = v[c];
        return true;
      }
  }
  return false;
}

}  // namespace

Result<std::vector<Guess>> guess_vertices(std::span<const uint32_t> indices, size_t vertices) {
  if (vertices > indices.size())
    return Error{fmt::format("mesh: {} vertices for {} corners of triangles", vertices, indices.size())};
  std::vector<Guess> guesses;
  guesses.reserve(vertices);
  for (size_t t = 0; t < indices.size() / 3; ++t) {
    std::array<uint32_t, 3> v{indices[3 * t], indices[3 * t + 1], indices[3 * t + 2]};
    std::sort(v.begin(), v.end());
    for (size_t i = 0; i < 3; ++i) {
      const auto next = static_cast<uint32_t>(guesses.size());
      if (v[i] < next) continue;
      if (v[i] > next || next >= vertices)
        return Error{fmt::format("mesh: triangle {} has vertex {}, {} is next of {}", t, v[i], next, vertices)};
      Guess guess;
      guess.known = i == 0 ? 0 : 1;
      if (i > 0) guess.a = v[i - 1];
      if (i == 2 && v[1] < v[2]) {
        guess.b = v[0];
        if (v[1] != v[0] && find_across(indices, t, guess)) guess.known = 3;
      }
      if (i == 0 && next > 0) guess.known = 1, guess.a = next - 1;
      guesses.push_back(guess);
    }
  }
  if (guesses.size() != vertices)
    return Error{fmt::format("mesh: triangles use {} of {} vertices", guesses.size(), vertices)};
  return guesses;
}

std::vector<Guess> without_parallelograms(std::vector<Guess> guesses) {
  for (Guess& guess : guesses) guess.known = std::min<uint8_t>(guess.known, 1);
  return guesses;
}

}  // namespace promenade
