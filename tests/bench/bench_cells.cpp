// What a cell's front costs in the build, and a step from cell to cell at run time.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <random>

#include "codec/id_set.h"
#include "layout/cell_faces.h"
#include "layout/cell_front.h"
#include "layout/cells_io.h"
#include "layout/node_forest.h"
#include "preprocess/visibility/view_cells.h"
#include "runtime/cursor.h"
#include "runtime/vlod_marks.h"

namespace promenade {
namespace {

constexpr float kSideM = 1024;

/// A quadtree over a square kilometre whose errors halve with each level: 4^levels leaves.
Model quadtree(uint32_t levels) {
  Model model;
  ModelTables& tables = model.tables;
  NodeRecord root;
  root.box = {{0, 0, 0}, {kSideM, kSideM, 30}};
  root.error_m = 16;
  tables.nodes.push_back(root);
  tables.roots = {NodeId{0}};
  for (uint32_t i = 0; i < tables.nodes.size(); ++i) {
    if (tables.nodes[i].level == levels) continue;
    tables.nodes[i].first_child = static_cast<uint32_t>(tables.children.size());
    tables.nodes[i].child_count = 4;
    const Box box = tables.nodes[i].box;
    for (uint32_t quarter = 0; quarter < 4; ++quarter) {
      NodeRecord child;
      child.box = box;
      ((quarter & 1U) != 0 ? child.box.min.x : child.box.max.x) = box.center().x;
      ((quarter & 2U) != 0 ? child.box.min.y : child.box.max.y) = box.center().y;
      child.error_m = tables.nodes[i].error_m / 2;
      child.level = tables.nodes[i].level + 1;
      child.parent = NodeId{i};
      child.triangles = 2000;
      tables.children.push_back(NodeId{static_cast<uint32_t>(tables.nodes.size())});
      tables.nodes.push_back(child);
    }
  }
  return model;
}

FrontBound one_pixel() { return {1, pixel_scale(1280, 720, 60)}; }

/// Cells of 16 m or so over the same square.
CellTables cells() {
  CellPlan plan({{0, 0, 0}, {kSideM, kSideM, 16}});
  std::vector<uint32_t> open = {CellPlan::kRoot}, leaves;
  while (!open.empty()) {
    const uint32_t leaf = open.back();
    open.pop_back();
    if (plan.box_of(leaf).size().x <= 16) {
      plan.set_cell(leaf, plan.box_of(leaf));
      continue;
    }
    for (const uint32_t part : plan.split_octants(leaf)) open.push_back(part);
  }
  CellTables tables = tables_of(plan, one_pixel(), leaves);
  if (!find_faces(tables)) return {};
  return tables;
}

void front_of_a_cell(benchmark::State& state) {
  const Model model = quadtree(static_cast<uint32_t>(state.range(0)));
  const Box cell{{500, 500, 0}, {516, 516, 16}};
  size_t nodes = 0;
  for (auto _ : state) nodes = cell_front(model, cell, one_pixel()).size();
  state.counters["front_nodes"] = double(nodes);
  state.counters["model_nodes"] = double(model.tables.nodes.size());
}
BENCHMARK(front_of_a_cell)->Arg(5)->Arg(7)->Arg(9)->Unit(benchmark::kMicrosecond);

void cursor_steps(benchmark::State& state) {
  const CellTables tables = cells();
  Cursor cursor(&tables);
  glm::dvec3 eye(512, 512, 2), velocity(0.9, 0.31, 0);
  for (auto _ : state) {
    for (int i = 0; i < 2; ++i)
      if (eye[i] + velocity[i] < 0 || eye[i] + velocity[i] > double(kSideM)) velocity[i] = -velocity[i];
    eye += velocity;
    benchmark::DoNotOptimize(cursor.move_to(eye));
  }
  state.counters["cells"] = double(tables.cells.size());
}
BENCHMARK(cursor_steps);

void cursor_teleports(benchmark::State& state) {
  const CellTables tables = cells();
  Cursor cursor(&tables);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> place(0, kSideM);
  for (auto _ : state) benchmark::DoNotOptimize(cursor.move_to({place(random), place(random), 2}));
}
BENCHMARK(cursor_teleports);

/// A step between two neighbouring cells: their difference on the tree.
void marks_step(benchmark::State& state) {
  const Model model = quadtree(7);
  const Box left{{500, 500, 0}, {516, 516, 16}}, right{{516, 500, 0}, {532, 516, 16}};
  const std::vector<NodeId> a = cell_front(model, left, one_pixel()), b = cell_front(model, right, one_pixel());
  VlodMarks marks(model);
  bool at_a = false;
  for (auto _ : state) marks.change_to((at_a = !at_a) ? a : b);
  state.counters["nodes"] = double(a.size());
}
BENCHMARK(marks_step)->Unit(benchmark::kMicrosecond);

/// Any cell's whole set from disk, without anything read before: every vLOD of a model's cells in turn, its block not
/// among those that were read last. longest_ms: the slowest of all cells. The argument: levels of the quadtree.
void teleports(benchmark::State& state) {
  const Model model = quadtree(static_cast<uint32_t>(state.range(0)));
  const CellTables tables = cells();
  const std::filesystem::path file = std::filesystem::temp_directory_path() / "promenade_bench_cells.bin";
  const CellsOwner owner{1, static_cast<uint32_t>(model.tables.nodes.size())};
  const Result<NodeForest> forest = node_forest(model.tables);
  const auto vlod_of = [&](CellId cell) {
    return Result<std::vector<NodeId>>(cell_front(model, tables.cells[index_of(cell)].box, one_pixel()));
  };
  if (!write_cells(file, tables, owner, *forest, vlod_of).ok()) return state.SkipWithError("cannot write");
  const Result<CellsReader> reader = CellsReader::open(file, owner, *forest);
  if (!reader.ok()) return state.SkipWithError("cannot open");
  const auto count = static_cast<uint32_t>(tables.cells.size());
  std::mt19937 random(1);
  double longest_s = 0;
  size_t nodes = 0, reads = 0;
  for (auto _ : state) {
    const auto start = std::chrono::steady_clock::now();
    const Result<Vlod> vlod = reader->read_vlod(CellId{static_cast<uint32_t>(random() % count)});
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    longest_s = std::max(longest_s, seconds);
    nodes += vlod->nodes.size(), reads += vlod->bytes_read > 0 ? 1U : 0U;
  }
  const double times = double(state.iterations());
  state.counters["nodes"] = double(nodes) / times;
  state.counters["read_share"] = double(reads) / times;
  state.counters["longest_ms"] = longest_s * 1e3;
  state.counters["blocks"] = double(reader->blocks().size());
  std::filesystem::remove(file);
}
BENCHMARK(teleports)->Arg(5)->Arg(7)->Arg(9)->Unit(benchmark::kMicrosecond);

void decode_vlod(benchmark::State& state) {
  const Model model = quadtree(7);
  std::vector<uint32_t> ids;
  for (const NodeId id : cell_front(model, {{500, 500, 0}, {516, 516, 16}}, one_pixel())) ids.push_back(index_of(id));
  const std::vector<std::byte> bytes = encode_ids(ids);
  for (auto _ : state) benchmark::DoNotOptimize(decode_ids(bytes, static_cast<uint32_t>(model.tables.nodes.size())));
  state.counters["bytes"] = double(bytes.size());
  state.SetItemsProcessed(state.iterations() * static_cast<int64_t>(ids.size()));
}
BENCHMARK(decode_vlod)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace promenade
