// Triangles per second of a build and of its stages, over a generated city.

#include <benchmark/benchmark.h>
#include <unistd.h>

#include <filesystem>
#include <string>

#include "datasets/city.h"
#include "preprocess/build.h"

namespace promenade {
namespace {

/// range: triangles, jobs.
void BM_Build(benchmark::State& state) {
  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / ("promenade_bench_build_" + std::to_string(::getpid()));
  std::filesystem::create_directories(folder);
  JobMonitor monitor;
  CityOptions city;
  city.triangles = static_cast<uint64_t>(state.range(0));
  if (const auto made = generate_city(city, folder / "city.glb", monitor); !made.ok())
    state.SkipWithError(made.error().message.c_str());
  BuildOptions options;
  options.sources = {folder / "city.glb"};
  options.model = folder / "city.prom";
  options.jobs = static_cast<uint32_t>(state.range(1));
  for (auto _ : state) {
    const Result<BuildFigures> figures = build_model(options, monitor);
    if (!figures.ok()) {
      state.SkipWithError(figures.error().message.c_str());
      break;
    }
    const auto triangles = double(figures->triangles_in);
    for (const auto& [stage, seconds] : figures->stage_wall_s)
      state.counters[stage + "_triangles_per_s"] = triangles / seconds;
    for (const auto& [part, seconds] : figures->node_cpu_s)
      if (seconds > 0) state.counters[part + "_us_per_triangle"] = 1e6 * seconds / triangles;
    state.counters["triangles_per_s"] = benchmark::Counter(triangles, benchmark::Counter::kIsIterationInvariantRate);
    state.counters["bits_per_triangle"] = 8 * double(figures->bytes_by_part.at("geometry")) / triangles;
  }
  std::filesystem::remove_all(folder);
}
BENCHMARK(BM_Build)
    ->Args({100'000, 1})
    ->Args({100'000, 2})
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime()
    ->Iterations(1);

}  // namespace
}  // namespace promenade
