#include "preprocess/charts.h"

#include <fmt/format.h>
#include <stb_rect_pack.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <glm/geometric.hpp>
#include <limits>
#include <numeric>
#include <tuple>

namespace promenade {
namespace {

constexpr float kMinTiltCos = 0.7F;    // 45 degrees: texels are stretched by at most 1.4
constexpr float kTouching = 1e-4F;     // share of a triangle's height by which neighbours may seem to overlap
constexpr double kFill = 0.9;          // how full a packed atlas is, for the first guess of its width
constexpr double kCoarser = 1.12;      // step of the search for a texel that fits
constexpr double kCoarsest = 1 << 16;  // beyond, every chart is as small as charts get
constexpr uint32_t kNone = 0xffffffffU;

using Flat = std::array<glm::vec2, 3>;

float cross(const glm::vec2& a, const glm::vec2& b) { return a.x * b.y - a.y * b.x; }

/// Numbers vertices so that those at one place have one number.
std::vector<uint32_t> places_of(const Mesh& mesh) {
  std::vector<uint32_t> order(mesh.positions.size());
  std::iota(order.begin(), order.end(), 0U);
  const auto key = [&mesh](uint32_t v) {
    const glm::vec3& p = mesh.positions[v];
    return std::tuple(p.x, p.y, p.z);
  };
  std::sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) { return key(a) < key(b); });
  std::vector<uint32_t> places(order.size());
  for (size_t i = 0; i < order.size(); ++i)
    places[order[i]] = i > 0 && key(order[i - 1]) == key(order[i]) ? places[order[i - 1]] : static_cast<uint32_t>(i);
  return places;
}

/// The triangle across each corner's following edge; kNone at borders and where more than two meet.
std::vector<uint32_t> neighbours_of(const Mesh& mesh) {
  const std::vector<uint32_t> places = places_of(mesh);
  struct Edge {
    uint32_t low, high, corner;
  };
  std::vector<Edge> edges;
  edges.reserve(mesh.indices.size());
  for (uint32_t c = 0; c < mesh.indices.size(); ++c) {
    const uint32_t a = places[mesh.indices[c]], b = places[mesh.indices[c % 3 == 2 ? c - 2 : c + 1]];
    edges.push_back({std::min(a, b), std::max(a, b), c});
  }
  std::sort(edges.begin(), edges.end(), [](const Edge& a, const Edge& b) {
    return std::tie(a.low, a.high, a.corner) < std::tie(b.low, b.high, b.corner);
  });
  std::vector<uint32_t> neighbours(mesh.indices.size(), kNone);
  for (size_t i = 0, end = 0; i < edges.size(); i = end) {
    for (end = i; end < edges.size() && edges[end].low == edges[i].low && edges[end].high == edges[i].high;) ++end;
    if (end - i != 2 || edges[i].low == edges[i].high) continue;
    neighbours[edges[i].corner] = edges[i + 1].corner / 3;
    neighbours[edges[i + 1].corner] = edges[i].corner / 3;
  }
  return neighbours;
}

/// Whether some edge of `a` (counter-clockwise) has all of `b` on its other side.
bool parts(const Flat& a, const Flat& b) {
  for (size_t i = 0; i < 3; ++i) {
    const glm::vec2 edge = a[(i + 1) % 3] - a[i];
    const float slack = kTouching * std::abs(cross(edge, a[(i + 2) % 3] - a[i]));
    if (std::all_of(b.begin(), b.end(), [&](const glm::vec2& p) { return cross(edge, p - a[i]) <= slack; }))
      return true;
  }
  return false;
}

/// Triangles that lie flat already, and whether one more would cover any of them.
class FlatSet {
 public:
  bool overlaps(const Flat& t) const {
    const Bounds b = bounds_of(t);
    for (size_t i = 0; i < flats_.size(); ++i) {
      const Bounds& o = bounds_[i];
      if (b.min.x >= o.max.x || o.min.x >= b.max.x || b.min.y >= o.max.y || o.min.y >= b.max.y) continue;
      if (!parts(flats_[i], t) && !parts(t, flats_[i])) return true;
    }
    return false;
  }
  void add(const Flat& t) {
    flats_.push_back(t);
    bounds_.push_back(bounds_of(t));
  }

 private:
  struct Bounds {
    glm::vec2 min, max;
  };
  static Bounds bounds_of(const Flat& t) {
    return {glm::min(t[0], glm::min(t[1], t[2])), glm::max(t[0], glm::max(t[1], t[2]))};
  }

