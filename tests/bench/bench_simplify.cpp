// One step of the hierarchy, four to one, by our simplifier and by others: triangles a second, and the measured error
// over the box's diagonal (bound_share, p99_share). And what measuring itself costs.

#include <benchmark/benchmark.h>
#include <fmt/format.h>
#include <meshoptimizer.h>

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <OpenMesh/Tools/Decimater/DecimaterT.hh>
#include <OpenMesh/Tools/Decimater/ModQuadricT.hh>
#include <functional>
#include <string>

#include "preprocess/simplify.h"
#include "preprocess/weld.h"
#include "tests/preprocess/surfaces.h"

namespace promenade {
namespace {

using Method = std::function<Mesh(const Mesh&, uint32_t)>;

Mesh by_promenade(const Mesh& mesh, uint32_t target) { return simplify(mesh, {.target_triangles = target}); }

/// Positions only, equal ones one vertex: what the others work on.
Mesh welded(const Mesh& mesh) {
  const Places places = find_places(mesh.positions);
  Mesh out;
  for (const uint32_t v : places.first_vertex) out.positions.push_back(mesh.positions[v]);
  for (const uint32_t v : mesh.indices) out.indices.push_back(places.of_vertex[v]);
  return out;
}

Mesh by_meshoptimizer(const Mesh& mesh, uint32_t target) {
  Mesh out = welded(mesh);
  std::vector<uint32_t> indices(out.indices.size());
  indices.resize(meshopt_simplify(indices.data(), out.indices.data(), out.indices.size(), &out.positions[0].x,
                                  out.positions.size(), sizeof(glm::vec3), size_t(target) * 3, 1e9F, 0, nullptr));
  out.indices = std::move(indices);
  return out;
}

Mesh by_meshoptimizer_sloppy(const Mesh& mesh, uint32_t target) {
  Mesh out = welded(mesh);
  std::vector<uint32_t> indices(out.indices.size());
  indices.resize(meshopt_simplifySloppy(indices.data(), out.indices.data(), out.indices.size(), &out.positions[0].x,
                                        out.positions.size(), sizeof(glm::vec3), size_t(target) * 3, 1e9F, nullptr));
  out.indices = std::move(indices);
  return out;
}

Mesh by_openmesh(const Mesh& mesh, uint32_t target) {
  using HalfEdges = OpenMesh::TriMesh_ArrayKernelT<>;
  const Mesh in = welded(mesh);
  HalfEdges half_edges;
  std::vector<HalfEdges::VertexHandle> vertices;
  for (const glm::vec3& p : in.positions) vertices.push_back(half_edges.add_vertex({p.x, p.y, p.z}));
  for (size_t i = 0; i < in.indices.size(); i += 3) {
    const uint32_t a = in.indices[i], b = in.indices[i + 1], c = in.indices[i + 2];
    if (a != b && b != c && c != a) half_edges.add_face(vertices[a], vertices[b], vertices[c]);
  }
  OpenMesh::Decimater::DecimaterT<HalfEdges> decimater(half_edges);
  OpenMesh::Decimater::ModQuadricT<HalfEdges>::Handle quadric;
  decimater.add(quadric);
  decimater.module(quadric).unset_max_err();
  decimater.initialize();
  decimater.decimate_to_faces(0, target);
  half_edges.garbage_collection();
  Mesh out;
  for (const auto v : half_edges.vertices()) {
    const auto p = half_edges.point(v);
    out.positions.emplace_back(p[0], p[1], p[2]);
  }
  for (const auto f : half_edges.faces())
    for (const auto v : f.vertices()) out.indices.push_back(static_cast<uint32_t>(v.idx()));
  return out;
}

/// Adds the error's counters: outside the timing.
void report(benchmark::State& state, const Mesh& mesh, const Mesh& result) {
  const SurfaceDistance distance = surface_distance(mesh, result);
  const float diagonal = bounds(mesh).diagonal();
  state.counters["triangles_per_s"] =
      benchmark::Counter(double(mesh.triangle_count()), benchmark::Counter::kIsIterationInvariantRate);
  state.counters["triangles_out_share"] = double(result.triangle_count()) / double(mesh.triangle_count());
  state.counters["bound_share"] = double(distance.bound_m / diagonal);
  state.counters["p99_share"] = double(distance.p99_m / diagonal);
}

void BM_simplify(benchmark::State& state, const Mesh& mesh, const Method& method) {
  const auto target = static_cast<uint32_t>(mesh.triangle_count() / 4);
  Mesh result;
  for (auto _ : state) result = method(mesh, target);
  report(state, mesh, result);
}

void BM_surface_distance(benchmark::State& state, const Mesh& mesh) {
  const Mesh result = by_promenade(mesh, static_cast<uint32_t>(mesh.triangle_count() / 4));
  for (auto _ : state) benchmark::DoNotOptimize(surface_distance(mesh, result));
  report(state, mesh, result);
}

[[maybe_unused]] const bool registered = [] {
  const std::vector<std::pair<std::string, Mesh>> meshes = {
      {"city_block", test::box_city_block()}, {"ball", test::ball(45)}, {"hills", test::hills(63)}};
  const std::vector<std::pair<std::string, Method>> methods = {{"promenade", by_promenade},
                                                               {"meshoptimizer", by_meshoptimizer},
                                                               {"meshoptimizer_sloppy", by_meshoptimizer_sloppy},
                                                               {"openmesh", by_openmesh}};
  for (const auto& [mesh_name, mesh] : meshes) {
    for (const auto& [method_name, method] : methods)
      benchmark::RegisterBenchmark(fmt::format("{}/{}", mesh_name, method_name).c_str(), BM_simplify, mesh, method)
          ->Unit(benchmark::kMillisecond);
    benchmark::RegisterBenchmark((mesh_name + "/surface_distance").c_str(), BM_surface_distance, mesh)
        ->Unit(benchmark::kMillisecond);
  }
  return true;
}();

}  // namespace
}  // namespace promenade
