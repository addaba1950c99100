#include "datasets/building_walk.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <glm/vec3.hpp>

namespace promenade {

namespace {

using glm::dvec3;

constexpr double kSpeedMPerS = 1.4, kEyeM = 1.65;
constexpr double kTurnDegPerS = 60;
constexpr double kCornerM = 0.6;     // corners are cut from so far before to so far behind
constexpr double kStepM = 0.4;       // between keys
constexpr double kLookAheadM = 0.9;  // the head turns towards where the feet will be
constexpr double kRingM = 7.9;       // the ring corridors' middle, from the facade

/// Polyline with its corners rounded by parabolas.
std::vector<dvec3> rounded(const std::vector<dvec3>& corners) {
  std::vector<dvec3> points{corners.front()};
  for (size_t i = 1; i + 1 < corners.size(); ++i) {
    const dvec3 before = corners[i - 1] - corners[i], after = corners[i + 1] - corners[i];
    const double a = std::min(kCornerM, glm::length(before) / 2), b = std::min(kCornerM, glm::length(after) / 2);
    const dvec3 p = corners[i] + glm::normalize(before) * a, q = corners[i] + glm::normalize(after) * b;
    for (int k = 0; k <= 6; ++k) {
      const double u = k / 6.0;
      points.push_back(p * (1 - u) * (1 - u) + corners[i] * 2.0 * u * (1 - u) + q * u * u);
    }
  }
  points.push_back(corners.back());
  return points;
}

/// Points `kStepM` apart along a polyline, both ends included.
std::vector<dvec3> resampled(const std::vector<dvec3>& points) {
  std::vector<double> at{0};
  for (size_t i = 1; i < points.size(); ++i) at.push_back(at.back() + glm::length(points[i] - points[i - 1]));
  const int steps = std::max(1, static_cast<int>(std::lround(at.back() / kStepM)));
  std::vector<dvec3> result;
  size_t i = 1;
  for (int k = 0; k <= steps; ++k) {
    const double s = at.back() * k / steps;
    while (i + 1 < points.size() && at[i] < s) ++i;
    const double length = at[i] - at[i - 1];
    result.push_back(length > 0 ? points[i - 1] + (points[i] - points[i - 1]) * ((s - at[i - 1]) / length) : points[i]);
  }
  return result;
}

class Walker {
 public:
  explicit Walker(const BuildingPlan& plan) : plan_(plan) {}

  void to(double x, double y, double floor_z) { leg_.emplace_back(x, y, floor_z + kEyeM); }
  void to(double x, double y) { to(x, y, floor_ * kStoreyM); }
  void enter_floor(uint32_t floor) { floor_ = floor; }
  uint32_t floor() const { return floor_; }

  /// Ends the leg and looks to the side, counter-clockwise.
  void look(double degrees) {
    finish_leg();
    turn_to(path_.keys.back().pose.yaw_deg + degrees);
  }

  /// From the corridor through the door to `depth_m` into the room and `aside_m` to the right, a look around, and back.
  void visit(const Room* room, double depth_m, double aside_m = 0) {
    if (room == nullptr) return;
    const RoomFrame frame = frame_of(*room);
    const auto at = [&](double u, double v) {
      const dvec3 p = frame.world_from_room * glm::dvec4(u, v, 0, 1);
      to(p.x, p.y, p.z);
    };
    const bool right = frame.door_u < frame.width_m / 2;  // the room's larger part
    const double u = frame.door_u;
    at(u, -1.4), at(u, 0.5), at(u + aside_m, depth_m);
    look(right ? -65 : 65), look(right ? -65 : 65);
    at(u + aside_m, depth_m), at(u, 0.5), at(u, -1.4);
    finish_leg();
    at(u, -1.4);
  }

  /// The room of a kind on this floor whose open door is nearest to (x, y).
  const Room* nearest(RoomKind kind, glm::dvec2 to) const {
    const Room* best = nullptr;
    double least = 1e300;
    for (const Room& room : plan_.rooms) {
      if (room.kind != kind || room.floor != floor_ || room.door_closed || room.door_width_m == 0) continue;
      const dvec3 door = frame_of(room).world_from_room * glm::dvec4(frame_of(room).door_u, 0, 0, 1);
      const double distance = glm::length(glm::dvec2(door) - to);
      if (distance < least) least = distance, best = &room;
    }
    return best;
  }

  /// Up one storey; ends in the corridor in front of the stairwell there.
  void climb(bool west) {
    const Room* stairs = nearest(RoomKind::stairwell, {west ? 0 : kWidthM, 0});
    const glm::dvec2 low = stairs->min + kWallHalfM, high = stairs->max - kWallHalfM;
    const double middle = (low.x + high.x) / 2, left = low.x + kFlightWidthM / 2, right = high.x - kFlightWidthM / 2;
    const double z = floor_ * kStoreyM, half = z + kStoreyM / 2, top = z + kStoreyM;
    const double y0 = low.y + kLandingM, y1 = y0 + kTreads * kTreadM;
    to(middle, kRingM, z), to(middle, low.y + 0.2, z), to(left, y0 - 0.55, z), to(left, y0, z), to(left, y1, half);
    to(left, y1 + 0.75, half), to(right, y1 + 0.75, half), to(right, y1, half), to(right, y0, top);
    to(right, y0 - 0.55, top), to(middle, low.y + 0.2, top);
    enter_floor(floor_ + 1);
    to(middle, kRingM);
  }

