// A triangle's edges are cut first, each by itself. Then the polygon that is left is divided plane by plane between
// points of its border: where a plane meets an edge that may not be cut, the edge's nearer end takes the point's place.
// Lines between pieces of one triangle may be cut anywhere.
#include "preprocess/lattice_cut.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <map>
#include <span>
#include <tuple>
#include <unordered_map>

namespace promenade {

namespace {

constexpr float kMostSteps = 64;  // of an edge: bounds the pieces of one triangle to some thousands

/// Interpolates in double between the ends of an edge.
template <class V>
V mixed(const V& a, const V& b, double t) {
  V out;
  for (int i = 0; i < V::length(); ++i)
    out[i] = static_cast<typename V::value_type>(double(a[i]) + t * (double(b[i]) - double(a[i])));
  return out;
}

glm::u8vec4 mixed(const glm::u8vec4& a, const glm::u8vec4& b, double t) {
  glm::u8vec4 out;
  for (int i = 0; i < 4; ++i)
    out[i] = static_cast<uint8_t>(std::lround(double(a[i]) + t * (double(b[i]) - double(a[i]))));
  return out;
}

bool before(const glm::vec3& a, const glm::vec3& b) { return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z); }

/// A corner of a polygon and the edge from it to the next one.
struct Corner {
  uint32_t vertex;
  bool inner_edge;  ///< between two pieces of one triangle: may be cut
};
using Polygon = std::vector<Corner>;

class LatticeCutter {
 public:
  LatticeCutter(Mesh& mesh, float step_m) : mesh_(mesh), step_m_(step_m) {}

  void cut(uint32_t triangle) {
    std::array<uint32_t, 3> v{};
    std::copy_n(mesh_.indices.begin() + std::ptrdiff_t(triangle) * 3, 3, v.begin());
    float longest = 0;
    for (size_t i = 0; i < 3; ++i) longest = std::max(longest, length(v[i], v[(i + 1) % 3]));
    if (!(longest > step_m_)) return;
    Polygon outline;
    for (size_t i = 0; i < 3; ++i) {
      outline.push_back({v[i], false});
      add_edge_points(v[i], v[(i + 1) % 3], outline);
    }
    if (outline.size() == 3) return;
    polygons_.assign(1, outline);
    inner_points_.clear();
    const float step = step_of_edge(longest);
    for (int axis = 0; axis < 3; ++axis) {
      float low = position(v[0])[axis], high = low;
      for (const uint32_t corner : v)
        low = std::min(low, position(corner)[axis]), high = std::max(high, position(corner)[axis]);
      each_plane(low, high, step, [&](float value) { divide_all(axis, value); });
    }
    normal_ = glm::cross(glm::dvec3(position(v[1])) - glm::dvec3(position(v[0])),
                         glm::dvec3(position(v[2])) - glm::dvec3(position(v[0])));
    first_ = true;
    for (Polygon& polygon : polygons_) triangulate(polygon, triangle);
  }

 private:
  const glm::vec3& position(uint32_t v) const { return mesh_.positions[v]; }
  float length(uint32_t a, uint32_t b) const { return glm::distance(position(a), position(b)); }

  /// The planes between two coordinates that are at most 64 steps apart, in order.
  template <class Visit>
  static void each_plane(float low, float high, float step, const Visit& visit) {
    for (double k = std::floor(double(low) / double(step)) + 1; k * double(step) < double(high); ++k)
      visit(static_cast<float>(k * double(step)));
  }

  float step_of_edge(float edge_m) const {
    float step = step_m_;
    while (edge_m > kMostSteps * step) step *= 2;
    return step;
  }

  uint32_t add_vertex(uint32_t a, uint32_t b, double t, int axis, float value) {
    const auto made = static_cast<uint32_t>(mesh_.positions.size());
    glm::vec3 point = mixed(position(a), position(b), t);
    point[axis] = value;
    mesh_.positions.push_back(point);
    if (!mesh_.normals.empty()) {
      const glm::vec3 n = mixed(mesh_.normals[a], mesh_.normals[b], t);
      const float n_length = glm::length(n);
      const glm::vec3 of_a = mesh_.normals[a];
      mesh_.normals.push_back(n_length > 0 ? n / n_length : of_a);
    }
    if (!mesh_.texcoords.empty()) mesh_.texcoords.push_back(mixed(mesh_.texcoords[a], mesh_.texcoords[b], t));
    if (!mesh_.colors.empty()) mesh_.colors.push_back(mixed(mesh_.colors[a], mesh_.colors[b], t));
    return made;
  }

