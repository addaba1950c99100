// Charts are laid out (charts.h), each texel is given its place on the simplified surface, asks for the nearest point
// of the detailed surface (closest_point.h), and takes what that looks like (texture_sampler.h). Texels that no
// triangle touches take after their nearest neighbour in the chart.
#include "preprocess/bake.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <utility>

#include "geometry/closest_point.h"
#include "preprocess/charts.h"
#include "preprocess/texture_sampler.h"

namespace promenade {
namespace {

constexpr float kReach = 0.75F;      // texels: how far outside its triangle a texel's centre may lie and still ask
constexpr float kSameTexel = 0.01F;  // texels: no one sees which of two triangles this near to a point is nearer
constexpr float kWithin = 1e-4F;     // least weight of a corner at a point that is not on an edge
constexpr uint32_t kNone = 0xffffffffU;
constexpr int kEdgeContrast = 24;      // of 255: what one look may be off without anyone seeing it
constexpr float kClearWeight = 1e-3F;  // clear looks keep a say in the colour
constexpr uint32_t kCells = 5;  // of bins of normals along a side of a cube; odd, so that axes are in the middle of one
constexpr uint32_t kDirections = 6 * kCells * kCells;
constexpr uint32_t kTwoSided = kDirections;          // added to the bin of a two-sided triangle
constexpr uint32_t kAnyDirection = 2 * kDirections;  // triangles without area
// Cosine of the angle to a chart's direction from which surface counts as facing another way: its own triangles (45
// degrees and half a bin) do not, a wall at right angles does, though both are equally near at the edge between them.
constexpr float kFacingCos = 0.35F;

/// What lies at a texel: a triangle of the simplified mesh and how far the texel's centre is outside it.
struct Cover {
  uint32_t triangle = kNone;
  float distance2 = std::numeric_limits<float>::infinity();
  glm::vec2 weights{0};  // of the second and third corner
};

/// Weights of b and c at the point of triangle abc that is closest to p.
glm::vec2 closest_weights(const glm::vec2& p, const glm::vec2& a, const glm::vec2& b, const glm::vec2& c) {
  const auto on_edge = [&p](const glm::vec2& from, const glm::vec2& to) {
    const glm::vec2 edge = to - from;
    const float length2 = glm::dot(edge, edge);
    return length2 > 0 ? std::clamp(glm::dot(p - from, edge) / length2, 0.0F, 1.0F) : 0.0F;
  };
  const glm::vec2 ab = b - a, ac = c - a, ap = p - a;
  const float area = ab.x * ac.y - ab.y * ac.x;
  if (area != 0) {
    const float wb = (ap.x * ac.y - ap.y * ac.x) / area, wc = (ab.x * ap.y - ab.y * ap.x) / area;
    if (wb >= 0 && wc >= 0 && wb + wc <= 1) return {wb, wc};
  }
  const float s = on_edge(a, b), t = on_edge(b, c), r = on_edge(a, c);
  const std::array<glm::vec2, 3> candidates = {glm::vec2(s, 0), glm::vec2(1 - t, t), glm::vec2(0, r)};
  return *std::min_element(candidates.begin(), candidates.end(), [&](const glm::vec2& x, const glm::vec2& y) {
    const glm::vec2 dx = ap - x.x * ab - x.y * ac, dy = ap - y.x * ab - y.y * ac;
    return glm::dot(dx, dx) < glm::dot(dy, dy);
  });
}

/// Side of the cube and cell on it that a direction points to.
uint32_t direction_bin(const glm::vec3& n) {
  const glm::vec3 size = glm::abs(n);
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  const auto cell = [&](int other) {
    return std::min(static_cast<uint32_t>((n[other] / size[axis] + 1) * (float(kCells) / 2)), kCells - 1);
  };
  const uint32_t side = static_cast<uint32_t>(axis) * 2 + (n[axis] < 0 ? 1U : 0U);
  return (side * kCells + cell((axis + 1) % 3)) * kCells + cell((axis + 2) % 3);
}

std::array<glm::vec3, kDirections> bin_directions() {
  std::array<glm::vec3, kDirections> directions{};
  for (uint32_t bin = 0; bin < kDirections; ++bin) {
    const uint32_t side = bin / (kCells * kCells);
    const int axis = static_cast<int>(side / 2);
    const auto middle = [](uint32_t cell) { return (float(cell) + 0.5F) * 2 / float(kCells) - 1; };
    glm::vec3 n(0);
    n[axis] = side % 2 == 0 ? 1.0F : -1.0F;
    n[(axis + 1) % 3] = middle(bin / kCells % kCells);
    n[(axis + 2) % 3] = middle(bin % kCells);
    directions[bin] = glm::normalize(n);
  }
  return directions;
}

/// The detailed surface: where it is nearest, and what it looks like there.
class DetailedSurface {
 public:
  DetailedSurface(const Mesh& mesh, std::span<const Material> materials,
                  const std::function<const Image*(uint32_t)>& picture, float texel_m)
      : mesh_(mesh), tree_(mesh), sampler_(materials, picture), texel_m_(texel_m) {
    for (uint32_t t = 0; t < mesh.triangle_count(); ++t) {
      const glm::vec3 n = triangle_cross(mesh, t);
      if (!(glm::dot(n, n) > 0))
        direction_.push_back(kAnyDirection);
      else
        direction_.push_back(direction_bin(n) + (materials[mesh.material_of(t)].two_sided ? kTwoSided : 0));
      footprint_uv_.push_back(footprint(t, glm::length(n)));
    }
  }

