#include "preprocess/border.h"

#include <tbb/parallel_sort.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <unordered_map>

#include "preprocess/weld.h"

namespace promenade {

namespace {

constexpr uint32_t kNone = 0xffffffffU;
constexpr uint32_t kMany = 0xfffffffeU;

uint64_t key_of(uint32_t from, uint32_t to) { return uint64_t(from) << 32U | to; }
uint64_t undirected(uint32_t a, uint32_t b) { return key_of(std::min(a, b), std::max(a, b)); }

bool is_near_a_side(const glm::vec3& p, const Box& cell, float reach_m) {
  const glm::vec3 distance = glm::min(glm::abs(p - cell.min), glm::abs(cell.max - p));
  return std::min({distance.x, distance.y, distance.z}) <= reach_m;
}

/// An edge of a leaf's triangle that another leaf, or another chunk, may have too.
struct Sighting {
  uint64_t edge;
  uint32_t index;  ///< in the order of leaves and their corners
  uint32_t leaf;
  uint32_t corner;
  bool operator<(const Sighting& other) const { return edge != other.edge ? edge < other.edge : index < other.index; }
};

}  // namespace

std::vector<Border> find_borders(const Mesh& mesh, std::span<const std::span<const uint32_t>> leaves, const Box& cell,
                                 float reach_m) {
  const Places places = find_places(mesh.positions);
  const auto place = [&](uint32_t corner) { return places.of_vertex[mesh.indices[corner]]; };
  std::vector<uint32_t> leaf_at(places.count(), kNone);
  for (uint32_t leaf = 0; leaf < leaves.size(); ++leaf)
    for (const uint32_t t : leaves[leaf])
      for (uint32_t corner = 3 * t; corner < 3 * t + 3; ++corner) {
        uint32_t& at = leaf_at[place(corner)];
        at = at == kNone || at == leaf ? leaf : kMany;
      }
  if (reach_m > 0)
    for (size_t p = 0; p < leaf_at.size(); ++p)
      if (is_near_a_side(mesh.positions[places.first_vertex[p]], cell, reach_m)) leaf_at[p] = kMany;
  std::vector<Sighting> sightings;
  for (uint32_t leaf = 0; leaf < leaves.size(); ++leaf)
    for (uint32_t i = 0; i < leaves[leaf].size(); ++i) {
      const uint32_t first = leaves[leaf][i] * 3;
      const std::array<uint32_t, 3> p{place(first), place(first + 1), place(first + 2)};
      if (p[0] == p[1] || p[1] == p[2] || p[2] == p[0]) continue;
      for (uint32_t c = 0; c < 3; ++c) {
        const uint32_t from = p[c], to = p[(c + 1) % 3];
        if (leaf_at[from] == kMany && leaf_at[to] == kMany)
          sightings.push_back({undirected(from, to), static_cast<uint32_t>(sightings.size()), leaf, 3 * i + c});
      }
    }
  tbb::parallel_sort(sightings);
  // An edge of one leaf's triangles only is a border where it is open and near a side; one that several leaves have is
  // for those that have it once.
  const auto near = [&](uint64_t p) {
    return reach_m > 0 && is_near_a_side(mesh.positions[places.first_vertex[p]], cell, reach_m);
  };
  std::vector<uint32_t> corner_of_index(sightings.size(), kNone);  // of borders
  std::vector<uint32_t> leaf_of_index(sightings.size());
  for (size_t begin = 0, end = 0; begin < sightings.size(); begin = end) {
    const uint64_t edge = sightings[begin].edge;
    while (end < sightings.size() && sightings[end].edge == edge) ++end;
    const bool is_shared = sightings[begin].leaf != sightings[end - 1].leaf;  // ascending
    if (!is_shared && !(near(edge >> 32U) && near(edge & kNone))) continue;
    for (size_t s = begin; s < end; ++s) {
      const auto has_same_leaf = [&](size_t other) { return sightings[other].leaf == sightings[s].leaf; };
      if ((s > begin && has_same_leaf(s - 1)) || (s + 1 < end && has_same_leaf(s + 1))) continue;
      corner_of_index[sightings[s].index] = sightings[s].corner;
      leaf_of_index[sightings[s].index] = sightings[s].leaf;
    }
  }
  std::vector<Border> borders(leaves.size());
  for (size_t i = 0; i < corner_of_index.size(); ++i)
    if (corner_of_index[i] != kNone) borders[leaf_of_index[i]].edges.push_back({corner_of_index[i], 0});
  return borders;
}

namespace {

template <class V>
V mixed(const V& a, const V& b, float t) {
  return a + (b - a) * t;
}
glm::u8vec4 mixed(const glm::u8vec4& a, const glm::u8vec4& b, float t) {
  glm::u8vec4 out;
  for (int i = 0; i < 4; ++i) out[i] = static_cast<uint8_t>(std::lround(float(a[i]) + t * (float(b[i]) - float(a[i]))));
  return out;
}

/// Edges of several surfaces' borders, made to meet.
class Joiner {
 public:
  Joiner(Mesh& mesh, std::span<const Border* const> borders, std::span<const uint32_t> first_triangle) : mesh_(mesh) {
    number_points(borders, first_triangle);
    for (uint32_t e = 0; e < edges_.size(); ++e) edge_at_[edges_[e].corner] = e;
  }

