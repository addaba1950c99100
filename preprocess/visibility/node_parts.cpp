#include "preprocess/visibility/node_parts.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <glm/geometric.hpp>
#include <mutex>
#include <numeric>
#include <optional>

namespace promenade {
namespace {

constexpr float kSmallestHalf = 24;  // triangles: fewer are not worth a box

struct Triangle {
  glm::vec3 center, normal;  ///< normal: unit, or 0 for a triangle without area
  uint32_t index;
  bool any_side;  ///< two-sided
};

NodePart part_of(const Mesh& mesh, std::span<const Triangle> triangles) {
  NodePart part;
  glm::vec3 sum(0);
  bool any_side = false;
  for (const Triangle& t : triangles) {
    for (size_t k = 0; k < 3; ++k) part.box.add(mesh.positions[mesh.indices[size_t(t.index) * 3 + k]]);
    sum += t.normal;
    any_side |= t.any_side;
  }
  const float length = glm::length(sum);
  if (any_side || length <= 0) return part;
  part.cone = {sum / length, 1};
  for (const Triangle& t : triangles)
    if (t.normal != glm::vec3(0))
      part.cone.cos_angle = std::min(part.cone.cos_angle, glm::dot(t.normal, part.cone.axis));
  // Wider than computed, so that rounding never makes it too narrow.
  part.cone.cos_angle = std::max(-1.0F, part.cone.cos_angle - 1e-5F);
  return part;
}

/// Splits at the median of the longest axis of the values.
template <class Key>
size_t halve(std::span<Triangle> triangles, const Key& key) {
  Box box;
  for (const Triangle& t : triangles) box.add(key(t));
  const int axis = box.longest_axis();
  const size_t half = triangles.size() / 2;
  std::nth_element(triangles.begin(), triangles.begin() + std::ptrdiff_t(half), triangles.end(),
                   [&](const Triangle& a, const Triangle& b) {
                     const float ka = key(a)[axis], kb = key(b)[axis];
                     return ka != kb ? ka < kb : a.index < b.index;
                   });
  return half;
}

void cut(const Mesh& mesh, std::span<Triangle> triangles, uint32_t most_parts, std::vector<NodePart>& parts) {
  if (most_parts < 2 || float(triangles.size()) < 2 * kSmallestHalf) {
    parts.push_back(part_of(mesh, triangles));
    return;
  }
  const size_t half = halve(triangles, [](const Triangle& t) { return t.center; });
  cut(mesh, triangles.subspan(0, half), most_parts / 2, parts);
  cut(mesh, triangles.subspan(half), most_parts - most_parts / 2, parts);
}

}  // namespace

std::vector<NodePart> cut_into_parts(const Mesh& mesh, std::span<const Material> materials, uint32_t most_parts) {
  std::vector<Triangle> triangles;
  triangles.reserve(mesh.triangle_count());
  for (uint32_t t = 0; t < mesh.triangle_count(); ++t) {
    const auto corner = [&](size_t k) { return mesh.positions[mesh.indices[size_t(t) * 3 + k]]; };
    const glm::vec3 cross = triangle_cross(mesh, t);
    const float length = glm::length(cross);
    const uint32_t material = mesh.material_of(t);
    triangles.push_back({(corner(0) + corner(1) + corner(2)) / 3.0F, length > 0 ? cross / length : glm::vec3(0), t,
                         material < materials.size() && materials[material].two_sided});
  }
  std::vector<NodePart> parts;
  if (!triangles.empty()) cut(mesh, triangles, most_parts, parts);
  return parts;
}

Result<NodeParts> NodeParts::make(const ModelReader& model, JobMonitor& monitor) {
  const ModelTables& tables = model.model().tables;
  const size_t count = tables.nodes.size();
  std::vector<std::vector<NodePart>> made(count);
  std::atomic<size_t> done = 0;
  std::mutex mutex;
  std::optional<std::pair<size_t, Error>> failed;  // the first by node
  tbb::parallel_for(size_t(0), count, [&](size_t i) {
    if (monitor.cancelled()) return;
    const Result<Mesh> mesh = model.read_mesh(NodeId{static_cast<uint32_t>(i)});
    if (mesh) {
      made[i] = cut_into_parts(*mesh, tables.materials, kMostParts);
    } else {
      const std::lock_guard lock(mutex);
      if (!failed || i < failed->first) failed = {i, mesh.error()};
    }
    if (++done % 64 == 0) monitor.progress("parts", done, count);
  });
  if (failed) return failed->second;
  if (monitor.cancelled()) return Error{"interrupted"};
  monitor.progress("parts", count, count);
  NodeParts parts;
  parts.first_.reserve(count + 1);
  parts.first_.push_back(0);
  for (std::vector<NodePart>& of_node : made) {
    parts.parts_.insert(parts.parts_.end(), of_node.begin(), of_node.end());
    parts.first_.push_back(parts.parts_.size());
    of_node = {};
  }
  return parts;
}

bool faces_away_from_cell(const NormalCone& cone, const Box& box, const Box& cell) {
  if (cone.cos_angle <= 0) return false;
  // A pixel's width of margin: the rasteriser rounds corners, which turns triangles that are seen edge-on.
  constexpr double kMargin = 0.005;
  const double sine = std::sqrt(std::max(0.0, 1 - double(cone.cos_angle) * double(cone.cos_angle))) + kMargin;
  const glm::dvec3 low = glm::dvec3(box.min) - glm::dvec3(cell.max), high = glm::dvec3(box.max) - glm::dvec3(cell.min);
  for (unsigned i = 0; i < 8; ++i) {
    const glm::dvec3 d((i & 1U) != 0 ? high.x : low.x, (i & 2U) != 0 ? high.y : low.y, (i & 4U) != 0 ? high.z : low.z);
    if (glm::dot(glm::dvec3(cone.axis), d) <= sine * glm::length(d)) return false;
  }
  return true;
}

}  // namespace promenade
