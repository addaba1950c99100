// Beyond a wall's line, at a depth d, a ray from an eye at a distance e before the line has risen from the wall's top
// by (top - eye) d / e: least, for a top above the eyes, from the farthest eye, and for one below from the nearest; of
// two eyes in the same place of the plan from the higher. So one plane through the wall's top bounds the shadow for all
// eyes, and likewise one upright plane through each of its ends.

#include "preprocess/visibility/cull_map.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <optional>

#include "preprocess/visibility/plan_segments.h"

namespace promenade {
namespace {

constexpr float kNothing = std::numeric_limits<float>::lowest();
constexpr double kLeastM = 1e-3;    // walls nearer to the cell, or shorter, are left out
constexpr double kRoundM = 1e-6;    // of a border of a shadow
constexpr float kRoundUpM = 1e-4F;  // of heights

/// What a point of the plan's depth beyond a line and place along it grow by, from its value at the wall's first end.
struct Linear {
  double base;
  glm::dvec2 slope;
  double at(const glm::dvec2& p) const { return base + glm::dot(slope, p); }
};

std::array<glm::dvec2, 4> corners_of(const Box& box) {
  const glm::dvec2 low(box.min), high(box.max);
  return {low, glm::dvec2(high.x, low.y), high, glm::dvec2(low.x, high.y)};
}

/// The pixels whose middles lie between two values.
std::pair<uint32_t, uint32_t> pixels_between(double low, double high) {
  const double side = CullMap::kSidePx;
  const double first = std::clamp(std::ceil(low - 0.5), 0.0, side),
               end = std::clamp(std::floor(high - 0.5) + 1, 0.0, side);
  return {static_cast<uint32_t>(first), static_cast<uint32_t>(std::max(first, end))};
}

/// Of a polygon the corner where a line touches it that has the polygon and the cell on one side: on the left (1) or on
/// the right (-1) of who looks from the cell.
std::optional<size_t> tangent(std::span<const glm::vec2> polygon, const std::array<glm::dvec2, 4>& cell, double side) {
  for (const glm::dvec2& eye : cell) {
    size_t outer = 0;
    for (size_t i = 1; i < polygon.size(); ++i)
      if (side * cross(glm::dvec2(polygon[outer]) - eye, glm::dvec2(polygon[i]) - eye) > 0) outer = i;
    const glm::dvec2 way = glm::dvec2(polygon[outer]) - eye;
    const auto within = [&](const glm::dvec2& p) { return side * cross(way, p - eye) <= 0; };
    if (std::all_of(cell.begin(), cell.end(), within) &&
        std::all_of(polygon.begin(), polygon.end(), [&](const glm::vec2& p) { return within(glm::dvec2(p)); }))
      return outer;
  }
  return std::nullopt;
}

/// Whether the line between two corners of a polygon lies in it.
bool lies_within(std::span<const glm::vec2> polygon, size_t first, size_t last) {
  const glm::dvec2 a(polygon[first]), b(polygon[last]), middle = (a + b) * 0.5;
  bool inside = false;
  for (size_t i = 0, k = polygon.size() - 1; i < polygon.size(); k = i++) {
    const glm::dvec2 p(polygon[k]), q(polygon[i]);
    if ((p.y > middle.y) != (q.y > middle.y) && middle.x < (q.x - p.x) * (middle.y - p.y) / (q.y - p.y) + p.x)
      inside = !inside;
    if (i == first || i == last || k == first || k == last) continue;
    const bool apart = cross(b - a, p - a) * cross(b - a, q - a) > 0 || cross(q - p, a - p) * cross(q - p, b - p) > 0;
    if (!apart) return false;
  }
  return inside;
}

}  // namespace

void CullMap::reset(const Box& cell, const glm::vec2& low, const glm::vec2& high) {
  cell_ = cell;
  low_ = glm::dvec2(low);
  pixel_m_ = glm::max((glm::dvec2(high) - low_) / double(kSidePx), glm::dvec2(kLeastM));
  heights_.assign(size_t(kSidePx) * kSidePx, kNothing);
}

void CullMap::add_wall(const glm::vec2& a, const glm::vec2& b, float top_m, const Box& clear) {
  if (meets(clear, a, b)) return;
  const glm::dvec2 from(a), along = glm::dvec2(b) - from;
  const double length = glm::length(along);
  if (!(length > kLeastM)) return;
  const glm::dvec2 way = along / length;
  glm::dvec2 towards(-way.y, way.x);  // the cell
  const auto eyes = corners_of(cell_);
  if (glm::dot(towards, eyes[0] - from) < 0) towards = -towards;
  double nearest = INFINITY, farthest = 0, left = -INFINITY, right = INFINITY;  // growth of both ends with the depth
  for (const glm::dvec2& eye : eyes) {
    const double distance = glm::dot(towards, eye - from), place = glm::dot(way, eye - from);
    if (!(distance > kLeastM)) return;
    nearest = std::min(nearest, distance), farthest = std::max(farthest, distance);
    left = std::max(left, -place / distance), right = std::min(right, (length - place) / distance);
  }
  const double rise = double(top_m) - double(cell_.max.z);
  const double climb = rise / (rise > 0 ? farthest : nearest);
  // In pixels, from the map's corner on. What is not negative in all of them lies in the shadow's plan.
  const glm::dvec2 start = (low_ - from);
  const auto linear = [&](const glm::dvec2& slope, double base) {
    return Linear{base + glm::dot(slope, start) - kRoundM, slope * pixel_m_};
  };
  const std::array<Linear, 3> bounds = {linear(-towards, 0), linear(way + towards * left, 0),
                                        linear(-way - towards * right, length)};
  const Linear height{double(top_m) - climb * glm::dot(towards, start), -climb * towards * pixel_m_};
  // The rows that it may reach: its corners, the farther ones where it ends or beyond the map.
  double depth = glm::length(pixel_m_) * kSidePx + glm::length(start + pixel_m_ * double(kSidePx) * 0.5);
  if (left > right) depth = std::min(depth, length / (left - right));
  double lowest = INFINITY, highest = -INFINITY;
  for (const glm::dvec2& corner : {glm::dvec2(0), glm::dvec2(length, 0), glm::dvec2(left * depth, depth),
                                   glm::dvec2(length + right * depth, depth)}) {
    const double y = (from.y + way.y * corner.x - towards.y * corner.y - low_.y) / pixel_m_.y;
    lowest = std::min(lowest, y), highest = std::max(highest, y);
  }
  const auto [first_row, end_row] = pixels_between(lowest - 1, highest + 1);
  const double lower = 0.5 * (std::abs(height.slope.x) + std::abs(height.slope.y));
  for (uint32_t y = first_row; y < end_row; ++y) {
    double low_x = 0, high_x = kSidePx;
    for (const Linear& bound : bounds) {
      // A pixel lies within when its middle does by half of what the bound changes across it.
      const double least = 0.5 * (std::abs(bound.slope.x) + std::abs(bound.slope.y));
      const double here = bound.base + bound.slope.y * (double(y) + 0.5) - least;
      if (std::abs(bound.slope.x) < kRoundM * kRoundM)
        high_x = here >= 0 ? high_x : -1;
      else
        bound.slope.x > 0 ? low_x = std::max(low_x, -here / bound.slope.x)
                          : high_x = std::min(high_x, -here / bound.slope.x);
    }
    const auto [first, end] = pixels_between(low_x, high_x);
    for (uint32_t x = first; x < end; ++x) {
      const double here = height.at({double(x) + 0.5, double(y) + 0.5}) - lower;
      at(x, y) = std::max(at(x, y), static_cast<float>(here) - kRoundUpM);
    }
  }
}

void CullMap::add_solid(std::span<const glm::vec2> polygon, float top_m, const Box& clear) {
  for (size_t i = 0, k = polygon.size() - 1; i < polygon.size(); k = i++)
    add_wall(polygon[k], polygon[i], top_m, clear);
  const auto eyes = corners_of(cell_);
  const std::optional<size_t> left = tangent(polygon, eyes, 1), right = tangent(polygon, eyes, -1);
  if (left && right && *left != *right && lies_within(polygon, *left, *right))
    add_wall(polygon[*left], polygon[*right], top_m, clear);
}

bool CullMap::hides(const Box& box) const {
  const glm::dvec2 low = (glm::dvec2(box.min) - low_) / pixel_m_, high = (glm::dvec2(box.max) - low_) / pixel_m_;
  if (!(low.x >= 0 && low.y >= 0 && high.x < kSidePx && high.y < kSidePx)) return false;
  const auto first_x = static_cast<uint32_t>(low.x), end_x = static_cast<uint32_t>(high.x) + 1;
  const auto first_y = static_cast<uint32_t>(low.y), end_y = static_cast<uint32_t>(high.y) + 1;
  for (uint32_t y = first_y; y < end_y; ++y) {
    const float* row = heights_.data() + size_t(y) * kSidePx;
    if (std::any_of(row + first_x, row + end_x, [&](float height) { return height < box.max.z; })) return false;
  }
  return true;
}

}  // namespace promenade
