// A side of a far picture, 513 x 513 pixels: to bytes and back, alone and told against a neighbour's, and drawn.

#include <benchmark/benchmark.h>

#include <cmath>

#include "codec/far_mesh.h"
#include "codec/far_warp.h"
#include "geometry/random.h"
#include "runtime/cpu_renderer.h"

namespace promenade {
namespace {

constexpr uint32_t kLevels = 9;

/// Towers with windows before the sky, two to five half boxes away; `aside`: pixels that the eye has moved by.
FarFace towers(bool depth, double aside) {
  FarFace face;
  face.grid.levels = kLevels;
  const uint32_t side = face.grid.side();
  face.colors = {side, side, std::vector<glm::u8vec4>(face.grid.vertices(), {0, 0, 0, 0})};
  face.kept.assign(face.grid.vertices(), 0);
  face.depth.assign(face.grid.vertices(), FarFace::kNearest);
  Random random(5);
  struct Tower {
    double left, width, height, distance;
    uint32_t shade;
  };
  std::vector<Tower> row(120);
  for (Tower& t : row)
    t = {random.range(-60.0, 560.0), random.range(10.0, 40.0), random.range(20.0, 160.0), random.range(2.0, 5.0),
         60 + random.below(150)};
  for (uint32_t y = 0; y < side; ++y)
    for (uint32_t x = 0; x < side; ++x) {
      double nearest = y > side / 2 ? 6 : 1e9;
      glm::u8vec4 color(90, 100, 80, nearest < 1e9 ? 255 : 0);
      for (const Tower& t : row) {
        const double u = x - (t.left + aside / t.distance), v = double(side) / 2 + 10 - y;
        if (u < 0 || u >= t.width || v < -10 || v >= t.height || t.distance >= nearest) continue;
        nearest = t.distance;
        const bool window = std::fmod(u, 4) < 2 && std::fmod(v + 10, 5) < 3;
        const auto shade = static_cast<uint8_t>(window ? t.shade / 2 : t.shade);
        color = {shade, shade, static_cast<uint8_t>(shade / 2 + 60), 255};
      }
      face.colors.at(x, y) = color;
      if (depth && nearest < 1e9)
        face.depth[face.grid.index(x, y)] = static_cast<uint16_t>(FarFace::kNearest / nearest);
    }
  if (depth) {
    const std::vector<float> value(face.depth.begin(), face.depth.end());
    std::vector<float> low = value, high = value;
    for (size_t i = 0; i < value.size(); ++i) {
      const bool there = face.colors.pixels[i].a != 0;
      low[i] = there ? value[i] * 0.95F : 0.0F, high[i] = there ? value[i] * 1.05F : 1e9F;
    }
    refine_halvings(face.grid, value, low, high, face.kept);
  } else {
    close_halvings(face.grid, face.kept);
  }
  for (size_t i = 0; i < face.kept.size(); ++i)
    if (face.kept[i] == 0) face.depth[i] = 0;
  return face;
}

/// A side, and what it may be told against.
struct Pair {
  explicit Pair(bool depth) : told(towers(depth, 20)) {
    neighbour = *decode_far_face(*encode_far_face(towers(depth, 0), {}));
    for (const FarFace*& side : reference.sides) side = &neighbour;
    reference.offset = {0, 0.08, 0};
  }
  FarFace told, neighbour;
  FarReference reference;
};

void BM_encode_far_face(benchmark::State& state) {
  const FarFace face = towers(state.range(0) != 0, 0);
  size_t bytes = 0;
  for (auto unused : state) bytes = encode_far_face(face, {})->size();
  state.counters["bytes"] = double(bytes);
  state.counters["triangles"] = far_triangles(face);
}
BENCHMARK(BM_encode_far_face)->ArgName("depth")->DenseRange(0, 1)->Unit(benchmark::kMillisecond);

void BM_decode_far_face(benchmark::State& state) {
  const std::vector<std::byte> bytes = *encode_far_face(towers(state.range(0) != 0, 0), {});
  for (auto unused : state) benchmark::DoNotOptimize(decode_far_face(bytes).ok());
}
BENCHMARK(BM_decode_far_face)->ArgName("depth")->DenseRange(0, 1)->Unit(benchmark::kMillisecond);

void BM_encode_far_delta(benchmark::State& state) {
  const Pair pair(state.range(0) != 0);
  const auto how = static_cast<FarForetelling>(state.range(1));
  size_t bytes = 0;
  for (auto unused : state) bytes = encode_far_delta(pair.told, {}, 0, pair.reference, how)->size();
  state.counters["bytes"] = double(bytes);
}
BENCHMARK(BM_encode_far_delta)
    ->ArgNames({"depth", "how"})
    ->Args({0, 1})
    ->Args({1, 1})
    ->Args({1, 2})
    ->Unit(benchmark::kMillisecond);

void BM_decode_far_delta(benchmark::State& state) {
  const Pair pair(state.range(0) != 0);
  const std::vector<std::byte> bytes =
      *encode_far_delta(pair.told, {}, 0, pair.reference, static_cast<FarForetelling>(state.range(1)));
  for (auto unused : state) benchmark::DoNotOptimize(decode_far_face(bytes, 0, &pair.reference).ok());
}
BENCHMARK(BM_decode_far_delta)
    ->ArgNames({"depth", "how"})
    ->Args({0, 1})
    ->Args({1, 1})
    ->Args({1, 2})
    ->Unit(benchmark::kMillisecond);

void BM_warp_far_face(benchmark::State& state) {
  const Pair pair(true);
  for (auto unused : state)
    benchmark::DoNotOptimize(foretell(pair.told, 0, pair.reference, FarForetelling::warped).pixels.data());
}
BENCHMARK(BM_warp_far_face)->Unit(benchmark::kMillisecond);

/// solid: 0: all triangles are looked at for holes; 1: those that have some.
void BM_draw_far_face(benchmark::State& state) {
  FarFace face = towers(state.range(0) != 0, 0);
  Mesh mesh = far_mesh(face, {{0, 0, 0}, 300, 0, true});
  if (state.range(1) == 0) mesh.materials.assign(mesh.triangle_count(), 1);
  CpuRendererOptions options;
  options.threads = 1;
  const std::unique_ptr<Renderer> renderer = create_cpu_renderer(options);
  std::array<Material, 2> materials;
  for (Material& m : materials) m.texture = 0, m.wrap_u = m.wrap_v = Wrap::clamp, m.two_sided = true;
  materials[1].alpha = AlphaMode::mask;
  fill_colors(face.colors);
  const TextureHandle texture = *renderer->create_texture(*renderer->stage_texture(face.colors));
  const MeshHandle handle = *renderer->create_mesh(*renderer->stage_mesh(mesh, materials), std::span(&texture, 1));
  FrameView view;
  view.camera.width_px = view.camera.height_px = 512;
  view.camera.vertical_fov_deg = 90;
  const std::vector<DrawItem> items = {{handle, kNoNode}};
  for (auto unused : state) benchmark::DoNotOptimize(renderer->draw(view, items).ok());
  state.counters["triangles"] = double(mesh.triangle_count());
}
BENCHMARK(BM_draw_far_face)
    ->ArgNames({"depth", "solid"})
    ->Args({0, 0})
    ->Args({0, 1})
    ->Args({1, 0})
    ->Args({1, 1})
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace promenade
