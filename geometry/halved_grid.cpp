#include "geometry/halved_grid.h"

#include <algorithm>
#include <cstdlib>

namespace promenade {
namespace {

/// Values over the vertices within one triangle of the grid, its legs or its hypotenuse along the axes.
class TriangleCheck {
 public:
  TriangleCheck(const HalvedGrid& grid, std::span<const float> value, std::span<const float> low,
                std::span<const float> high)
      : side_(static_cast<int32_t>(grid.side())), value_(value), low_(low), high_(high) {}

  /// Whether the plane through the corners stays within the bounds at all vertices of the triangle.
  bool within(uint32_t a, uint32_t b, uint32_t c) const {
    const Place pa = place(a), pb = place(b), pc = place(c);
    // Both differences are along an axis for legs, and add up to one for a hypotenuse along an axis.
    const float ux = static_cast<float>(pa.x - pc.x), uy = static_cast<float>(pa.y - pc.y);
    const float vx = static_cast<float>(pb.x - pc.x), vy = static_cast<float>(pb.y - pc.y);
    const float du = value_[a] - value_[c], dv = value_[b] - value_[c];
    const float inverse = 1 / (ux * vy - uy * vx);
    const float by_x = (du * vy - dv * uy) * inverse, by_y = (dv * ux - du * vx) * inverse;
    const int32_t top = std::min({pa.y, pb.y, pc.y}), bottom = std::max({pa.y, pb.y, pc.y});
    for (int32_t y = top; y <= bottom; ++y) {
      int32_t left = side_, right = -1;
      for (const auto& [p, q] : {std::pair(pa, pb), std::pair(pb, pc), std::pair(pc, pa)}) {
        if (y < std::min(p.y, q.y) || y > std::max(p.y, q.y)) continue;
        if (p.y == q.y) {
          left = std::min({left, p.x, q.x}), right = std::max({right, p.x, q.x});
          continue;
        }
        // Edges are vertical or diagonal: whole numbers throughout.
        const int32_t x =
            p.x + (q.x - p.x) / std::abs(q.x == p.x ? 1 : q.x - p.x) * std::abs(y - p.y) * (q.x != p.x ? 1 : 0);
        left = std::min(left, x), right = std::max(right, x);
      }
      const float base = value_[c] + by_y * static_cast<float>(y - pc.y) - by_x * static_cast<float>(pc.x);
      const size_t row = size_t(y) * static_cast<size_t>(side_);
      bool inside = true;
      for (int32_t x = left; x <= right; ++x) {
        const float here = base + by_x * static_cast<float>(x);
        inside = inside && here >= low_[row + static_cast<size_t>(x)] && here <= high_[row + static_cast<size_t>(x)];
      }
      if (!inside) return false;
    }
    return true;
  }

 private:
  struct Place {
    int32_t x, y;
  };
  Place place(uint32_t index) const {
    return {static_cast<int32_t>(index) % side_, static_cast<int32_t>(index) / side_};
  }

  int32_t side_;
  std::span<const float> value_, low_, high_;
};

}  // namespace

bool close_halvings(const HalvedGrid& grid, std::span<uint8_t> kept) {
  bool added = false;
  for_each_halving_point(grid, false, [&](const HalvingPoint& p) {
    if (kept[p.at] == 0) return;
    for (const uint32_t apex : p.apexes) {
      added = added || kept[apex] == 0;
      kept[apex] = 1;
    }
  });
  for (const uint32_t y : {0U, grid.cells()})
    for (const uint32_t x : {0U, grid.cells()}) kept[grid.index(x, y)] = 1;
  return added;
}

void refine_halvings(const HalvedGrid& grid, std::span<const float> value, std::span<const float> low,
                     std::span<const float> high, std::span<uint8_t> kept) {
  const TriangleCheck check(grid, value, low, high);
  for_each_halving_point(grid, false, [&](const HalvingPoint& p) {
    if (kept[p.at] == 0)
      for (const uint32_t apex : p.apexes)
        if (!check.within(p.ends[0], p.ends[1], apex)) {
          kept[p.at] = 1;
          break;
        }
    if (kept[p.at] == 0) return;
    for (const uint32_t apex : p.apexes) kept[apex] = 1;
  });
  close_halvings(grid, kept);
}

}  // namespace promenade
