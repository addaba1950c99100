// What the CPU visibility buffer's frames cost on awkward models, one thread, 1280 x 720, shaded and smoothed:
//
//   Sides/SET/0, /1    a shared set with every material culled from behind, and with every material two-sided; times by
//                      the same triangles, so their ratio is what a two-sided triangle costs more
//   Foliage/0, /1, /2  trees of leaf cards: opaque and culled; opaque and two-sided; two-sided with holes
//   Prepare, PrepareTexture, LoadBeside: what a loader does to a textured node, and street frames while another thread
//                      does it a hundred times a second (median and 99th percentile)
//
//   PROMENADE_DATASETS=FOLDER    where the shared sets lie (SET/SET.glb, SET/path_*.json); unset: no Sides

#include <benchmark/benchmark.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <random>
#include <thread>

#include "codec/image_codec.h"
#include "geometry/path.h"
#include "layout/file_io.h"
#include "preprocess/import.h"
#include "raster/shade.h"
#include "raster/visibility.h"
#include "runtime/calibration_scene.h"

namespace {

using namespace promenade;  // NOLINT(google-build-using-namespace)
using Clock = std::chrono::steady_clock;

double ms_since(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

/// Meshes, prepared with their materials changed, and where they are looked at from.
struct Model {
  std::vector<Material> materials;
  std::vector<MipTexture> textures;
  std::unique_ptr<SurfaceTable> surfaces;
  std::vector<PreparedMesh> prepared;
  std::vector<RasterItem> items;
  std::vector<Camera> cameras;
  uint64_t triangles = 0;
  bool sound = true;

  void finish(std::span<const Image> images) {
    for (const Image& image : images) {
      Result<MipTexture> made = MipTexture::make(image.pixels.empty() ? Image{1, 1, {glm::u8vec4(255)}} : image);
      if (made) textures.push_back(std::move(*made));
    }
    std::vector<const MipTexture*> pointers;
    for (const MipTexture& t : textures) pointers.push_back(&t);
    surfaces = std::make_unique<SurfaceTable>(materials, pointers);
  }
};

Camera camera_at(const Pose& pose) {
  Camera camera;
  camera.pose = pose;
  return camera;
}

/// Eight poses along each path of a set.
bool add_cameras(const std::filesystem::path& folder, Model& model) {
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    if (!name.starts_with("path_")) continue;
    const Result<std::string> text = read_text_file(entry.path(), uint64_t(1) << 24);
    const Result<CameraPath> path = text ? parse_path(*text, name) : Result<CameraPath>(text.error());
    if (!path || path->keys.empty()) return false;
    for (int i = 0; i < 8; ++i)
      model.cameras.push_back(camera_at(pose_at(*path, path->keys.back().t_s * (i + 0.5) / 8)));
  }
  return !model.cameras.empty();
}

Model shared_set(const std::filesystem::path& folder, const std::string& name, bool two_sided) {
  Model model;
  JobMonitor silent;
  const Result<Scene> scene = import_part({folder / name / (name + ".glb"), name, 0}, {}, silent);
  model.sound = scene && add_cameras(folder / name, model);
  if (!model.sound) return model;
  model.materials = scene->materials;
  for (Material& m : model.materials) m.two_sided = two_sided;
  std::vector<Image> images;
  for (const SourceTexture& t : scene->textures) {
    Result<Image> image = decode_image(t.encoded, t.name);
    images.push_back(image ? std::move(*image) : Image{});
  }
  model.finish(images);
  for (const Mesh& mesh : scene->meshes) model.prepared.push_back(*prepare(mesh, model.materials));
  for (const SceneInstance& instance : scene->instances) {
    const PreparedMesh& mesh = model.prepared[instance.mesh];
    model.items.push_back(
        {&mesh, static_cast<uint32_t>(model.items.size()), model.surfaces.get(), instance.world_from_mesh});
    model.triangles += mesh.triangle_count;
  }
  return model;
}

/// A card of leaves: about half of it is there.
Image leaves() {
  Image image;
  image.width = image.height = 128;
  for (uint32_t y = 0; y < 128; ++y)
    for (uint32_t x = 0; x < 128; ++x) {
      const float u = std::sin(float(x) * 0.31F) + std::sin(float(y) * 0.27F + float(x) * 0.05F);
      image.pixels.emplace_back(uint8_t(40 + x % 40), uint8_t(110 + y % 60), uint8_t(30), uint8_t(u > 0 ? 255 : 0));
    }
  return image;
}

enum Foliage : int64_t { opaque_culled, opaque_two_sided, with_holes };

/// A wood of 400 trees, each a crown of 300 cards.
Model wood(Foliage kind) {
  Model model;
  Material m;
  m.texture = 0, m.two_sided = kind != opaque_culled;
  if (kind == with_holes) m.alpha = AlphaMode::mask;
  model.materials.push_back(m);
  const Image image = leaves();
  model.finish({&image, 1});
  std::mt19937 random(7);
  const auto within = [&random](float half) {
    return (float(random() % 20001) / 10000.0F - 1.0F) * half;  // the same numbers everywhere
  };
  constexpr uint32_t kSide = 20, kCards = 300;
  model.prepared.reserve(size_t(kSide) * kSide);
  for (uint32_t tree = 0; tree < kSide * kSide; ++tree) {
    Mesh mesh;
    const glm::vec3 at(float(tree % kSide) * 7 + within(2), float(tree / kSide) * 7 + within(2), 5);
    for (uint32_t i = 0; i < kCards; ++i) {
      const glm::vec3 center = at + glm::vec3(within(2), within(2), within(3));
      const glm::vec3 along(within(0.5F), within(0.5F), within(0.5F)), up(within(0.5F), within(0.5F), within(0.5F));
      const auto first = static_cast<uint32_t>(mesh.positions.size());
      for (const glm::vec2 c : {glm::vec2(-1, -1), glm::vec2(1, -1), glm::vec2(1, 1), glm::vec2(-1, 1)}) {
        mesh.positions.push_back(center + along * c.x + up * c.y);
        mesh.texcoords.push_back(c * 0.5F + 0.5F);
      }
      for (const uint32_t k : {0U, 1U, 2U, 0U, 2U, 3U}) mesh.indices.push_back(first + k);
    }
    mesh.materials.assign(mesh.triangle_count(), 0);
    model.triangles += mesh.triangle_count();
    model.prepared.push_back(*prepare(mesh, model.materials));
    model.items.push_back({&model.prepared.back(), tree, model.surfaces.get(), {}});
  }
  for (int i = 0; i < 8; ++i) {
    const bool above = i % 2 == 1;
    model.cameras.push_back(
        camera_at({{-10 + 14.0 * i, -8, above ? 25.0 : 1.7}, 60.0 + 7 * i, above ? -20.0 : 5.0, 0}));
  }
  return model;
}

void draw_frames(benchmark::State& state, const Model& model) {
  if (!model.sound) return state.SkipWithError("no such set");
  VisibilityOptions options;
  ShadeOptions shading;
  options.threads = shading.threads = 1;
  VisibilityBuffer buffer;
  Image picture;
  double draw_ms = 0;
  uint64_t set_up = 0;
  for (auto _ : state)
    for (const Camera& camera : model.cameras) {
      if (!buffer.draw(perspective_view(camera, glm::dvec3(0)), model.items, options).ok())
        state.SkipWithError("not drawn");
      shade(buffer, shading, picture);
      smooth_edges(buffer, shading, picture);
      draw_ms += buffer.stats().draw_ms, set_up += buffer.stats().triangles_set_up;
    }
  const double frames = double(state.iterations()) * double(model.cameras.size());
  state.counters["frames"] = double(model.cameras.size());
  state.counters["draw_ms"] = draw_ms / frames;
  state.counters["set_up"] = double(set_up) / frames;
  state.counters["triangles"] = double(model.triangles);
}

/// The model that was asked for last: making one takes longer than a benchmark.
template <class Make>
const Model& kept(const std::string& name, const Make& make) {
  static std::string made;
  static std::unique_ptr<Model> model;
  if (made != name) model.reset(), model = std::make_unique<Model>(make()), made = name;
  return *model;
}

void BM_Sides(benchmark::State& state, const std::string& folder, const std::string& set) {
  const bool two_sided = state.range(0) != 0;
  draw_frames(state, kept(set + (two_sided ? " two-sided" : ""), [&] { return shared_set(folder, set, two_sided); }));
}

void BM_Foliage(benchmark::State& state) {
  const auto kind = Foliage(state.range(0));
  draw_frames(state, kept("wood " + std::to_string(kind), [&] { return wood(kind); }));
}

// --- Loading beside drawing ------------------------------------------------------------------------------------------

/// A square of hilly ground with its own texture: 968 triangles.
Mesh node_mesh(uint32_t column, uint32_t row) { return hilly_square(column, row, 22, 1); }
Image node_picture() { return striped_picture(512); }

void BM_Prepare(benchmark::State& state) {
  const Mesh mesh = node_mesh(3, 4);
  for (auto _ : state) benchmark::DoNotOptimize(prepare(mesh, {}));
  state.counters["triangles"] = double(mesh.triangle_count());
}

void BM_PrepareTexture(benchmark::State& state) {
  const Image image = node_picture();
  for (auto _ : state) benchmark::DoNotOptimize(MipTexture::make(image));
}

/// Argument: nodes a second that the other thread decodes (a JPEG of 512 x 512) and prepares.
void BM_LoadBeside(benchmark::State& state) {
  Model model;
  const Image picture = node_picture();
  model.materials.emplace_back().texture = 0;
  model.finish({&picture, 1});
  constexpr uint32_t kSide = 32;
  model.prepared.reserve(size_t(kSide) * kSide);
  for (uint32_t i = 0; i < kSide * kSide; ++i) {
    model.prepared.push_back(*prepare(node_mesh(i % kSide, i / kSide), model.materials));
    model.items.push_back({&model.prepared.back(), i, model.surfaces.get(), {}});
    model.triangles += model.prepared.back().triangle_count;
  }
  const Result<std::vector<std::byte>> jpeg = encode_image(picture, ImageFormat::jpeg);
  if (!jpeg) return state.SkipWithError("no JPEG");
  std::atomic<bool> done = false;
  std::atomic<uint64_t> loaded = 0;
  const Clock::time_point began = Clock::now();
  std::thread loader([&] {
    const Mesh mesh = node_mesh(1, 2);
    for (auto next = began; state.range(0) > 0 && !done; ++loaded) {
      next += std::chrono::microseconds(1000000 / state.range(0));
      std::this_thread::sleep_until(next);
      const Result<Image> image = decode_image(*jpeg, "node");
      if (image) benchmark::DoNotOptimize(MipTexture::make(*image));
      benchmark::DoNotOptimize(prepare(mesh, model.materials));
    }
  });
  VisibilityOptions options;
  ShadeOptions shading;
  options.threads = shading.threads = 1;
  VisibilityBuffer buffer;
  Image drawn;
  std::vector<double> frame_ms;
  double angle = 0;
  for (auto _ : state) {
    const Camera camera = camera_at({{300 + angle * 2, 100, 12}, 40 + angle, -5, 0});
    angle += 0.5;
    const Clock::time_point start = Clock::now();
    if (!buffer.draw(perspective_view(camera, glm::dvec3(0)), model.items, options).ok())
      state.SkipWithError("not drawn");
    shade(buffer, shading, drawn);
    smooth_edges(buffer, shading, drawn);
    frame_ms.push_back(ms_since(start));
  }
  const double seconds = ms_since(began) / 1000;
  done = true;
  loader.join();
  std::sort(frame_ms.begin(), frame_ms.end());
  state.counters["frame_ms_p50"] = frame_ms[frame_ms.size() / 2];
  state.counters["frame_ms_p99"] = frame_ms[frame_ms.size() * 99 / 100];
  state.counters["loaded_per_s"] = double(loaded) / seconds;
  state.counters["triangles"] = double(model.triangles);
}

const bool registered = [] {
  if (const char* folder = std::getenv("PROMENADE_DATASETS"))
    for (const std::string set : {"small_house", "citysim"})
      for (const int64_t two_sided : {0, 1})
        benchmark::RegisterBenchmark(("Sides/" + set).c_str(), BM_Sides, std::string(folder), set)
            ->Arg(two_sided)
            ->Unit(benchmark::kMillisecond)
            ->MinTime(1.0);
  for (const int64_t kind : {opaque_culled, opaque_two_sided, with_holes})
    benchmark::RegisterBenchmark("Foliage", BM_Foliage)->Arg(kind)->Unit(benchmark::kMillisecond)->MinTime(1.0);
  benchmark::RegisterBenchmark("Prepare", BM_Prepare)->Unit(benchmark::kMicrosecond);
  benchmark::RegisterBenchmark("PrepareTexture", BM_PrepareTexture)->Unit(benchmark::kMicrosecond);
  for (const int64_t nodes : {0, 100})
    benchmark::RegisterBenchmark("LoadBeside", BM_LoadBeside)
        ->Arg(nodes)
        ->Iterations(300)
        ->UseRealTime()
        ->Unit(benchmark::kMillisecond);
  return true;
}();

}  // namespace
