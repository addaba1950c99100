#include "preprocess/visibility/line_beam.h"

#include <algorithm>
#include <cmath>

namespace promenade {
namespace {

constexpr double kHairM = 1e-6;      // roundings fall on the side of what is seen
constexpr double kLeastArea = 1e-9;  // added to areas, so that products tell thin ones apart

double cross(const glm::dvec2& a, const glm::dvec2& b) { return a.x * b.y - a.y * b.x; }

}  // namespace

LineSector::LineSector(uint32_t number, const glm::dvec3& about) : main(static_cast<int>(number % 3)), origin(about) {
  for (int axis = 0; axis < 3; ++axis) sign[axis] = ((number / 3) >> static_cast<uint32_t>(axis) & 1U) != 0 ? -1 : 1;
}

DBox LineSector::placed(const DBox& box) const {
  const glm::dvec3 a = (box.min - origin) * sign, b = (box.max - origin) * sign;
  return {glm::min(a, b), glm::max(a, b)};
}

LinePolygon::LinePolygon(double t0, double t1, double x0, double x1) {
  corners_[0] = {0, x0 - kHairM}, corners_[1] = {1, x0 - t1 - kHairM};
  corners_[2] = {1, x1 - t0 + kHairM}, corners_[3] = {0, x1 + kHairM};
  count_ = 4;
}

/// Keeps the lines that pass at or below (side 1), or at or above (side -1), the point (t, x).
void LinePolygon::keep(double t, double x, double side) {
  std::array<glm::dvec2, 2 * kMostCorners> kept;  // rounding leaves polygons that a line may cut more than twice
  uint32_t count = 0;
  const auto over = [&](const glm::dvec2& line) { return side * (line.x * t + line.y - x) - kHairM; };
  bool cut = false;
  for (uint32_t i = 0; i < count_; ++i) {
    const glm::dvec2 &a = corners_[i], &b = corners_[i + 1 == count_ ? 0 : i + 1];
    const double over_a = over(a), over_b = over(b);
    if (over_a <= 0) kept[count++] = a;
    cut |= over_a > 0;
    if ((over_a <= 0) != (over_b <= 0)) kept[count++] = a + (b - a) * (over_a / (over_a - over_b));
  }
  if (!cut || count > kMostCorners) return;  // too many corners: the larger set is sound, too
  std::copy_n(kept.begin(), count, corners_.begin());
  count_ = count;
}

void LinePolygon::keep_touching(double t0, double t1, double x0, double x1) {
  keep(t0, x1, 1);
  keep(t1, x0, -1);
}

bool LinePolygon::touches(double t0, double t1, double x0, double x1) const {
  uint32_t too_high = 0, too_low = 0;
  for (uint32_t i = 0; i < count_; ++i) {
    const bool high = corners_[i].x * t0 + corners_[i].y > x1 + kHairM;
    const bool low = corners_[i].x * t1 + corners_[i].y < x0 - kHairM;
    if (!high && !low) return true;
    too_high += high ? 1U : 0U, too_low += low ? 1U : 0U;
  }
  if (too_high == count_ || too_low == count_) return false;
  LinePolygon left = *this;
  left.keep_touching(t0, t1, x0, x1);
  return !left.empty();
}

void LinePolygon::add(const LinePolygon& other) {
  std::array<glm::dvec2, 2 * kMostCorners> all;
  uint32_t count = 0;
  for (const LinePolygon* polygon : {static_cast<const LinePolygon*>(this), &other})
    for (uint32_t i = 0; i < polygon->count_; ++i) all[count++] = polygon->corners_[i];
  const auto end = all.begin() + count;
  std::sort(all.begin(), end,
            [](const glm::dvec2& a, const glm::dvec2& b) { return a.x != b.x ? a.x < b.x : a.y < b.y; });
  std::array<glm::dvec2, 4 * kMostCorners> hull;
  uint32_t size = 0, least = 2;
  const auto put = [&](const glm::dvec2& p) {
    while (size >= least && cross(hull[size - 1] - hull[size - 2], p - hull[size - 2]) <= 0) --size;
    hull[size++] = p;
  };
  for (uint32_t i = 0; i < count; ++i) put(all[i]);
  least = size + 1;
  for (uint32_t i = count > 0 ? count - 1 : 0; i-- > 0;) put(all[i]);
  if (size > 1) --size;  // the first again
  if (size <= kMostCorners) {
    std::copy_n(hull.begin(), size, corners_.begin());
    count_ = size;
    return;
  }
  glm::dvec2 low = hull[0], high = hull[0];
  for (uint32_t i = 1; i < size; ++i) low = glm::min(low, hull[i]), high = glm::max(high, hull[i]);
  corners_[0] = low, corners_[1] = {high.x, low.y}, corners_[2] = high, corners_[3] = {low.x, high.y};
  count_ = 4;
}

bool LinePolygon::contains(const LinePolygon& other) const {
  if (area() < 4 * kLeastArea) return false;  // all but a line: no inside to speak of
  for (uint32_t i = 0; i < count_; ++i) {
    const glm::dvec2 &a = corners_[i], &b = corners_[i + 1 == count_ ? 0 : i + 1];
    for (uint32_t k = 0; k < other.count_; ++k)
      if (cross(b - a, other.corners_[k] - a) < 0) return false;
  }
  return true;
}

double LinePolygon::area() const {
  double twice = 0;
  for (uint32_t i = 2; i < count_; ++i) twice += cross(corners_[i - 1] - corners_[0], corners_[i] - corners_[0]);
  return twice / 2 + kLeastArea;
}

LineBeam::LineBeam(const LineSector& sector, const DBox& from) : main_(sector.main) {
  for (int i = 0; i < 2; ++i) {
    const int axis = (main_ + 1 + i) % 3;
    across_[static_cast<size_t>(i)] = LinePolygon(from.min[main_], from.max[main_], from.min[axis], from.max[axis]);
  }
}

void LineBeam::keep_touching(const DBox& box) {
  for (int i = 0; i < 2; ++i) {
    const int axis = (main_ + 1 + i) % 3;
    across_[static_cast<size_t>(i)].keep_touching(box.min[main_], box.max[main_], box.min[axis], box.max[axis]);
  }
}

bool LineBeam::touches(const DBox& box) const {
  for (int i = 0; i < 2; ++i) {
    const int axis = (main_ + 1 + i) % 3;
    if (!across_[static_cast<size_t>(i)].touches(box.min[main_], box.max[main_], box.min[axis], box.max[axis]))
      return false;
  }
  return true;
}

void LineBeam::add(const LineBeam& other) {
  across_[0].add(other.across_[0]);
  across_[1].add(other.across_[1]);
}

bool LineBeam::contains(const LineBeam& other) const {
  return across_[0].contains(other.across_[0]) && across_[1].contains(other.across_[1]);
}

}  // namespace promenade
