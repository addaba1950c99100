#pragma once
// Surfaces of known shape that the tests of measuring and simplifying share.

#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <map>
#include <numbers>
#include <tuple>
#include <utility>
#include <vector>

#include "geometry/mesh.h"
#include "tests/numbers.h"

namespace promenade::test {

/// n by n squares of two triangles over [0, size]^2, at height(x, y). Vertices shared.
template <class Height>
Mesh grid(uint32_t n, float size, const Height& height) {
  Mesh mesh;
  for (uint32_t y = 0; y <= n; ++y)
    for (uint32_t x = 0; x <= n; ++x) {
      const float px = size * float(x) / float(n), py = size * float(y) / float(n);
      mesh.positions.emplace_back(px, py, height(px, py));
    }
  for (uint32_t y = 0; y < n; ++y)
    for (uint32_t x = 0; x < n; ++x) {
      const uint32_t a = y * (n + 1) + x, b = a + n + 1;
      mesh.indices.insert(mesh.indices.end(), {a, a + 1, b, b, a + 1, b + 1});
    }
  return mesh;
}

inline Mesh flat_grid(uint32_t n, float size = 1, float z = 0) {
  return grid(n, size, [z](float, float) { return z; });
}

inline Mesh hills(uint32_t n) {
  return grid(n, 100, [](float x, float y) {
    return 5 * std::sin(x * 0.1F) * std::cos(y * 0.13F) + std::sin(x * 0.7F + y * 0.3F) + 0.2F * std::sin(x * 3.1F);
  });
}

/// Closed, radius 10 m, with the poles' degenerate triangles. Vertices shared, normals smooth.
inline Mesh ball(uint32_t rings) {
  Mesh mesh;
  const uint32_t sectors = rings * 2;
  for (uint32_t r = 0; r <= rings; ++r)
    for (uint32_t s = 0; s <= sectors; ++s) {
      const double theta = std::numbers::pi * r / rings;
      const double phi = 2 * std::numbers::pi * (s % sectors) / sectors;
      const double ring = r == 0 || r == rings ? 0 : std::sin(theta);  // the poles are points
      const glm::dvec3 n(ring * std::cos(phi), ring * std::sin(phi), std::cos(theta));
      mesh.positions.emplace_back(10.0 * n);
      mesh.normals.emplace_back(glm::normalize(glm::vec3(n)));
    }
  for (uint32_t r = 0; r < rings; ++r)
    for (uint32_t s = 0; s < sectors; ++s) {
      const uint32_t a = r * (sectors + 1) + s, b = a + sectors + 1;
      mesh.indices.insert(mesh.indices.end(), {a, b, a + 1, a + 1, b, b + 1});
    }
  return mesh;
}

/// A flat-shaded quadrilateral of one colour.
inline void add_quad(Mesh& mesh, const glm::vec3& a, const glm::vec3& b, const glm::vec3& c, const glm::vec3& d,
                     const glm::u8vec4& color) {
  const glm::vec3 normal = glm::normalize(glm::cross(b - a, c - a));
  const auto first = static_cast<uint32_t>(mesh.positions.size());
  for (const glm::vec3& p : {a, b, c, d}) {
    mesh.positions.push_back(p);
    mesh.normals.push_back(normal);
    mesh.colors.push_back(color);
  }
  for (const uint32_t i : {0U, 1U, 2U, 0U, 2U, 3U}) mesh.indices.push_back(first + i);
}

/// A closed box of 12 triangles.
inline void add_box(Mesh& mesh, const glm::vec3& low, const glm::vec3& high, const glm::u8vec4& color) {
  const auto corner = [&](unsigned i) {
    return glm::vec3((i & 1U) != 0 ? high.x : low.x, (i & 2U) != 0 ? high.y : low.y, (i & 4U) != 0 ? high.z : low.z);
  };
  const unsigned faces[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
  for (const auto& f : faces) add_quad(mesh, corner(f[0]), corner(f[1]), corner(f[2]), corner(f[3]), color);
}

/// A wall from `origin` along u and v with columns by rows of windows, each 0.2 m deep and of another colour.
inline void add_wall_with_windows(Mesh& mesh, const glm::vec3& origin, const glm::vec3& u, const glm::vec3& v,
                                  uint32_t columns, uint32_t rows, const glm::u8vec4& color) {
  const glm::u8vec4 glass(40, 60, 90, 255);
  const glm::vec3 inward = -glm::normalize(glm::cross(u, v));
  const glm::vec3 du = u / float(columns), dv = v / float(rows);
  for (uint32_t row = 0; row < rows; ++row)
    for (uint32_t column = 0; column < columns; ++column) {
      const auto at = [&](float s, float t, float depth) {
        return origin + du * (float(column) + s) + dv * (float(row) + t) + inward * depth;
      };
      const glm::vec2 outer[4] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
      const glm::vec2 inner[4] = {{0.25F, 0.3F}, {0.75F, 0.3F}, {0.75F, 0.8F}, {0.25F, 0.8F}};
      for (size_t i = 0; i < 4; ++i) {
        const size_t j = (i + 1) % 4;
        const glm::vec3 a = at(inner[i].x, inner[i].y, 0), b = at(inner[j].x, inner[j].y, 0);
        add_quad(mesh, at(outer[i].x, outer[i].y, 0), at(outer[j].x, outer[j].y, 0), b, a, color);
        add_quad(mesh, a, b, b + inward * 0.2F, a + inward * 0.2F, color);
      }
      add_quad(mesh, at(0.25F, 0.3F, 0.2F), at(0.75F, 0.3F, 0.2F), at(0.75F, 0.8F, 0.2F), at(0.25F, 0.8F, 0.2F), glass);
    }
}

/// Four houses with windows on all sides, ledges, street lamps, a roof and the ground.
inline Mesh box_city_block() {
  Mesh mesh;
  Numbers numbers(11);
  for (int house = 0; house < 4; ++house) {
    const int row = house / 2;
    const glm::vec3 o(30.0F * float(house % 2), 30.0F * float(row), 0);
    const float w = numbers.between(14, 20), d = numbers.between(14, 20), h = numbers.between(9, 24);
    const glm::u8vec4 color(150 + house * 25, 160, 140, 255);
    const auto columns = static_cast<uint32_t>(w / 3), rows = static_cast<uint32_t>(h / 3);
    add_wall_with_windows(mesh, o, {w, 0, 0}, {0, 0, h}, columns, rows, color);
    add_wall_with_windows(mesh, o + glm::vec3(w, 0, 0), {0, d, 0}, {0, 0, h}, columns, rows, color);
    add_wall_with_windows(mesh, o + glm::vec3(w, d, 0), {-w, 0, 0}, {0, 0, h}, columns, rows, color);
    add_wall_with_windows(mesh, o + glm::vec3(0, d, 0), {0, -d, 0}, {0, 0, h}, columns, rows, color);
    add_quad(mesh, o + glm::vec3(0, 0, h), o + glm::vec3(w, 0, h), o + glm::vec3(w, d, h), o + glm::vec3(0, d, h),
             {90, 90, 90, 255});
    for (float z = 2.9F; z < h; z += 3)
      add_box(mesh, o + glm::vec3(-0.2F, -0.2F, z), o + glm::vec3(w + 0.2F, 0, z + 0.1F), {200, 200, 200, 255});
    for (int lamp = 0; lamp < 5; ++lamp) {
      const glm::vec3 foot = o + glm::vec3(numbers.between(-5, 23), -3, 0);
      add_box(mesh, foot, foot + glm::vec3(0.1F, 0.1F, 3), {60, 60, 60, 255});
      add_box(mesh, foot + glm::vec3(-0.3F, -0.3F, 3), foot + glm::vec3(0.4F, 0.4F, 3.3F), {250, 240, 200, 255});
    }
    add_quad(mesh, o + glm::vec3(-5, -5, 0), o + glm::vec3(25, -5, 0), o + glm::vec3(25, 25, 0),
             o + glm::vec3(-5, 25, 0), {70, 70, 75, 255});
  }
  return mesh;
}

/// Triangles that share no place, each about `size`, anywhere in a cube of 20 m.
inline Mesh disjoint_triangles(uint32_t triangles, float size = 0.3F, uint64_t seed = 1) {
  Numbers numbers(seed);
  Mesh mesh;
  for (uint32_t t = 0; t < triangles; ++t) {
    const glm::vec3 a = numbers.in_cube(10);
    const glm::vec3 b = a + numbers.in_cube(size), c = a + numbers.in_cube(size);
    mesh.positions.insert(mesh.positions.end(), {a, b, c});
    for (uint32_t i = 0; i < 3; ++i) mesh.indices.push_back(t * 3 + i);
  }
  return mesh;
}

/// A flat disc of triangles that all meet in its middle.
inline Mesh hub(uint32_t spokes) {
  Mesh mesh;
  mesh.positions.emplace_back(0, 0, 0);
  for (uint32_t s = 0; s < spokes; ++s) {
    const double phi = 2 * std::numbers::pi * s / spokes;
    mesh.positions.emplace_back(std::cos(phi), std::sin(phi), 0);
    mesh.indices.insert(mesh.indices.end(), {0, 1 + s, 1 + (s + 1) % spokes});
  }
  return mesh;
}

/// Triangles between few places: edges with many triangles, fans through a point, repeated and degenerate ones.
inline Mesh tangled_soup(uint32_t triangles, uint32_t places, uint64_t seed = 1) {
  Numbers numbers(seed);
  Mesh mesh;
  for (uint32_t p = 0; p < places; ++p) mesh.positions.push_back(numbers.in_cube(10));
  for (uint32_t i = 0; i < triangles * 3; ++i) mesh.indices.push_back(static_cast<uint32_t>(numbers.next() % places));
  return mesh;
}

using Point = std::tuple<float, float, float>;

/// Edges between places that the triangles of all meshes together do not pass once in either direction, however their
/// corners are numbered: none for a closed surface.
inline std::map<std::pair<Point, Point>, int> open_edges(const std::vector<Mesh>& meshes) {
  std::map<std::pair<Point, Point>, int> edges;
  for (const Mesh& mesh : meshes)
    for (size_t i = 0; i < mesh.indices.size(); ++i) {
      const auto point = [&](size_t corner) {
        const glm::vec3& p = mesh.positions[mesh.indices[corner]];
        return Point(p.x, p.y, p.z);
      };
      const Point a = point(i), b = point(i % 3 == 2 ? i - 2 : i + 1);
      if (a == b) continue;
      if (a < b)
        ++edges[{a, b}];
      else
        --edges[{b, a}];
    }
  std::erase_if(edges, [](const auto& edge) { return edge.second == 0; });
  return edges;
}

}  // namespace promenade::test
