#include "preprocess/import_builder.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <utility>

namespace promenade {

namespace {

constexpr double kOffsetStep = 1024;  // floats resolve a tenth of a millimetre over a few such steps
constexpr size_t kOffsetSamples = 1025;
constexpr glm::vec3 kNoNormal(0);

bool finite(const glm::dvec3& p) { return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z); }

/// Per axis the median of a sample of finite positions: a few wild ones do not move it.
glm::dvec3 choose_offset(const std::vector<glm::dvec3>& positions) {
  glm::dvec3 offset(0);
  std::vector<double> values;
  for (int axis = 0; axis < 3; ++axis) {
    values.clear();
    for (size_t v = 0; v < positions.size(); v += positions.size() / kOffsetSamples + 1)
      if (finite(positions[v])) values.push_back(positions[v][axis]);
    if (values.empty()) return glm::dvec3(0);
    const auto middle = values.begin() + static_cast<ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    offset[axis] = std::round(*middle / kOffsetStep) * kOffsetStep;
  }
  return offset;
}

/// Attribute arrays appear with the first vertex that has the attribute.
template <class V>
void add_attribute(std::vector<V>& values, const std::optional<V>& value, const V& fill, size_t before) {
  if (!value && values.empty()) return;
  values.resize(before, fill);
  values.push_back(value.value_or(fill));
}

/// Two triangles where the quadrilateral is planar enough and one of its diagonals lies inside.
bool split_quad(const std::array<glm::dvec3, 4>& p, std::array<uint32_t, 6>& corners) {
  const glm::dvec3 normal = glm::cross(p[2] - p[0], p[3] - p[1]);
  const double length = glm::length(normal);
  const double size = glm::distance(p[0], p[2]) + glm::distance(p[1], p[3]);
  if (!(length > 0) || !(std::abs(glm::dot(p[1] - p[0], normal)) <= 1e-4 * length * size)) return false;
  const auto front = [&](size_t a, size_t b, size_t c) {
    return glm::dot(glm::cross(p[b] - p[a], p[c] - p[a]), normal) > 0;
  };
  if (front(0, 1, 2) && front(0, 2, 3)) {
    corners = {0, 1, 2, 0, 2, 3};
    return true;
  }
  corners = {1, 2, 3, 1, 3, 0};
  return front(1, 2, 3) && front(1, 3, 0);
}

}  // namespace

uint32_t MeshBuilder::add_vertex(const SourceVertex& vertex) {
  const size_t before = positions_.size();
  positions_.push_back(vertex.position);
  add_attribute(mesh_.normals, vertex.normal, kNoNormal, before);
  add_attribute(mesh_.texcoords, vertex.texcoord, glm::vec2(0), before);
  add_attribute(mesh_.colors, vertex.color, glm::u8vec4(255), before);
  return static_cast<uint32_t>(before);
}

void MeshBuilder::add_triangle(uint32_t a, uint32_t b, uint32_t c, uint32_t material) {
  mesh_.indices.insert(mesh_.indices.end(), {a, b, c});
  mesh_.materials.push_back(material);
}

void MeshBuilder::add_polygon(std::span<const uint32_t> corners, std::span<const uint32_t> ring_sizes,
                              uint32_t material, Counts& counts) {
  if (corners.size() == 3) {
    add_triangle(corners[0], corners[1], corners[2], material);
    return;
  }
  if (corners.size() == 4 && ring_sizes.size() == 1) {
    std::array<uint32_t, 6> cut{};
    if (split_quad({position(corners[0]), position(corners[1]), position(corners[2]), position(corners[3])}, cut)) {
      add_triangle(corners[cut[0]], corners[cut[1]], corners[cut[2]], material);
      add_triangle(corners[cut[3]], corners[cut[4]], corners[cut[5]], material);
      return;
    }
  }
  std::vector<glm::dvec3> points;
  points.reserve(corners.size());
  for (const uint32_t c : corners) points.push_back(position(c));
  if (!std::all_of(points.begin(), points.end(), finite)) {
    // Whatever triangles: those at the broken point go later, and it is counted then.
    for (size_t i = 2; i < ring_sizes[0]; ++i) add_triangle(corners[0], corners[i - 1], corners[i], material);
    return;
  }
  const Triangulation cut = triangulate(points, ring_sizes);
  if (cut.non_planar) ++counts["faces_non_planar"];
  if (cut.unclean) ++counts["faces_unclean"];
  if (cut.corners.empty()) ++counts["faces_degenerate"];
  for (size_t i = 0; i + 2 < cut.corners.size(); i += 3)
    add_triangle(corners[cut.corners[i]], corners[cut.corners[i + 1]], corners[cut.corners[i + 2]], material);
}

void MeshBuilder::fill_normals() {
  if (mesh_.normals.empty()) return;
  for (size_t i = 0; i < mesh_.indices.size(); ++i) {
    glm::vec3& normal = mesh_.normals[mesh_.indices[i]];
    if (normal != kNoNormal) continue;
    const glm::vec3 cross = triangle_cross(mesh_, i / 3);
    const float length = glm::length(cross);
    if (length > 0 && std::isfinite(length)) normal = cross / length;
  }
}

Mesh MeshBuilder::finish(glm::dvec3& offset) {
  offset = choose_offset(positions_);
  mesh_.positions.reserve(positions_.size());
  for (const glm::dvec3& p : positions_) mesh_.positions.emplace_back(p - offset);
  positions_ = {};
  if (!mesh_.normals.empty()) mesh_.normals.resize(mesh_.positions.size(), kNoNormal);
  if (!mesh_.texcoords.empty()) mesh_.texcoords.resize(mesh_.positions.size(), glm::vec2(0));
  if (!mesh_.colors.empty()) mesh_.colors.resize(mesh_.positions.size(), glm::u8vec4(255));
  fill_normals();
  return std::exchange(mesh_, {});
}

void add_object(Scene& scene, MeshBuilder& builder, const std::string& name, const std::string& class_name,
                bool is_solid) {
  glm::dvec3 offset(0);
  Mesh mesh = builder.finish(offset);
  if (mesh.triangle_count() == 0) return;
  scene.instances.push_back(
      {static_cast<uint32_t>(scene.meshes.size()), glm::translate(glm::dmat4(1), offset), name, class_name});
  scene.instances.back().is_solid = is_solid;
  scene.meshes.push_back(std::move(mesh));
}

}  // namespace promenade
