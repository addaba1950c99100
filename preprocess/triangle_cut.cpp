#include "preprocess/triangle_cut.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <tuple>

namespace promenade {

namespace {

/// Interpolates in double between the ends of an edge.
template <class V>
V mixed(const V& a, const V& b, double t) {
  V out;
  for (int i = 0; i < V::length(); ++i)
    out[i] = static_cast<typename V::value_type>(double(a[i]) + t * (double(b[i]) - double(a[i])));
  return out;
}

glm::u8vec4 mixed_color(const glm::u8vec4& a, const glm::u8vec4& b, double t) {
  glm::u8vec4 out;
  for (int i = 0; i < 4; ++i)
    out[i] = static_cast<uint8_t>(std::lround(double(a[i]) + t * (double(b[i]) - double(a[i]))));
  return out;
}

bool before(const glm::vec3& a, const glm::vec3& b) { return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z); }

void add_triangle(Mesh& mesh, uint32_t like, const std::array<uint32_t, 3>& corners) {
  mesh.indices.insert(mesh.indices.end(), corners.begin(), corners.end());
  if (!mesh.materials.empty()) mesh.materials.push_back(mesh.material_of(like));
}

}  // namespace

bool TriangleCutter::cuts_edge(uint32_t a, uint32_t b) const {
  const glm::vec3& p = mesh_->positions[a];
  const glm::vec3& q = mesh_->positions[b];
  const float low = std::min(p[plane_.axis], q[plane_.axis]);
  const float high = std::max(p[plane_.axis], q[plane_.axis]);
  if (!(low < plane_.value && plane_.value < high)) return false;
  return glm::distance(p, q) > plane_.min_edge_m;
}

bool TriangleCutter::crosses(uint32_t triangle) const {
  const uint32_t* v = &mesh_->indices[size_t(triangle) * 3];
  return cuts_edge(v[0], v[1]) || cuts_edge(v[1], v[2]) || cuts_edge(v[2], v[0]);
}

uint32_t TriangleCutter::point_on(uint32_t a, uint32_t b) {
  const uint64_t key = uint64_t(std::min(a, b)) << 32 | std::max(a, b);
  if (const auto known = points_.find(key); known != points_.end()) return known->second;
  // From the same end whichever triangle asks, so that the point is the same to the bit.
  if (before(mesh_->positions[b], mesh_->positions[a])) std::swap(a, b);
  Mesh& m = *mesh_;
  const double from = m.positions[a][plane_.axis];
  const double to = m.positions[b][plane_.axis];
  const double t = (double(plane_.value) - from) / (to - from);
  const auto made = static_cast<uint32_t>(m.positions.size());
  glm::vec3 point = mixed(m.positions[a], m.positions[b], t);
  point[plane_.axis] = plane_.value;
  m.positions.push_back(point);
  if (!m.normals.empty()) {
    const glm::vec3 n = mixed(m.normals[a], m.normals[b], t);
    const float length = glm::length(n);
    m.normals.push_back(length > 0 ? n / length : m.normals[a]);
  }
  if (!m.texcoords.empty()) m.texcoords.push_back(mixed(m.texcoords[a], m.texcoords[b], t));
  if (!m.colors.empty()) m.colors.push_back(mixed_color(m.colors[a], m.colors[b], t));
  points_.emplace(key, made);
  return made;
}

void TriangleCutter::place(uint32_t triangle, std::vector<uint32_t>& below, std::vector<uint32_t>& above) const {
  (centroid(*mesh_, triangle)[plane_.axis] < plane_.value ? below : above).push_back(triangle);
}

void TriangleCutter::cut(uint32_t triangle, std::vector<uint32_t>& below, std::vector<uint32_t>& above) {
  std::array<uint32_t, 3> v{};
  std::copy_n(mesh_->indices.begin() + std::ptrdiff_t(triangle) * 3, 3, v.begin());
  std::array<bool, 3> cuts{cuts_edge(v[0], v[1]), cuts_edge(v[1], v[2]), cuts_edge(v[2], v[0])};
  // At most two edges cross a plane. Turned so that edge 0 is cut and edge 1 is not.
  while (!cuts[0] || cuts[1]) {
    std::rotate(v.begin(), v.begin() + 1, v.end());
    std::rotate(cuts.begin(), cuts.begin() + 1, cuts.end());
  }
  const uint32_t p = point_on(v[0], v[1]);
  std::vector<std::array<uint32_t, 3>> pieces;
  if (cuts[2]) {  // both edges at v[0]: a triangle at the corner and a quadrilateral
    const uint32_t q = point_on(v[2], v[0]);
    pieces = {{v[0], p, q}, {p, v[1], v[2]}, {p, v[2], q}};
  } else {
    pieces = {{v[0], p, v[2]}, {p, v[1], v[2]}};
  }
  std::copy(pieces[0].begin(), pieces[0].end(), mesh_->indices.begin() + std::ptrdiff_t(triangle) * 3);
  place(triangle, below, above);
  for (size_t i = 1; i < pieces.size(); ++i) {
    add_triangle(*mesh_, triangle, pieces[i]);
    place(static_cast<uint32_t>(mesh_->triangle_count() - 1), below, above);
  }
}

glm::vec3 centroid(const Mesh& mesh, uint32_t triangle) {
  const uint32_t* v = &mesh.indices[size_t(triangle) * 3];
  return (mesh.positions[v[0]] + mesh.positions[v[1]] + mesh.positions[v[2]]) * (1.0F / 3.0F);
}

namespace {

template <class V>
std::vector<V> gathered(const std::vector<V>& from, const std::vector<uint32_t>& which) {
  std::vector<V> out;
  if (from.empty()) return out;
  out.reserve(which.size());
  for (const uint32_t i : which) out.push_back(from[i]);
  return out;
}

}  // namespace

Mesh piece_of(const Mesh& mesh, std::span<const uint32_t> triangles) {
  Mesh piece;
  piece.indices.reserve(triangles.size() * 3);
  for (const uint32_t t : triangles)
    for (size_t corner = 0; corner < 3; ++corner) piece.indices.push_back(mesh.indices[size_t(t) * 3 + corner]);
  std::vector<uint32_t> used = piece.indices;
  std::sort(used.begin(), used.end());
  used.erase(std::unique(used.begin(), used.end()), used.end());
  for (uint32_t& i : piece.indices)
    i = static_cast<uint32_t>(std::lower_bound(used.begin(), used.end(), i) - used.begin());
  piece.positions = gathered(mesh.positions, used);
  piece.normals = gathered(mesh.normals, used);
  piece.texcoords = gathered(mesh.texcoords, used);
  piece.colors = gathered(mesh.colors, used);
  if (!mesh.materials.empty())
    for (const uint32_t t : triangles) piece.materials.push_back(mesh.materials[t]);
  return piece;
}

}  // namespace promenade