  /// Up the auditorium's left aisle to the corridor above.
  void climb_auditorium() {
    const Room* hall = nearest(RoomKind::auditorium, {0, 0});
    const RoomFrame below = frame_of(*hall);
    const glm::dvec2 low = hall->min + kWallHalfM;
    const double aisle = low.x + kAisleM / 2, foot = low.y + kFrontRowM - kRowDepthM / 2;
    const double head = foot + kRows * kRowDepthM;
    to(hall->door_at, kRingM), to(hall->door_at, low.y + 0.6);
    look(35);
    to(hall->door_at, low.y + 0.6), to(low.x + below.door_u * 0.7, low.y + 1.6), to(aisle, foot - 0.3), to(aisle, foot),
        to(aisle, head, kStoreyM);
    to(aisle, head + 0.5, kStoreyM);
    look(-150);
    enter_floor(1);
    const Room* upper = nearest(RoomKind::auditorium, {0, kDepthM});
    to(aisle, head + 0.5), to(upper->door_at, upper->max.y - 0.6), to(upper->door_at, kDepthM - kRingM);
  }

  CameraPath take() {
    finish_leg();
    return std::move(path_);
  }

 private:
  void key(const dvec3& eye, double yaw, double pitch) { path_.keys.push_back({time_, {eye, yaw, pitch, 0}}); }

  /// The same direction as `yaw`, by the shortest turn from where the head is.
  double unwound(double yaw) const {
    if (path_.keys.empty()) return yaw;
    const double now = path_.keys.back().pose.yaw_deg;
    return yaw + 360 * std::round((now - yaw) / 360);
  }

  void turn_to(double yaw) {
    const Pose now = path_.keys.back().pose;
    const double angle = std::abs(yaw - now.yaw_deg);
    if (angle < 1) return;
    time_ += std::max(0.25, angle / kTurnDegPerS);
    key(now.eye, yaw, 0);
  }

  void finish_leg() {
    std::vector<dvec3> corners;
    for (const dvec3& p : leg_) {
      if (corners.empty() || glm::length(p - corners.back()) > 0.02) corners.push_back(p);
    }
    leg_.clear();
    if (corners.size() < 2) return;
    const std::vector<dvec3> points = resampled(rounded(corners));
    const auto ahead = static_cast<size_t>(std::lround(kLookAheadM / kStepM));
    const auto heading = [&](size_t i) {
      const dvec3 d = points[std::min(i + ahead, points.size() - 1)] - points[i];
      return glm::length(glm::dvec2(d)) > 1e-3 ? d : points[i] - points[i - 1];
    };
    for (size_t i = 0; i < points.size(); ++i) {
      const dvec3 d = heading(i);
      const double yaw = unwound(glm::degrees(std::atan2(d.y, d.x)));
      const double pitch = 0.5 * glm::degrees(std::atan2(d.z, glm::length(glm::dvec2(d))));
      if (i == 0 && path_.keys.empty()) key(points[0], yaw, pitch);
      if (i == 0) turn_to(yaw);
      if (i == 0) continue;
      time_ += glm::length(points[i] - points[i - 1]) / kSpeedMPerS;
      key(points[i], yaw, pitch);
    }
  }

  const BuildingPlan& plan_;
  CameraPath path_;
  std::vector<dvec3> leg_;
  double time_ = 0;
  uint32_t floor_ = 0;
};

constexpr double kBranchM = kWidthM / 2, kEastM = kWidthM - kRingM, kNorthM = kDepthM - kRingM;

void walk_ground_floor(Walker& w, bool auditorium) {
  w.to(kBranchM, -16), w.to(kBranchM, -1), w.to(kBranchM, 3.6);
  w.look(40), w.look(-80);
  w.to(kBranchM, 3.6), w.to(kBranchM, kRingM);
  w.visit(w.nearest(RoomKind::laboratory, {kEastM, kRingM}), 4.5);
  if (auditorium) return;
  w.to(kEastM, kRingM), w.to(kEastM, kNorthM), w.to(kRingM, kNorthM);
  w.visit(w.nearest(RoomKind::office, {kRingM, kDepthM / 2}), 1.9);
}

void walk_library_floor(Walker& w) {
  w.to(kRingM, kNorthM), w.to(kRingM, kRingM);
  w.visit(w.nearest(RoomKind::library, {kBranchM, kRingM}), 2.2);
}

/// From the eastern stairs (even floors) or the western ones to the others, by the branch.
void walk_office_floor(Walker& w) {
  const bool eastern = w.floor() % 2 == 0;
  const double aside = eastern ? 10 : -10, end = eastern ? kRingM : kEastM;
  w.visit(w.nearest(RoomKind::office, {kBranchM + aside, kRingM}), 1.9);
  w.to(kBranchM, kRingM), w.to(kBranchM, kNorthM);
  const Room* lab = w.nearest(RoomKind::laboratory, {end, kNorthM});
  const bool deep = lab != nullptr && w.floor() == 2;
  w.visit(deep ? lab : w.nearest(RoomKind::office, {kBranchM - aside, kNorthM}), deep ? 5.0 : 1.9);
  w.to(end, kNorthM), w.to(end, kRingM);
}

}  // namespace

CameraPath walk_building(const BuildingPlan& plan) {
  Walker walker(plan);
  walk_ground_floor(walker, plan.floors > 1);
  if (plan.floors > 1) {
    walker.climb_auditorium();
    walk_library_floor(walker);
  }
  for (uint32_t floor = 2; floor < plan.floors; ++floor) {
    walker.climb(floor % 2 != 0);
    walk_office_floor(walker);
  }
  return walker.take();
}

}  // namespace promenade
