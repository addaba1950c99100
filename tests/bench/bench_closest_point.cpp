// Building the tree of boxes and asking it: triangles and queries a second.

#include <benchmark/benchmark.h>

#include <cmath>
#include <numbers>

#include "geometry/closest_point.h"

namespace promenade {
namespace {

/// A sphere of radius 10 m with a fine relief, so that neighbouring triangles differ.
Mesh rough_sphere(uint32_t rings) {
  Mesh mesh;
  const uint32_t sectors = rings * 2;
  for (uint32_t r = 0; r <= rings; ++r)
    for (uint32_t s = 0; s <= sectors; ++s) {
      const double theta = std::numbers::pi * r / rings;
      const double phi = 2 * std::numbers::pi * s / sectors;
      const double radius = 10 + 0.2 * std::sin(9 * theta) * std::cos(13 * phi);
      mesh.positions.emplace_back(radius * std::sin(theta) * std::cos(phi), radius * std::sin(theta) * std::sin(phi),
                                  radius * std::cos(theta));
    }
  for (uint32_t r = 0; r < rings; ++r)
    for (uint32_t s = 0; s < sectors; ++s) {
      const uint32_t a = r * (sectors + 1) + s;
      const uint32_t b = a + sectors + 1;
      mesh.indices.insert(mesh.indices.end(), {a, b, a + 1, a + 1, b, b + 1});
    }
  return mesh;
}

void BM_build(benchmark::State& state) {
  const Mesh mesh = rough_sphere(static_cast<uint32_t>(state.range(0)));
  for (auto _ : state) benchmark::DoNotOptimize(ClosestPointTree(mesh));
  state.counters["triangles_per_s"] =
      benchmark::Counter(double(mesh.triangle_count()), benchmark::Counter::kIsIterationInvariantRate);
}
BENCHMARK(BM_build)->Arg(22)->Arg(45)->Arg(160)->Unit(benchmark::kMicrosecond);

/// Points at `offset_mm` from the surface; in order along it, each hinted by the one before (range 2), or not.
void BM_query(benchmark::State& state) {
  const Mesh mesh = rough_sphere(static_cast<uint32_t>(state.range(0)));
  const ClosestPointTree tree(mesh);
  const float factor = 1 + float(state.range(1)) * 1e-4F;
  const bool hinted = state.range(2) != 0;
  const size_t stride = hinted ? 1 : 7919;
  uint32_t hint = kNoTriangle;
  size_t v = 0;
  for (auto _ : state) {
    const glm::vec3 p = mesh.positions[v] * factor;
    const ClosestPointTree::Nearest found = tree.nearest(p, {.hint = hinted ? hint : kNoTriangle});
    hint = found.triangle;
    benchmark::DoNotOptimize(found);
    v = (v + stride) % mesh.positions.size();
  }
  state.counters["triangles"] = double(mesh.triangle_count());
}
BENCHMARK(BM_query)->ArgsProduct({{22, 45, 160}, {20, 500}, {0, 1}});

}  // namespace
}  // namespace promenade
