#include "raster/visibility.h"

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <limits>
#include <map>
#include <numeric>
#include <thread>

#include "raster/gaps.h"
#include "raster/hand_over.h"
#include "raster/visibility_state.h"

namespace promenade {

namespace {

using raster_kernel::BoxPicture;
using raster_kernel::Frame;
using raster_kernel::Item;
using raster_kernel::Kernels;
using raster_kernel::kSubpixel;
using raster_kernel::kTile;
using raster_kernel::Region;

constexpr int32_t kGuardPx = 1024;       // beyond the picture's sides; keeps coordinates within 2^22 sub-pixels
constexpr size_t kRegionsPerThread = 4;  // so that a thread that drew an easy region takes another
constexpr int32_t kSmallestRegion = 8;   // tiles; smaller ones repeat too much set-up

using Clock = std::chrono::steady_clock;
double ms_since(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

bool finite(const glm::dvec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

Status check(const RasterView& view) {
  if (view.width_px == 0 || view.height_px == 0 || view.width_px > kMaxPictureSide || view.height_px > kMaxPictureSide)
    return Error{"picture of " + std::to_string(view.width_px) + " x " + std::to_string(view.height_px) +
                 " pixels: sides must be 1 to " + std::to_string(kMaxPictureSide)};
  if (!finite(view.eye) || !finite(view.right) || !finite(view.up) || !finite(view.forward) ||
      !std::isfinite(view.near_m))
    return Error{"view with a number that is not finite"};
  if (glm::length(view.eye) > kMaxCoordinateM) return Error{"view with an eye beyond 1e12 m of the model's origin"};
  if (!view.orthographic && !(view.near_m >= 1e-9))
    return Error{"view with a near plane at " + std::to_string(view.near_m) + " m: it must be at least 1e-9 m away"};
  if (!(view.scale_px > 0) || view.scale_px > 1e9)
    return Error{"view with a scale of " + std::to_string(view.scale_px) + " pixels"};
  return Done{};
}

Frame frame_of(const RasterView& view, const VisibilityOptions& options) {
  Frame f = {};
  f.width = static_cast<int32_t>(view.width_px), f.height = static_cast<int32_t>(view.height_px);
  f.tiles_x = (f.width + kTile - 1) / kTile, f.tiles_y = (f.height + kTile - 1) / kTile;
  f.axis_x = f.width * kSubpixel / 2, f.axis_y = f.height * kSubpixel / 2;
  f.guard_x = static_cast<float>(f.axis_x + kGuardPx * kSubpixel);
  f.guard_y = static_cast<float>(f.axis_y + kGuardPx * kSubpixel);
  f.near_m = static_cast<float>(view.near_m);
  f.orthographic = view.orthographic;
  f.clear_z = view.orthographic ? std::numeric_limits<float>::lowest() : 0.0F;
  f.cull_hidden = options.cull_hidden, f.cull_back = options.cull_back, f.one_sided = options.one_sided;
  f.draw_solid = true, f.draw_blended = options.draw_blended, f.screen_door = true;
  return f;
}

void set_attributes(Item& item, const RasterItem& drawn) {
  const PreparedAttributes& mesh = drawn.mesh->attributes;
  if (mesh.vertices.empty()) return;
  item.vertices = mesh.vertices.data(), item.vertex_words = mesh.words;
  item.normal_at = mesh.normal_at, item.color_at = mesh.color_at, item.texcoord_at = mesh.texcoord_at;
  item.indices = mesh.indices.view(), item.materials = mesh.materials.view();
  if (drawn.surfaces == nullptr) return;
  item.surfaces = drawn.surfaces->surfaces().data();
  item.surface_count = static_cast<uint32_t>(drawn.surfaces->surfaces().size());
}

/// Rows of the view's rotation times the item's, and the eye in the item's frame, in two floats.
void set_transform(Item& item, const RasterView& view, const std::optional<glm::dmat4>& placed) {
  const glm::dmat3 linear = placed ? glm::dmat3(*placed) : glm::dmat3(1.0);
  const glm::dvec3 offset = placed ? glm::dvec3((*placed)[3]) : glm::dvec3(0.0);
  const double det = glm::determinant(linear);
  const glm::dmat3 inverse = placed ? glm::inverse(linear) : glm::dmat3(1.0);
  const glm::dvec3 eye = inverse * (view.eye - offset);
  const double scale = view.scale_px * kSubpixel;
  const glm::dvec3 rows[3] = {view.right * scale * linear, -view.up * scale * linear, view.forward * linear};
  const glm::dvec3 axis = inverse * view.forward;
  const glm::dmat3 normals = glm::transpose(inverse);
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k) {
      item.rows[i][k] = static_cast<float>(rows[i][k]), item.exact_rows[i][k] = rows[i][k];
      item.normal_rows[i][k] = static_cast<float>(normals[k][i]);
    }
    item.eye_hi[i] = static_cast<float>(eye[i]), item.exact_eye[i] = eye[i];
    item.eye_lo[i] = static_cast<float>(eye[i] - double(item.eye_hi[i]));
    item.axis[i] = static_cast<float>(axis[i]);
  }
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k) item.model_rows[i][k] = static_cast<float>(linear[k][i]);
    item.model_rows[i][3] = static_cast<float>(offset[i]);
  }
  item.placed = placed.has_value();
  item.mirrored = det < 0;
  if (!(std::abs(det) > 0) || !finite(eye) || !finite(axis) || glm::length(eye) > double(kMaxCoordinateM))
    item.block_count = 0;
}

}  // namespace

