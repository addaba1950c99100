#include "datasets/city_path.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <vector>

#include "datasets/city_block.h"

namespace promenade {
namespace {

constexpr double kWalkMps = 1.4;
constexpr double kWalkEyeM = 1.7;
constexpr double kLongestWalkM = 420;  // five minutes
constexpr double kDriveMps = 100 / 3.6;
constexpr double kDriveEyeM = 1.4;
constexpr double kLongestDriveM = 5000;  // three minutes
constexpr double kFlyMps = 40;
constexpr double kLongestFlightS = 120;
constexpr double kTurnDegPerS = 70;   // standing at a corner
constexpr double kCornerCutM = 0.8;   // nobody walks to a corner's very point
constexpr double kSharpTurnDeg = 20;  // a smaller one is taken while moving

struct Motion {
  double speed_mps = 1, eye_z_m = 0, pitch_deg = 0;
};

/// Through the points, looking ahead.
CameraPath path_along(const std::vector<glm::dvec2>& points, const Motion& motion) {
  CameraPath path;
  double t_s = 0, yaw_deg = 0;
  const auto key = [&](const glm::dvec2& p, double yaw) {
    path.keys.push_back({t_s, {{p, motion.eye_z_m}, yaw, motion.pitch_deg, 0}});
  };
  for (size_t i = 0; i < points.size(); ++i) {
    const bool last = i + 1 == points.size();
    const glm::dvec2 way = last ? points[i] - points[i - 1] : points[i + 1] - points[i];
    const double heading = glm::degrees(std::atan2(way.y, way.x));
    const double turn = i == 0 ? 0 : std::remainder(heading - yaw_deg, 360.0);
    if (i == 0) yaw_deg = heading;
    if (std::abs(turn) > kSharpTurnDeg) {
      key(points[i], yaw_deg);
      t_s += std::abs(turn) / kTurnDegPerS;
      yaw_deg += turn;
      key(points[i], yaw_deg);
    } else {
      key(points[i], yaw_deg + turn / 2);
      yaw_deg += turn;
    }
    if (!last) t_s += glm::length(way) / motion.speed_mps;
  }
  return path;
}

/// The walking line along one side of a block, from corner to corner.
void add_side(const CityPlan& plan, uint32_t x, uint32_t y, size_t side, std::vector<glm::dvec2>& points) {
  const PlanRect block = plan.block(x, y);
  const std::array<glm::dvec2, 4> corners = {
      block.low, {block.high.x, block.low.y}, block.high, {block.low.x, block.high.y}};
  const glm::dvec2 from = corners[side], to = corners[(side + 1) % 4], way = glm::normalize(to - from);
  const double in_m = walking_line_m(plan.options());
  const double length = glm::distance(from, to), ends = std::min(in_m + kCornerCutM, length / 3);
  const auto count = static_cast<int>(std::max(2.0, std::ceil(length / 4)));
  for (int k = 0; k <= count; ++k) {
    const double share = static_cast<double>(k) / count;
    const glm::dvec2 p = from + way * (ends + (length - 2 * ends) * share);
    const glm::dvec2 along = plan.direction(p, way);
    points.push_back(plan.world(p) + glm::dvec2(-along.y, along.x) * in_m);
  }
}

}  // namespace

CameraPath walk_through(const CityPlan& plan) {
  const uint32_t y = plan.blocks_y() / 2, first = plan.blocks_x() / 2;
  const double pitch = plan.options().block_length_m + plan.options().street_width_m;
  const auto wish = static_cast<uint32_t>(std::clamp(kLongestWalkM / 2 / pitch, 1.0, 1e6));
  const uint32_t count = std::min(wish, plan.blocks_x() - first);
  std::vector<glm::dvec2> points;
  // Eastwards on the southern pavements, around the last block's corners, and back on the northern ones.
  for (uint32_t k = 0; k < count; ++k) add_side(plan, first + k, y, 0, points);
  add_side(plan, first + count - 1, y, 1, points);
  for (uint32_t k = count; k-- > 0;) add_side(plan, first + k, y, 2, points);
  add_side(plan, first, y, 3, points);
  const double floor_m = plan.options().street_height_m + plan.options().curb_height_m;
  return path_along(points, {kWalkMps, floor_m + kWalkEyeM, 0});
}

CameraPath drive_through(const CityPlan& plan) {
  const uint32_t y = plan.blocks_y() / 2;
  const double lane_m = std::min(2.4, plan.options().street_width_m / 4);
  // Traffic keeps to the right; the first street has only its northern half.
  const double v = plan.cell(0, y).low.y + (y == 0 ? lane_m : -lane_m);
  const double middle = plan.size().x / 2, half = std::min(plan.size().x, kLongestDriveM) / 2 - 4;
  const double from = y == 0 ? middle + half : middle - half, to = 2 * middle - from;
  return path_along(plan.line({from, v}, {to, v}, 6), {kDriveMps, plan.options().street_height_m + kDriveEyeM, 0});
}

CameraPath fly_over(const CityPlan& plan) {
  const glm::dvec2 size = plan.size();
  const double height_m =
      plan.options().street_height_m + plan.options().curb_height_m + 1.5 * plan.options().max_height_m;
  std::vector<glm::dvec2> points;
  constexpr int kPoints = 64;
  for (int k = 0; k <= kPoints; ++k) {
    const double t = static_cast<double>(k) / kPoints;
    points.push_back(size * glm::dvec2(t - 0.5, 0.14 * std::sin(6.283185307179586 * t)));
  }
  return path_along(points, {std::max(kFlyMps, size.x / kLongestFlightS), height_m, -25});
}

}  // namespace promenade
