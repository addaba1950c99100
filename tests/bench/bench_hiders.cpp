// What a hider asks again and again: the horizon around an eye, the shadows of boxes from their best point, and what
// the build makes of a solid before.
#include <benchmark/benchmark.h>

#include <array>
#include <cmath>
#include <vector>

#include "geometry/random.h"
#include "preprocess/footprints.h"
#include "preprocess/visibility/azimuth_horizon.h"
#include "preprocess/visibility/box_view.h"
#include "preprocess/visibility/cull_map.h"
#include "preprocess/visibility/projection_point.h"
#include "tests/preprocess/situations.h"

namespace promenade {
namespace {

const Box cell{{-2, -2, 0}, {2, 2, 2}};

/// Blocks on a grid of streets around the cell.
std::vector<Box> blocks(size_t count) {
  Random random(7);
  std::vector<Box> blocks;
  const int side = static_cast<int>(std::ceil(std::sqrt(double(count))));
  for (int i = 0; i < side * side && blocks.size() < count; ++i) {
    const glm::vec3 low(float(i % side - side / 2) * 24 + 5, float(i / side - side / 2) * 24 + 5, -1);
    const glm::vec3 size(random.range(10.0F, 16.0F), random.range(10.0F, 16.0F), random.range(5.0F, 40.0F));
    blocks.push_back({low, low + size});
  }
  return blocks;
}

/// Things to hide, twice as far.
std::vector<Box> things() {
  Random random(8);
  std::vector<Box> things;
  for (int i = 0; i < 2000; ++i) {
    const glm::vec3 at(random.range(-600.0F, 600.0F), random.range(-600.0F, 600.0F), random.range(0.0F, 10.0F));
    things.push_back({at, at + glm::vec3(6, 6, 4)});
  }
  return things;
}

/// Supporting planes of so many boxes and a cell.
void shadows(benchmark::State& state) {
  const std::vector<Box> solids = blocks(static_cast<size_t>(state.range(0)));
  for (auto _ : state) benchmark::DoNotOptimize(shrunk_occluders(cell, solids));
  state.SetItemsProcessed(state.iterations() * state.range(0));
}
BENCHMARK(shadows)->Arg(150)->Arg(1500)->Unit(benchmark::kMicrosecond);

/// The quadratic program of so many boxes.
void best_point(benchmark::State& state) {
  const std::vector<ShrunkOccluder> occluders = shrunk_occluders(cell, blocks(static_cast<size_t>(state.range(0))));
  std::vector<const ShrunkOccluder*> all;
  all.reserve(occluders.size());
  for (const ShrunkOccluder& occluder : occluders) all.push_back(&occluder);
  const Box world{{-1000, -1000, -1}, {1000, 1000, 60}};
  for (auto _ : state) benchmark::DoNotOptimize(projection_point(cell, world, all));
  state.counters["boxes"] = double(all.size());
}
BENCHMARK(best_point)->Arg(150)->Arg(1500)->Unit(benchmark::kMicrosecond);

/// A picture of boxes from an eye, or of their shadows from the cell (1), and 2000 questions.
void picture(benchmark::State& state) {
  const std::vector<Box> solids = blocks(1500), asked = things();
  const std::vector<ShrunkOccluder> occluders = shrunk_occluders(cell, solids);
  BoxView view;
  size_t hidden = 0;
  for (auto _ : state) {
    view.reset(glm::dvec3(cell.center()));
    for (const Box& box : asked) view.want(box);
    if (state.range(0) == 0)
      for (const Box& box : solids) view.add(box);
    else
      for (const ShrunkOccluder& occluder : occluders) view.add(occluder.shadow);
    hidden = 0;
    for (const Box& box : asked) hidden += view.hides(box) ? 1U : 0U;
  }
  state.counters["hidden"] = double(hidden);
}
BENCHMARK(picture)->Arg(0)->Arg(1)->Unit(benchmark::kMicrosecond);

/// The horizon of 1500 upright blocks, and 2000 questions.
void horizon(benchmark::State& state) {
  const std::vector<Box> solids = blocks(1500), asked = things();
  std::vector<std::array<glm::vec2, 4>> outlines;
  outlines.reserve(solids.size());
  for (const Box& box : solids)
    outlines.push_back({glm::vec2(box.min), {box.max.x, box.min.y}, glm::vec2(box.max), {box.min.x, box.max.y}});
  AzimuthHorizon horizon;
  size_t hidden = 0;
  for (auto _ : state) {
    horizon.reset(glm::dvec3(cell.center()));
    horizon.want_none();
    for (const Box& box : asked) horizon.want(horizon.view_of(box));
    horizon.wants_complete();
    for (size_t i = 0; i < solids.size(); ++i)
      if (horizon.worth_adding(solids[i])) horizon.add(outlines[i], solids[i].max.z, cell);
    hidden = 0;
    for (const Box& box : asked) hidden += horizon.hides(horizon.view_of(box)) ? 1U : 0U;
  }
  state.counters["hidden"] = double(hidden);
}
BENCHMARK(horizon)->Unit(benchmark::kMicrosecond);

/// A cull map of the same blocks, and the same questions.
void cull_map(benchmark::State& state) {
  const std::vector<Box> solids = blocks(1500), asked = things();
  CullMap map;
  size_t hidden = 0;
  for (auto _ : state) {
    map.reset(cell, {-610, -610}, {610, 610});
    for (const Box& box : solids) {
      const std::array<glm::vec2, 4> outline = {
          glm::vec2(box.min), {box.max.x, box.min.y}, glm::vec2(box.max), {box.min.x, box.max.y}};
      if (!map.hides(box)) map.add_solid(outline, box.max.z, cell);
    }
    hidden = 0;
    for (const Box& box : asked) hidden += map.hides(box) ? 1U : 0U;
  }
  state.counters["hidden"] = double(hidden);
}
BENCHMARK(cull_map)->Unit(benchmark::kMicrosecond);

/// A solid of so many boxes beside one another: proof that it is closed, slices, plans.
void footprints(benchmark::State& state) {
  Mesh mesh;
  for (int i = 0; i < state.range(0); ++i)
    append(mesh, block({float(i) * 12, 0, 0}, {float(i) * 12 + 10, 10, 8 + float(i % 5)}));
  const std::array<Material, 2> materials{};
  size_t found = 0;
  for (auto _ : state) found = footprints_of(mesh, materials).all.size();
  state.counters["footprints"] = double(found);
  state.SetItemsProcessed(state.iterations() * static_cast<int64_t>(mesh.triangle_count()));
}
BENCHMARK(footprints)->Arg(1)->Arg(16)->Arg(64)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace promenade
