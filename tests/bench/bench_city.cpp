// Triangles a second that the city generator makes, and writes.

#include <benchmark/benchmark.h>

#include <filesystem>

#include "datasets/city.h"
#include "datasets/city_block.h"

namespace promenade {
namespace {

/// One block's geometry in memory, on one thread. Argument 0: detail.
void BM_make_block(benchmark::State& state) {
  CityOptions options;
  options.blocks_x = options.blocks_y = 16;
  const CityPlan plan(options);
  PropLibrary props;
  uint64_t triangles = 0;
  uint32_t block = 0;
  for (auto _ : state) {
    const CityBlock made =
        make_block(plan, block % 16, block / 16 % 16, {static_cast<double>(state.range(0)), false}, props);
    triangles += made.unique_triangles, ++block;
    benchmark::DoNotOptimize(made);
  }
  state.counters["unique_triangles"] = benchmark::Counter(static_cast<double>(triangles), benchmark::Counter::kIsRate);
}
BENCHMARK(BM_make_block)->Arg(1)->Arg(2)->Arg(4)->Arg(7)->Unit(benchmark::kMillisecond);

/// A whole city to disk. Argument 0: triangles. 1: threads.
void BM_generate_city(benchmark::State& state) {
  const std::filesystem::path output = std::filesystem::temp_directory_path() / "promenade_bench_city.glb";
  CityOptions options;
  options.triangles = static_cast<uint64_t>(state.range(0));
  options.jobs = static_cast<uint32_t>(state.range(1));
  JobMonitor nobody;
  uint64_t triangles = 0;
  for (auto _ : state) {
    const Result<CityFigures> figures = generate_city(options, output, nobody);
    if (!figures) return state.SkipWithError(figures.error().message.c_str());
    triangles += figures->triangles;
  }
  for (const char* name : {".glb", "_walk.json", "_drive.json", "_fly.json"})
    std::filesystem::remove(std::filesystem::temp_directory_path() / ("promenade_bench_city" + std::string(name)));
  state.counters["triangles"] = benchmark::Counter(static_cast<double>(triangles), benchmark::Counter::kIsRate);
}
BENCHMARK(BM_generate_city)
    ->Args({1'000'000, 1})
    ->Args({1'000'000, 2})
    ->Args({5'000'000, 1})
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace promenade