  /// Appends the points at which the edge from a to b is cut, on the way from a.
  void add_edge_points(uint32_t a, uint32_t b, Polygon& outline) {
    const uint64_t key = uint64_t(std::min(a, b)) << 32 | std::max(a, b);
    const auto [place, is_new] = points_of_edge_.try_emplace(key);
    // From the same end whichever triangle asks, so that the points are the same to the bit.
    const bool turned = before(position(b), position(a));
    if (is_new) place->second = turned ? make_edge_points(b, a) : make_edge_points(a, b);
    const std::vector<uint32_t>& points = place->second;
    for (size_t i = 0; i < points.size(); ++i) outline.push_back({points[turned ? points.size() - 1 - i : i], false});
  }

  std::vector<uint32_t> make_edge_points(uint32_t a, uint32_t b) {
    const float edge_m = length(a, b);
    if (!(edge_m > step_m_)) return {};
    const float step = step_of_edge(edge_m);
    struct Crossing {
      double t;
      int axis;
      float value;
    };
    std::vector<Crossing> crossings;
    for (int axis = 0; axis < 3; ++axis) {
      const float from = position(a)[axis], to = position(b)[axis];
      const float low = std::min(from, to), high = std::max(from, to);
      each_plane(low, high, step, [&](float value) {
        crossings.push_back({(double(value) - double(from)) / (double(to) - double(from)), axis, value});
      });
    }
    std::sort(crossings.begin(), crossings.end(),
              [](const Crossing& x, const Crossing& y) { return std::tie(x.t, x.axis) < std::tie(y.t, y.axis); });
    std::vector<uint32_t> points;
    glm::vec3 last = position(a);
    for (const Crossing& crossing : crossings) {
      const uint32_t made = add_vertex(a, b, crossing.t, crossing.axis, crossing.value);
      const glm::vec3 at = position(made);
      if (at == last || at == position(b)) continue;  // through a corner of the lattice: one point is enough
      last = at;
      points.push_back(made);
    }
    return points;
  }

  void divide_all(int axis, float value) {
    const size_t count = polygons_.size();
    for (size_t i = 0; i < count; ++i) divide(i, axis, value);
  }

  /// -1 below the plane, 0 on it, 1 above.
  static int side_of(float coordinate, float value) { return coordinate < value ? -1 : coordinate > value ? 1 : 0; }

  void divide(size_t index, int axis, float value) {
    const Polygon& polygon = polygons_[index];
    const size_t count = polygon.size();
    sides_.resize(count);
    bool below = false, above = false;
    for (size_t i = 0; i < count; ++i) {
      sides_[i] = side_of(position(polygon[i].vertex)[axis], value);
      below = below || sides_[i] < 0, above = above || sides_[i] > 0;
    }
    if (!below || !above) return;
    for (size_t i = 0; i < count; ++i) {
      const size_t next = (i + 1) % count;
      if (sides_[i] * sides_[next] >= 0 || polygon[i].inner_edge) continue;
      const glm::vec3 &a = position(polygon[i].vertex), &b = position(polygon[next].vertex);
      const float to_a = std::abs(a[axis] - value), to_b = std::abs(b[axis] - value);
      sides_[to_a != to_b ? (to_a < to_b ? i : next) : (before(a, b) ? i : next)] = 0;
    }
    Polygon ring;
    std::vector<int> ring_sides;
    for (size_t i = 0; i < count; ++i) {
      const size_t next = (i + 1) % count;
      ring.push_back(polygon[i]), ring_sides.push_back(sides_[i]);
      // By where the ends really are: the piece on the other side of an inner edge must find the same.
      const int side = side_of(position(polygon[i].vertex)[axis], value);
      const int next_side = side_of(position(polygon[next].vertex)[axis], value);
      if (polygon[i].inner_edge && side * next_side < 0)
        ring.push_back({inner_point(polygon[i].vertex, polygon[next].vertex, axis, value), true}),
            ring_sides.push_back(0);
    }
    split_ring(index, std::move(ring), ring_sides);
  }

