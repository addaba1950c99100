// What a frame of the runtime is made of: selection and pricing over large trees, the loader's work on a node, uploads,
// and whole frames with each renderer over a generated city.

#include <benchmark/benchmark.h>
#include <unistd.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <string>

#include "datasets/city.h"
#include "geometry/path.h"
#include "layout/model_io.h"
#include "preprocess/build.h"
#include "runtime/cpu_renderer.h"
#include "runtime/fades.h"
#include "runtime/gl_renderer.h"
#include "runtime/posed_model.h"
#include "runtime/session.h"
#include "tests/runtime/forest.h"

namespace promenade {
namespace {

constexpr uint32_t kWidthPx = 1280, kHeightPx = 720;

/// A square tree of 4^depth leaves across the view; errors halve from level to level.
class LargeForest : public forest::Forest {
 public:
  explicit LargeForest(uint32_t depth) { grow(root({{20, -2000, 0}, {4000, 2000, 60}}, 400), 4, depth); }
};

SelectView from_the_street() {
  SelectView view;
  view.camera = {{{0, 0, 2}, 0, 0, 0}, kWidthPx, kHeightPx, 60, 0.1};
  return view;
}

/// What a frame takes for things that move: boxes and matrices. range: how many.
void BM_Pose(benchmark::State& state) {
  forest::Forest street;
  ModelObjects& objects = street.edit().objects;
  constexpr uint32_t kKeys = 30;
  for (uint32_t i = 0; i < static_cast<uint32_t>(state.range(0)); ++i) {
    const NodeId root = street.root({{0, 0, 0}, {100, 100, 2}}, 0);
    AnimationJoint joint;
    joint.tracks[AnimationJoint::translation_slot] = static_cast<uint32_t>(objects.animation.tracks.size());
    const auto first_time = static_cast<uint32_t>(objects.animation.times.size()),
               first_value = static_cast<uint32_t>(objects.animation.values.size());
    for (uint32_t k = 0; k < kKeys; ++k) {
      objects.animation.times.push_back(float(k));
      for (uint32_t c = 0; c < 3; ++c) objects.animation.values.push_back(float((k * 7 + c * 11 + i) % 98));
    }
    objects.animation.tracks.push_back({AnimationTrack::Way::linear, 3, first_time, first_value, kKeys, kKeys - 1});
    objects.animation.joints.push_back(joint);
    objects.moving.push_back({i, root, glm::dmat4(1)});
    objects.moving_nodes.push_back({i, {{0, 0, 0}, {2, 2, 2}}});
  }
  PosedModel posed(street.model());
  double time_s = 0;
  for (auto _ : state) {
    posed.set_time(time_s += 0.033);
    benchmark::DoNotOptimize(posed.now().tables.nodes.data());
  }
  state.counters["objects_per_s"] =
      benchmark::Counter(double(state.range(0)), benchmark::Counter::kIsIterationInvariantRate);
}
BENCHMARK(BM_Pose)->Arg(100)->Arg(10000)->Unit(benchmark::kMicrosecond);

/// range: depth, policy.
void BM_Select(benchmark::State& state) {
  const LargeForest forest(static_cast<uint32_t>(state.range(0)));
  SelectOptions options;
  options.policy = static_cast<Policy>(state.range(1));
  const std::vector<uint8_t> resident(forest.model().tables.nodes.size(), 1);
  SelectState memory;
  Selection selection;
  const SelectView view = from_the_street();
  for (auto _ : state) {
    select(forest.model(), view, resident, options, memory, selection);
    benchmark::DoNotOptimize(selection.front.data());
  }
  state.SetLabel(std::string(name_of(options.policy)));
  state.counters["nodes"] = double(resident.size());
  state.counters["visited"] = double(selection.updates.size());
  state.counters["visited_per_s"] =
      benchmark::Counter(double(selection.updates.size()), benchmark::Counter::kIsIterationInvariantRate);
}
BENCHMARK(BM_Select)
    ->ArgsProduct(
        {{5, 8}, {int(Policy::static_error), int(Policy::time_slices), int(Policy::lakhia), int(Policy::cost_benefit)}})
    ->Unit(benchmark::kMicrosecond);

/// What fades take on a front that keeps changing level: every tenth of it a frame. range: nodes of the tree's depth.
void BM_Fades(benchmark::State& state) {
  const LargeForest forest(static_cast<uint32_t>(state.range(0)));
  const Model& model = forest.model();
  std::vector<NodeId> coarse, fine;
  for (uint32_t i = 0; i < model.tables.nodes.size(); ++i) {
    if (model.tables.nodes[i].level + 1 == static_cast<uint32_t>(state.range(0))) coarse.push_back(NodeId{i});
  }
  const std::vector<uint8_t> resident(model.tables.nodes.size(), 1);
  const Frustum frustum = frustum_of(from_the_street().camera, model.manifest.origin);
  Fades fades(model);
  std::vector<FadedNode> items;
  size_t frame = 0;
  for (auto _ : state) {
    state.PauseTiming();
    fine.clear();
    for (size_t i = 0; i < coarse.size(); ++i) {
      if ((i + frame / 4) % 10 != 0) {
        fine.push_back(coarse[i]);
        continue;
      }
      const std::span<const NodeId> children = model.children_of(coarse[i]);
      fine.insert(fine.end(), children.begin(), children.end());
    }
    ++frame;
    state.ResumeTiming();
    fades.follow(fine, resident, frustum, nullptr, 8, items);
    benchmark::DoNotOptimize(items.data());
  }
  state.counters["front"] = double(coarse.size());
  state.counters["fades"] = double(fades.running());
}
BENCHMARK(BM_Fades)->Arg(5)->Unit(benchmark::kMicrosecond);

/// A generated city, its walk and its model, on disk as long as the program runs.
class City {
 public:
  static const City& get() {
    static const City city;
    return city;
  }
  ~City() { std::filesystem::remove_all(folder_); }
  City(const City&) = delete;
  City& operator=(const City&) = delete;

