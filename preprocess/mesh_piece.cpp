#include "preprocess/mesh_piece.h"

#include <algorithm>

namespace promenade {

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
