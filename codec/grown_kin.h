#pragma once
// What new places and vertices of a growing mesh are met with.

#include <cstdint>

#include "codec/vertex_guesses.h"

namespace promenade {

/// Three places that a new one is likely to be like. Before the first place there are three more, at 0, so that places
/// are numbered from kFirstPlace on here.
struct PlaceKin {
  uint32_t family =
      0;  ///< 0: a place of a new part, 1: beside another one, 2: beyond the edge a b of a triangle with c
  uint32_t a = 0, b = 0, c = 0;
};

constexpr uint32_t kFirstPlace = 3;

/// count: of the places before.
inline PlaceKin kin_of_nothing(uint32_t count) { return {0, count + 2, count + 1, count}; }
inline PlaceKin kin_of_one(uint32_t count, uint32_t beside) {
  beside += kFirstPlace;
  return beside == count + 2 ? PlaceKin{1, beside, count + 1, count} : PlaceKin{1, beside, count + 2, count + 1};
}
inline PlaceKin kin_of_three(uint32_t a, uint32_t b, uint32_t c) {
  return {2, a + kFirstPlace, b + kFirstPlace, c + kFirstPlace};
}

/// What a vertex was met with.
struct VertexKin {
  Guess guess;            ///< a: the one that it is likely to look like
  uint32_t twin = kNone;  ///< another in the same place; kNone: it was the first there
  static constexpr uint32_t kNone = 0xffffffffU;
};

}  // namespace promenade
