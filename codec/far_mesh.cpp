#include "codec/far_mesh.h"

#include <algorithm>

#include "codec/far_coverage.h"
#include "geometry/cube_side.h"

namespace promenade {
namespace {

constexpr uint32_t kNone = 0xffffffffU;
/// Pixels that filters reach over borders, of a picture seen at half its size.
constexpr uint32_t kFilterReach = 2;

}  // namespace

Mesh far_mesh(const FarFace& face, const FarPlace& place) {
  const HalvedGrid& grid = face.grid;
  const CubeSide axes = cube_side(place.side);
  const double half_m = place.box_m / 2, middle = grid.cells() / 2.0;
  Mesh mesh;
  std::vector<uint32_t> number(grid.vertices(), kNone);
  const FarCoverage coverage(face);
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
  const FarCoverage coverage(face);
  for_each_triangle(face.grid, face.kept,
                    [&](uint32_t a, uint32_t b, uint32_t c) { count += coverage.any(a, b, c) ? 1U : 0U; });
  return count;
}

}  // namespace promenade
