// Speed and size of the mesh codecs on a hilly node of 2,048 triangles, on a grid of 1/512 m.

#include <benchmark/benchmark.h>

#include "codec/geometry_codec.h"
#include "tests/codec/mesh_fixtures.h"

namespace promenade {
namespace {

GeometryEncodeOptions options_of(const benchmark::State& state) {
  return {static_cast<GeometryCodec>(state.range(0)), 1.0F / 512, 9};
}

void set_figures(benchmark::State& state, const Mesh& mesh, size_t bytes) {
  const auto triangles = static_cast<double>(mesh.triangle_count());
  state.SetLabel(std::string(name_of(static_cast<GeometryCodec>(state.range(0)))));
  state.counters["bits_per_triangle"] = 8 * static_cast<double>(bytes) / triangles;
  state.counters["triangles_per_s"] =
      benchmark::Counter(triangles * static_cast<double>(state.iterations()), benchmark::Counter::kIsRate);
}

void BM_encode_mesh(benchmark::State& state) {
  const Mesh mesh = hills(32);
  size_t bytes = 0;
  for (auto unused : state) {
    const Result<EncodedMesh> encoded = encode_mesh(mesh, options_of(state));
    bytes = encoded ? encoded->bytes.size() : 0;
    benchmark::DoNotOptimize(bytes);
  }
  set_figures(state, mesh, bytes);
}
BENCHMARK(BM_encode_mesh)->DenseRange(0, 3);

void BM_decode_mesh(benchmark::State& state) {
  const Mesh mesh = hills(32);
  const std::vector<std::byte> bytes = encode_mesh(mesh, options_of(state))->bytes;
  for (auto unused : state) {
    const Result<Mesh> decoded = decode_mesh(bytes);
    benchmark::DoNotOptimize(decoded.ok());
  }
  set_figures(state, mesh, bytes.size());
}
BENCHMARK(BM_decode_mesh)->DenseRange(0, 3);

}  // namespace
}  // namespace promenade
