#include "preprocess/node_mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <unordered_map>

#include "codec/quantized_mesh.h"
#include "preprocess/weld.h"

namespace promenade {

namespace {

constexpr glm::u8vec4 kWhite{255, 255, 255, 255};

glm::u8vec4 multiplied(const glm::u8vec4& a, const glm::u8vec4& b) {
  if (a == kWhite) return b;
  if (b == kWhite) return a;
  glm::u8vec4 out;
  for (int i = 0; i < 3; ++i) out[i] = linear_to_srgb(srgb_to_linear(a[i]) * srgb_to_linear(b[i]));
  out.a = static_cast<uint8_t>((int(a.a) * int(b.a) + 127) / 255);
  return out;
}

/// A copy of vertex v at the end.
uint32_t duplicate_vertex(Mesh& mesh, uint32_t v) {
  const auto made = static_cast<uint32_t>(mesh.positions.size());
  const glm::vec3 position = mesh.positions[v];
  mesh.positions.push_back(position);
  const auto repeat = [v](auto& values) {
    if (values.empty()) return;
    const auto value = values[v];
    values.push_back(value);
  };
  repeat(mesh.normals), repeat(mesh.texcoords), repeat(mesh.colors);
  return made;
}

/// Whether every corner's normal is the triangle's own, or 0.
bool is_flat(const Mesh& mesh, size_t triangle) {
  constexpr float kSame = 0.99996F;  // cosine of half a degree, which lights by less than a hundredth
  const glm::vec3 cross = triangle_cross(mesh, triangle);
  const float least = kSame * glm::length(cross);
  for (size_t c = 0; c < 3; ++c) {
    const glm::vec3& normal = mesh.normals[mesh.indices[3 * triangle + c]];
    if (normal != glm::vec3(0) && glm::dot(cross, normal) < least) return false;
  }
  return true;
}

/// Normals of 0 for triangles that show their own; vertices that others share with them split.
void forget_flat_normals(Mesh& mesh) {
  if (mesh.normals.empty()) return;
  std::vector<uint8_t> flat(mesh.triangle_count());
  std::vector<uint8_t> is_smooth(mesh.vertex_count(), 0);
  bool any_smooth = false;
  for (size_t t = 0; t < flat.size(); ++t) {
    flat[t] = is_flat(mesh, t) ? 1 : 0;
    if (flat[t] != 0) continue;
    any_smooth = true;
    for (size_t c = 0; c < 3; ++c) is_smooth[mesh.indices[3 * t + c]] = 1;
  }
  if (!any_smooth) {
    mesh.normals.clear();
    return;
  }
  std::vector<uint32_t> flat_copy(mesh.vertex_count(), 0);  // 0: none yet, as no copy is the first vertex
  for (size_t t = 0; t < flat.size(); ++t) {
    if (flat[t] == 0) continue;
    for (size_t c = 0; c < 3; ++c) {
      uint32_t& v = mesh.indices[3 * t + c];
      if (is_smooth[v] != 0) {
        if (flat_copy[v] == 0) flat_copy[v] = duplicate_vertex(mesh, v);
        v = flat_copy[v];
      }
      mesh.normals[v] = glm::vec3(0);
    }
  }
}

}  // namespace

void drop_idle_attributes(Mesh& mesh, const std::function<bool(uint32_t)>& is_textured) {
  if (!mesh.texcoords.empty()) {
    const std::vector<uint32_t> used = materials_of(mesh);
    if (std::none_of(used.begin(), used.end(), is_textured)) mesh.texcoords.clear();
  }
  if (std::all_of(mesh.colors.begin(), mesh.colors.end(), [](const glm::u8vec4& c) { return c == kWhite; }))
    mesh.colors.clear();
  forget_flat_normals(mesh);
}

void fold_colors(Mesh& mesh, const std::vector<Material>& materials,
                 const std::function<uint32_t(uint32_t)>& plain_of) {
  if (mesh.materials.empty()) mesh.materials.assign(mesh.triangle_count(), 0);
  const std::vector<uint32_t> used = materials_of(mesh);
  const auto is_white = [&](uint32_t m) {
    return plain_of(m) == m || (materials[m].color == kWhite && mesh.colors.empty());
  };
  if (!std::all_of(used.begin(), used.end(), is_white)) {
    mesh.colors.resize(mesh.vertex_count(), kWhite);
    constexpr uint32_t kFresh = 0xffffffffU;
    std::vector<uint32_t> owner(mesh.vertex_count(), kFresh);  // the material that a vertex was coloured for
    std::unordered_map<uint64_t, uint32_t> copies;             // (vertex, material) -> its copy
    const std::vector<glm::u8vec4> before = mesh.colors;
    for (size_t i = 0; i < mesh.indices.size(); ++i) {
      const uint32_t v = mesh.indices[i];
      const uint32_t m = mesh.materials[i / 3];
      glm::u8vec4 color = plain_of(m) == m ? before[v] : multiplied(before[v], materials[m].color);
      if (plain_of(m) != m && materials[m].alpha != AlphaMode::blend) color.a = 255;
      if (owner[v] == kFresh) {
        owner[v] = m;
        mesh.colors[v] = color;
      } else if (owner[v] != m && mesh.colors[v] != color) {
        const auto [place, is_new] = copies.emplace(uint64_t(v) << 32 | m, 0U);
        if (is_new) {
          place->second = duplicate_vertex(mesh, v);
          mesh.colors[place->second] = color;
        }
        mesh.indices[i] = place->second;
      }
    }
  }
  for (uint32_t& m : mesh.materials) m = plain_of(m);
}

namespace {

/// Twice what a triangle covers: of the surface, and of the whole picture.
struct Coverage {
  double area_m2, of_picture;
};

Coverage coverage_of(const Mesh& mesh, size_t triangle) {
  const glm::dvec2 a = mesh.texcoords[mesh.indices[3 * triangle]];
  const glm::dvec2 u = glm::dvec2(mesh.texcoords[mesh.indices[3 * triangle + 1]]) - a;
  const glm::dvec2 v = glm::dvec2(mesh.texcoords[mesh.indices[3 * triangle + 2]]) - a;
  return {double(glm::length(triangle_cross(mesh, triangle))), std::abs(u.x * v.y - u.y * v.x)};
}

}  // namespace

double texel_size_m(const Mesh& mesh, uint32_t material, uint32_t width, uint32_t height) {
  double area_m2 = 0, texels = 0;
  if (mesh.texcoords.empty()) return 0;
  for (size_t t = 0; t < mesh.triangle_count(); ++t) {
    if (mesh.material_of(t) != material) continue;
    const Coverage coverage = coverage_of(mesh, t);
    area_m2 += coverage.area_m2, texels += coverage.of_picture * width * height;
  }
  return area_m2 > 0 && texels > 0 ? std::sqrt(area_m2 / texels) : 0;
}

double largest_texel_m(const Mesh& mesh, uint32_t material, uint32_t width, uint32_t height) {
  constexpr double kAside = 0.01;
  if (mesh.texcoords.empty()) return 0;
  struct Part {
    double texel2, area_m2;
  };
  std::vector<Part> parts;
  parts.reserve(mesh.triangle_count());
  double area_m2 = 0;
  for (size_t t = 0; t < mesh.triangle_count(); ++t) {
    if (mesh.material_of(t) != material) continue;
    const Coverage coverage = coverage_of(mesh, t);
    if (!(coverage.area_m2 > 0)) continue;
    const double texels = coverage.of_picture * width * height;
    parts.push_back(
        {texels > 0 ? coverage.area_m2 / texels : std::numeric_limits<double>::infinity(), coverage.area_m2});
    area_m2 += coverage.area_m2;
  }
  std::sort(parts.begin(), parts.end(), [](const Part& a, const Part& b) { return a.texel2 > b.texel2; });
  double aside_m2 = 0;
  for (const Part& part : parts) {
    aside_m2 += part.area_m2;
    if (aside_m2 > kAside * area_m2) return std::isfinite(part.texel2) ? std::sqrt(part.texel2) : 0;
  }
  return 0;
}

bool loses_surface_on_grid(const Mesh& mesh, float step_m) {
  std::vector<glm::vec3> rounded;
  rounded.reserve(mesh.vertex_count());
  for (const glm::vec3& p : mesh.positions) rounded.push_back(snapped(p, step_m));
  // Most meshes keep every triangle, which is quickly seen.
  const auto collapses = [&](size_t t) {
    const glm::vec3 &a = rounded[mesh.indices[3 * t]], &b = rounded[mesh.indices[3 * t + 1]],
                    &c = rounded[mesh.indices[3 * t + 2]];
    return a == b || b == c || c == a;
  };
  size_t first = 0;
  while (first < mesh.triangle_count() && !collapses(first)) ++first;
  if (first == mesh.triangle_count()) return false;
  const Places places = find_places(rounded);
  const auto corners = [&](size_t t) {
    std::array<uint32_t, 3> v{};
    for (size_t c = 0; c < 3; ++c) v[c] = places.of_vertex[mesh.indices[3 * t + c]];
    std::sort(v.begin(), v.end());
    return v;
  };
  const auto edge = [](uint32_t a, uint32_t b) { return uint64_t(a) << 32U | b; };
  std::vector<uint32_t> points;  // places that must remain, edges that must
  std::vector<uint64_t> edges;
  std::vector<uint8_t> is_end(places.count(), 0);  // of such edges
  for (size_t t = first; t < mesh.triangle_count(); ++t) {
    if (!collapses(t)) continue;
    const auto position = [&](size_t c) { return mesh.positions[mesh.indices[3 * t + c]]; };
    if (position(0) == position(1) || position(1) == position(2) || position(2) == position(0)) continue;
    const auto v = corners(t);
    if (v[0] == v[2]) points.push_back(v[0]);
    if (v[0] != v[2]) edges.push_back(edge(v[0], v[2])), is_end[v[0]] = is_end[v[2]] = 1;
  }
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  std::vector<uint8_t> remains(places.count(), 0), edge_remains(edges.size(), 0);
  for (size_t t = 0; t < mesh.triangle_count(); ++t) {
    const auto v = corners(t);
    if (v[0] == v[1] || v[1] == v[2]) continue;
    for (const uint32_t p : v) remains[p] = 1;
    for (const auto& [from, to] : {std::pair(v[0], v[1]), std::pair(v[1], v[2]), std::pair(v[0], v[2])}) {
      if (is_end[from] == 0 || is_end[to] == 0) continue;  // most
      const auto at = std::lower_bound(edges.begin(), edges.end(), edge(from, to));
      if (at != edges.end() && *at == edge(from, to)) edge_remains[static_cast<size_t>(at - edges.begin())] = 1;
    }
  }
  return std::any_of(points.begin(), points.end(), [&](uint32_t p) { return remains[p] == 0; }) ||
         std::any_of(edge_remains.begin(), edge_remains.end(), [](uint8_t its) { return its == 0; });
}

void round_colors(Mesh& mesh) {
  constexpr int kValues = 64;
  for (glm::u8vec4& color : mesh.colors)
    for (int i = 0; i < 3; ++i) {
      const int value = (int(color[i]) * (kValues - 1) + 127) / 255;
      color[i] = static_cast<uint8_t>((value * 255 + (kValues - 1) / 2) / (kValues - 1));
    }
}

std::vector<uint32_t> materials_of(const Mesh& mesh) {
  if (mesh.materials.empty()) return {0};
  std::vector<uint32_t> used;
  for (const uint32_t m : mesh.materials)
    if (used.empty() || used.back() != m) used.push_back(m);
  std::sort(used.begin(), used.end());
  used.erase(std::unique(used.begin(), used.end()), used.end());
  return used;
}

glm::vec3 average_normal(const Mesh& mesh) {
  glm::dvec3 sum(0);
  for (size_t t = 0; t < mesh.triangle_count(); ++t) sum += glm::dvec3(triangle_cross(mesh, t));
  const double length = glm::length(sum);
  return length > 0 && std::isfinite(length) ? glm::vec3(sum / length) : glm::vec3(0);
}

}  // namespace promenade
