// Baking a node of 2,000 triangles from 8,000, with an atlas of about 256 x 256 texels; making its pictures smaller.

#include <benchmark/benchmark.h>

#include "codec/image_codec.h"
#include "preprocess/bake.h"
#include "preprocess/charts.h"
#include "tests/codec/mesh_fixtures.h"

namespace promenade {
namespace {

Image noise(uint32_t side) {
  Image image{side, side, {}};
  for (uint32_t i = 0; i < side * side; ++i) image.pixels.emplace_back(i * 7, i * 13, i * 29, 255);
  return image;
}

void BM_bake_atlas(benchmark::State& state) {
  const Mesh simplified = hills(32), detailed = hills(64);
  const Image image = noise(static_cast<uint32_t>(state.range(0)));
  Material material;
  material.texture = 0;
  const std::vector<Material> materials = {material};
  uint64_t texels = 0;
  for (auto unused : state) {
    const Result<BakedMesh> baked =
        bake_atlas(simplified, detailed, materials, [&](uint32_t) { return &image; }, {0.2, 1024, 2});
    texels = baked ? baked->atlas.pixels.size() : 0;
  }
  state.counters["texels"] = static_cast<double>(texels);
}
BENCHMARK(BM_bake_atlas)->Arg(64)->Arg(2048)->Unit(benchmark::kMillisecond);

void BM_make_charts(benchmark::State& state) {
  const Mesh mesh = hills(32);
  for (auto unused : state) benchmark::DoNotOptimize(make_charts(mesh).size());
}
BENCHMARK(BM_make_charts)->Unit(benchmark::kMillisecond);

void BM_resized(benchmark::State& state) {
  const Image image = noise(static_cast<uint32_t>(state.range(0)));
  for (auto unused : state) benchmark::DoNotOptimize(resized(image, image.width / 2, image.height / 2).pixels.data());
  state.SetItemsProcessed(static_cast<int64_t>(image.pixels.size()) * state.iterations());
}
BENCHMARK(BM_resized)->Arg(1024)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace promenade
