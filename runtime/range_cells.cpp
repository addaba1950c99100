#include "runtime/range_cells.h"

#include <algorithm>
#include <array>
#include <glm/geometric.hpp>
#include <map>
#include <queue>

namespace promenade {
namespace {

constexpr std::array<std::pair<RangeCull, std::string_view>, 3> kNames = {
    {{RangeCull::any, "any"}, {RangeCull::plane, "plane"}, {RangeCull::direction, "direction"}}};

/// The part of a box that is nearest to a point.
glm::dvec3 nearest_in(const Box& box, const glm::dvec3& point) {
  return glm::clamp(point, glm::dvec3(box.min), glm::dvec3(box.max));
}

bool ray_meets(const Box& box, const glm::dvec3& from, const glm::dvec3& along) {
  double enter = 0, leave = 1e30;
  for (int axis = 0; axis < 3; ++axis) {
    const double least = double(box.min[axis]) - from[axis], most = double(box.max[axis]) - from[axis];
    if (along[axis] == 0) {
      if (least > 0 || most < 0) return false;
      continue;
    }
    const double a = least / along[axis], b = most / along[axis];
    enter = std::max(enter, std::min(a, b));
    leave = std::min(leave, std::max(a, b));
  }
  return enter <= leave;
}

/// Whether the cull lets a cell count. A standing eye may go anywhere.
bool passes(const Box& box, const glm::dvec3& eye, const glm::dvec3& velocity, RangeCull cull) {
  if (cull == RangeCull::any || glm::dot(velocity, velocity) == 0) return true;
  if (cull == RangeCull::direction) return ray_meets(box, eye, velocity);
  glm::dvec3 foremost;  // the corner farthest along the movement
  for (int axis = 0; axis < 3; ++axis) foremost[axis] = double(velocity[axis] > 0 ? box.max[axis] : box.min[axis]);
  return glm::dot(foremost - eye, velocity) >= 0;
}

}  // namespace

std::string_view name_of(RangeCull cull) {
  for (const auto& [known, name] : kNames)
    if (known == cull) return name;
  return "";
}

std::optional<RangeCull> range_cull_named(std::string_view name) {
  for (const auto& [cull, known] : kNames)
    if (known == name) return cull;
  return std::nullopt;
}

std::vector<RangeCell> range_cells(const CellTables& tables, CellId cell, const glm::dvec3& eye,
                                   const glm::dvec3& velocity_m_per_s, const RangeOptions& options) {
  const double speed = std::max(glm::length(velocity_m_per_s), options.least_speed_m);
  struct Reached {
    double seconds;
    CellId cell;
    glm::dvec3 at;  ///< where the way enters it
    bool operator<(const Reached& other) const {
      return seconds != other.seconds ? seconds > other.seconds : cell > other.cell;
    }
  };
  std::vector<RangeCell> range;
  std::map<CellId, double> settled;
  std::priority_queue<Reached> queue;
  queue.push({0, cell, eye});
  while (!queue.empty() && range.size() < options.most_cells) {
    const Reached here = queue.top();
    queue.pop();
    if (!settled.emplace(here.cell, here.seconds).second) continue;
    if (here.cell != cell) range.push_back({here.cell, here.seconds});
    for (const uint32_t index : tables.faces_of(here.cell)) {
      const CellFace& face = tables.faces[index];
      const CellId next = face.other(here.cell);
      if (settled.contains(next) || !passes(tables.cells[index_of(next)].box, eye, velocity_m_per_s, options.cull))
        continue;
      for (const Box& portal : tables.portals_of(face)) {
        const glm::dvec3 at = nearest_in(portal, here.at);
        const double seconds = here.seconds + glm::distance(here.at, at) / speed;
        if (seconds <= options.horizon_s) queue.push({seconds, next, at});
      }
    }
  }
  return range;
}

}  // namespace promenade