  Border run() {
    const size_t count = edges_.size();
    for (uint32_t e = 0; e < count; ++e) lead_through(e);
    return rest();
  }

 private:
  struct Edge {
    uint32_t corner;
    uint32_t from, to;  ///< points
    uint32_t surface;
    std::vector<uint32_t> passed;  ///< points
  };

  void number_points(std::span<const Border* const> borders, std::span<const uint32_t> first_triangle) {
    std::vector<glm::vec3> all;
    for (size_t s = 0; s < borders.size(); ++s)
      for (size_t e = 0; e < borders[s]->edges.size(); ++e) {
        const uint32_t corner = borders[s]->edges[e].corner + first_triangle[s] * 3;
        for (const uint32_t c : {corner, next_in_triangle(corner)}) all.push_back(mesh_.positions[mesh_.indices[c]]);
        const std::span<const glm::vec3> passed = borders[s]->passed_by(e);
        all.insert(all.end(), passed.begin(), passed.end());
        edges_.push_back({corner, 0, 0, static_cast<uint32_t>(s), std::vector<uint32_t>(passed.size())});
      }
    const Places places = find_places(all);
    for (const uint32_t v : places.first_vertex) points_.push_back(all[v]);
    on_border_of_.assign(points_.size(), kNone);
    size_t next = 0;
    for (Edge& edge : edges_) {
      edge.from = places.of_vertex[next++], edge.to = places.of_vertex[next++];
      for (uint32_t& point : edge.passed) point = places.of_vertex[next++];
      for (const uint32_t end : {edge.from, edge.to}) {
        uint32_t& surface = on_border_of_[end];
        surface = surface == kNone || surface == edge.surface ? edge.surface : kMany;
      }
    }
  }

  bool is_kept_by_another(uint32_t point, uint32_t surface) const {
    return on_border_of_[point] != kNone && on_border_of_[point] != surface;
  }