Item item_of(const RasterItem& drawn, const RasterView& view) {
  Item item = {};
  const PreparedMesh& mesh = *drawn.mesh;
  item.blocks = mesh.blocks.data();
  item.block_count = static_cast<uint32_t>(mesh.blocks.size());
  item.x = mesh.x.data(), item.y = mesh.y.data(), item.z = mesh.z.data();
  for (size_t c = 0; c < 3; ++c) item.corners[c] = mesh.corners[c].data();
  item.triangle_of = mesh.triangle_of.view();
  set_attributes(item, drawn);
  set_transform(item, view, drawn.model_from_mesh);
  item.fade_from = drawn.fade_from, item.fade_to = drawn.fade_to;
  item.error_m = drawn.error_m;
  item.fading = !(drawn.fade_from <= 0 && drawn.fade_to >= 1);
  return item;
}

void half_of(const Box& box, float* center, float* half) {
  for (int i = 0; i < 3; ++i) {
    center[i] = (box.min[i] + box.max[i]) * 0.5F;
    const float h = std::max(box.max[i] - center[i], center[i] - box.min[i]);
    half[i] = h + (std::abs(center[i]) + h) * 2e-7F;
  }
}

namespace {

/// The same for a layer of what is seen through: only its blocks that are, which are the mesh's last.
Item blended_item_of(const RasterItem& drawn, const RasterView& view) {
  const std::vector<raster_kernel::Block>& blocks = drawn.mesh->blocks;
  size_t first = blocks.size();
  while (first > 0 && (blocks[first - 1].flags & raster_kernel::block_blended) != 0) --first;
  if (first == blocks.size()) return {};
  Item item = item_of(drawn, view);
  item.blocks += first, item.block_count -= std::min(item.block_count, static_cast<uint32_t>(first));
  return item;
}

/// What the item's blocks lie in, in the mesh's frame.
Box box_of(const Item& item) {
  Box box;
  for (uint32_t i = 0; i < item.block_count; ++i) {
    const raster_kernel::Block& b = item.blocks[i];
    const glm::vec3 center(b.box_center[0], b.box_center[1], b.box_center[2]),
        half(b.box_half[0], b.box_half[1], b.box_half[2]);
    box.add(center - half), box.add(center + half);
  }
  return box;
}

/// Ids in the order of (node, place in the list), a whole number of runs each.
Status number_items(VisibilityBuffer::State& s, std::span<const RasterItem> items) {
  std::vector<uint32_t> order(items.size());
  std::iota(order.begin(), order.end(), 0U);
  const auto before = [&](uint32_t a, uint32_t b) {
    return items[a].node != items[b].node ? items[a].node < items[b].node : a < b;
  };
  if (!std::is_sorted(order.begin(), order.end(), before)) std::sort(order.begin(), order.end(), before);
  s.item_of_run.clear();
  constexpr size_t kMostRuns = (size_t(1) << (32 - kIdRunBits)) - 1;
  for (const uint32_t i : order) {
    s.items[i].first_id = static_cast<uint32_t>(s.item_of_run.size() << kIdRunBits);
    const size_t runs = (size_t(items[i].mesh->triangle_count) + (1U << kIdRunBits) - 1) >> kIdRunBits;
    if (runs > kMostRuns - s.item_of_run.size())
      return Error{"more than 4294967040 triangles in one picture; draw coarser nodes"};
    s.item_of_run.insert(s.item_of_run.end(), runs, i);
  }
  return Done{};
}

struct Seen {
  BoxPicture box;
  uint32_t item;
};

/// The items in the picture, from near to far.
std::vector<Seen> items_in_view(const VisibilityBuffer::State& s, std::span<const RasterItem> items,
                                const Kernels& kernels, bool layer) {
  std::vector<Seen> seen;
  for (uint32_t i = 0; i < items.size(); ++i) {
    if (s.items[i].block_count == 0) continue;
    float center[3], half[3];
    half_of(layer ? box_of(s.items[i]) : items[i].mesh->box, center, half);
    const Seen one = {kernels.project_box(s.frame, s.items[i], center, half), i};
    if (!one.box.culled) seen.push_back(one);
  }
  std::sort(seen.begin(), seen.end(), [](const Seen& a, const Seen& b) {
    return a.box.nearest_z != b.box.nearest_z ? a.box.nearest_z > b.box.nearest_z : a.item < b.item;
  });
  return seen;
}

/// Cuts the picture into regions, as square as may be.
std::vector<Region> regions_of(const Frame& f, unsigned threads) {
  int32_t columns = 1, rows = 1;
  const size_t wanted = threads == 1 ? 1 : threads * kRegionsPerThread;
  while (static_cast<size_t>(columns) * static_cast<size_t>(rows) < wanted) {
    const int32_t width = f.tiles_x / columns, height = f.tiles_y / rows;
    if (std::max(width, height) < 2 * kSmallestRegion) break;
    (width >= height ? columns : rows) *= 2;
  }
  std::vector<Region> regions;
  for (int32_t r = 0; r < rows; ++r) {
    for (int32_t c = 0; c < columns; ++c) {
      Region region = {};
      region.tx0 = f.tiles_x * c / columns, region.tx1 = f.tiles_x * (c + 1) / columns;
      region.ty0 = f.tiles_y * r / rows, region.ty1 = f.tiles_y * (r + 1) / rows;
      region.stride = region.tx1 - region.tx0 + raster_kernel::kLanePadding;
      regions.push_back(region);
    }
  }
  return regions;
}

void add(VisibilityStats& s, const raster_kernel::Counts& c) {
  s.items_drawn += c.items_drawn, s.items_hidden += c.items_hidden;
  s.blocks_drawn += c.blocks_drawn, s.blocks_hidden += c.blocks_hidden, s.blocks_facing_away += c.blocks_facing_away;
  s.triangles_set_up += c.triangles_set_up, s.triangles_drawn += c.triangles_drawn,
      s.triangles_clipped += c.triangles_clipped;
}

bool overlaps(const Region& r, const BoxPicture& b) {
  return b.x1 >= r.tx0 * kTile && b.x0 < r.tx1 * kTile && b.y1 >= r.ty0 * kTile && b.y0 < r.ty1 * kTile;
}

/// Room for depths, ids, tiles, and the regions that share it.
void size_planes(VisibilityBuffer::State& s, unsigned threads) {
  const size_t pixels = size_t(s.frame.tiles_x) * size_t(s.frame.tiles_y) * raster_kernel::kTilePixels;
  s.z.resize(pixels), s.id.resize(pixels);
  s.frame.z = s.z.data(), s.frame.id = s.id.data();
  std::vector<Region> regions = regions_of(s.frame, threads);
  const auto same = [](const Region& a, const Region& b) {
    return a.tx0 == b.tx0 && a.ty0 == b.ty0 && a.tx1 == b.tx1 && a.ty1 == b.ty1;
  };
  if (!std::equal(regions.begin(), regions.end(), s.regions.begin(), s.regions.end(), same))
    s.blank.assign(regions.size(), 0);
  s.regions = std::move(regions);
  size_t tiles = 0;
  for (const Region& r : s.regions) tiles += size_t(r.stride) * size_t(r.ty1 - r.ty0);
  s.hz.resize(tiles), s.dirty.resize(tiles);
  tiles = 0;
  for (Region& r : s.regions) {
    r.hz = &s.hz[tiles], r.dirty = &s.dirty[tiles];
    tiles += size_t(r.stride) * size_t(r.ty1 - r.ty0);
  }
}

raster_kernel::Coverage coverage_of(PixelRule rule) { return static_cast<raster_kernel::Coverage>(rule); }

/// The part of a region that the boxes lie in; none of it: tx0 >= tx1.
Region part_of(const Region& r, std::span<const Seen> seen) {
  Region part = r;
  part.tx0 = r.tx1, part.ty0 = r.ty1, part.tx1 = r.tx0, part.ty1 = r.ty0;
  for (const Seen& one : seen) {
    if (!overlaps(r, one.box)) continue;
    part.tx0 = std::min(part.tx0, std::max(r.tx0, one.box.x0 / kTile));
    part.ty0 = std::min(part.ty0, std::max(r.ty0, one.box.y0 / kTile));
    part.tx1 = std::max(part.tx1, std::min(r.tx1, one.box.x1 / kTile + 1));
    part.ty1 = std::max(part.ty1, std::min(r.ty1, one.box.y1 / kTile + 1));
  }
  return part;
}

/// Lets a region of a layer begin behind nothing and, in its `part`, before the solid surfaces.
void begin_layer(VisibilityBuffer::State& s, const VisibilityBuffer::State& solid, size_t region, const Region& part) {
  const Region& r = s.regions[region];
  const auto place = [&s](int32_t tx, int32_t ty) {
    return (size_t(ty) * size_t(s.frame.tiles_x) + size_t(tx)) * raster_kernel::kTilePixels;
  };
  const auto pixels = [](const Region& of) { return size_t(of.tx1 - of.tx0) * raster_kernel::kTilePixels; };
  const size_t tiles = size_t(r.stride) * size_t(r.ty1 - r.ty0);
  std::fill_n(r.hz, tiles, s.frame.clear_z);
  std::fill_n(r.dirty, tiles, uint8_t(1));  // what is farthest is found where it is asked for
  if (s.blank[region] == 0)
    for (int32_t ty = r.ty0; ty < r.ty1; ++ty)
      std::fill_n(&s.id[place(r.tx0, ty)], pixels(r), raster_kernel::kNoSurface);
  s.blank[region] = 1;
  if (part.tx0 >= part.tx1) return;
  for (int32_t ty = part.ty0; ty < part.ty1; ++ty)
    std::copy_n(&solid.z[place(part.tx0, ty)], pixels(part), &s.z[place(part.tx0, ty)]);
}

/// Draws a layer's region; what lies behind a layer that is empty there is empty, too.
void draw_layer_region(VisibilityBuffer::State& s, const VisibilityBuffer::State& solid,
                       const VisibilityBuffer::State* before, const Kernels& kernels, std::span<const Seen> seen,
                       size_t region, const VisibilityOptions& options) {
  Region& r = s.regions[region];
  const bool behind_nothing =
      before != nullptr && before->regions.size() == s.regions.size() && before->blank[region] != 0;
  Region part = part_of(r, behind_nothing ? std::span<const Seen>() : seen);
  part.counts = {};
  begin_layer(s, solid, region, part);
  if (part.tx0 < part.tx1)
    for (const Seen& one : seen)
      if (overlaps(part, one.box)) kernels.draw(s.frame, s.items[one.item], one.box, part, coverage_of(options.rule));
  r.counts = part.counts;
  s.blank[region] = part.counts.triangles_drawn == 0 ? 1 : 0;
}

}  // namespace

