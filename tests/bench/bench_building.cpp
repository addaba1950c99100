// How fast a furnished building is designed and written; argument: thousands of triangles.
#include <benchmark/benchmark.h>

#include <filesystem>

#include "datasets/building.h"

namespace promenade {
namespace {

void BM_generate_building(benchmark::State& state) {
  BuildingOptions options;
  options.triangles = static_cast<uint64_t>(state.range(0)) * 1000;
  const std::filesystem::path output = std::filesystem::temp_directory_path() / "bench_building.glb";
  JobMonitor monitor;
  uint64_t triangles = 0, bytes = 0;
  for (auto _ : state) {
    const Result<BuildingFigures> made = generate_building(options, output, monitor);
    if (!made) return state.SkipWithError(made.error().message.c_str());
    triangles += made->triangles, bytes += made->bytes;
  }
  state.counters["triangles/s"] = benchmark::Counter(static_cast<double>(triangles), benchmark::Counter::kIsRate);
  state.SetBytesProcessed(static_cast<int64_t>(bytes));
  std::filesystem::remove(output);
  std::filesystem::remove(std::filesystem::temp_directory_path() / "bench_building_walk.json");
}
BENCHMARK(BM_generate_building)->Arg(1400)->Arg(10'000)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace promenade
