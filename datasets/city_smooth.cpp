#include "datasets/city_smooth.h"

#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <map>
#include <numbers>
#include <utility>

namespace promenade {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;
constexpr float kSharpCosine = 0.766F;  // 40 degrees

glm::vec3 unit_or_up(const glm::vec3& v) {
  const float length = glm::length(v);
  return length > 1e-12F ? v / length : glm::vec3(0, 0, 1);
}

}  // namespace

uint32_t SmoothShape::vertex(const glm::vec3& p, const glm::vec3& normal, const Color& color) {
  mesh_.positions.emplace_back(place_ * glm::vec4(p, 1));
  mesh_.normals.push_back(unit_or_up(glm::vec3(place_ * glm::vec4(normal, 0))));
  mesh_.colors.push_back(color);
  return static_cast<uint32_t>(mesh_.positions.size() - 1);
}

void SmoothShape::quad(uint32_t a, uint32_t b, uint32_t c, uint32_t d) {
  // Quads at a pole have lost a side.
  const auto same = [&](uint32_t i, uint32_t j) { return mesh_.positions[i] == mesh_.positions[j]; };
  if (!same(a, b) && !same(b, c) && !same(a, c)) mesh_.indices.insert(mesh_.indices.end(), {a, b, c});
  if (!same(a, c) && !same(c, d) && !same(a, d)) mesh_.indices.insert(mesh_.indices.end(), {a, c, d});
}

void SmoothShape::box(const glm::vec3& low, const glm::vec3& high) {
  for (int axis = 0; axis < 3; ++axis)
    for (const bool top : {false, true}) {
      const int u = (axis + 1) % 3, v = (axis + 2) % 3;
      glm::vec3 normal(0);
      normal[axis] = top ? 1.0F : -1.0F;
      std::array<uint32_t, 4> corner{};
      for (uint32_t k = 0; k < 4; ++k) {
        glm::vec3 p = low;
        p[axis] = top ? high[axis] : low[axis];
        p[u] = (k == 1 || k == 2) ? high[u] : low[u];
        p[v] = k >= 2 ? high[v] : low[v];
        corner[k] = vertex(p, normal, color_);
      }
      if (top)
        quad(corner[0], corner[1], corner[2], corner[3]);
      else
        quad(corner[3], corner[2], corner[1], corner[0]);
    }
}

void SmoothShape::lathe(const glm::vec3& center, std::span<const glm::vec2> profile, int sides) {
  const auto normal_of = [&](size_t segment) {
    const glm::vec2 way = profile[segment + 1] - profile[segment];
    return glm::normalize(glm::vec2(way.y, -way.x));
  };
  for (size_t s = 0; s + 1 < profile.size(); ++s) {
    const glm::vec2 own = normal_of(s);
    const auto smoothed = [&](size_t other) {
      const glm::vec2 n = normal_of(other);
      return glm::dot(n, own) > kSharpCosine ? glm::normalize(own + n) : own;
    };
    const std::array<glm::vec2, 2> normals = {s > 0 ? smoothed(s - 1) : own,
                                              s + 2 < profile.size() ? smoothed(s + 1) : own};
    uint32_t first = 0;
    for (int i = 0; i <= sides; ++i) {
      const float angle = 2 * kPi * static_cast<float>(i % sides) / static_cast<float>(sides);
      const glm::vec3 way(std::cos(angle), std::sin(angle), 0);
      for (size_t end = 0; end < 2; ++end) {
        const uint32_t v = vertex(center + way * profile[s + end].x + glm::vec3(0, 0, profile[s + end].y),
                                  way * normals[end].x + glm::vec3(0, 0, normals[end].y), color_);
        if (i == 0 && end == 0) first = v;
      }
    }
    for (uint32_t i = 0; i < static_cast<uint32_t>(sides); ++i)
      quad(first + 2 * i, first + 2 * i + 2, first + 2 * i + 3, first + 2 * i + 1);
  }
}

void SmoothShape::grid(std::span<const glm::vec3> points, size_t columns,
                       const std::function<Color(size_t row, size_t column)>& color_of) {
  const size_t rows = points.size() / columns;
  std::vector<glm::vec3> normals(points.size(), glm::vec3(0));
  const auto corners = [&](size_t r, size_t c) {
    const size_t i = r * columns + c;
    return std::array<size_t, 4>{i, i + columns, i + columns + 1, i + 1};
  };
  for (size_t r = 0; r + 1 < rows; ++r)
    for (size_t c = 0; c + 1 < columns; ++c) {
      const auto q = corners(r, c);
      const glm::vec3 n = glm::cross(points[q[2]] - points[q[0]], points[q[3]] - points[q[1]]);
      for (const size_t i : q) normals[i] += n;
    }
  // Quads of one colour share their corners.
  std::map<std::pair<size_t, uint32_t>, uint32_t> made;
  for (size_t r = 0; r + 1 < rows; ++r)
    for (size_t c = 0; c + 1 < columns; ++c) {
      const Color color = color_of(r, c);
      const uint32_t key = uint32_t(color.r) << 16 | uint32_t(color.g) << 8 | color.b;
      std::array<uint32_t, 4> v{};
      const auto q = corners(r, c);
      for (size_t k = 0; k < 4; ++k) {
        const auto [at, is_new] = made.try_emplace({q[k], key}, 0);
        if (is_new) at->second = vertex(points[q[k]], normals[q[k]], color);
        v[k] = at->second;
      }
      quad(v[0], v[1], v[2], v[3]);
    }
}

void SmoothShape::blob(const glm::vec3& center, const glm::vec3& radii, int rings, int sides,
                       const std::function<float(const glm::vec3&)>& radius_of) {
  const auto columns = static_cast<size_t>(sides) + 1;
  std::vector<glm::vec3> points;
  for (int r = 0; r <= rings; ++r)
    for (int s = 0; s <= sides; ++s) {
      const float up = -kPi / 2 + kPi * static_cast<float>(r) / static_cast<float>(rings);
      const float around = 2 * kPi * static_cast<float>(s % sides) / static_cast<float>(sides);
      const float across = r == 0 || r == rings ? 0 : std::cos(up);
      const glm::vec3 way(across * std::cos(around), across * std::sin(around), std::sin(up));
      points.push_back(center + way * radii * radius_of(way));
    }
  const auto first = static_cast<uint32_t>(mesh_.positions.size());
  for (size_t i = 0; i < points.size(); ++i) {
    const glm::vec3 way = (points[i] - center) / (radii * radii);
    const float light = 0.72F + 0.32F * (points[i].z - center.z) / radii.z;
    vertex(points[i], way, shade(color_, light));
  }
  for (uint32_t r = 0; r < static_cast<uint32_t>(rings); ++r)
    for (uint32_t s = 0; s < static_cast<uint32_t>(sides); ++s) {
      const uint32_t a = first + r * static_cast<uint32_t>(columns) + s, above = a + static_cast<uint32_t>(columns);
      quad(a, a + 1, above + 1, above);
    }
}

}  // namespace promenade
