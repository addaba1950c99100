#include "raster/gaps.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <optional>
#include <vector>

#include "raster/visibility_state.h"

namespace promenade {
namespace {

using raster_kernel::Item;
using raster_kernel::kGapReach;
using raster_kernel::kSubpixel;

/// What rounding to sub-pixels, twice, may open; in pixels.
constexpr double kRoundingPx = 4.0 / kSubpixel;

struct Step {
  int32_t across, down;
};
constexpr std::array<Step, 4> kLines{{{1, 0}, {0, 1}, {1, 1}, {-1, 1}}};
/// Which of the pixels along a line (one step before, one behind, two before, two behind) lie on both sides, the
/// nearest first.
constexpr std::array<std::array<size_t, 2>, 3> kPairs{{{0, 1}, {0, 3}, {2, 1}}};

/// A pixel that shows something nearer.
struct Beside {
  size_t at = 0;
  uint32_t id = raster_kernel::kNoSurface;
};

/// A pixel that is written in place of what was drawn.
struct Filled {
  size_t at;
  float z;
  uint32_t id;
};

uint32_t number_at(const raster_kernel::Numbers& numbers, uint64_t i) {
  return numbers.narrow != nullptr ? numbers.narrow[i] : numbers.wide[i];
}

/// A surface beside a pixel, carried on to its centre.
struct Side {
  uint32_t id;
  double depth_m;    ///< of the surface at the centre
  double changes_m;  ///< depth from the pixel that shows it to this one
  double past_px;    ///< from the triangle's edge to the centre
};

class GapCloser {
 public:
  explicit GapCloser(const VisibilityBuffer::State& state) : s_(state) {}

  void look_at(int32_t x, int32_t y, std::vector<Filled>& filled) const {
    const size_t here = at(x, y);
    const float before = s_.z[here] * raster_kernel::kGapNearer;
    std::array<std::array<Beside, 2 * kGapReach>, kLines.size()> around;
    for (size_t line = 0; line < kLines.size(); ++line)
      for (int32_t i = 0; i < kGapReach; ++i) {
        around[line][2 * size_t(i)] = beside(x, y, kLines[line], -1 - i, before);
        around[line][2 * size_t(i) + 1] = beside(x, y, kLines[line], 1 + i, before);
      }
    for (const std::array<size_t, 2>& pair : kPairs)
      for (const std::array<Beside, 2 * kGapReach>& line : around) {
        const Beside &a = line[pair[0]], &b = line[pair[1]];
        if (a.id == raster_kernel::kNoSurface || b.id == raster_kernel::kNoSurface ||
            s_.item_at(a.at) == s_.item_at(b.at))
          continue;
        if (const std::optional<Side> side = joined(x, y, a, b)) {
          filled.push_back({here, static_cast<float>(1 / side->depth_m), side->id});
          return;
        }
      }
  }

 private:
  size_t at(int32_t x, int32_t y) const { return s_.at(static_cast<uint32_t>(x), static_cast<uint32_t>(y)); }

  const Item& item_of(const Beside& beside) const { return s_.items[s_.item_at(beside.at)]; }

  Beside beside(int32_t x, int32_t y, const Step& line, int32_t steps, float before) const {
    x += line.across * steps, y += line.down * steps;
    if (x < 0 || y < 0 || x >= s_.frame.width || y >= s_.frame.height) return {};
    const size_t there = at(x, y);
    if (!(s_.z[there] > before)) return {};
    return {there, s_.id[there]};
  }

  /// The side that takes the pixel, if the two should meet there.
  std::optional<Side> joined(int32_t x, int32_t y, const Beside& a, const Beside& b) const {
    const double errors_m[2] = {double(item_of(a).error_m), double(item_of(b).error_m)};
    if (!(errors_m[0] + errors_m[1] > 0)) return {};
    const double scale_px = s_.view.scale_px;
    const double most_px =
        (errors_m[0] * double(s_.z[a.at]) + errors_m[1] * double(s_.z[b.at])) * scale_px + kRoundingPx;
    const std::optional<Side> first = side_of(x, y, a, most_px);
    if (!first) return {};
    const std::optional<Side> second = side_of(x, y, b, most_px - first->past_px);
    if (!second) return {};
    const double tolerance_m = errors_m[0] + errors_m[1] + first->changes_m + second->changes_m;
    if (std::abs(first->depth_m - second->depth_m) > tolerance_m) return {};
    const bool is_first = first->past_px != second->past_px ? first->past_px < second->past_px : first->id < second->id;
    return is_first ? first : second;
  }

