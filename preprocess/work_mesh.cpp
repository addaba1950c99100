#include "preprocess/work_mesh.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <glm/geometric.hpp>
#include <numeric>

#include "preprocess/weld.h"

namespace promenade {

namespace {

/// A normal whose cosine with its triangle is less lights the wrong side of it.
constexpr float kLeastNormalCosine = 0.2F;

/// Whether a triangle with the same corners in the same turn, and the same material, is alive already.
bool repeats(const WorkMesh& work, const Mesh& mesh, uint32_t triangle) {
  const uint32_t first = triangle * 3;
  for (uint32_t c = work.first_corner[work.place[first]]; c != WorkMesh::kNone; c = work.next_corner[c]) {
    const uint32_t second = next_in_triangle(c);
    if (work.place[second] == work.place[first + 1] && work.place[next_in_triangle(second)] == work.place[first + 2] &&
        mesh.material_of(work.source_triangle[c / 3]) == mesh.material_of(work.source_triangle[triangle]))
      return true;
  }
  return false;
}

}  // namespace

WorkMesh make_work_mesh(const Mesh& mesh) {
  const Places places = find_places(mesh.positions);
  WorkMesh work;
  const Box box = bounds(mesh);
  work.origin = box.center();
  work.diagonal_m = box.diagonal();
  work.positions.reserve(places.count());
  work.model_positions.reserve(places.count());
  for (const uint32_t v : places.first_vertex) {
    work.model_positions.push_back(mesh.positions[v]);
    work.positions.push_back(mesh.positions[v] - work.origin);
  }
  work.first_corner.assign(places.count(), WorkMesh::kNone);
  work.merged_into.resize(places.count());
  std::iota(work.merged_into.begin(), work.merged_into.end(), 0U);
  const size_t corners = mesh.indices.size();
  work.place.reserve(corners), work.attributes.reserve(corners), work.next_corner.reserve(corners);
  for (uint32_t t = 0; t < mesh.triangle_count(); ++t) {
    std::array<uint32_t, 3> p{};
    for (size_t c = 0; c < 3; ++c) p[c] = places.of_vertex[mesh.indices[size_t(t) * 3 + c]];
    if (p[0] == p[1] || p[1] == p[2] || p[2] == p[0]) continue;
    const auto triangle = static_cast<uint32_t>(work.source_triangle.size());
    work.source_triangle.push_back(t);
    work.place.insert(work.place.end(), p.begin(), p.end());
    if (repeats(work, mesh, triangle)) {
      work.source_triangle.pop_back();
      work.place.resize(size_t(triangle) * 3);
      continue;
    }
    for (uint32_t c = 0; c < 3; ++c) {
      work.attributes.push_back(mesh.indices[size_t(t) * 3 + c]);
      work.next_corner.push_back(work.first_corner[p[c]]);
      work.first_corner[p[c]] = triangle * 3 + c;
    }
  }
  work.alive_count = work.shown_count = static_cast<uint32_t>(work.source_triangle.size());
  work.alive.assign(work.alive_count, 1);
  return work;
}

namespace {

/// Numbers what its corners show: equal place, attributes and normal, one vertex.
class VertexMaker {
 public:
  VertexMaker(const WorkMesh& work, const Mesh& source, Mesh& out) : work_(work), source_(source), out_(out) {
    const size_t slots = std::bit_ceil(size_t(work.alive_count) * 6 + 1);
    table_.assign(slots, WorkMesh::kNone);
  }

  uint32_t vertex(uint32_t corner, const glm::vec3& face_normal) {
    const uint32_t place = work_.place[corner];
    const uint32_t from = work_.attributes[corner];
    glm::vec3 normal(0);
    if (!source_.normals.empty()) {
      normal = source_.normals[from];
      const bool wrong = !(glm::dot(normal, face_normal) >= kLeastNormalCosine);
      if (wrong && normal != glm::vec3(0) && glm::dot(face_normal, face_normal) > 0) normal = face_normal;
    }
    uint64_t hash = (uint64_t(place) << 32U | from) * 0x9e3779b97f4a7c15ULL;
    hash ^= std::bit_cast<uint32_t>(normal.x) * 0xbf58476d1ce4e5b9ULL;
    size_t slot = (hash >> 20U) & (table_.size() - 1);
    for (; table_[slot] != WorkMesh::kNone; slot = (slot + 1) & (table_.size() - 1)) {
      const uint32_t v = table_[slot];
      if (place_[v] == place && from_[v] == from && (out_.normals.empty() || out_.normals[v] == normal)) return v;
    }
    const auto v = static_cast<uint32_t>(out_.positions.size());
    table_[slot] = v;
    place_.push_back(place), from_.push_back(from);
    out_.positions.push_back(work_.model_positions[place]);
    if (!source_.normals.empty()) out_.normals.push_back(normal);
    if (!source_.texcoords.empty()) out_.texcoords.push_back(source_.texcoords[from]);
    if (!source_.colors.empty()) out_.colors.push_back(source_.colors[from]);
    return v;
  }

 private:
  const WorkMesh& work_;
  const Mesh& source_;
  Mesh& out_;
  std::vector<uint32_t> table_;
  std::vector<uint32_t> place_, from_;
};

}  // namespace

Mesh finish(const WorkMesh& work, const Mesh& source) {
  Mesh out;
  out.indices.reserve(size_t(work.alive_count) * 3);
  VertexMaker maker(work, source, out);
  for (uint32_t t = 0; t < work.triangle_count(); ++t) {
    if (work.alive[t] == 0) continue;
    const glm::vec3 cross = glm::cross(work.at(t * 3 + 1) - work.at(t * 3), work.at(t * 3 + 2) - work.at(t * 3));
    const float length = glm::length(cross);
    const glm::vec3 normal = length > 0 ? cross / length : glm::vec3(0);
    for (uint32_t c = 0; c < 3; ++c) out.indices.push_back(maker.vertex(t * 3 + c, normal));
    if (!source.materials.empty()) out.materials.push_back(source.materials[work.source_triangle[t]]);
  }
  return out;
}

float color_contrast(const glm::u8vec4& a, const glm::u8vec4& b) {
  int largest = 0;
  for (int i = 0; i < 4; ++i) largest = std::max(largest, std::abs(int(a[i]) - int(b[i])));
  return float(largest) / 255.0F;
}

}  // namespace promenade
