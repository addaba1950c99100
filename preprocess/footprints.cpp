#include "preprocess/footprints.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <map>

#include "preprocess/plan_polygons.h"
#include "preprocess/weld.h"

namespace promenade {
namespace {

constexpr size_t kMostTriangles = 1 << 16;  // of a solid: more is no block of a building
constexpr int kMostSteps = 8;               // of a tower
constexpr double kAboveBaseM = 0.002;       // where the first plan is taken: within what columns take for closed
constexpr double kClearM = 1e-4;            // planes keep so far from vertices
constexpr double kWithinM = 0.002;          // outlines from the walls, which are rounded
constexpr double kLeastRiseM = 1.5, kLeastStepM = 0.5;
constexpr double kFar = std::numeric_limits<double>::infinity();

/// A triangle with its corners in welded places.
using Corners = std::array<uint32_t, 3>;

/// Every edge goes as often one way as the other: the triangles are a surface without a border, and how often it winds
/// around a point changes only across it.
bool is_closed(std::span<const Corners> triangles) {
  std::vector<std::pair<uint64_t, int>> edges;
  edges.reserve(triangles.size() * 3);
  for (const Corners& corners : triangles)
    for (size_t i = 0; i < 3; ++i) {
      const uint64_t a = corners[i], b = corners[(i + 1) % 3];
      edges.emplace_back(std::min(a, b) << 32U | std::max(a, b), a < b ? 1 : -1);
    }
  std::sort(edges.begin(), edges.end());
  int sum = 0;
  for (size_t i = 0; i < edges.size(); ++i) {
    sum += edges[i].second;
    if ((i + 1 == edges.size() || edges[i + 1].first != edges[i].first) && sum != 0) return false;
  }
  return true;
}

/// Takes out pairs that lie on each other, back to back: walls between solids that touch.
void cancel_pairs(std::vector<Corners>& triangles) {
  struct Face {
    Corners sorted;
    bool turned = false;  ///< an odd order of the sorted ones
    size_t at = 0;
    auto operator<=>(const Face&) const = default;
  };
  std::vector<Face> faces;
  faces.reserve(triangles.size());
  for (size_t t = 0; t < triangles.size(); ++t) {
    Corners c = triangles[t];
    bool turned = false;
    for (const auto& [i, k] : {std::pair<size_t, size_t>(0, 1), {1, 2}, {0, 1}})
      if (c[i] > c[k]) std::swap(c[i], c[k]), turned = !turned;
    faces.push_back({c, turned, t});
  }
  std::sort(faces.begin(), faces.end());
  std::vector<bool> gone(triangles.size(), false);
  for (size_t i = 0; i + 1 < faces.size(); ++i) {
    if (faces[i].sorted != faces[i + 1].sorted || faces[i].turned == faces[i + 1].turned) continue;
    gone[faces[i].at] = gone[faces[i + 1].at] = true;
    ++i;
  }
  size_t kept = 0;
  for (size_t t = 0; t < triangles.size(); ++t)
    if (!gone[t]) triangles[kept++] = triangles[t];
  triangles.resize(kept);
}

class Solid {
 public:
  Solid(const Mesh& mesh, std::span<const Material> materials) {
    const Places places = find_places(mesh.positions);
    points_.reserve(places.count());
    for (const uint32_t v : places.first_vertex) points_.emplace_back(mesh.positions[v]);
    for (size_t t = 0; t < mesh.triangle_count(); ++t) {
      if (materials[mesh.material_of(t)].alpha != AlphaMode::opaque) continue;
      Corners corners{};
      for (size_t i = 0; i < 3; ++i) corners[i] = places.of_vertex[mesh.indices[3 * t + i]];
      if (corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0]) continue;
      triangles_.push_back(corners);
    }
    for (const glm::dvec3& p : points_) heights_.push_back(p.z);
    std::sort(heights_.begin(), heights_.end());
  }

  Footprints run() {
    if (triangles_.empty() || !is_closed(triangles_)) return {};
    cancel_pairs(triangles_);
    double plane = clear_plane(heights_.front() + kAboveBaseM);
    base_m_ = plane;
    double least = base_m_ + kLeastRiseM;
    for (int step = 1; step <= kMostSteps && plane < heights_.back(); ++step) {
      const std::vector<PlanLoops> plans = taken_apart(shrunk(united(slice(plane)), kWithinM));
      std::vector<double> tops;
      double lowest = kFar;
      for (const PlanLoops& plan : plans) {
        tops.push_back(top_of(plan));
        if (tops.back() > plane) lowest = std::min(lowest, tops.back());
      }
      // What is higher goes on in the next plane.
      for (size_t i = 0; i < plans.size(); ++i)
        if (tops[i] >= least && (tops[i] == lowest || step == kMostSteps)) add(plans[i], tops[i]);
      if (lowest == kFar) break;
      plane = clear_plane(lowest + kAboveBaseM);
      if (lowest >= least) least = lowest + kLeastStepM;
    }
    return std::move(made_);
  }

 private:
  /// The lowest height from z on that no vertex is near.
  double clear_plane(double z) const {
    auto next = std::lower_bound(heights_.begin(), heights_.end(), z - kClearM);
    for (; next != heights_.end() && *next <= z + kClearM; ++next) z = *next + 2 * kClearM;
    return z;
  }

