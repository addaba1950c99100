#include "datasets/shapes.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/constants.hpp>
#include <glm/matrix.hpp>

namespace promenade {

namespace {

constexpr double kCreaseCosine = 0.766;  // 40 degrees: sharper bends of a profile keep their edge

double cross2(const glm::dvec2& a, const glm::dvec2& b) { return a.x * b.y - a.y * b.x; }

/// Directions of n equal steps around the circle; the quarters are exact, so that the extents of round things are.
std::vector<glm::dvec2> circle(uint32_t n) {
  std::vector<glm::dvec2> points(n);
  for (uint32_t i = 0; i < n; ++i) {
    const double angle = glm::two_pi<double>() * i / n;
    points[i] = {std::cos(angle), std::sin(angle)};
    for (int c = 0; c < 2; ++c) {
      if (std::abs(points[i][c]) < 1e-12) points[i][c] = 0;
    }
  }
  return points;
}

bool segments_cross(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c, const glm::dvec2& d) {
  const double abc = cross2(b - a, c - a), abd = cross2(b - a, d - a);
  const double cda = cross2(d - c, a - c), cdb = cross2(d - c, b - c);
  return ((abc > 0) != (abd > 0)) && ((cda > 0) != (cdb > 0)) && abc != 0 && abd != 0 && cda != 0 && cdb != 0;
}

bool strictly_between(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& p) {
  return std::abs(cross2(b - a, p - a)) < 1e-12 && glm::dot(p - a, b - a) > 1e-12 && glm::dot(p - b, a - b) > 1e-12;
}

struct Loop {
  std::vector<glm::dvec2> points;  ///< all corners, outer first
  std::vector<uint32_t> order;     ///< the one loop around the bridged polygon
};

/// Whether the bridge from a to b crosses or touches no edge of the loop, nor of the holes that still wait.
bool bridge_is_free(const Loop& loop, std::span<const std::vector<glm::dvec2>> holes, const glm::dvec2& a,
                    const glm::dvec2& b) {
  const auto blocked = [&](const glm::dvec2& c, const glm::dvec2& d) {
    return segments_cross(a, b, c, d) || strictly_between(a, b, c) || strictly_between(a, b, d);
  };
  for (size_t i = 0; i < loop.order.size(); ++i) {
    if (blocked(loop.points[loop.order[i]], loop.points[loop.order[(i + 1) % loop.order.size()]])) return false;
  }
  for (const std::vector<glm::dvec2>& hole : holes) {
    for (size_t i = 0; i < hole.size(); ++i) {
      if (blocked(hole[i], hole[(i + 1) % hole.size()])) return false;
    }
  }
  return true;
}

/// Ties a hole (corners first.. in points) into the loop by the shortest free bridge.
void bridge(Loop& loop, std::span<const std::vector<glm::dvec2>> holes, uint32_t first, uint32_t count) {
  double best = 1e300;
  size_t at = 0;
  uint32_t start = 0;
  for (size_t i = 0; i < loop.order.size(); ++i) {
    for (uint32_t k = 0; k < count; ++k) {
      const glm::dvec2& a = loop.points[loop.order[i]];
      const glm::dvec2& b = loop.points[first + k];
      const double length = glm::length(b - a);
      if (length >= best || !bridge_is_free(loop, holes, a, b)) continue;
      best = length, at = i, start = k;
    }
  }
  std::vector<uint32_t> tour;
  for (uint32_t k = 0; k <= count; ++k) tour.push_back(first + (start + k) % count);
  tour.push_back(loop.order[at]);
  loop.order.insert(loop.order.begin() + static_cast<std::ptrdiff_t>(at) + 1, tour.begin(), tour.end());
}

/// How round the triangle at corner i is if that can be cut off; 0 if not. The roundest ear goes first, so that corners
/// on one line find partners off it as long as there are any.
double ear_roundness(const Loop& loop, size_t i) {
  const size_t n = loop.order.size();
  const glm::dvec2& a = loop.points[loop.order[(i + n - 1) % n]];
  const glm::dvec2& b = loop.points[loop.order[i]];
  const glm::dvec2& c = loop.points[loop.order[(i + 1) % n]];
  const double area = cross2(b - a, c - b);
  if (area <= 1e-12) return 0;
  for (size_t k = 0; k < n; ++k) {
    const glm::dvec2& p = loop.points[loop.order[k]];
    if (p == a || p == b || p == c) continue;
    if (cross2(b - a, p - a) >= 0 && cross2(c - b, p - b) >= 0 && cross2(a - c, p - c) >= 0) return 0;
  }
  return area / std::max({glm::dot(b - a, b - a), glm::dot(c - b, c - b), glm::dot(a - c, a - c)});
}

/// A frame whose z axis is `axis` (unit).
glm::dmat3 frame_along(const glm::dvec3& axis) {
  const glm::dvec3 helper = std::abs(axis.z) < 0.9 ? glm::dvec3(0, 0, 1) : glm::dvec3(1, 0, 0);
  const glm::dvec3 x = glm::normalize(glm::cross(helper, axis));
  return {x, glm::cross(axis, x), axis};
}

}  // namespace

glm::u8vec4 shaded(glm::u8vec4 c, double amount) {
  for (int i = 0; i < 3; ++i) {
    const double v = amount < 0 ? c[i] * (1 + amount) : c[i] + (255 - c[i]) * amount;
    c[i] = static_cast<uint8_t>(std::clamp(v + 0.5, 0.0, 255.0));
  }
  return c;
}

glm::dmat4 moved(const glm::dvec3& by) {
  glm::dmat4 m(1);
  m[3] = glm::dvec4(by, 1);
  return m;
}

/// The four quarters are exact: a building's furniture stands square.
glm::dmat4 turned_z(double degrees) {
  double c = std::cos(glm::radians(degrees)), s = std::sin(glm::radians(degrees));
  if (std::abs(c) < 1e-12) c = 0;
  if (std::abs(s) < 1e-12) s = 0;
  glm::dmat4 m(1);
  m[0] = {c, s, 0, 0};
  m[1] = {-s, c, 0, 0};
  return m;
}

glm::dmat4 turned_x(double degrees) {
  const double c = std::cos(glm::radians(degrees)), s = std::sin(glm::radians(degrees));
  glm::dmat4 m(1);
  m[1] = {0, c, s, 0};
  m[2] = {0, -s, c, 0};
  return m;
}

std::vector<uint32_t> triangulate(std::span<const glm::dvec2> outer, std::span<const std::vector<glm::dvec2>> holes) {
  Loop loop;
  loop.points.assign(outer.begin(), outer.end());
  for (uint32_t i = 0; i < outer.size(); ++i) loop.order.push_back(i);
  std::vector<uint32_t> starts;
  for (const std::vector<glm::dvec2>& hole : holes) {
    starts.push_back(static_cast<uint32_t>(loop.points.size()));
    loop.points.insert(loop.points.end(), hole.begin(), hole.end());
  }
  for (size_t h = 0; h < holes.size(); ++h)
    bridge(loop, holes.subspan(h), starts[h], static_cast<uint32_t>(holes[h].size()));
  std::vector<uint32_t> triangles;
  while (loop.order.size() >= 3) {
    const size_t n = loop.order.size();
    size_t ear = n;
    double best = 0;
    for (size_t i = 0; i < n; ++i) {
      const double roundness = ear_roundness(loop, i);
      if (roundness > best) best = roundness, ear = i;
    }
    if (ear == n) break;  // only corners on one line are left
    for (const size_t corner : {(ear + n - 1) % n, ear, (ear + 1) % n}) triangles.push_back(loop.order[corner]);
    loop.order.erase(loop.order.begin() + static_cast<std::ptrdiff_t>(ear));
  }
  return triangles;
}

uint32_t Sculptor::steps(double at_one, uint32_t least) const {
  return std::max(least, static_cast<uint32_t>(std::lround(at_one * quality_)));
}

Sculptor& Sculptor::paint(glm::u8vec4 color) {
  color_ = color;
  return *this;
}

Sculptor& Sculptor::stand(const glm::dmat4& mesh_from_part) {
  frame_ = mesh_from_part;
  const glm::dmat3 linear(mesh_from_part);
  normal_frame_ = glm::transpose(glm::inverse(linear));
  mirrors_ = glm::determinant(linear) < 0;
  return *this;
}

uint32_t Sculptor::vertex(const glm::dvec3& p, const glm::dvec3& n) {
  mesh_.positions.emplace_back(glm::dvec3(frame_ * glm::dvec4(p, 1)));
  mesh_.normals.emplace_back(glm::normalize(normal_frame_ * n));
  mesh_.colors.push_back(color_);
  return static_cast<uint32_t>(mesh_.positions.size() - 1);
}

/// Leaves out what a pole or a corner squeezed to nothing.
void Sculptor::triangle(uint32_t a, uint32_t b, uint32_t c) {
  const auto& p = mesh_.positions;
  if (p[a] == p[b] || p[b] == p[c] || p[c] == p[a]) return;
  if (mirrors_) std::swap(b, c);
  mesh_.indices.insert(mesh_.indices.end(), {a, b, c});
}

void Sculptor::flat_quad(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, const glm::dvec3& d) {
  const glm::dvec3 n = glm::cross(c - a, d - b);
  const uint32_t first = vertex(a, n);
  vertex(b, n), vertex(c, n), vertex(d, n);
  quad(first, first + 1, first + 2, first + 3);
}

void Sculptor::box(const glm::dvec3& min, const glm::dvec3& max) {
  assert(min.x < max.x && min.y < max.y && min.z < max.z);
  const auto corner = [&](int i) {
    return glm::dvec3((i & 1) != 0 ? max.x : min.x, (i & 2) != 0 ? max.y : min.y, (i & 4) != 0 ? max.z : min.z);
  };
  static constexpr int kFaces[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                       {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  for (const auto& face : kFaces) flat_quad(corner(face[0]), corner(face[1]), corner(face[2]), corner(face[3]));
}

/// A sphere's rings, pulled apart at the equator and the four quarter meridians.
void Sculptor::rounded_box(const glm::dvec3& min, const glm::dvec3& max, double radius, uint32_t arc) {
  if (arc == 0 || radius <= 0) return box(min, max);
  radius = std::min(radius, 0.4999 * std::min({max.x - min.x, max.y - min.y, max.z - min.z}));
  const glm::dvec3 low = min + radius, high = max - radius;
  const uint32_t per_ring = 4 * (arc + 1);
  const std::vector<glm::dvec2> unit = circle(4 * arc);
  const auto first = static_cast<uint32_t>(mesh_.positions.size());
  for (uint32_t ring = 0; ring < 2 * (arc + 1); ++ring) {
    const bool top = ring > arc;
    const uint32_t latitude = top ? ring - 1 : ring;                       // of 2 arc; the equator is there twice
    const glm::dvec2 lift = unit[(4 * arc - arc + latitude) % (4 * arc)];  // from -90 to 90 degrees
    for (uint32_t k = 0; k < per_ring; ++k) {
      const uint32_t quarter = k / (arc + 1);
      const glm::dvec2 around = unit[(k - quarter) % (4 * arc)];
      const glm::dvec3 direction(around.x * lift.x, around.y * lift.x, lift.y);
      const glm::dvec3 corner(quarter == 0 || quarter == 3 ? high.x : low.x, quarter < 2 ? high.y : low.y,
                              top ? high.z : low.z);
      vertex(corner + radius * direction, direction);
    }
  }
  const uint32_t rings = 2 * (arc + 1);
  for (uint32_t ring = 0; ring + 1 < rings; ++ring) {
    for (uint32_t k = 0; k < per_ring; ++k) {
      const uint32_t a = first + ring * per_ring + k, b = first + ring * per_ring + (k + 1) % per_ring;
      quad(a, b, b + per_ring, a + per_ring);
    }
  }
  const uint32_t step = arc + 1, last = first + (rings - 1) * per_ring;
  quad(first + 3 * step, first + 2 * step, first + step, first);
  quad(last, last + step, last + 2 * step, last + 3 * step);
}

void Sculptor::lathe(std::span<const glm::dvec2> profile, bool ring, uint32_t sides) {
  const std::vector<glm::dvec2> around = circle(sides);
  const size_t n = profile.size(), segments = ring ? n : n - 1;
  const auto normal_of = [&](size_t s) {
    const glm::dvec2 d = profile[(s + 1) % n] - profile[s];
    return glm::normalize(glm::dvec2(d.y, -d.x));
  };
  // A corner that two segments share smoothly takes the mean of their normals, seen from either.
  const auto corner_normal = [&](size_t segment, bool end) {
    const glm::dvec2 own = normal_of(segment);
    if (!ring && (end ? segment + 1 == segments : segment == 0)) return own;
    const glm::dvec2 other = normal_of(end ? (segment + 1) % segments : (segment + segments - 1) % segments);
    return glm::dot(own, other) > kCreaseCosine ? glm::normalize(own + other) : own;
  };
  for (size_t s = 0; s < segments; ++s) {
    const auto first = static_cast<uint32_t>(mesh_.positions.size());
    for (const bool end : {false, true}) {
      const glm::dvec2 p = profile[(s + (end ? 1 : 0)) % n], m = corner_normal(s, end);
      for (const glm::dvec2& a : around) vertex({p.x * a.x, p.x * a.y, p.y}, {m.x * a.x, m.x * a.y, m.y});
    }
    for (uint32_t k = 0; k < sides; ++k) {
      const uint32_t next = (k + 1) % sides;
      quad(first + k, first + next, first + sides + next, first + sides + k);
    }
  }
}

void Sculptor::cone(const glm::dvec3& from, const glm::dvec3& to, double radius_from, double radius_to,
                    uint32_t sides) {
  const double length = glm::length(to - from);
  const glm::dmat4 before = frame_;
  glm::dmat4 local(frame_along((to - from) / length));
  local[3] = glm::dvec4(from, 1);
  stand(before * local);
  std::vector<glm::dvec2> profile{{0, 0}};
  if (radius_from > 0) profile.emplace_back(radius_from, 0);
  if (radius_to > 0) profile.emplace_back(radius_to, length);
  profile.emplace_back(0, length);
  lathe(profile, false, sides);
  stand(before);
}

void Sculptor::ellipsoid(const glm::dvec3& center, const glm::dvec3& radii, uint32_t sides, uint32_t rings) {
  const glm::dmat4 before = frame_;
  glm::dmat4 local(1);
  for (int i = 0; i < 3; ++i) local[i][i] = radii[i];
  local[3] = glm::dvec4(center, 1);
  stand(before * local);
  std::vector<glm::dvec2> profile;
  for (uint32_t i = 0; i <= rings; ++i) {
    const double angle = glm::pi<double>() * (double(i) / rings - 0.5);
    const bool pole = i == 0 || i == rings;
    profile.emplace_back(pole ? 0 : std::cos(angle), std::sin(angle));
  }
  lathe(profile, false, sides);
  stand(before);
}

void Sculptor::tube(std::span<const glm::dvec3> points, double radius, uint32_t sides) {
  const std::vector<glm::dvec2> around = circle(sides);
  const size_t n = points.size();
  const auto direction = [&](size_t i) { return glm::normalize(points[i + 1] - points[i]); };
  glm::dmat3 frame = frame_along(direction(0));
  const auto first = static_cast<uint32_t>(mesh_.positions.size());
  std::vector<std::vector<glm::dvec3>> rings;
  for (size_t i = 0; i < n; ++i) {
    const glm::dvec3 before = direction(i == 0 ? 0 : i - 1), after = direction(i + 1 == n ? i - 1 : i);
    const glm::dvec3 axis = glm::normalize(before + after);
    // Parallel transport: the least turn that brings the frame to the new axis.
    const glm::dvec3 x = glm::normalize(frame[0] - axis * glm::dot(frame[0], axis));
    frame = glm::dmat3(x, glm::cross(axis, x), axis);
    std::vector<glm::dvec3> ring;
    for (const glm::dvec2& a : around) {
      const glm::dvec3 out = frame[0] * a.x + frame[1] * a.y;
      ring.push_back(points[i] + radius * out);
      vertex(ring.back(), out);
    }
    rings.push_back(std::move(ring));
  }
  for (uint32_t i = 0; i + 1 < n; ++i) {
    for (uint32_t k = 0; k < sides; ++k) {
      const uint32_t a = first + i * sides + k, b = first + i * sides + (k + 1) % sides;
      quad(a, b, b + sides, a + sides);
    }
  }
  for (const bool end : {false, true}) {
    const glm::dvec3 n_cap = end ? direction(n - 2) : -direction(0);
    const auto cap = static_cast<uint32_t>(mesh_.positions.size());
    for (const glm::dvec3& p : end ? rings.back() : rings.front()) vertex(p, n_cap);
    for (uint32_t k = 1; k + 1 < sides; ++k) {
      if (end)
        triangle(cap, cap + k, cap + k + 1);
      else
        triangle(cap, cap + k + 1, cap + k);
    }
  }
}

void Sculptor::extrude(std::span<const glm::dvec2> outer, std::span<const std::vector<glm::dvec2>> holes, double z0,
                       double z1, const glm::u8vec4* top, const glm::u8vec4* bottom) {
  const glm::u8vec4 sides = color_;
  const std::vector<uint32_t> triangles = triangulate(outer, holes);
  std::vector<glm::dvec2> points(outer.begin(), outer.end());
  const auto wall = [&](std::span<const glm::dvec2> loop) {
    for (size_t i = 0; i < loop.size(); ++i) {
      const glm::dvec2 &a = loop[i], &b = loop[(i + 1) % loop.size()];
      flat_quad({a, z0}, {b, z0}, {b, z1}, {a, z1});
    }
  };
  wall(outer);
  for (const std::vector<glm::dvec2>& hole : holes) {
    wall(hole);
    points.insert(points.end(), hole.begin(), hole.end());
  }
  for (const bool up : {false, true}) {
    const glm::u8vec4* own = up ? top : bottom;
    paint(own != nullptr ? *own : sides);
    const auto first = static_cast<uint32_t>(mesh_.positions.size());
    for (const glm::dvec2& p : points) vertex({p, up ? z1 : z0}, {0, 0, up ? 1 : -1});
    for (size_t t = 0; t < triangles.size(); t += 3) {
      const uint32_t a = first + triangles[t], b = first + triangles[t + 1], c = first + triangles[t + 2];
      triangle(a, up ? b : c, up ? c : b);
    }
  }
  paint(sides);
}

void Sculptor::leaf(std::span<const glm::dvec3> points, std::span<const glm::dvec3> side, double thickness) {
  const size_t n = points.size();
  std::vector<glm::dvec3> up(n);
  for (size_t i = 0; i < n; ++i) {
    const glm::dvec3 along = points[std::min(i + 1, n - 1)] - points[i == 0 ? 0 : i - 1];
    const glm::dvec3 across = glm::length(side[i]) > 0 ? side[i] : side[i == 0 ? 1 : n - 2];
    up[i] = glm::normalize(glm::cross(across, along));
  }
  for (const double face : {1.0, -1.0}) {
    std::vector<uint32_t> left(n), rib(n), right(n);
    for (size_t i = 0; i < n; ++i) {
      const bool tip = i == 0 || i + 1 == n;
      const glm::dvec3 half = tip ? glm::dvec3(0) : side[i],
                       bulge = tip ? glm::dvec3(0) : up[i] * (thickness * face / 2);
      left[i] = vertex(points[i] - half, up[i] * face);
      rib[i] = vertex(points[i] + bulge, up[i] * face);
      right[i] = vertex(points[i] + half, up[i] * face);
    }
    for (size_t i = 0; i + 1 < n; ++i) {
      if (face > 0) {
        quad(rib[i], right[i], right[i + 1], rib[i + 1]);
        quad(left[i], rib[i], rib[i + 1], left[i + 1]);
      } else {
        quad(rib[i], rib[i + 1], right[i + 1], right[i]);
        quad(left[i], left[i + 1], rib[i + 1], rib[i]);
      }
    }
  }
}

Mesh Sculptor::take() {
  Mesh mesh = std::move(mesh_);
  mesh_ = {};
  return mesh;
}

}  // namespace promenade