  const std::string& failure() const { return failure_; }
  const ModelReader& reader() const { return *reader_; }
  const ModelSource& source() const { return *source_; }
  const CameraPath& walk() const { return walk_; }

 private:
  City() : folder_(std::filesystem::temp_directory_path() / ("promenade_bench_runtime_" + std::to_string(::getpid()))) {
    if (const Status made = make(); !made.ok()) failure_ = made.error().message;
  }

  Status make() {
    std::filesystem::create_directories(folder_);
    JobMonitor monitor;
    CityOptions city;
    city.triangles = 1'000'000;
    if (const auto made = generate_city(city, folder_ / "city.glb", monitor); !made.ok()) return made.error();
    BuildOptions options;
    options.sources = {folder_ / "city.glb"};
    options.model = folder_ / "city.prom";
    if (const auto built = build_model(options, monitor); !built.ok()) return built.error();
    Result<ModelReader> reader = ModelReader::open(options.model);
    if (!reader.ok()) return reader.error();
    reader_ = std::make_unique<ModelReader>(std::move(*reader));
    source_ = source_of(*reader_);
    std::ifstream file(folder_ / "city_walk.json");
    const std::string text((std::istreambuf_iterator<char>(file)), {});
    Result<CameraPath> walk = parse_path(text, "city_walk.json");
    if (!walk.ok()) return walk.error();
    walk_ = std::move(*walk);
    return Done{};
  }