  std::vector<Flat> flats_;
  std::vector<Bounds> bounds_;
};

/// Any two directions at right angles to a unit one and to each other; the first is level where it can be.
void set_axes(const glm::vec3& normal, Chart& chart) {
  const glm::vec3 level(-normal.y, normal.x, 0);
  chart.right = glm::dot(level, level) > 1e-6F ? glm::normalize(level) : glm::vec3(1, 0, 0);
  chart.down = glm::normalize(glm::cross(normal, chart.right));
  chart.right = glm::cross(chart.down, normal);
}

class ChartMaker {
 public:
  explicit ChartMaker(const Mesh& mesh) : mesh_(mesh), neighbours_(neighbours_of(mesh)) {
    for (size_t t = 0; t < mesh.triangle_count(); ++t) {
      const glm::vec3 n = triangle_cross(mesh, t);
      const float length = glm::length(n);
      normals_.push_back(length > 0 && std::isfinite(length) ? n / length : glm::vec3(0));
      areas_.push_back(length);
    }
    charted_.resize(mesh.triangle_count());
  }

  std::vector<Chart> make() {
    std::vector<uint32_t> seeds(mesh_.triangle_count());
    std::iota(seeds.begin(), seeds.end(), 0U);
    std::stable_sort(seeds.begin(), seeds.end(), [this](uint32_t a, uint32_t b) { return areas_[a] > areas_[b]; });
    std::vector<Chart> charts;
    for (const uint32_t seed : seeds) {
      if (charted_[seed]) continue;
      charts.push_back(grown(seed));
      lay_tight(charts.back());
    }
    return charts;
  }

 private:
  Flat flat(const Chart& chart, uint32_t triangle) const {
    Flat out;
    for (size_t c = 0; c < 3; ++c) out[c] = chart.flat(mesh_.positions[mesh_.indices[size_t(triangle) * 3 + c]]);
    return out;
  }

  Chart grown(uint32_t seed) {
    Chart chart;
    const glm::vec3 normal = normals_[seed] == glm::vec3(0) ? glm::vec3(0, 0, 1) : normals_[seed];
    chart.origin = mesh_.positions[mesh_.indices[size_t(seed) * 3]];
    set_axes(normal, chart);
    FlatSet laid;
    std::deque<uint32_t> open = {seed};
    charted_[seed] = true;
    laid.add(flat(chart, seed));
    while (!open.empty()) {
      const uint32_t t = open.front();
      open.pop_front();
      chart.triangles.push_back(t);
      for (size_t c = 0; c < 3; ++c) {
        const uint32_t next = neighbours_[size_t(t) * 3 + c];
        if (next == kNone || charted_[next] || glm::dot(normals_[next], normal) < kMinTiltCos) continue;
        const Flat laid_flat = flat(chart, next);
        if (laid.overlaps(laid_flat)) continue;
        laid.add(laid_flat);
        charted_[next] = true;
        open.push_back(next);
      }
    }
    return chart;
  }

  /// The chart's box for axes turned by the angle whose cosine and sine are given.
  void set_box(Chart& chart, const glm::vec3& right, const glm::vec3& down) const {
    chart.right = right, chart.down = down;
    glm::vec2 low(std::numeric_limits<float>::max()), high(std::numeric_limits<float>::lowest());
    for (const uint32_t t : chart.triangles)
      for (const glm::vec2& p : flat(chart, t)) low = glm::min(low, p), high = glm::max(high, p);
    chart.origin += low.x * right + low.y * down;
    chart.size_m = high - low;
  }

  /// Turns the chart so that its box is small: level, or along the longest edge, or in between.
  void lay_tight(Chart& chart) const {
    glm::vec2 longest(1, 0);
    float longest2 = 0;
    for (const uint32_t t : chart.triangles) {
      const Flat f = flat(chart, t);
      for (size_t c = 0; c < 3; ++c) {
        const glm::vec2 edge = f[(c + 1) % 3] - f[c];
        if (glm::dot(edge, edge) > longest2) longest2 = glm::dot(edge, edge), longest = edge;
      }
    }
    const glm::vec3 right = chart.right, down = chart.down;
    set_box(chart, right, down);
    constexpr int kTurns = 6;
    const float edge_angle = std::atan2(longest.y, longest.x);
    for (int turn = 0; turn < kTurns; ++turn) {
      const float angle = edge_angle + float(turn) * 1.5707963F / kTurns;
      Chart turned = chart;
      set_box(turned, std::cos(angle) * right + std::sin(angle) * down,
              std::cos(angle) * down - std::sin(angle) * right);
      if (turned.size_m.x * turned.size_m.y < 0.95F * chart.size_m.x * chart.size_m.y) chart = turned;
    }
  }

