#pragma once
// Surfaces over a square grid, cut into right triangles that are halved where more detail is wanted: right-triangulated
// irregular networks (Evans, Kirkpatrick, Townsend, "Right-triangulated irregular networks", 2001).

#include <array>
#include <cstdint>
#include <span>
#include <utility>

namespace promenade {

/// A grid of 2^levels + 1 vertices a side; vertex (x, y) has the index y * side + x. Two triangles cover it, meeting
/// along the diagonal from (0, 0). A triangle is halved at the middle of its hypotenuse when that vertex is kept. Which
/// vertices are kept is an array of one byte each; the corners always are.
struct HalvedGrid {
  uint32_t levels = 0;  ///< at most kMostLevels

  static constexpr uint32_t kMostLevels = 12;
  uint32_t side() const { return (1U << levels) + 1; }
  uint32_t cells() const { return 1U << levels; }
  uint64_t vertices() const { return uint64_t(side()) * side(); }
  uint32_t index(uint32_t x, uint32_t y) const { return y * side() + x; }
};

/// A vertex that two triangles (one at the grid's border) may be halved at.
struct HalvingPoint {
  uint32_t at = 0;
  std::array<uint32_t, 2> ends{};    ///< of the hypotenuse, whose middle it is
  std::array<uint32_t, 2> apexes{};  ///< the corners across it; at the border both are the same
};

/// Calls visit(const HalvingPoint&) for every vertex but the corners, the finest first: each after all whose halving
/// needs it. Reversed: the coarsest first.
template <class Visit>
void for_each_halving_point(const HalvedGrid& grid, bool coarsest_first, Visit&& visit) {
  const uint32_t n = grid.cells();
  const auto centres = [&](uint32_t size) {
    const uint32_t half = size / 2;
    for (uint32_t y = half; y < n; y += size)
      for (uint32_t x = half; x < n; x += size) {
        const uint32_t a = grid.index(x - half, y - half), b = grid.index(x + half, y + half);
        const uint32_t c = grid.index(x + half, y - half), d = grid.index(x - half, y + half);
        // The diagonals of a square's quarters meet in its middle.
        const bool main = ((x / size + y / size) & 1U) == 0;
        if (main)
          visit(HalvingPoint{grid.index(x, y), {a, b}, {c, d}});
        else
          visit(HalvingPoint{grid.index(x, y), {c, d}, {a, b}});
      }
  };
  const auto edges = [&](uint32_t size) {
    const uint32_t half = size / 2;
    for (uint32_t y = 0; y <= n; y += half)
      for (uint32_t x = (y / half) % 2 == 0 ? half : 0; x <= n; x += size) {
        const bool flat = (y / half) % 2 == 0;  // along a row
        const uint32_t at = grid.index(x, y);
        const uint32_t along = flat ? half : half * grid.side(), across = flat ? half * grid.side() : half;
        const uint32_t place = flat ? y : x;
        const uint32_t before = place > 0 ? at - across : at + across, after = place < n ? at + across : before;
        visit(HalvingPoint{at, {at - along, at + along}, {before, after}});
      }
  };
  if (coarsest_first) {
    for (uint32_t size = n; size >= 2; size /= 2) centres(size), edges(size);
  } else {
    for (uint32_t size = 2; size <= n; size *= 2) edges(size), centres(size);
  }
}

/// Keeps every vertex that those which are kept need to be reached by halvings, so that no triangle meets another's
/// edge in its middle. kept: one a vertex, 0 or 1. Returns whether any was added.
bool close_halvings(const HalvedGrid& grid, std::span<uint8_t> kept);

/// Keeps vertices until the triangles between them, with the kept vertices' values, lie within [low, high] at every
/// vertex (a vertex's own value must), beginning with those that are kept already; closed afterwards. All spans: one
/// a vertex.
void refine_halvings(const HalvedGrid& grid, std::span<const float> value, std::span<const float> low,
                     std::span<const float> high, std::span<uint8_t> kept);

/// Calls visit(a, b, c), indices of vertices clockwise on a grid whose rows go down, for every triangle.
template <class Visit>
void for_each_triangle(const HalvedGrid& grid, std::span<const uint8_t> kept, Visit&& visit) {
  struct Corner {
    uint32_t x, y;
  };
  struct Open {
    Corner a, b, c;  ///< c across the hypotenuse
  };
  const uint32_t n = grid.cells();
  // As deep as halvings go, each leaving one triangle behind.
  std::array<Open, 2 * HalvedGrid::kMostLevels + 4> open{};
  size_t count = 0;
  const auto push = [&](const Corner& a, const Corner& b, const Corner& c) { open[count++] = {a, b, c}; };
  push({0, 0}, {n, n}, {0, n});
  push({n, n}, {0, 0}, {n, 0});
  const auto at = [&](const Corner& p) { return grid.index(p.x, p.y); };
  while (count > 0) {
    const auto [a, b, c] = open[--count];
    const Corner m{(a.x + b.x) / 2, (a.y + b.y) / 2};
    const bool halvable = (a.x + b.x) % 2 == 0 && (a.y + b.y) % 2 == 0;
    if (halvable && kept[at(m)] != 0) {
      push(c, a, m);
      push(b, c, m);
    } else {
      visit(at(a), at(b), at(c));
    }
  }
}

}  // namespace promenade
