// Import of a triangulated terrain as GLB, OBJ and binary PLY, with and without repair: triangles per second.

#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>

#include "preprocess/import.h"

namespace promenade {
namespace {

/// A height field of side x side squares.
Mesh terrain(uint32_t side) {
  Mesh mesh;
  for (uint32_t y = 0; y <= side; ++y)
    for (uint32_t x = 0; x <= side; ++x)
      mesh.positions.emplace_back(float(x), float(y), std::sin(float(x) * 0.1F) * std::cos(float(y) * 0.07F));
  for (uint32_t y = 0; y < side; ++y)
    for (uint32_t x = 0; x < side; ++x) {
      const uint32_t v = y * (side + 1) + x;
      mesh.indices.insert(mesh.indices.end(), {v, v + 1, v + side + 1, v + side + 1, v + 1, v + side + 2});
    }
  return mesh;
}

template <class T>
void put(std::string& out, const T& value) {
  out.append(reinterpret_cast<const char*>(&value), sizeof(value));
}

std::string to_glb(const Mesh& mesh) {
  const size_t position_bytes = mesh.positions.size() * 12;
  const size_t index_bytes = mesh.indices.size() * 4;
  std::string json = fmt::format(
      R"({{"asset":{{"version":"2.0"}},"buffers":[{{"byteLength":{}}}],"bufferViews":[{{"buffer":0,"byteLength":{}}},)"
      R"({{"buffer":0,"byteOffset":{},"byteLength":{}}}],"accessors":[{{"bufferView":0,"componentType":5126,"count":{},)"
      R"("type":"VEC3"}},{{"bufferView":1,"componentType":5125,"count":{},"type":"SCALAR"}}],"meshes":[{{"primitives":)"
      R"([{{"attributes":{{"POSITION":0}},"indices":1}}]}}],"nodes":[{{"mesh":0}}],"scenes":[{{"nodes":[0]}}]}})",
      position_bytes + index_bytes, position_bytes, position_bytes, index_bytes, mesh.positions.size(),
      mesh.indices.size());
  json.resize((json.size() + 3) / 4 * 4, ' ');
  std::string out;
  put(out, 0x46546C67U), put(out, 2U);
  put(out, static_cast<uint32_t>(28 + json.size() + position_bytes + index_bytes));
  put(out, static_cast<uint32_t>(json.size())), put(out, 0x4E4F534AU);
  out += json;
  put(out, static_cast<uint32_t>(position_bytes + index_bytes)), put(out, 0x004E4942U);
  out.append(reinterpret_cast<const char*>(mesh.positions.data()), position_bytes);
  out.append(reinterpret_cast<const char*>(mesh.indices.data()), index_bytes);
  return out;
}

std::string to_obj(const Mesh& mesh) {
  std::string out;
  for (const glm::vec3& p : mesh.positions) fmt::format_to(std::back_inserter(out), "v {} {} {}\n", p.x, p.y, p.z);
  for (size_t i = 0; i < mesh.indices.size(); i += 3)
    fmt::format_to(std::back_inserter(out), "f {} {} {}\n", mesh.indices[i] + 1, mesh.indices[i + 1] + 1,
                   mesh.indices[i + 2] + 1);
  return out;
}

std::string to_ply(const Mesh& mesh) {
  std::string out = fmt::format(
      "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\n"
      "element face {}\nproperty list uchar uint vertex_indices\nend_header\n",
      mesh.positions.size(), mesh.triangle_count());
  for (const glm::vec3& p : mesh.positions) put(out, p);
  for (size_t t = 0; t < mesh.triangle_count(); ++t) {
    out += '\3';
    out.append(reinterpret_cast<const char*>(&mesh.indices[3 * t]), 12);
  }
  return out;
}

void import_terrain(benchmark::State& state, const char* extension, std::string (*encode)(const Mesh&)) {
  const Mesh mesh = terrain(static_cast<uint32_t>(state.range(0)));
  const std::filesystem::path path =
      std::filesystem::temp_directory_path() / (std::string("promenade_bench_import") + extension);
  const std::string bytes = encode(mesh);
  std::ofstream(path, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  ImportOptions options;
  options.repair = state.range(1) != 0;
  JobMonitor monitor;
  for (auto _ : state) {
    const Result<Scene> scene = import_part({path, path.filename().string(), bytes.size()}, options, monitor);
    if (!scene.ok()) state.SkipWithError(scene.error().message.c_str());
    benchmark::DoNotOptimize(scene);
  }
  const auto triangles = static_cast<double>(mesh.triangle_count());
  state.counters["triangles"] = triangles;
  state.counters["triangles_per_s"] = benchmark::Counter(triangles, benchmark::Counter::kIsIterationInvariantRate);
  std::filesystem::remove(path);
}

// Squares a side (708: a million triangles) and whether faces are repaired.
BENCHMARK_CAPTURE(import_terrain, glb, ".glb", to_glb)->Args({708, 0})->Args({708, 1})->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(import_terrain, ply, ".ply", to_ply)->Args({708, 0})->Args({708, 1})->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(import_terrain, obj, ".obj", to_obj)->Args({708, 0})->Args({708, 1})->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace promenade
