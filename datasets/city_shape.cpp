#include "datasets/city_shape.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <numeric>

namespace promenade {
namespace {

/// Where the corner of a mitred outline goes for each metre that its edges move outwards.
glm::vec2 mitre(const glm::vec2& before, const glm::vec2& corner, const glm::vec2& after) {
  const glm::vec2 e0 = glm::normalize(corner - before), e1 = glm::normalize(after - corner);
  const glm::vec2 n0(e0.y, -e0.x), n1(e1.y, -e1.x);
  const glm::vec2 sum = n0 + n1;
  // A spike would run far away: never more than about twice the outset.
  return sum / std::max(1.0F + glm::dot(n0, n1), 0.45F);
}

std::vector<glm::vec2> mitres(std::span<const glm::vec2> polygon) {
  const size_t n = polygon.size();
  std::vector<glm::vec2> result(n);
  for (size_t i = 0; i < n; ++i) result[i] = mitre(polygon[(i + n - 1) % n], polygon[i], polygon[(i + 1) % n]);
  return result;
}

bool inside(const glm::vec2& p, const glm::vec2& a, const glm::vec2& b, const glm::vec2& c) {
  return cross(a, b, p) >= 0 && cross(b, c, p) >= 0 && cross(c, a, p) >= 0;
}

bool is_ear(std::span<const glm::vec2> polygon, const std::vector<uint32_t>& left, size_t i) {
  const size_t n = left.size();
  const uint32_t before = left[(i + n - 1) % n], corner = left[i], after = left[(i + 1) % n];
  if (cross(polygon[before], polygon[corner], polygon[after]) <= 0) return false;
  return std::none_of(left.begin(), left.end(), [&](uint32_t other) {
    return other != before && other != corner && other != after &&
           inside(polygon[other], polygon[before], polygon[corner], polygon[after]);
  });
}

uint8_t channel(float value) { return static_cast<uint8_t>(std::clamp(value + 0.5F, 0.0F, 255.0F)); }

}  // namespace

Color shade(const Color& color, float factor) {
  return {channel(static_cast<float>(color.r) * factor), channel(static_cast<float>(color.g) * factor),
          channel(static_cast<float>(color.b) * factor), color.a};
}

Color blend(const Color& a, const Color& b, float t) {
  const auto mix = [t](uint8_t x, uint8_t y) {
    return channel(static_cast<float>(x) + (static_cast<float>(y) - static_cast<float>(x)) * t);
  };
  return {mix(a.r, b.r), mix(a.g, b.g), mix(a.b, b.b), a.a};
}

float cross(const glm::vec2& a, const glm::vec2& b, const glm::vec2& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

float area_of(std::span<const glm::vec2> polygon) {
  float twice = 0;
  for (size_t i = 1; i + 1 < polygon.size(); ++i) twice += cross(polygon[0], polygon[i], polygon[i + 1]);
  return twice / 2;
}

glm::vec2 centroid_of(std::span<const glm::vec2> polygon) {
  glm::vec2 sum(0);
  float twice = 0;
  for (size_t i = 1; i + 1 < polygon.size(); ++i) {
    const float part = cross(polygon[0], polygon[i], polygon[i + 1]);
    sum += (polygon[0] + polygon[i] + polygon[i + 1]) * (part / 3), twice += part;
  }
  return twice == 0 ? polygon[0] : sum / twice;
}

std::vector<glm::vec2> outset(std::span<const glm::vec2> polygon, float by) {
  std::vector<glm::vec2> result = mitres(polygon);
  for (size_t i = 0; i < result.size(); ++i) result[i] = polygon[i] + result[i] * by;
  return result;
}

std::vector<uint32_t> triangulated(std::span<const glm::vec2> polygon) {
  std::vector<uint32_t> left(polygon.size()), triangles;
  std::iota(left.begin(), left.end(), 0U);
  while (left.size() > 3) {
    size_t ear = 0;
    while (ear < left.size() && !is_ear(polygon, left, ear)) ++ear;
    if (ear == left.size()) ear = 0;  // only when rounding has closed every ear: any triangle then does
    const size_t n = left.size();
    triangles.insert(triangles.end(), {left[(ear + n - 1) % n], left[ear], left[(ear + 1) % n]});
    left.erase(left.begin() + static_cast<std::ptrdiff_t>(ear));
  }
  triangles.insert(triangles.end(), left.begin(), left.end());
  return triangles;
}

WallFrame WallFrame::between(const glm::vec2& a, const glm::vec2& b) {
  const glm::vec2 along = glm::normalize(b - a);
  return {a, along, {along.y, -along.x}};
}

uint32_t Shape::vertex(const glm::vec3& p, const glm::vec2& texcoord) {
  if (counting_) return 0;
  mesh_.positions.push_back(p);
  mesh_.colors.push_back(color_);
  if (with_texcoords_) mesh_.texcoords.push_back(texcoord);
  return static_cast<uint32_t>(mesh_.positions.size() - 1);
}

void Shape::triangle(uint32_t a, uint32_t b, uint32_t c) {
  ++triangles_;
  if (counting_) return;
  mesh_.indices.insert(mesh_.indices.end(), {a, b, c});
  mesh_.materials.push_back(material_);
}

void Shape::face(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c, const glm::vec3& d) {
  if (counting_) {
    triangles_ += 2;
    return;
  }
  const uint32_t first = vertex(a);
  vertex(b), vertex(c), vertex(d);
  quad(first, first + 1, first + 2, first + 3);
}

void Shape::face(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
  const uint32_t first = vertex(a);
  vertex(b), vertex(c);
  triangle(first, first + 1, first + 2);
}

void Shape::box(const WallFrame& frame, const glm::vec3& low, const glm::vec3& high, uint32_t without) {
  if (counting_) {
    triangles_ += 12 - 2 * static_cast<uint64_t>(((without & Side::bottom) != 0) + ((without & Side::top) != 0) +
                                                 ((without & Side::back) != 0));
    return;
  }
  // A frame's y points to the right of x when it stands on a wall, to the left when it is the world's.
  const bool mirrored = frame.along.x * frame.out.y - frame.along.y * frame.out.x < 0;
  std::array<uint32_t, 8> v{};
  for (uint32_t i = 0; i < 8; ++i)
    v[i] = vertex(
        frame.at((i & 1U) != 0 ? high.x : low.x, (i & 2U) != 0 ? high.y : low.y, (i & 4U) != 0 ? high.z : low.z));
  const auto side = [&](uint32_t a, uint32_t b, uint32_t c, uint32_t d) {
    if (mirrored)
      quad(v[d], v[c], v[b], v[a]);
    else
      quad(v[a], v[b], v[c], v[d]);
  };
  side(1, 3, 7, 5), side(2, 0, 4, 6), side(3, 2, 6, 7);
  if ((without & Side::back) == 0) side(0, 1, 5, 4);
  if ((without & Side::bottom) == 0) side(0, 2, 3, 1);
  if ((without & Side::top) == 0) side(4, 5, 7, 6);
}

void Shape::ring(std::span<const glm::vec2> polygon, std::span<const glm::vec2> profile) {
  const auto n = static_cast<uint32_t>(polygon.size()), rows = static_cast<uint32_t>(profile.size());
  if (counting_) {
    triangles_ += uint64_t(2) * n * (rows - 1);
    return;
  }
  const std::vector<glm::vec2> ways = mitres(polygon);
  uint32_t first = 0;
  for (uint32_t r = 0; r < rows; ++r)
    for (uint32_t i = 0; i < n; ++i) {
      const uint32_t v = vertex(glm::vec3(polygon[i] + ways[i] * profile[r].x, profile[r].y));
      if (r == 0 && i == 0) first = v;
    }
  for (uint32_t r = 0; r + 1 < rows; ++r)
    for (uint32_t i = 0; i < n; ++i) {
      const uint32_t a = first + r * n + i, b = first + r * n + (i + 1) % n;
      quad(a, b, b + n, a + n);
    }
}

void Shape::cap(std::span<const glm::vec2> polygon, float z) {
  if (counting_) {
    triangles_ += polygon.size() - 2;
    return;
  }
  uint32_t first = 0;
  for (size_t i = 0; i < polygon.size(); ++i) {
    const uint32_t v = vertex({polygon[i], z});
    if (i == 0) first = v;
  }
  const std::vector<uint32_t> corners = triangulated(polygon);
  for (size_t i = 0; i < corners.size(); i += 3)
    triangle(first + corners[i], first + corners[i + 1], first + corners[i + 2]);
}

void Shape::spire(std::span<const glm::vec2> polygon, float base_z, const glm::vec3& apex) {
  const uint32_t tip = vertex(apex);
  const auto n = static_cast<uint32_t>(polygon.size());
  for (const glm::vec2& p : polygon) vertex({p, base_z});
  for (uint32_t i = 0; i < n; ++i) triangle(tip + 1 + i, tip + 1 + (i + 1) % n, tip);
}

void Shape::cylinder(const glm::vec3& center, float radius, float top_radius, float height, int sides) {
  std::vector<glm::vec2> circle(static_cast<size_t>(sides));
  for (int i = 0; i < sides; ++i) {
    const float angle = 2 * std::numbers::pi_v<float> * static_cast<float>(i) / static_cast<float>(sides);
    circle[static_cast<size_t>(i)] = glm::vec2(std::cos(angle), std::sin(angle));
  }
  const auto n = static_cast<uint32_t>(sides);
  const uint32_t first = vertex(center + glm::vec3(circle[0] * radius, 0));
  for (uint32_t i = 1; i < n; ++i) vertex(center + glm::vec3(circle[i] * radius, 0));
  for (uint32_t i = 0; i < n; ++i) vertex(center + glm::vec3(circle[i] * top_radius, height));
  for (uint32_t i = 0; i < n; ++i) quad(first + i, first + (i + 1) % n, first + n + (i + 1) % n, first + n + i);
  for (uint32_t i = 1; i + 1 < n; ++i) triangle(first + n, first + n + i, first + n + i + 1);
}

void Shape::stitch(std::span<const glm::vec3> a, std::span<const glm::vec3> b) {
  assert(a.size() > 1 && b.size() > 1);
  const uint32_t first_a = vertex(a[0]);
  for (size_t i = 1; i < a.size(); ++i) vertex(a[i]);
  const uint32_t first_b = vertex(b[0]);
  for (size_t i = 1; i < b.size(); ++i) vertex(b[i]);
  const auto last_a = static_cast<uint32_t>(a.size() - 1), last_b = static_cast<uint32_t>(b.size() - 1);
  uint32_t i = 0, j = 0;
  while (i < last_a || j < last_b) {
    // The line that lags behind goes on.
    const bool step_a = j == last_b || (i < last_a && uint64_t(i) * last_b <= uint64_t(j) * last_a);
    if (step_a)
      triangle(first_a + i, first_a + i + 1, first_b + j), ++i;
    else
      triangle(first_a + i, first_b + j + 1, first_b + j), ++j;
  }
}

Mesh Shape::take() {
  if (std::all_of(mesh_.materials.begin(), mesh_.materials.end(), [](uint32_t m) { return m == 0; }))
    mesh_.materials.clear();
  return std::move(mesh_);
}

}  // namespace promenade