  /// Where the surface meets a plane that no vertex lies on: loops with what is solid to their left.
  PlanLoops slice(double z) const {
    struct Way {
      uint64_t to;
      glm::dvec2 from_place;
    };
    std::multimap<uint64_t, Way> ways;
    const auto key = [](uint64_t a, uint64_t b) { return std::min(a, b) << 32U | std::max(a, b); };
    const auto place = [&](uint32_t a, uint32_t b) {
      const glm::dvec3 &p = points_[std::min(a, b)], &q = points_[std::max(a, b)];
      return glm::dvec2(p + (q - p) * ((z - p.z) / (q.z - p.z)));
    };
    for (const Corners& c : triangles_) {
      std::optional<size_t> down, up;
      for (size_t i = 0; i < 3; ++i) {
        const bool from_above = points_[c[i]].z > z, to_above = points_[c[(i + 1) % 3]].z > z;
        if (from_above && !to_above) down = i;
        if (!from_above && to_above) up = i;
      }
      if (!down) continue;
      const uint32_t a = c[*down], b = c[(*down + 1) % 3], d = c[*up], e = c[(*up + 1) % 3];
      ways.emplace(key(a, b), Way{key(d, e), place(a, b)});
    }
    PlanLoops loops;
    while (!ways.empty()) {
      PlanLoop loop;
      for (auto at = ways.begin(); at != ways.end();) {
        const Way way = at->second;
        ways.erase(at);
        loop.push_back(way.from_place);
        at = ways.find(way.to);
      }
      if (loop.size() > 2) loops.push_back(std::move(loop));
    }
    return loops;
  }

  /// The lowest place above the base of what reaches over the plan; below the plan's own base: no prism.
  double top_of(const PlanLoops& plan) const {
    glm::dvec2 low(kFar), high(-kFar);
    for (const PlanLoop& loop : plan)
      for (const glm::dvec2& p : loop) low = glm::min(low, p), high = glm::max(high, p);
    double top = kFar;
    for (const Corners& corners : triangles_) {
      std::array<glm::dvec2, 3> t;
      double from = kFar, to = -kFar;
      glm::dvec2 t_low(kFar), t_high(-kFar);
      for (size_t i = 0; i < 3; ++i) {
        const glm::dvec3& p = points_[corners[i]];
        t[i] = glm::dvec2(p);
        from = std::min(from, p.z), to = std::max(to, p.z);
        t_low = glm::min(t_low, t[i]), t_high = glm::max(t_high, t[i]);
      }
      if (to <= base_m_ || from >= top) continue;
      if (t_high.x < low.x || t_low.x > high.x || t_high.y < low.y || t_low.y > high.y) continue;
      if (overlap(t, plan)) top = from;
    }
    return top;
  }

  static double side(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& p) {
    return (b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x);
  }

  /// Whether two line segments meet; touching counts.
  static bool meet(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c, const glm::dvec2& d) {
    const auto apart = [](double u, double v) { return (u > 0 && v > 0) || (u < 0 && v < 0); };
    if (std::max(a.x, b.x) < std::min(c.x, d.x) || std::max(c.x, d.x) < std::min(a.x, b.x) ||
        std::max(a.y, b.y) < std::min(c.y, d.y) || std::max(c.y, d.y) < std::min(a.y, b.y))
      return false;
    return !apart(side(a, b, c), side(a, b, d)) && !apart(side(c, d, a), side(c, d, b));
  }

  /// Whether a triangle's plan, a line's perhaps, reaches into or over a plan's.
  static bool overlap(const std::array<glm::dvec2, 3>& t, const PlanLoops& plan) {
    if (contains(plan, t[0]) || contains({{t[0], t[1], t[2]}}, plan[0][0])) return true;
    for (const PlanLoop& loop : plan)
      for (size_t i = 0, last = loop.size() - 1; i < loop.size(); last = i++)
        for (size_t k = 0; k < 3; ++k)
          if (meet(t[k], t[(k + 1) % 3], loop[last], loop[i])) return true;
    return false;
  }

  void add(const PlanLoops& plan, double top) {
    for (const PlanLoop& loop : plan) {
      made_.points.insert(made_.points.end(), loop.begin(), loop.end());
      made_.loop_ends.push_back(static_cast<uint32_t>(made_.points.size()));
    }
    made_.all.push_back({static_cast<float>(base_m_), static_cast<float>(top - kWithinM),
                         static_cast<uint32_t>(made_.loop_ends.size())});
  }

  std::vector<glm::dvec3> points_;
  std::vector<Corners> triangles_;
  std::vector<double> heights_;  ///< of all points, ascending
  double base_m_ = 0;
  Footprints made_;
};

}  // namespace

Footprints footprints_of(const Mesh& mesh, std::span<const Material> materials) {
  if (mesh.triangle_count() < 4 || mesh.triangle_count() > kMostTriangles) return {};
  return Solid(mesh, materials).run();
}

std::optional<Footprints> placed(const Footprints& footprints, const glm::dmat4& world_from_mesh) {
  const glm::dmat4& m = world_from_mesh;
  constexpr double kNone = 1e-9;
  const bool upright = std::abs(m[2].x) < kNone && std::abs(m[2].y) < kNone && std::abs(m[0].z) < kNone &&
                       std::abs(m[1].z) < kNone && m[2].z > 0;
  if (!upright || m[0].x * m[1].y - m[0].y * m[1].x <= 0) return std::nullopt;
  Footprints out = footprints;
  for (glm::vec2& p : out.points) p = glm::vec2(m * glm::dvec4(glm::dvec2(p), 0, 1));
  for (Footprint& f : out.all)
    for (float* z : {&f.base_m, &f.top_m}) *z = static_cast<float>(m[2].z * double(*z) + m[3].z);
  return out;
}

}  // namespace promenade
