// Finding the flat patches of another colour in a node's triangles, and raising the sheets that they become; finding
// the reliefs of walls and windows.

#include <benchmark/benchmark.h>

#include "preprocess/patches.h"
#include "preprocess/relief.h"
#include "tests/preprocess/surfaces.h"

namespace promenade {
namespace {

void count_triangles(benchmark::State& state, const WorkMesh& work, size_t patches) {
  state.counters["triangles_per_s"] =
      benchmark::Counter(double(work.triangle_count()), benchmark::Counter::kIsIterationInvariantRate);
  state.counters["patches"] = double(patches);
}

/// Houses whose windows are woven into their walls: nearly every pane is a patch.
void BM_add_patches(benchmark::State& state) {
  const Mesh mesh = test::box_city_block();
  const WorkMesh whole = make_work_mesh(mesh);
  WorkMesh work;
  size_t patches = 0;
  for (auto _ : state) {
    state.PauseTiming();
    work = whole;
    state.ResumeTiming();
    patches = add_patches(work, mesh).size();
  }
  count_triangles(state, whole, patches);
}
BENCHMARK(BM_add_patches)->Unit(benchmark::kMicrosecond);

/// The same houses: every wall and its panes.
void BM_find_reliefs(benchmark::State& state) {
  const WorkMesh work = make_work_mesh(test::box_city_block());
  size_t reliefs = 0;
  for (auto _ : state) reliefs = find_reliefs(work, 1).size();
  state.counters["triangles_per_s"] =
      benchmark::Counter(double(work.triangle_count()), benchmark::Counter::kIsIterationInvariantRate);
  state.counters["reliefs"] = double(reliefs);
}
BENCHMARK(BM_find_reliefs)->Unit(benchmark::kMicrosecond);

/// The same walls, every pane lifted.
void BM_raise_sheets(benchmark::State& state) {
  constexpr float kHeightM = 0.05F, kReachM = 0.4F;
  const Mesh mesh = test::box_city_block();
  WorkMesh lifted = make_work_mesh(mesh);
  const std::vector<Patch> patches = add_patches(lifted, mesh);
  for (const Patch& patch : patches) lift(patch, lifted);
  const std::vector<uint8_t> may_rise(lifted.triangle_count(), 1);
  WorkMesh work;
  for (auto _ : state) {
    state.PauseTiming();
    work = lifted;
    state.ResumeTiming();
    if (!raise_sheets(work, mesh, may_rise, kHeightM, kReachM)) return state.SkipWithError("nothing has risen");
  }
  count_triangles(state, lifted, patches.size());
}
BENCHMARK(BM_raise_sheets)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace promenade