  std::filesystem::path folder_;
  std::unique_ptr<ModelReader> reader_;
  std::unique_ptr<ModelSource> source_;
  CameraPath walk_;
  std::string failure_;
};

/// A renderer and, for OpenGL, the context that it draws with.
struct Drawing {
  std::unique_ptr<GlContext> context;
  std::unique_ptr<Renderer> renderer;
};

enum class RendererKind : int64_t { cpu, gl };

Result<Drawing> create_drawing(RendererKind kind) {
  Drawing drawing;
  if (kind == RendererKind::cpu) {
    drawing.renderer = create_cpu_renderer();
    return drawing;
  }
  Result<std::unique_ptr<GlContext>> context = create_offscreen_context();
  if (!context.ok()) return context.error();
  drawing.context = std::move(*context);
  Result<std::unique_ptr<GlRenderer>> renderer = create_gl_renderer(*drawing.context);
  if (!renderer.ok()) return renderer.error();
  drawing.renderer = std::move(*renderer);
  return drawing;
}

/// Skips the benchmark when its city or renderer could not be made.
std::optional<Drawing> begin(benchmark::State& state, int64_t kind) {
  if (!City::get().failure().empty()) {
    state.SkipWithError(City::get().failure().c_str());
    return std::nullopt;
  }
  Result<Drawing> drawing = create_drawing(static_cast<RendererKind>(kind));
  if (!drawing.ok()) {
    state.SkipWithError(drawing.error().message.c_str());
    return std::nullopt;
  }
  state.SetLabel(static_cast<RendererKind>(kind) == RendererKind::cpu ? "cpu" : "gl");
  return std::move(*drawing);
}

/// What the loader thread does for a node's mesh: read, check, decode, stage. range: renderer.
void BM_LoadNode(benchmark::State& state) {
  const std::optional<Drawing> drawing = begin(state, state.range(0));
  if (!drawing) return;
  const ModelTables& tables = City::get().reader().model().tables;
  uint32_t next = 0;
  uint64_t triangles = 0;
  for (auto _ : state) {
    const NodeId id{next++ % static_cast<uint32_t>(tables.nodes.size())};
    const Result<Mesh> mesh = City::get().reader().read_mesh(id);
    if (!mesh.ok()) {
      state.SkipWithError(mesh.error().message.c_str());
      return;
    }
    benchmark::DoNotOptimize(drawing->renderer->stage_mesh(*mesh, tables.materials));
    triangles += mesh->triangle_count();
  }
  state.counters["nodes_per_s"] = benchmark::Counter(1, benchmark::Counter::kIsIterationInvariantRate);
  state.counters["triangles_per_s"] = benchmark::Counter(double(triangles), benchmark::Counter::kIsRate);
}
BENCHMARK(BM_LoadNode)->Arg(int64_t(RendererKind::cpu))->Arg(int64_t(RendererKind::gl))->Unit(benchmark::kMicrosecond);

/// What the render thread does for a staged mesh. range: renderer.
void BM_Upload(benchmark::State& state) {
  const std::optional<Drawing> drawing = begin(state, state.range(0));
  if (!drawing) return;
  const ModelTables& tables = City::get().reader().model().tables;
  constexpr uint32_t kMeshes = 32;
  std::vector<Mesh> meshes;
  for (uint32_t i = 0; i < kMeshes; ++i) {
    Result<Mesh> mesh = City::get().reader().read_mesh(NodeId{i * 7919 % static_cast<uint32_t>(tables.nodes.size())});
    if (mesh.ok()) meshes.push_back(std::move(*mesh));
  }
  for (auto _ : state) {
    state.PauseTiming();
    std::vector<std::unique_ptr<StagedMesh>> staged;
    staged.reserve(meshes.size());
    for (const Mesh& mesh : meshes) staged.push_back(drawing->renderer->stage_mesh(mesh, tables.materials));
    state.ResumeTiming();
    std::vector<MeshHandle> handles;
    for (const auto& one : staged)
      if (const auto handle = drawing->renderer->create_mesh(*one, {}); handle.ok()) handles.push_back(*handle);
    state.PauseTiming();
    for (const MeshHandle handle : handles) drawing->renderer->destroy(handle);
    state.ResumeTiming();
  }
  state.counters["nodes_per_s"] =
      benchmark::Counter(double(meshes.size()), benchmark::Counter::kIsIterationInvariantRate);
}
BENCHMARK(BM_Upload)->Arg(int64_t(RendererKind::cpu))->Arg(int64_t(RendererKind::gl))->Unit(benchmark::kMicrosecond);

/// Frames of the street walk with everything loaded beforehand at each stop: selection, pricing and drawing without the
/// disk. range: renderer, policy.
void BM_Frame(benchmark::State& state) {
  const std::optional<Drawing> drawing = begin(state, state.range(0));
  if (!drawing) return;
  SessionOptions options;
  options.select.policy = static_cast<Policy>(state.range(1));
  options.frame_bytes = drawing->renderer->frame_bytes(kWidthPx, kHeightPx, true);
  Result<Session> session = Session::open(City::get().source(), *drawing->renderer, options);
  if (!session.ok()) {
    state.SkipWithError(session.error().message.c_str());
    return;
  }
  constexpr double kStopS = 5;
  const Camera first{pose_at(City::get().walk(), 0), kWidthPx, kHeightPx, 60, 0.1};
  if (const Status measured = session->measure_overhead(first); !measured.ok()) {
    state.SkipWithError(measured.error().message.c_str());
    return;
  }
  double t_s = 0, select_ms = 0, draw_ms = 0, triangles = 0;
  for (auto _ : state) {
    state.PauseTiming();
    const Camera camera{pose_at(City::get().walk(), t_s), kWidthPx, kHeightPx, 60, 0.1};
    const Result<FrameRow> settled = session->settle(camera);
    t_s += kStopS;
    state.ResumeTiming();
    const Result<FrameRow> row = session->frame(camera, 0);
    if (!settled.ok() || !row.ok()) {
      state.SkipWithError((settled.ok() ? row : settled).error().message.c_str());
      return;
    }
    select_ms += row->select_ms, draw_ms += row->draw_ms, triangles += double(row->triangles_drawn);
  }
  state.SetLabel((static_cast<RendererKind>(state.range(0)) == RendererKind::cpu ? "cpu " : "gl ") +
                 std::string(name_of(options.select.policy)));
  const auto mean = [](double sum) { return benchmark::Counter(sum, benchmark::Counter::kAvgIterations); };
  state.counters["select_ms"] = mean(select_ms);
  state.counters["draw_ms"] = mean(draw_ms);
  state.counters["triangles"] = mean(triangles);
}
BENCHMARK(BM_Frame)
    ->ArgsProduct({{int64_t(RendererKind::cpu), int64_t(RendererKind::gl)},
                   {int(Policy::static_error), int(Policy::time_slices)}})
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime()
    ->Iterations(20);

}  // namespace
}  // namespace promenade
