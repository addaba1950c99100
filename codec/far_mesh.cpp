#include "codec/far_mesh.h"

#include <algorithm>

#include "geometry/cube_side.h"

namespace promenade {
namespace {

constexpr uint32_t kNone = 0xffffffffU;
/// Pixels that filters reach over borders, of a picture seen at half its size.
constexpr uint32_t kFilterReach = 2;

/// How many pixels show something, in any rectangle.
class Coverage {
 public:
  explicit Coverage(const FarFace& face) : grid_(face.grid), sums_(size_t(grid_.side() + 1) * (grid_.side() + 1), 0) {
    const uint32_t side = grid_.side();
    for (uint32_t y = 0; y < side; ++y)
      for (uint32_t x = 0; x < side; ++x)
        sum(x + 1, y + 1) = sum(x, y + 1) + sum(x + 1, y) - sum(x, y) + (face.colors.at(x, y).a != 0 ? 1U : 0U);
  }

  /// Within the triangle's rectangle and a pixel around it: filtering reaches that far.
  bool any(uint32_t a, uint32_t b, uint32_t c) { return count(a, b, c).there != 0; }
  /// The same, all of them. `reach` pixels around: coarser pictures of the face have filters that reach farther.
  bool all(uint32_t a, uint32_t b, uint32_t c, uint32_t reach) {
    const Count found = count(a, b, c, reach);
    return found.there == found.pixels;
  }

 private:
  struct Count {
    uint32_t there = 0, pixels = 0;
  };
  Count count(uint32_t a, uint32_t b, uint32_t c, uint32_t reach = 1) {
    const uint32_t side = grid_.side();
    const auto [x0, x1] = std::minmax({a % side, b % side, c % side});
    const auto [y0, y1] = std::minmax({a / side, b / side, c / side});
    const uint32_t left = x0 > reach ? x0 - reach : 0, top = y0 > reach ? y0 - reach : 0;
    const uint32_t right = std::min(x1 + reach + 1, side), bottom = std::min(y1 + reach + 1, side);
    return {sum(right, bottom) + sum(left, top) - sum(left, bottom) - sum(right, top), (right - left) * (bottom - top)};
  }

  uint32_t& sum(uint32_t x, uint32_t y) { return sums_[size_t(y) * (grid_.side() + 1) + x]; }

  const HalvedGrid& grid_;
  std::vector<uint32_t> sums_;
};

}  // namespace

Mesh far_mesh(const FarFace& face, const FarPlace& place) {
  const HalvedGrid& grid = face.grid;
  const CubeSide axes = cube_side(place.side);
  const double half_m = place.box_m / 2, middle = grid.cells() / 2.0;
  Mesh mesh;
  std::vector<uint32_t> number(grid.vertices(), kNone);
  Coverage coverage(face);
  const auto vertex = [&](uint32_t at) {
    if (number[at] != kNone) return number[at];
    const uint32_t x = at % grid.side(), y = at / grid.side();
    const double inverse = std::max<double>(face.depth[at], 1) / FarFace::kNearest;
    const double depth_m = half_m / inverse * (place.pushed ? 1 + kFarPush : 1);
    // A grid of one square has its vertices on the borders, too.
    const double right = middle > 0 ? (x - middle) / middle : 0, up = middle > 0 ? (middle - y) / middle : 0;
    mesh.positions.emplace_back(place.centre + depth_m * (axes.forward + right * axes.right + up * axes.up));
    mesh.texcoords.emplace_back((float(x) + 0.5F) / float(grid.side()), (float(y) + 0.5F) / float(grid.side()));
    return number[at] = static_cast<uint32_t>(mesh.positions.size() - 1);
  };
  for_each_triangle(grid, face.kept, [&](uint32_t a, uint32_t b, uint32_t c) {
    if (!coverage.any(a, b, c)) return;
    // Clockwise in a picture is seen from behind: turned.
    const uint32_t va = vertex(a), vb = vertex(b), vc = vertex(c);
    mesh.indices.insert(mesh.indices.end(), {va, vc, vb});
    mesh.materials.push_back(coverage.all(a, b, c, kFilterReach) ? 0 : 1);
  });
  return mesh;
}

uint32_t far_triangles(const FarFace& face) {
  uint32_t count = 0;
  Coverage coverage(face);
  for_each_triangle(face.grid, face.kept,
                    [&](uint32_t a, uint32_t b, uint32_t c) { count += coverage.any(a, b, c) ? 1U : 0U; });
  return count;
}

}  // namespace promenade