unsigned thread_count(unsigned wanted) {
  return wanted != 0 ? wanted : std::max(1U, std::thread::hardware_concurrency());
}

namespace {

/// Kept: of each arena that is made, oneTBB 2021.8 keeps 7 KiB for good, and a frame would make four.
tbb::task_arena& arena_of(unsigned threads) {
  thread_local std::map<unsigned, tbb::task_arena> arenas;
  return arenas.try_emplace(threads, static_cast<int>(threads)).first->second;
}

}  // namespace

void run_parallel(unsigned threads, size_t count, const std::function<void(size_t)>& body) {
  const unsigned n = std::min(thread_count(threads), std::max(1U, std::thread::hardware_concurrency()));
  if (n == 1 || count <= 1) {
    for (size_t i = 0; i < count; ++i) body(i);
    return;
  }
  HandOver begin, end;
  begin.give();
  const auto task = [&](size_t i) {
    begin.take();
    body(i);
    end.give();
  };
  arena_of(n).execute([&] { tbb::parallel_for(size_t(0), count, task, tbb::simple_partitioner()); });
  end.take();
}

Simd supported_simd(Simd wanted) {
  const bool wide = wanted == Simd::best || wanted == Simd::avx512;
#if defined(__x86_64__)
  __builtin_cpu_init();
  if (wide && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
      __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512cd"))
    return Simd::avx512;
  if ((wide || wanted == Simd::avx2) && __builtin_cpu_supports("avx2") && __builtin_cpu_supports("bmi") &&
      __builtin_cpu_supports("bmi2") && __builtin_cpu_supports("popcnt"))
    return Simd::avx2;
#else
  static_cast<void>(wide);
#endif
  return Simd::portable;
}

const raster_kernel::Kernels& kernels_of(Simd simd) {
  switch (supported_simd(simd)) {
    case Simd::avx512:
      return raster_kernel::avx512_kernels();
    case Simd::avx2:
      return raster_kernel::avx2_kernels();
    default:
      return raster_kernel::portable_kernels();
  }
}

float VisibilityBuffer::State::depth_m(size_t at) const {
  if (!covered(at)) return std::numeric_limits<float>::infinity();
  return frame.orthographic ? -z[at] : 1.0F / z[at];
}

VisibilityBuffer::VisibilityBuffer() : state_(std::make_unique<State>()) {}
VisibilityBuffer::~VisibilityBuffer() = default;
VisibilityBuffer::VisibilityBuffer(VisibilityBuffer&&) noexcept = default;
VisibilityBuffer& VisibilityBuffer::operator=(VisibilityBuffer&&) noexcept = default;

uint32_t VisibilityBuffer::width_px() const { return state_->view.width_px; }
uint32_t VisibilityBuffer::height_px() const { return state_->view.height_px; }
const RasterView& VisibilityBuffer::view() const { return state_->view; }
const VisibilityStats& VisibilityBuffer::stats() const { return state_->stats; }

Status VisibilityBuffer::draw(const RasterView& view, std::span<const RasterItem> items,
                              const VisibilityOptions& options) {
  PROMENADE_TRY(check(view));
  return draw_over(view, nullptr, nullptr, items, options);
}

Status VisibilityBuffer::draw_layer(const VisibilityBuffer& solid, const VisibilityBuffer* before,
                                    std::span<const RasterItem> items, const VisibilityOptions& options) {
  if (solid.state_->kernels == nullptr)
    return Error{"a layer before a picture that was never drawn; draw the solid one first"};
  return draw_over(solid.view(), solid.state_.get(), before == nullptr ? nullptr : before->state_.get(), items,
                   options);
}

Status VisibilityBuffer::draw_over(const RasterView& view, const State* solid, const State* before,
                                   std::span<const RasterItem> items, const VisibilityOptions& options) {
  State& s = *state_;
  const Clock::time_point start = Clock::now();
  const Kernels& kernels = kernels_of(options.simd);
  s.kernels = nullptr;  // until the picture is whole
  s.view = view, s.stats = {}, s.frame = frame_of(view, options);
  s.items.clear(), s.nodes.clear();
  for (const RasterItem& item : items) {
    s.items.push_back(solid == nullptr ? item_of(item, view) : blended_item_of(item, view));
    s.nodes.push_back(item.node);
  }
  PROMENADE_TRY(number_items(s, items));
  if (solid != nullptr) {
    s.frame.draw_solid = false, s.frame.draw_blended = true, s.frame.screen_door = false;
    if (before != nullptr) s.frame.before_z = before->z.data(), s.frame.before_id = before->id.data();
  }
  const std::vector<Seen> seen = items_in_view(s, items, kernels, solid != nullptr);
  s.stats.items = items.size(), s.stats.items_in_view = seen.size();
  size_planes(s, thread_count(options.threads));
  s.stats.cull_ms = ms_since(start);

  const Clock::time_point drawing = Clock::now();
  run_parallel(options.threads, s.regions.size(), [&](size_t i) {
    if (solid != nullptr) return draw_layer_region(s, *solid, before, kernels, seen, i, options);
    Region& r = s.regions[i];
    kernels.clear(s.frame, r);
    for (const Seen& one : seen)
      if (overlaps(r, one.box)) kernels.draw(s.frame, s.items[one.item], one.box, r, coverage_of(options.rule));
    s.blank[i] = 0;
  });
  for (const Region& r : s.regions) add(s.stats, r.counts);
  s.kernels = &kernels;
  if (options.close_gaps && solid == nullptr) s.stats.gaps_closed = close_gaps(s, options.threads);
  s.stats.draw_ms = ms_since(drawing);
  return Done{};
}

float VisibilityBuffer::depth_m(uint32_t x, uint32_t y) const { return state_->depth_m(state_->at(x, y)); }

uint32_t VisibilityBuffer::item(uint32_t x, uint32_t y) const {
  const size_t at = state_->at(x, y);
  return state_->covered(at) ? state_->item_at(at) : kNoTriangle;
}

uint32_t VisibilityBuffer::node(uint32_t x, uint32_t y) const {
  const uint32_t i = item(x, y);
  return i == kNoTriangle ? kNoTriangle : state_->nodes[i];
}

uint32_t VisibilityBuffer::triangle(uint32_t x, uint32_t y) const {
  const size_t at = state_->at(x, y);
  return state_->covered(at) ? state_->id[at] - state_->items[state_->item_at(at)].first_id : kNoTriangle;
}

void VisibilityBuffer::read_depth_m(std::span<float> out) const {
  for (uint32_t y = 0, i = 0; y < height_px(); ++y)
    for (uint32_t x = 0; x < width_px(); ++x, ++i) out[i] = depth_m(x, y);
}

void VisibilityBuffer::read_nodes(std::span<uint32_t> out) const {
  for (uint32_t y = 0, i = 0; y < height_px(); ++y)
    for (uint32_t x = 0; x < width_px(); ++x, ++i) out[i] = node(x, y);
}

void VisibilityBuffer::read_triangles(std::span<uint32_t> out) const {
  for (uint32_t y = 0, i = 0; y < height_px(); ++y)
    for (uint32_t x = 0; x < width_px(); ++x, ++i) out[i] = triangle(x, y);
}

}  // namespace promenade
