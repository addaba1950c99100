#include "preprocess/fins.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <unordered_map>

#include "preprocess/weld.h"

namespace promenade {

namespace {

/// Of what is passed by: the neighbour's border lies as far on its other side.
constexpr float kReach = 1.5F;
/// What is nearer to the edge than this needs no fin, in steps of the leaves' grid.
constexpr float kLeast = 0.9F;
/// What is added for rounding, in such steps.
constexpr float kRounding = 1;

uint32_t next_in_triangle(uint32_t corner) { return corner % 3 == 2 ? corner - 2 : corner + 1; }

glm::vec3 unit(const glm::vec3& v) {
  const float length = glm::length(v);
  return length > 0 ? v / length : glm::vec3(0);
}

/// What an edge of the border passes by, in metres >= 0.
struct Extent {
  float up_m = 0, down_m = 0, out_m = 0;
};

/// Where the border goes through a place.
struct Ridge {
  glm::vec3 up{0};  ///< sum of the edges'
  Extent extent;
  bool is_used = false;
};

class FinMaker {
 public:
  FinMaker(Mesh& mesh, const Border& border, const FinOptions& options)
      : mesh_(mesh), border_(border), options_(options), places_(find_places(mesh.positions)) {}

  std::vector<uint8_t> run() {
    find_ridges();
    std::vector<uint8_t> is_exact(mesh_.vertex_count(), 0);
    for (size_t v = 0; v < is_exact.size(); ++v) is_exact[v] = ridges_[places_.of_vertex[v]].is_used ? 1 : 0;
    for (const Edge& edge : edges_)
      if (edge.bends || edge.gapes) add_fin(edge);
    is_exact.resize(mesh_.vertex_count(), 1);
    return is_exact;
  }

 private:
  struct Edge {
    uint32_t corner;
    glm::vec3 up, outward;
    bool bends, gapes;  ///< whether what it passes by lies above or below, or beyond
  };

  uint32_t place(uint32_t corner) const { return places_.of_vertex[mesh_.indices[corner]]; }

  void find_ridges() {
    ridges_.resize(places_.count());
    edges_.reserve(border_.edges.size());
    const float least_m = kLeast * options_.leaf_step_m;
    for (size_t e = 0; e < border_.edges.size(); ++e) {
      const uint32_t corner = border_.edges[e].corner, end = next_in_triangle(corner);
      const glm::vec3 up = unit(triangle_cross(mesh_, corner / 3));
      const glm::vec3 from = mesh_.positions[mesh_.indices[corner]], to = mesh_.positions[mesh_.indices[end]];
      const glm::vec3 outward = glm::cross(unit(to - from), up);
      const Extent extent = extent_of(e, from, to, up, outward);
      edges_.push_back({corner, up, outward, std::max(extent.up_m, extent.down_m) > least_m, extent.out_m > least_m});
      for (const uint32_t c : {corner, end}) {
        Ridge& ridge = ridges_[place(c)];
        ridge.up += up, ridge.is_used = true;
        ridge.extent.up_m = std::max(ridge.extent.up_m, extent.up_m);
        ridge.extent.down_m = std::max(ridge.extent.down_m, extent.down_m);
        ridge.extent.out_m = std::max(ridge.extent.out_m, extent.out_m);
      }
    }
  }

  Extent extent_of(size_t edge, const glm::vec3& from, const glm::vec3& to, const glm::vec3& up,
                   const glm::vec3& outward) const {
    Extent extent;
    const glm::vec3 along = to - from;
    const float length2 = glm::dot(along, along);
    for (const glm::vec3& point : border_.passed_by(edge)) {
      const float t = length2 > 0 ? std::clamp(glm::dot(point - from, along) / length2, 0.0F, 1.0F) : 0;
      const glm::vec3 off = point - from - along * t;
      const float above = glm::dot(off, up);
      extent.up_m = std::max(extent.up_m, above), extent.down_m = std::max(extent.down_m, -above);
      extent.out_m = std::max(extent.out_m, glm::dot(off, outward));
    }
    return extent;
  }

  float reach_m(float extent_m) const { return kReach * extent_m + kRounding * options_.leaf_step_m; }

  /// Across the border where that is passed by above or below only, on from the surface where it is beyond only, else
  /// one strip up and outward and one down and outward.
  void add_fin(const Edge& edge) {
    const std::array<uint32_t, 2> ends{edge.corner, next_in_triangle(edge.corner)};
    std::array<uint32_t, 2> base{}, top{}, bottom{};
    for (size_t i = 0; i < 2; ++i) {
      const Ridge& ridge = ridges_[place(ends[i])];
      base[i] = mesh_.indices[ends[i]];
      const glm::vec3 at = mesh_.positions[base[i]], up = unit(ridge.up);
      const glm::vec3 out = edge.gapes ? edge.outward * reach_m(ridge.extent.out_m) : glm::vec3(0);
      if (edge.bends) {
        top[i] = vertex(base[i], Side::top, at + out + up * reach_m(ridge.extent.up_m), edge);
        bottom[i] = vertex(base[i], Side::bottom, at + out - up * reach_m(ridge.extent.down_m), edge);
      } else {
        top[i] = vertex(base[i], Side::top, at + out, edge);
      }
    }
    if (edge.bends && edge.gapes) {
      add_strip(top, base, edge.corner);
      add_strip(base, bottom, edge.corner);
    } else {
      add_strip(top, edge.bends ? bottom : base, edge.corner);
    }
  }

  void add_strip(const std::array<uint32_t, 2>& upper, const std::array<uint32_t, 2>& lower, uint32_t corner) {
    mesh_.indices.insert(mesh_.indices.end(), {upper[1], upper[0], lower[0], upper[1], lower[0], lower[1]});
    if (mesh_.materials.empty()) return;
    const uint32_t material = mesh_.material_of(corner / 3);
    mesh_.materials.insert(mesh_.materials.end(), 2,
                           options_.fin_material ? options_.fin_material(material) : material);
  }

  enum class Side : uint8_t { top, bottom };

  /// One like another, elsewhere; shared by fins that stand on one line.
  uint32_t vertex(uint32_t like, Side side, const glm::vec3& position, const Edge& edge) {
    const auto next = static_cast<uint32_t>(mesh_.positions.size());
    if (!edge.gapes) {
      const auto [made, is_new] = made_.try_emplace(uint64_t(like) << 1U | (side == Side::top ? 1U : 0U), next);
      if (!is_new) return made->second;
    }
    mesh_.positions.push_back(position);
    if (mesh_.normals.empty()) mesh_.normals.resize(next, glm::vec3(0));
    const glm::vec3 same = mesh_.normals[like];
    mesh_.normals.push_back(same != glm::vec3(0) ? same : edge.up);
    const auto repeat = [like](auto& values) {
      if (values.empty()) return;
      const auto value = values[like];
      values.push_back(value);
    };
    repeat(mesh_.texcoords), repeat(mesh_.colors);
    return next;
  }

  Mesh& mesh_;
  const Border& border_;
  const FinOptions& options_;
  Places places_;
  std::vector<Ridge> ridges_;  // of each place
  std::vector<Edge> edges_;
  std::unordered_map<uint64_t, uint32_t> made_;
};

}  // namespace

std::vector<uint8_t> add_fins(Mesh& mesh, const Border& border, const FinOptions& options) {
  if (border.edges.empty()) return {};
  return FinMaker(mesh, border, options).run();
}

}  // namespace promenade
