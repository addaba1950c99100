// Broken numbers: found, counted and taken out before anything computes with them.

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <numeric>

#include "preprocess/repair.h"

namespace promenade {

namespace {

constexpr size_t kMiddleSamples = 1025;  // of a mesh's vertices: enough that a few broken ones cannot move the median

template <class V>
bool finite(const V& v) {
  for (int i = 0; i < V::length(); ++i)
    if (!std::isfinite(v[i])) return false;
  return true;
}

bool finite_matrix(const glm::dmat4& m) { return finite(m[0]) && finite(m[1]) && finite(m[2]) && finite(m[3]); }

void add(Counts& counts, const char* key, uint64_t count) {
  if (count != 0) counts[key] += count;
}

double median(std::vector<double>& values) {
  const auto middle = values.begin() + static_cast<ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Component-wise median of points.
glm::dvec3 median(const std::vector<glm::dvec3>& points) {
  glm::dvec3 out(0);
  std::vector<double> values(points.size());
  for (int axis = 0; axis < 3 && !points.empty(); ++axis) {
    std::transform(points.begin(), points.end(), values.begin(), [axis](const glm::dvec3& p) { return p[axis]; });
    out[axis] = median(values);
  }
  return out;
}

glm::dvec3 middle_of(const Mesh& mesh) {
  const size_t step = mesh.vertex_count() / kMiddleSamples + 1;
  std::vector<glm::dvec3> points;
  for (size_t v = 0; v < mesh.vertex_count(); v += step) points.emplace_back(mesh.positions[v]);
  return median(points);
}

glm::dvec3 apply(const glm::dmat4& m, const glm::dvec3& p) { return glm::dvec3(m * glm::dvec4(p, 1.0)); }

bool within(const glm::dvec3& p, const glm::dvec3& middle, double extent) {
  return glm::distance(p, middle) <= extent;  // false for NaN
}

bool box_within(const Box& box, const glm::dmat4& world_from_mesh, const glm::dvec3& middle, double extent) {
  for (unsigned corner = 0; corner < 8; ++corner) {
    const glm::dvec3 p((corner & 1U) != 0 ? box.max.x : box.min.x, (corner & 2U) != 0 ? box.max.y : box.min.y,
                       (corner & 4U) != 0 ? box.max.z : box.min.z);
    if (!within(apply(world_from_mesh, p), middle, extent)) return false;
  }
  return true;
}

/// Replaces normals that are no direction by the normal of a face that uses them.
uint64_t mend_normals(Mesh& mesh) {
  uint64_t mended = 0;
  std::vector<bool> broken(mesh.normals.size(), false);
  bool any = false;
  for (size_t v = 0; v < mesh.normals.size(); ++v) {
    glm::vec3& n = mesh.normals[v];
    const float length = glm::length(n);
    if (length > 1e-6F && std::isfinite(length)) {
      if (std::abs(length - 1.0F) > 1e-5F) n /= length;
      continue;
    }
    if (!finite(n)) ++mended;
    n = glm::vec3(0, 0, 1);
    broken[v] = any = true;
  }
  if (!any) return mended;
  for (size_t i = 0; i < mesh.indices.size(); ++i) {
    const uint32_t v = mesh.indices[i];
    if (!broken[v]) continue;
    const glm::vec3 cross = triangle_cross(mesh, i / 3);
    const float length = glm::length(cross);
    if (!(length > 0) || !std::isfinite(length)) continue;
    mesh.normals[v] = cross / length;
    broken[v] = false;
  }
  return mended;
}

}  // namespace

uint64_t drop_vertices(Mesh& mesh, const std::vector<bool>& broken) {
  std::vector<uint32_t> kept;
  const size_t triangles = mesh.triangle_count();
  kept.reserve(triangles);
  for (uint32_t t = 0; t < triangles; ++t) {
    const uint32_t* corners = mesh.indices.data() + size_t(t) * 3;
    if (!broken[corners[0]] && !broken[corners[1]] && !broken[corners[2]]) kept.push_back(t);
  }
  mesh = submesh(mesh, kept);  // also when no face goes: the broken vertices must
  return triangles - kept.size();
}

std::vector<bool> mark_non_finite(Mesh& mesh, Counts& counts) {
  std::vector<bool> broken(mesh.vertex_count(), false);
  uint64_t positions = 0;
  for (size_t v = 0; v < mesh.vertex_count(); ++v) {
    if (finite(mesh.positions[v])) continue;
    broken[v] = true;
    ++positions;
  }
  uint64_t attributes = mend_normals(mesh);
  for (glm::vec2& uv : mesh.texcoords) {
    if (finite(uv)) continue;
    uv = glm::vec2(0);
    ++attributes;
  }
  add(counts, "vertices_non_finite", positions);
  add(counts, "attributes_non_finite", attributes);
  return broken;
}

void drop_out_of_range(Scene& scene, double max_extent_m) {
  std::vector<glm::dvec3> middle_of_mesh;
  std::vector<Box> box_of_mesh;
  for (const Mesh& mesh : scene.meshes) {
    middle_of_mesh.push_back(middle_of(mesh));
    box_of_mesh.push_back(bounds(mesh));
  }
  std::vector<glm::dvec3> middles;
  std::vector<bool> sound(scene.instances.size(), false);
  for (size_t i = 0; i < scene.instances.size(); ++i) {
    const SceneInstance& instance = scene.instances[i];
    const glm::dvec3 middle = apply(instance.world_from_mesh, middle_of_mesh[instance.mesh]);
    sound[i] = finite_matrix(instance.world_from_mesh) && finite(middle);
    if (sound[i]) middles.push_back(middle);
  }
  const glm::dvec3 middle = median(middles);

  std::vector<std::vector<bool>> broken(scene.meshes.size());
  std::vector<SceneInstance> kept;
  for (size_t i = 0; i < scene.instances.size(); ++i) {
    SceneInstance& instance = scene.instances[i];
    const glm::dmat4& m = instance.world_from_mesh;
    if (!sound[i] || !within(apply(m, middle_of_mesh[instance.mesh]), middle, max_extent_m)) continue;
    const Mesh& mesh = scene.meshes[instance.mesh];
    if (!box_within(box_of_mesh[instance.mesh], m, middle, max_extent_m)) {
      std::vector<bool>& flags = broken[instance.mesh];
      flags.resize(mesh.vertex_count(), false);
      for (size_t v = 0; v < mesh.vertex_count(); ++v)
        if (!within(apply(m, glm::dvec3(mesh.positions[v])), middle, max_extent_m)) flags[v] = true;
    }
    kept.push_back(std::move(instance));
  }
  add(scene.report.counts, "instances_dropped", scene.instances.size() - kept.size());
  scene.instances = std::move(kept);
  for (size_t m = 0; m < scene.meshes.size(); ++m) {
    const auto vertices = static_cast<uint64_t>(std::count(broken[m].begin(), broken[m].end(), true));
    if (vertices == 0) continue;
    add(scene.report.counts, "vertices_out_of_range", vertices);
    add(scene.report.counts, "faces_dropped", drop_vertices(scene.meshes[m], broken[m]));
  }
}

}  // namespace promenade