  /// Parts a polygon between the two corners at which its border changes sides.
  void split_ring(size_t index, Polygon ring, const std::vector<int>& sides) {
    const size_t count = ring.size();
    size_t up = count, down = count;
    int before_zeros = 0;
    for (size_t i = 0; i < 2 * count; ++i) {  // twice around: the first finds out what comes before the zeros
      const int side = sides[i % count], next = sides[(i + 1) % count];
      if (side != 0) before_zeros = side;
      if (side != 0 || next == 0) continue;
      if (before_zeros < 0 && next > 0) up = i % count;
      if (before_zeros > 0 && next < 0) down = i % count;
    }
    if (up == count || down == count) {
      polygons_[index] = std::move(ring);
      return;
    }
    const auto part = [&](size_t from, size_t to) {
      Polygon piece;
      for (size_t i = from; i != to; i = (i + 1) % count) piece.push_back(ring[i]);
      piece.push_back({ring[to].vertex, true});
      return piece;
    };
    Polygon first = part(up, down), second = part(down, up);
    polygons_[index] = std::move(ring);
    if (first.size() < 3 || second.size() < 3) return;
    polygons_[index] = std::move(first);
    polygons_.push_back(std::move(second));
  }

  uint32_t inner_point(uint32_t a, uint32_t b, int axis, float value) {
    if (b < a) std::swap(a, b);
    const auto [place, is_new] = inner_points_.try_emplace({a, b}, 0U);
    if (is_new) {
      const double from = position(a)[axis], to = position(b)[axis];
      place->second = add_vertex(a, b, (double(value) - from) / (to - from), axis, value);
    }
    return place->second;
  }

  /// Twice the area that a triangle has on the whole triangle's plane.
  double area_of(uint32_t a, uint32_t b, uint32_t c) const {
    const glm::dvec3 p(position(a));
    return glm::dot(glm::cross(glm::dvec3(position(b)) - p, glm::dvec3(position(c)) - p), normal_);
  }

  /// Cuts off the best-shaped ear that leaves an area, until a triangle is left.
  void triangulate(Polygon& polygon, uint32_t like) {
    double left = 0;
    for (size_t i = 2; i < polygon.size(); ++i)
      left += area_of(polygon[0].vertex, polygon[i - 1].vertex, polygon[i].vertex);
    while (polygon.size() > 3) {
      const size_t count = polygon.size();
      size_t best = 0;
      double best_shape = -1, best_area = 0;
      for (size_t i = 0; i < count; ++i) {
        const uint32_t a = polygon[(i + count - 1) % count].vertex, b = polygon[i].vertex,
                       c = polygon[(i + 1) % count].vertex;
        const double area = area_of(a, b, c);
        constexpr double kSome = 1e-6;  // of the polygon: what rounding leaves of a line
        if (area <= kSome * left || left - area <= kSome * left) continue;
        const auto edge = static_cast<double>(std::max({length(a, b), length(b, c), length(c, a)}));
        if (const double shape = area / (edge * edge); shape > best_shape)
          best = i, best_shape = shape, best_area = area;
      }
      left -= best_area;
      add_triangle(polygon[(best + count - 1) % count].vertex, polygon[best].vertex, polygon[(best + 1) % count].vertex,
                   like);
      polygon.erase(polygon.begin() + static_cast<std::ptrdiff_t>(best));
    }
    add_triangle(polygon[0].vertex, polygon[1].vertex, polygon[2].vertex, like);
  }

  void add_triangle(uint32_t a, uint32_t b, uint32_t c, uint32_t like) {
    const std::array<uint32_t, 3> corners{a, b, c};
    if (first_) {
      std::copy(corners.begin(), corners.end(), mesh_.indices.begin() + std::ptrdiff_t(like) * 3);
      first_ = false;
      return;
    }
    mesh_.indices.insert(mesh_.indices.end(), corners.begin(), corners.end());
    if (!mesh_.materials.empty()) mesh_.materials.push_back(mesh_.material_of(like));
  }

  Mesh& mesh_;
  float step_m_;
  std::unordered_map<uint64_t, std::vector<uint32_t>> points_of_edge_;
  // of the triangle at hand
  std::vector<Polygon> polygons_;
  std::map<std::pair<uint32_t, uint32_t>, uint32_t> inner_points_;
  std::vector<int> sides_;
  glm::dvec3 normal_{0};
  bool first_ = true;
};

}  // namespace

void cut_along_lattice(Mesh& mesh, float step_m) {
  if (!(step_m > 0)) return;
  LatticeCutter cutter(mesh, step_m);
  const size_t count = mesh.triangle_count();
  for (size_t t = 0; t < count; ++t) cutter.cut(static_cast<uint32_t>(t));
}

}  // namespace promenade
