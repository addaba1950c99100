#include "preprocess/mesh_piece.h"

#include <bit>
#include <utility>

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

/// Numbers vertices in the order of their first use and returns which they were.
std::vector<uint32_t> renumber(std::vector<uint32_t>& indices) {
  constexpr uint32_t kFree = 0xffffffffU;
  const size_t slots = std::bit_ceil(indices.size() * 2 + 1);
  std::vector<std::pair<uint32_t, uint32_t>> table(slots, {kFree, 0});  // open addressing: before, after
  std::vector<uint32_t> used;
  used.reserve(indices.size() / 2);
  for (uint32_t& i : indices) {
    size_t slot = (i * 0x9e3779b97f4a7c15ULL >> 20U) & (slots - 1);
    while (table[slot].first != kFree && table[slot].first != i) slot = (slot + 1) & (slots - 1);
    if (table[slot].first == kFree) {
      table[slot] = {i, static_cast<uint32_t>(used.size())};
      used.push_back(i);
    }
    i = table[slot].second;
  }
  return used;
}

}  // namespace

Mesh piece_of(const Mesh& mesh, std::span<const uint32_t> triangles) {
  Mesh piece;
  piece.indices.reserve(triangles.size() * 3);
  for (const uint32_t t : triangles)
    for (size_t corner = 0; corner < 3; ++corner) piece.indices.push_back(mesh.indices[size_t(t) * 3 + corner]);
  const std::vector<uint32_t> used = renumber(piece.indices);
  piece.positions = gathered(mesh.positions, used);
  piece.normals = gathered(mesh.normals, used);
  piece.texcoords = gathered(mesh.texcoords, used);
  piece.colors = gathered(mesh.colors, used);
  if (!mesh.materials.empty())
    for (const uint32_t t : triangles) piece.materials.push_back(mesh.materials[t]);
  return piece;
}

}  // namespace promenade