  /// Which way (unit) the texels that follow face.
  void face(const glm::vec3& normal) {
    for (uint32_t bin = 0; bin < kDirections; ++bin) {
      const float facing = glm::dot(bin_directions_[bin], normal);
      faces_away_[bin] = facing < kFacingCos ? uint8_t(1) : uint8_t(0);
      faces_away_[bin + kTwoSided] = std::abs(facing) < kFacingCos ? uint8_t(1) : uint8_t(0);
    }
    hint_ = kNoTriangle;
  }

  /// What is there, and how it lets through what is behind it.
  std::pair<Light, AlphaMode> seen_at(const glm::vec3& p) {
    ClosestPointTree::Limits limits;
    limits.hint = hint_;
    limits.group_of_triangle = direction_.data();
    limits.group_hidden = faces_away_.data();
    const float enough_m = kSameTexel * texel_m_;
    limits.enough_distance2_m2 = enough_m * enough_m;
    ClosestPoint found = tree_.closest(p, limits);
    // Far off, the surface that faces this way may have nothing to do with this one.
    const float near2 = 16 * texel_m_ * texel_m_;
    if (found.triangle == kNoTriangle || found.distance2_m2 > near2) {
      const ClosestPoint any = tree_.closest(p);
      constexpr float kMuchNearer2 = 1.0F / 16;
      if (found.triangle == kNoTriangle || any.distance2_m2 < kMuchNearer2 * found.distance2_m2) found = any;
    }
    hint_ = found.triangle;
    return {look(found), sampler_.alpha_of(mesh_.material_of(found.triangle))};
  }

 private:
  /// Side of the patch of the texture that a texel covers.
  float footprint(uint32_t t, float twice_area_m2) const {
    if (mesh_.texcoords.empty() || !(twice_area_m2 > 0)) return 0;
    const glm::vec2 a = mesh_.texcoords[mesh_.indices[3 * size_t(t)]];
    const glm::vec2 ab = mesh_.texcoords[mesh_.indices[3 * size_t(t) + 1]] - a;
    const glm::vec2 ac = mesh_.texcoords[mesh_.indices[3 * size_t(t) + 2]] - a;
    return texel_m_ * std::sqrt(std::abs(ab.x * ac.y - ab.y * ac.x) / twice_area_m2);
  }