  const Mesh& mesh_;
  std::vector<uint32_t> neighbours_;
  std::vector<glm::vec3> normals_;  // 0 for triangles without area
  std::vector<float> areas_;
  std::vector<bool> charted_;
};

/// Rectangles for the charts at a texel size, and their area in texels; false when one is larger than the atlas.
bool set_sizes(std::span<const Chart> charts, uint32_t max_side_px, AtlasLayout& layout, double& area) {
  area = 0;
  layout.places.assign(charts.size(), {});
  for (size_t i = 0; i < charts.size(); ++i) {
    // Texels whose centres lie around the box: one more than its size, and one for the broken rest.
    const double w = std::floor(double(charts[i].size_m.x) / layout.texel_m) + 2 + 2.0 * layout.padding_px;
    const double h = std::floor(double(charts[i].size_m.y) / layout.texel_m) + 2 + 2.0 * layout.padding_px;
    if (!(w <= max_side_px && h <= max_side_px)) return false;
    layout.places[i].width = static_cast<uint32_t>(w);
    layout.places[i].height = static_cast<uint32_t>(h);
    area += w * h;
  }
  return area <= double(max_side_px) * max_side_px;
}

/// Packs the rectangles into the width; false when they reach below the largest height.
bool pack(uint32_t width, uint32_t max_height, AtlasLayout& layout) {
  std::vector<stbrp_rect> rects(layout.places.size());
  for (size_t i = 0; i < rects.size(); ++i) {
    rects[i].w = static_cast<stbrp_coord>(layout.places[i].width);
    rects[i].h = static_cast<stbrp_coord>(layout.places[i].height);
  }
  std::vector<stbrp_node> nodes(width);
  stbrp_context context = {};
  stbrp_init_target(&context, static_cast<int>(width), static_cast<int>(max_height), nodes.data(),
                    static_cast<int>(nodes.size()));
  if (stbrp_pack_rects(&context, rects.data(), static_cast<int>(rects.size())) == 0) return false;
  layout.width = width;
  layout.height = 0;
  for (size_t i = 0; i < rects.size(); ++i) {
    AtlasPlace& place = layout.places[i];
    place.x = static_cast<uint32_t>(rects[i].x);
    place.y = static_cast<uint32_t>(rects[i].y);
    layout.height = std::max(layout.height, place.y + place.height);
  }
  return true;
}

/// About square; the largest width if that is what it takes.
bool pack_at_size(std::span<const Chart> charts, uint32_t max_side_px, AtlasLayout& layout) {
  double area = 0;
  if (!set_sizes(charts, max_side_px, layout, area)) return false;
  uint32_t width = static_cast<uint32_t>(std::ceil(std::sqrt(area / kFill)));
  for (const AtlasPlace& place : layout.places) width = std::max(width, place.width);
  width = std::min(width, max_side_px);
  return pack(width, max_side_px, layout) || (width < max_side_px && pack(max_side_px, max_side_px, layout));
}

}  // namespace

glm::vec2 Chart::flat(const glm::vec3& p) const {
  const glm::vec3 from_origin = p - origin;
  return {glm::dot(from_origin, right), glm::dot(from_origin, down)};
}

std::vector<Chart> make_charts(const Mesh& mesh) { return ChartMaker(mesh).make(); }

glm::vec2 AtlasLayout::texels(size_t chart, const glm::vec2& flat_m) const {
  const AtlasPlace& place = places[chart];
  const float border = float(padding_px) + 0.5F;
  const glm::vec2 corner(float(place.x) + border, float(place.y) + border);
  return corner + glm::vec2(glm::dvec2(flat_m) / texel_m);
}

Result<AtlasLayout> pack_charts(std::span<const Chart> charts, const AtlasOptions& options) {
  for (uint32_t padding = options.padding_px;; --padding) {
    for (double coarser = 1; coarser < kCoarsest; coarser *= kCoarser) {
      AtlasLayout layout;
      layout.padding_px = padding;
      layout.texel_m = options.texel_m * coarser;
      if (pack_at_size(charts, options.max_side_px, layout)) return layout;
    }
    if (padding == 0) break;
  }
  return Error{fmt::format("{} charts do not fit into an atlas of {} x {} texels; allow a larger one", charts.size(),
                           options.max_side_px, options.max_side_px)};
}

}  // namespace promenade