  /// The surface at a pixel, carried on to (x, y); nothing where that cannot be told, or it ends farther away than
  /// that.
  std::optional<Side> side_of(int32_t x, int32_t y, const Beside& beside, double most_px) const {
    const Item& item = item_of(beside);
    if (item.vertices == nullptr) return {};
    const uint32_t triangle = beside.id - item.first_id;
    if (has_holes(item, triangle)) return {};
    std::array<glm::dvec3, 3> p;
    for (size_t i = 0; i < 3; ++i) p[i] = view_point(item, triangle, i);
    const glm::dvec3 ray((x + 0.5) * kSubpixel - s_.frame.axis_x, (y + 0.5) * kSubpixel - s_.frame.axis_y, 1);
    const glm::dvec3 normals[3] = {glm::cross(p[1], p[2]), glm::cross(p[2], p[0]), glm::cross(p[0], p[1])};
    const double det = glm::dot(p[0], normals[0]);
    if (!(std::abs(det) > 0)) return {};
    double past_px = 0;
    for (const glm::dvec3& n : normals) {
      const double across = std::sqrt(n.x * n.x + n.y * n.y) * kSubpixel;
      if (across > 0) past_px = std::max(past_px, -glm::dot(n, ray) / (det > 0 ? across : -across));
    }
    if (past_px > most_px) return {};
    double near_z = 0, far_z = 1 / double(s_.frame.near_m);
    for (const glm::dvec3& corner : p) {
      const double z = corner.z > double(s_.frame.near_m) ? 1 / corner.z : 1 / double(s_.frame.near_m);
      near_z = std::max(near_z, z), far_z = std::min(far_z, z);
    }
    const double z = std::clamp(glm::dot(normals[0] + normals[1] + normals[2], ray) / det, far_z, near_z);
    if (!(z > 0)) return {};
    const double shown_m = 1 / double(s_.z[beside.at]), depth_m = 1 / z;
    return Side{beside.id, depth_m, std::abs(shown_m - depth_m), past_px};
  }

  /// As the kernels see it: x and y in sub-pixels at 1 m, z in metres.
  glm::dvec3 view_point(const Item& item, uint32_t triangle, size_t corner) const {
    const uint64_t index = 3 * uint64_t(triangle) + corner;
    const uint32_t place = item.vertices[uint64_t(number_at(item.indices, index)) * item.vertex_words];
    const double d[3] = {double(item.x[place]) - item.exact_eye[0], double(item.y[place]) - item.exact_eye[1],
                         double(item.z[place]) - item.exact_eye[2]};
    glm::dvec3 out;
    for (int i = 0; i < 3; ++i)
      out[i] = item.exact_rows[i][0] * d[0] + item.exact_rows[i][1] * d[1] + item.exact_rows[i][2] * d[2];
    return out;
  }

  static bool has_holes(const Item& item, uint32_t triangle) {
    if (item.surfaces == nullptr) return false;
    const bool many = item.materials.narrow != nullptr || item.materials.wide != nullptr;
    const uint32_t material = many ? number_at(item.materials, triangle) : 0;
    return material < item.surface_count && item.surfaces[material].alpha != 0;
  }

  const VisibilityBuffer::State& s_;
};

}  // namespace

uint64_t close_gaps(VisibilityBuffer::State& state, unsigned threads) {
  const auto may_be_off = [](const Item& item) { return item.error_m > 0; };
  if (state.frame.orthographic || std::none_of(state.items.begin(), state.items.end(), may_be_off)) return 0;
  const GapCloser closer(state);
  std::vector<std::vector<Filled>> filled(static_cast<size_t>(state.frame.tiles_y));
  const size_t tiles = filled.size() * static_cast<size_t>(state.frame.tiles_x);
  state.gap_tiles.resize(tiles);
  raster_kernel::GapRoom shared = {};
  shared.item_of_run = state.item_of_run.data(), shared.run_bits = kIdRunBits;
  shared.tiles = state.gap_tiles.data();
  run_parallel(threads, filled.size(),
               [&](size_t row) { state.kernels->find_items(state.frame, shared, static_cast<int32_t>(row)); });
  run_parallel(threads, filled.size(), [&](size_t row) {
    thread_local std::vector<float> depths;
    thread_local std::vector<uint32_t> found;
    raster_kernel::GapRoom room = shared;
    room.stride = state.frame.width + 3 * raster_kernel::kLanePadding;
    depths.resize(size_t(room.stride) * (raster_kernel::kTile + 2 * kGapReach));
    found.resize(size_t(state.frame.width) * raster_kernel::kTile);
    room.depths = depths.data(), room.found = found.data();
    state.kernels->find_gaps(state.frame, room, static_cast<int32_t>(row));
    for (uint32_t i = 0; i < room.count; ++i)
      closer.look_at(static_cast<int32_t>(room.found[i] & 0xffffU), static_cast<int32_t>(room.found[i] >> 16U),
                     filled[row]);
  });
  uint64_t count = 0;
  for (const std::vector<Filled>& row : filled) {
    count += row.size();
    for (const Filled& pixel : row) state.z[pixel.at] = pixel.z, state.id[pixel.at] = pixel.id;
  }
  return count;
}

}  // namespace promenade