  Light look(const ClosestPoint& at) {
    const size_t first = size_t(at.triangle) * 3;
    glm::vec2 texcoord(0);
    Light color(1);
    if (!mesh_.texcoords.empty())
      for (int c = 0; c < 3; ++c)
        texcoord += at.barycentric[c] * mesh_.texcoords[mesh_.indices[first + static_cast<size_t>(c)]];
    if (!mesh_.colors.empty()) {
      color = Light(0);
      for (int c = 0; c < 3; ++c) {
        const glm::u8vec4& v = mesh_.colors[mesh_.indices[first + static_cast<size_t>(c)]];
        color += at.barycentric[c] *
                 Light(srgb_to_linear(v.r), srgb_to_linear(v.g), srgb_to_linear(v.b), float(v.a) / 255.0F);
      }
    }
    const uint32_t material = mesh_.material_of(at.triangle);
    color *= sampler_.at(material, texcoord, footprint_uv_[at.triangle]);
    if (sampler_.alpha_of(material) == AlphaMode::opaque) color.a = 1;  // whatever its vertices say
    return color;
  }

  const Mesh& mesh_;
  ClosestPointTree tree_;
  MaterialSampler sampler_;
  float texel_m_;
  std::vector<uint32_t> direction_;  // by triangle: a bin, or kAnyDirection
  std::vector<float> footprint_uv_;  // by triangle
  const std::array<glm::vec3, kDirections> bin_directions_ = bin_directions();
  std::array<uint8_t, kAnyDirection + 1> faces_away_{};  // by bin
  uint32_t hint_ = kNoTriangle;
};

/// Paints one chart after another into the atlas.
class Painter {
 public:
  Painter(const Mesh& mesh, const AtlasLayout& layout, DetailedSurface& surface, BakedMesh& out)
      : mesh_(mesh), layout_(layout), surface_(surface), out_(out), has_texels_(mesh.triangle_count(), 0) {
    out_.alpha.assign(mesh.triangle_count(), AlphaMode::opaque);
  }

  void paint(size_t index, const Chart& chart) {
    const AtlasPlace& place = layout_.places[index];
    covers_.assign(size_t(place.width) * place.height, Cover{});
    for (const uint32_t t : chart.triangles) cover(index, chart, t);
    std::vector<uint32_t> painted;
    surface_.face(glm::cross(chart.right, chart.down));
    for (uint32_t i = 0; i < covers_.size(); ++i) {
      if (covers_[i].triangle == kNone) continue;
      const auto [light, alpha] = surface_.seen_at(point_of(covers_[i]));
      put(place, i, light);
      // What lies on its edge may be its neighbour's.
      const glm::vec2& w = covers_[i].weights;
      if (std::min({w.x, w.y, 1 - w.x - w.y}) > kWithin) note(covers_[i].triangle, light, alpha);
      painted.push_back(i);
    }
    refine(chart, place, painted);
    spread(place, painted);
    for (const uint32_t t : chart.triangles) {
      if (has_texels_[t] != 0) continue;
      const auto [light, alpha] = surface_.seen_at(point_of({t, 0, glm::vec2(1.0F / 3)}));
      note(t, light, alpha);
    }
  }

 private:
  glm::u8vec4& texel(const AtlasPlace& place, uint32_t i) {
    return out_.atlas.at(place.x + i % place.width, place.y + i / place.width);
  }

  /// Texels that differ from a neighbour see an edge, which one look misses or overstates: they take the mean of four.
  void refine(const Chart& chart, const AtlasPlace& place, const std::vector<uint32_t>& painted) {
    std::vector<uint32_t> edges;
    for (const uint32_t i : painted)
      if (differs(place, i, i % place.width + 1 < place.width, i + 1) ||
          differs(place, i, i % place.width > 0, i - 1) ||
          differs(place, i, i + place.width < covers_.size(), i + place.width) ||
          differs(place, i, i >= place.width, i - place.width))
        edges.push_back(i);
    const float quarter_m = static_cast<float>(layout_.texel_m) / 4;
    for (const uint32_t i : edges) {
      const glm::vec3 middle = point_of(covers_[i]);
      glm::vec4 sum(0);
      for (const glm::vec2& off : {glm::vec2(-1, -1), glm::vec2(1, -1), glm::vec2(-1, 1), glm::vec2(1, 1)}) {
        const Light light = surface_.seen_at(middle + quarter_m * (off.x * chart.right + off.y * chart.down)).first;
        const float weight = light.a + kClearWeight;
        sum += glm::vec4(glm::vec3(light) * weight, weight);
      }
      put(place, i, Light(glm::vec3(sum) / sum.a, sum.a / 4 - kClearWeight));
    }
  }

