#include "raster/shade.h"

#include <algorithm>
#include <array>
#include <bit>
#include <glm/geometric.hpp>
#include <numeric>
#include <span>
#include <vector>

#include "raster/visibility_state.h"

namespace promenade {

namespace {

using raster_kernel::kSubpixel;
using raster_kernel::Shading;

const std::array<float, 256>& linear_table() {
  static const std::array<float, 256> table = [] {
    std::array<float, 256> t{};
    for (uint32_t i = 0; i < 256; ++i) t[i] = srgb_to_linear(static_cast<uint8_t>(i));
    return t;
  }();
  return table;
}

void put(const glm::vec3& v, float* out) {
  for (int i = 0; i < 3; ++i) out[i] = v[i];
}

void put_linear(const glm::u8vec4& color, float* out) {
  for (int i = 0; i < 3; ++i) out[i] = linear_table()[color[i]];
}

/// View rotation, eye and rays, as kernels want them.
void set_view(const RasterView& view, Shading& s) {
  const double scale = view.scale_px * kSubpixel;
  put(glm::vec3(view.right * scale), s.rows[0]);
  put(glm::vec3(-view.up * scale), s.rows[1]);
  put(glm::vec3(view.forward), s.rows[2]);
  put(glm::vec3(view.forward), s.ray_axis);
  put(view.orthographic ? glm::vec3(0) : glm::vec3(view.right / scale), s.ray_x);
  put(view.orthographic ? glm::vec3(0) : glm::vec3(-view.up / scale), s.ray_y);
  for (int i = 0; i < 3; ++i) {
    s.eye_hi[i] = static_cast<float>(view.eye[i]);
    s.eye_lo[i] = static_cast<float>(view.eye[i] - double(s.eye_hi[i]));
  }
}

void set_light(const ShadeOptions& o, Shading& s) {
  const float length = glm::length(o.to_sun);
  put(length > 0 ? o.to_sun / length : glm::vec3(0), s.to_sun);
  put(o.sun, s.sun), put(o.sky_ambient, s.sky), put(o.ground_ambient, s.ground);
  put_linear(o.zenith, s.zenith), put_linear(o.horizon, s.horizon), put_linear(o.below, s.below);
  s.plain = std::bit_cast<uint32_t>(o.plain);
  s.has_sky = o.sky;
  s.has_textures = o.textures;
}

Shading shading_of(const VisibilityBuffer::State& state, const ShadeOptions& options, Image& out) {
  Shading s = {};
  s.items = state.items.data();
  s.item_of_run = state.item_of_run.data();
  s.run_bits = kIdRunBits;
  s.orthographic = state.view.orthographic;
  s.linear_of_srgb = linear_table().data();
  s.anisotropy = std::clamp(options.anisotropy, 1.0F, 16.0F);
  set_view(state.view, s);
  set_light(options, s);
  s.out = reinterpret_cast<uint32_t*>(out.pixels.data());
  return s;
}

void size_like(const VisibilityBuffer& buffer, Image& image) {
  image.width = buffer.width_px(), image.height = buffer.height_px();
  image.pixels.resize(size_t(image.width) * image.height);
}

}  // namespace

void shade(const VisibilityBuffer& buffer, const ShadeOptions& options, Image& out) {
  const VisibilityBuffer::State& state = buffer.state();
  size_like(buffer, out);
  const Shading s = shading_of(state, options, out);
  const raster_kernel::Kernels& kernels = kernels_of(options.simd);
  run_parallel(options.threads, static_cast<size_t>(state.frame.tiles_y),
               [&](size_t row) { kernels.shade(state.frame, s, static_cast<int32_t>(row)); });
}

namespace {

/// Rows of a picture's width in thread-local room: no page is touched for the first time in every frame.
struct SmoothRoom {
  std::vector<uint8_t> strength;
  std::vector<uint32_t> counts;
  std::vector<size_t> first;  ///< of each row of tiles and of what would follow, into `smoothed`
  std::vector<raster_kernel::Smoothed> smoothed;
};

/// The least strength, and at least `least`, that no more than `most` pixels have.
int threshold_of(std::span<const uint32_t> counts, int least, uint64_t most) {
  std::array<uint64_t, raster_kernel::kStrengths> sum{};
  for (size_t i = 0; i < counts.size(); ++i) sum[i % sum.size()] += counts[i];
  uint64_t pixels = 0;
  int at = raster_kernel::kStrengths - 1;
  for (; at >= least; --at) {
    pixels += sum[static_cast<size_t>(at)];
    if (pixels > most) break;
  }
  return at + 1;  // 256: none
}

/// How many pixels of at least that strength lie in the rows before each, and in all of them.
std::vector<size_t> first_of_rows(std::span<const uint32_t> counts, int least) {
  std::vector<size_t> first{0};
  for (size_t row = 0; row < counts.size(); row += raster_kernel::kStrengths) {
    const auto of_row = counts.subspan(row, raster_kernel::kStrengths).subspan(static_cast<size_t>(least));
    first.push_back(std::accumulate(of_row.begin(), of_row.end(), first.back()));
  }
  return first;
}

}  // namespace

void smooth_edges(const VisibilityBuffer& buffer, const ShadeOptions& options, Image& picture) {
  static_assert(kMaxPictureSide <= uint32_t{raster_kernel::kMostTilesAcross} * raster_kernel::kTile);
  const VisibilityBuffer::State& state = buffer.state();
  const Shading s = shading_of(state, options, picture);
  const raster_kernel::Kernels& kernels = kernels_of(options.simd);
  const auto rows = static_cast<size_t>(state.frame.tiles_y);
  thread_local SmoothRoom kept;
  SmoothRoom& room = kept;  // the caller's, also on other threads
  raster_kernel::Smoothing smoothing = {};
  smoothing.in = s.out;
  smoothing.stride = state.frame.width + raster_kernel::kSmoothPadding;
  room.strength.resize(size_t(smoothing.stride) * buffer.height_px());
  room.counts.resize(rows * raster_kernel::kStrengths);
  smoothing.strength = room.strength.data(), smoothing.counts = room.counts.data();
  const auto with_room = [&smoothing] {
    thread_local std::vector<int32_t> ids;
    ids.resize(size_t(smoothing.stride) * raster_kernel::kSmoothRows);
    raster_kernel::Smoothing here = smoothing;
    here.room = ids.data();
    return here;
  };
  smoothing.least_difference = std::clamp(options.edge_difference, 1, 255);
  run_parallel(options.threads, rows,
               [&](size_t row) { kernels.find_edges(state.frame, with_room(), static_cast<int32_t>(row)); });
  const uint64_t most = std::max<uint64_t>(
      options.least_smoothed_px,
      static_cast<uint64_t>(std::clamp(options.most_smoothed, 0.0F, 1.0F) * static_cast<float>(picture.pixels.size())));
  smoothing.least_difference = threshold_of(room.counts, smoothing.least_difference, most);
  room.first = first_of_rows(room.counts, smoothing.least_difference);
  room.smoothed.resize(room.first.back());
  run_parallel(options.threads, rows, [&](size_t row) {
    raster_kernel::Smoothing here = with_room();
    here.smoothed = room.smoothed.data() + room.first[row];
    kernels.smooth(state.frame, s, here, static_cast<int32_t>(row));
  });
  run_parallel(options.threads, rows, [&](size_t row) {
    for (size_t i = room.first[row]; i < room.first[row + 1]; ++i) s.out[room.smoothed[i].at] = room.smoothed[i].color;
  });
}

void smooth_edges(const VisibilityBuffer& buffer, const ShadeOptions& options, const Image& in, Image& out) {
  size_like(buffer, out);
  std::copy(in.pixels.begin(), in.pixels.end(), out.pixels.begin());
  smooth_edges(buffer, options, out);
}

void blend_layers(std::span<const VisibilityBuffer* const> layers, const ShadeOptions& options, Image& picture) {
  if (layers.empty()) return;
  const VisibilityBuffer::State& state = layers[0]->state();  // where it has nothing, none has
  const Shading s = shading_of(state, options, picture);
  std::vector<raster_kernel::Layer> planes;
  for (const VisibilityBuffer* layer : layers) planes.push_back({layer->state().z.data(), layer->state().id.data()});
  const raster_kernel::Kernels& kernels = kernels_of(options.simd);
  run_parallel(options.threads, static_cast<size_t>(state.frame.tiles_y), [&](size_t row) {
    const auto ty = static_cast<int32_t>(row);
    raster_kernel::Layers here = {planes.data(), static_cast<int32_t>(planes.size()), state.frame.tiles_x, 0};
    for (size_t i = 0; i < state.regions.size(); ++i) {
      const raster_kernel::Region& r = state.regions[i];
      if (state.blank[i] == 0 && ty >= r.ty0 && ty < r.ty1)
        here.tx0 = std::min(here.tx0, r.tx0), here.tx1 = std::max(here.tx1, r.tx1);
    }
    if (here.tx0 < here.tx1) kernels.shade_layers(state.frame, s, here, ty);
  });
}

}  // namespace promenade
