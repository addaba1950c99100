#include "preprocess/fins.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <unordered_map>

#include "codec/quantized_mesh.h"
#include "preprocess/weld.h"

namespace promenade {

namespace {

/// Of what is passed by: the neighbour's border lies as far on its other side.
constexpr float kReach = 1.5F;
/// What is nearer to the edge than this needs no fin, in steps of the leaves' grid.
constexpr float kLeast = 0.001F;
/// What is added for rounding, in such steps.
constexpr float kRounding = 1;
/// Fins on either side of a place share their ends there where both stand about upright, as told by the cosine.
constexpr float kLeastCosine = 0.95F;
/// A triangle's height over its longest edge: flatter ones lie in no plane to speak of.
constexpr float kThin = 0.05F;
/// Where the border turns less, fins on either side share an end; of the sum of two units.
constexpr float kLeastSum = 1.4F;

glm::vec3 unit(const glm::vec3& v) {
  const float length = glm::length(v);
  return length > 0 ? v / length : glm::vec3(0);
}

/// What an edge of the border passes by, in metres >= 0.
struct Extent {
  float up_m = 0, down_m = 0, out_m = 0;
  float before_m = 0, after_m = 0;  ///< past its ends
};

/// Where the border goes through a place.
struct Ridge {
  glm::vec3 around{0};   ///< sum of the normals of all triangles there, by area
  glm::vec3 up{0};       ///< sum of the edges'
  glm::vec3 outward{0};  ///< sum of the edges'
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
    glm::vec3 normal, up, outward, along;
    std::array<float, 2> past_m;  ///< its ends
    bool bends, gapes;            ///< whether what it passes by lies above or below, or beyond
  };

  uint32_t place(uint32_t corner) const { return places_.of_vertex[mesh_.indices[corner]]; }

  void find_normals_around() {
    ridges_.resize(places_.count());
    for (const BorderEdge& edge : border_.edges)
      for (const uint32_t c : {edge.corner, next_in_triangle(edge.corner)}) ridges_[place(c)].is_used = true;
    for (uint32_t corner = 0; corner < mesh_.indices.size(); ++corner)
      if (Ridge& ridge = ridges_[place(corner)]; ridge.is_used) ridge.around += triangle_cross(mesh_, corner / 3);
  }

  void find_ridges() {
    find_normals_around();
    edges_.reserve(border_.edges.size());
    const float least_m = kLeast * options_.leaf_step_m;
    for (size_t e = 0; e < border_.edges.size(); ++e) {
      const uint32_t corner = border_.edges[e].corner, end = next_in_triangle(corner);
      const glm::vec3 from = rounded(mesh_.positions[mesh_.indices[corner]]),
                      to = rounded(mesh_.positions[mesh_.indices[end]]);
      const glm::vec3 normal = unit(triangle_cross(mesh_, corner / 3)), along = unit(to - from);
      glm::vec3 up = normal;
      if (is_thin(corner / 3)) {
        const glm::vec3 around = ridges_[place(corner)].around + ridges_[place(end)].around;
        up = unit(around - along * glm::dot(around, along));
      }
      const glm::vec3 outward = glm::cross(along, up);
      const Extent extent = extent_of(e, from, to, up, outward);
      Edge edge{corner, normal, up, outward, along, {extent.before_m, extent.after_m}, false, false};
      edge.bends = std::max(extent.up_m, extent.down_m) > least_m;
      edge.gapes = std::max({extent.out_m, extent.before_m, extent.after_m}) > least_m;
      edges_.push_back(edge);
      for (const uint32_t c : {corner, end}) {
        Ridge& ridge = ridges_[place(c)];
        ridge.up += up, ridge.outward += outward;
        ridge.extent.up_m = std::max(ridge.extent.up_m, extent.up_m);
        ridge.extent.down_m = std::max(ridge.extent.down_m, extent.down_m);
        ridge.extent.out_m = std::max(ridge.extent.out_m, extent.out_m);
      }
    }
  }

  bool is_thin(uint32_t triangle) const {
    float longest2 = 0;
    for (uint32_t c = 3 * triangle; c < 3 * triangle + 3; ++c) {
      const glm::vec3 edge = mesh_.positions[mesh_.indices[next_in_triangle(c)]] - mesh_.positions[mesh_.indices[c]];
      longest2 = std::max(longest2, glm::dot(edge, edge));
    }
    return glm::length(triangle_cross(mesh_, triangle)) < kThin * longest2;
  }

  /// As it will be stored: on the leaves' grid.
  glm::vec3 rounded(const glm::vec3& p) const { return snapped(p, options_.leaf_step_m); }

  Extent extent_of(size_t edge, const glm::vec3& from, const glm::vec3& to, const glm::vec3& up,
                   const glm::vec3& outward) const {
    Extent extent;
    const glm::vec3 along = to - from;
    const float length2 = glm::dot(along, along);
    for (const glm::vec3& point : border_.passed_by(edge)) {
      const float t = length2 > 0 ? std::clamp(glm::dot(rounded(point) - from, along) / length2, 0.0F, 1.0F) : 0;
      const glm::vec3 off = rounded(point) - from - along * t;
      if (length2 > 0 && (t <= 0 || t >= 1)) {
        const float past = glm::dot(off, along) / std::sqrt(length2);
        extent.before_m = std::max(extent.before_m, -past), extent.after_m = std::max(extent.after_m, past);
      }
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
      const glm::vec3 shared_up = unit(ridge.up);
      const bool leans = glm::dot(shared_up, edge.up) < kLeastCosine;
      const glm::vec3 at = mesh_.positions[base[i]], up = leans ? edge.up : shared_up;
      const float sum = glm::length(ridge.outward);
      const bool turns = edge.gapes && (sum < kLeastSum || edge.past_m[i] > 0);
      const bool is_own = turns || leans;
      const glm::vec3 outward = is_own ? edge.outward : ridge.outward * (2 / (sum * sum));
      const glm::vec3 past = edge.along * (edge.past_m[i] * (i == 0 ? -kReach : kReach));
      const glm::vec3 out = edge.gapes ? outward * reach_m(ridge.extent.out_m) + past : glm::vec3(0);
      if (edge.bends) {
        top[i] = vertex(base[i], Side::top, at + out + up * reach_m(ridge.extent.up_m), edge, is_own);
        bottom[i] = vertex(base[i], Side::bottom, at + out - up * reach_m(ridge.extent.down_m), edge, is_own);
      } else {
        top[i] = vertex(base[i], Side::beyond, at + out, edge, is_own);
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

  enum class Side : uint8_t { top, bottom, beyond };

  /// One like another, elsewhere; shared by fins of one kind, unless it is their own.
  uint32_t vertex(uint32_t like, Side side, const glm::vec3& position, const Edge& edge, bool is_own) {
    const auto next = static_cast<uint32_t>(mesh_.positions.size());
    if (!is_own) {
      const uint64_t kind = uint64_t(side) << 1U | (edge.gapes ? 1U : 0U);
      const auto [made, is_new] = made_.try_emplace(uint64_t(like) << 3U | kind, next);
      if (!is_new) return made->second;
    }
    mesh_.positions.push_back(position);
    if (mesh_.normals.empty()) mesh_.normals.resize(next, glm::vec3(0));
    const glm::vec3 same = mesh_.normals[like];
    mesh_.normals.push_back(same != glm::vec3(0) ? same : edge.normal);
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