  bool differs(const AtlasPlace& place, uint32_t i, bool inside, uint32_t other) {
    if (!inside || covers_[other].triangle == kNone) return false;
    const glm::ivec4 difference = glm::abs(glm::ivec4(texel(place, i)) - glm::ivec4(texel(place, other)));
    return std::max({difference.r, difference.g, difference.b, difference.a}) > kEdgeContrast;
  }

  static uint8_t opacity_of(const Light& light) {
    return static_cast<uint8_t>(std::lround(std::clamp(light.a, 0.0F, 1.0F) * 255.0F));
  }

  void note(uint32_t triangle, const Light& light, AlphaMode alpha) {
    has_texels_[triangle] = 1;
    if (opacity_of(light) < 255) out_.alpha[triangle] = std::max(out_.alpha[triangle], alpha);
  }

  void put(const AtlasPlace& place, uint32_t i, const Light& light) {
    const uint8_t opacity = opacity_of(light);
    texel(place, i) = {linear_to_srgb(light.r), linear_to_srgb(light.g), linear_to_srgb(light.b), opacity};
    out_.has_opacity = out_.has_opacity || opacity < 255;
  }

  glm::vec3 point_of(const Cover& c) const {
    const uint32_t* corner = &mesh_.indices[size_t(c.triangle) * 3];
    const glm::vec3 &a = mesh_.positions[corner[0]], &b = mesh_.positions[corner[1]], &d = mesh_.positions[corner[2]];
    return a + c.weights.x * (b - a) + c.weights.y * (d - a);
  }

  /// Claims the texels in and closely around a triangle, unless another is nearer.
  void cover(size_t index, const Chart& chart, uint32_t triangle) {
    const AtlasPlace& place = layout_.places[index];
    std::array<glm::vec2, 3> corner;
    for (size_t c = 0; c < 3; ++c)
      corner[c] = layout_.texels(index, chart.flat(mesh_.positions[mesh_.indices[size_t(triangle) * 3 + c]])) -
                  glm::vec2(float(place.x), float(place.y));
    const glm::vec2 low = glm::min(corner[0], glm::min(corner[1], corner[2])) - 1.5F;
    const glm::vec2 high = glm::max(corner[0], glm::max(corner[1], corner[2])) + 0.5F;
    const auto bound = [](float value, uint32_t size) {
      return static_cast<uint32_t>(std::clamp(value, 0.0F, float(size)));
    };
    for (uint32_t y = bound(std::ceil(low.y), place.height); y < bound(std::ceil(high.y), place.height); ++y)
      for (uint32_t x = bound(std::ceil(low.x), place.width); x < bound(std::ceil(high.x), place.width); ++x) {
        const glm::vec2 center(float(x) + 0.5F, float(y) + 0.5F);
        const glm::vec2 w = closest_weights(center, corner[0], corner[1], corner[2]);
        const glm::vec2 off = corner[0] + w.x * (corner[1] - corner[0]) + w.y * (corner[2] - corner[0]) - center;
        Cover& c = covers_[size_t(y) * place.width + x];
        const float distance2 = glm::dot(off, off);
        if (distance2 <= kReach * kReach && distance2 < c.distance2) c = {triangle, distance2, w};
      }
  }

  /// Gives the place's other texels the colour of their nearest neighbour, ring by ring.
  void spread(const AtlasPlace& place, std::vector<uint32_t>& painted) {
    for (size_t next = 0; next < painted.size(); ++next) {
      const uint32_t i = painted[next], x = i % place.width, y = i / place.width;
      const auto pass_on = [&](bool inside, uint32_t to) {
        if (!inside || covers_[to].triangle != kNone) return;
        covers_[to].triangle = covers_[i].triangle;
        texel(place, to) = texel(place, i);
        painted.push_back(to);
      };
      pass_on(x > 0, i - 1);
      pass_on(x + 1 < place.width, i + 1);
      pass_on(y > 0, i - place.width);
      pass_on(y + 1 < place.height, i + place.width);
    }
  }