  /// The edge's triangle becomes a fan around its third corner.
  void lead_through(uint32_t index) {
    const Edge whole = edges_[index];
    const uint32_t corner = whole.corner, triangle = corner / 3;
    const uint32_t from = mesh_.indices[corner], to = mesh_.indices[next_in_triangle(corner)],
                   apex = mesh_.indices[previous_in_triangle(corner)];
    Edge piece = whole;
    piece.passed.clear();
    uint32_t at = from, pieces = 0;
    const auto finish_piece = [&](uint32_t point, uint32_t vertex) {
      piece.to = point;
      if (pieces++ == 0) {
        mesh_.indices[next_in_triangle(corner)] = vertex;
        edges_[index] = piece;
      } else {
        piece.corner = add_triangle(triangle, at, vertex, apex);
        edge_at_[piece.corner] = static_cast<uint32_t>(edges_.size());
        edges_.push_back(piece);
      }
      piece.from = point, at = vertex;
      piece.passed.clear();
    };
    for (const uint32_t point : whole.passed) {
      if (is_kept_by_another(point, whole.surface) && point != piece.from && point != whole.to)
        finish_piece(point, add_vertex(from, to, point));
      else
        piece.passed.push_back(point);
    }
    if (pieces == 0) return;
    finish_piece(whole.to, to);
    // The triangle's next edge is that of the last piece.
    const auto moved = edge_at_.find(next_in_triangle(corner));
    if (moved == edge_at_.end()) return;
    const uint32_t edge = moved->second, new_corner = next_in_triangle(piece.corner);
    edge_at_.erase(moved);
    edges_[edge].corner = new_corner, edge_at_[new_corner] = edge;
  }

  uint32_t add_triangle(uint32_t like, uint32_t a, uint32_t b, uint32_t c) {
    const auto corner = static_cast<uint32_t>(mesh_.indices.size());
    mesh_.indices.insert(mesh_.indices.end(), {a, b, c});
    if (!mesh_.materials.empty()) mesh_.materials.push_back(mesh_.material_of(like));
    return corner;
  }

  uint32_t add_vertex(uint32_t a, uint32_t b, uint32_t point) {
    const glm::vec3 from = mesh_.positions[a], along = mesh_.positions[b] - from, position = points_[point];
    const float length2 = glm::dot(along, along);
    const float t = length2 > 0 ? std::clamp(glm::dot(position - from, along) / length2, 0.0F, 1.0F) : 0;
    const auto made = static_cast<uint32_t>(mesh_.positions.size());
    mesh_.positions.push_back(position);
    if (!mesh_.normals.empty()) {
      const glm::vec3 of_a = mesh_.normals[a], normal = mixed(of_a, mesh_.normals[b], t);
      const float length = glm::length(normal);
      mesh_.normals.push_back(length > 0 ? normal / length : of_a);
    }
    if (!mesh_.texcoords.empty()) mesh_.texcoords.push_back(mixed(mesh_.texcoords[a], mesh_.texcoords[b], t));
    if (!mesh_.colors.empty()) mesh_.colors.push_back(mixed(mesh_.colors[a], mesh_.colors[b], t));
    return made;
  }

  /// The edges that are there once: no other surface has them, nor is the same one folded there.
  Border rest() {
    std::unordered_map<uint64_t, uint32_t> counts;
    for (const Edge& edge : edges_) ++counts[undirected(edge.from, edge.to)];
    std::sort(edges_.begin(), edges_.end(), [](const Edge& a, const Edge& b) { return a.corner < b.corner; });
    Border border;
    for (const Edge& edge : edges_) {
      if (counts[undirected(edge.from, edge.to)] > 1) continue;
      for (const uint32_t point : edge.passed) border.passed.push_back(points_[point]);
      border.edges.push_back({edge.corner, static_cast<uint32_t>(border.passed.size())});
    }
    return border;
  }

  Mesh& mesh_;
  std::vector<Edge> edges_;
  std::unordered_map<uint32_t, uint32_t> edge_at_;  ///< by corner
  std::vector<glm::vec3> points_;
  std::vector<uint32_t> on_border_of_;  ///< of each point: the surface whose border goes through it, kMany, or kNone
};

}  // namespace

Border join_borders(Mesh& mesh, std::span<const Border* const> borders, std::span<const uint32_t> first_triangle) {
  return Joiner(mesh, borders, first_triangle).run();
}

}  // namespace promenade