  const Mesh& mesh_;
  const AtlasLayout& layout_;
  DetailedSurface& surface_;
  BakedMesh& out_;
  std::vector<Cover> covers_;
  std::vector<uint8_t> has_texels_;  // by triangle; or a look at its centroid
};

/// The mesh with a vertex for each chart that one lies in.
Mesh with_texcoords(const Mesh& mesh, const std::vector<Chart>& charts, const AtlasLayout& layout) {
  Mesh out;
  out.indices.resize(mesh.indices.size());
  std::vector<uint32_t> renamed(mesh.vertex_count()), chart_of(mesh.vertex_count(), kNone);
  const glm::vec2 size{float(layout.width), float(layout.height)};
  for (uint32_t index = 0; index < charts.size(); ++index) {
    for (const uint32_t t : charts[index].triangles) {
      for (size_t c = 0; c < 3; ++c) {
        const uint32_t v = mesh.indices[size_t(t) * 3 + c];
        if (chart_of[v] != index) {
          chart_of[v] = index;
          renamed[v] = static_cast<uint32_t>(out.positions.size());
          out.positions.push_back(mesh.positions[v]);
          if (!mesh.normals.empty()) out.normals.push_back(mesh.normals[v]);
          const glm::vec2 texels = layout.texels(index, charts[index].flat(mesh.positions[v]));
          out.texcoords.push_back(glm::clamp(texels / size, glm::vec2(0), glm::vec2(1)));
        }
        out.indices[size_t(t) * 3 + c] = renamed[v];
      }
    }
  }
  return out;
}

/// The mean colour: what the gaps between charts take, so that coarse mip levels do not darken.
glm::u8vec4 mean_color(const Mesh& detailed, std::span<const Material> materials) {
  glm::vec3 sum(0);
  for (size_t t = 0; t < detailed.triangle_count(); ++t) {
    const glm::u8vec4& c = materials[detailed.material_of(t)].color;
    sum += glm::vec3(srgb_to_linear(c.r), srgb_to_linear(c.g), srgb_to_linear(c.b));
  }
  sum /= float(detailed.triangle_count());
  return {linear_to_srgb(sum.r), linear_to_srgb(sum.g), linear_to_srgb(sum.b), 255};
}

Status check(const Mesh& simplified, const Mesh& detailed, std::span<const Material> materials,
             const BakeOptions& options) {
  if (simplified.triangle_count() == 0 || detailed.triangle_count() == 0)
    return Error{fmt::format("bake: {} triangles onto {}, neither may be none", detailed.triangle_count(),
                             simplified.triangle_count())};
  for (size_t t = 0; t < detailed.triangle_count(); ++t)
    if (detailed.material_of(t) >= materials.size())
      return Error{fmt::format("bake: triangle {}: material {} of {}", t, detailed.material_of(t), materials.size())};
  if (!(options.texel_m > 0 && std::isfinite(options.texel_m)) || options.max_side_px < 16 ||
      options.max_side_px > 16384 || options.padding_px < 1 || options.padding_px > 16)
    return Error{fmt::format("bake: texel of {} m, atlas of {}, padding of {} is out of range", options.texel_m,
                             options.max_side_px, options.padding_px)};
  return Done{};
}

}  // namespace

Result<BakedMesh> bake_atlas(const Mesh& simplified, const Mesh& detailed, std::span<const Material> materials,
                             const std::function<const Image*(uint32_t texture)>& picture, const BakeOptions& options) {
  PROMENADE_TRY(check(simplified, detailed, materials, options));
  const std::vector<Chart> charts = make_charts(simplified);
  const Result<AtlasLayout> layout = pack_charts(charts, {options.texel_m, options.max_side_px, options.padding_px});
  if (!layout) return layout.error();
  BakedMesh out;
  out.mesh = with_texcoords(simplified, charts, *layout);
  out.texel_m = layout->texel_m;
  out.atlas.width = layout->width;
  out.atlas.height = layout->height;
  out.atlas.pixels.assign(size_t(layout->width) * layout->height, mean_color(detailed, materials));
  DetailedSurface surface(detailed, materials, picture, static_cast<float>(layout->texel_m));
  Painter painter(simplified, *layout, surface, out);
  for (size_t i = 0; i < charts.size(); ++i) painter.paint(i, charts[i]);
  return out;
}

}  // namespace promenade
