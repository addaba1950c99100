#include "preprocess/visibility/box_view.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace promenade {
namespace {

constexpr double kFar = std::numeric_limits<double>::infinity();
constexpr double kHair = 1e-9;  // of a picture's side: roundings fall on the side of what is seen

constexpr double kFlat = 1e-5;  // a slope along a row: below, where it is passed is uncertain

/// Between its ends; empty when the first is above the second.
struct Range {
  double low, high;
  bool empty() const { return !(low <= high); }
};

double at_px(double px) { return px * (2.0 / BoxView::kSidePx) - 1; }

/// The s in a range for which some value of [a0 s, a1 s] lies in [low, high].
Range kept(Range s, double a0, double a1, double low, double high) {
  const auto at_most = [&s](double a, double bound) {  // a s <= bound
    if (a > 0)
      s.high = std::min(s.high, bound / a);
    else if (a < 0)
      s.low = std::max(s.low, bound / a);
    else if (bound < 0)
      s.low = kFar;
  };
  at_most(a0, high);
  at_most(-a1, -low);
  return s;
}

/// All of [a0 s, a1 s] for s in a range.
Range across(const Range& s, double a0, double a1) {
  return {std::min(a0 * s.low, a0 * s.high), std::max(a1 * s.low, a1 * s.high)};
}

/// A ray at u is in the box's slab [a0, a1] from 1 / this on.
double entry(double u, double a0, double a1) { return a0 > 0 ? u / a0 : a1 < 0 ? u / a1 : kFar; }

/// The pixels that lie wholly in a range, or those that it touches: first and end.
std::pair<int, int> inner(const Range& u) {
  const double half = BoxView::kSidePx / 2.0;
  const double low = std::ceil((u.low + kHair + 1) * half), high = std::floor((u.high - kHair + 1) * half);
  return {static_cast<int>(std::clamp(low, 0.0, double(BoxView::kSidePx))),
          static_cast<int>(std::clamp(high, 0.0, double(BoxView::kSidePx)))};
}
std::pair<int, int> outer(const Range& u) {
  const double half = BoxView::kSidePx / 2.0;
  const double low = std::floor((u.low - kHair + 1) * half), high = std::floor((u.high + kHair + 1) * half) + 1;
  return {static_cast<int>(std::clamp(low, 0.0, double(BoxView::kSidePx))),
          static_cast<int>(std::clamp(high, 0.0, double(BoxView::kSidePx)))};
}

}  // namespace

BoxView::BoxView() {
  for (std::vector<float>& face : nearness_) face.resize(size_t(kSidePx) * kSidePx);
}

void BoxView::reset(const glm::dvec3& eye) { eye_ = eye, wanted_ = 0; }

void BoxView::want(const Box& box) {
  Placed placed;
  for (uint32_t face = 0; face < kFaces; ++face) {
    if ((wanted_ >> face & 1U) != 0 || !place(box, face, placed)) continue;
    wanted_ |= 1U << face;
    std::fill(nearness_[face].begin(), nearness_[face].end(), 0.0F);
  }
}

bool BoxView::place(const Box& box, uint32_t face, Placed& placed) const {
  const int axis = static_cast<int>(face / 2), u = (axis + 1) % 3, v = (axis + 2) % 3;
  const glm::dvec3 low = glm::dvec3(box.min) - eye_, high = glm::dvec3(box.max) - eye_;
  const bool down = face % 2 != 0;
  const double near_m = std::max(down ? -high[axis] : low[axis], kNearM), far_m = down ? -low[axis] : high[axis];
  if (far_m <= near_m) return false;
  placed = {1 / near_m, 1 / far_m, low[u], high[u], low[v], high[v]};
  const Range s{placed.far_s, placed.near_s};
  const Range over = across(s, placed.u0, placed.u1), up = across(s, placed.v0, placed.v1);
  return over.low <= 1 && over.high >= -1 && up.low <= 1 && up.high >= -1;
}

void BoxView::draw(const Placed& box, std::vector<float>& nearness) const {
  const Range s{box.far_s, box.near_s};
  const auto [first, end] = inner(across(s, box.v0, box.v1));
  for (int row = first; row < end; ++row) {
    // Both borders of the row; the picture is convex, so what lies between lies in it.
    const double below = at_px(row), above = at_px(row + 1);
    const Range at_below = kept(s, box.v0, box.v1, below, below), at_above = kept(s, box.v0, box.v1, above, above);
    if (at_below.empty() || at_above.empty()) continue;
    const Range a = across(at_below, box.u0, box.u1), b = across(at_above, box.u0, box.u1);
    const auto [left, right] = inner({std::max(a.low, b.low), std::min(a.high, b.high)});
    const double cap = std::min({box.near_s, entry(below, box.v0, box.v1), entry(above, box.v0, box.v1)}) * (1 - 1e-6);
    float* out = nearness.data() + size_t(row) * kSidePx;
    const bool aside = box.u0 > 0 || box.u1 < 0;
    for (int x = left; x < right; ++x) {
      double here = cap;
      if (aside) here = std::min(here, entry(at_px(box.u0 > 0 ? x : x + 1), box.u0, box.u1) * (1 - 1e-6));
      out[x] = std::max(out[x], static_cast<float>(here));
    }
  }
}

void BoxView::draw(const BoxShadow& shadow, uint32_t face) {
  const int axis = static_cast<int>(face / 2);
  // Along (±1, u, v) something grows by this much a unit of depth.
  struct Growth {
    double middle, by_u, by_v;
    double least() const { return middle - std::abs(by_u) - std::abs(by_v); }  // on the face
  };
  const auto growth = [&](const glm::dvec3& normal) {
    return Growth{face % 2 != 0 ? -normal[axis] : normal[axis], normal[(axis + 1) % 3], normal[(axis + 2) % 3]};
  };
  // Along the rays of the shadow no side grows. Those across an axis of the face bound a rectangle.
  Range columns{-kFar, kFar}, rows{-kFar, kFar};
  std::array<Growth, BoxShadow::kMostSides> slanted;
  size_t slanted_count = 0;
  for (const HalfSpace& side : shadow.sides()) {
    const Growth g = growth(side.normal);
    if (!(g.least() < 0)) return;
    if (g.by_u != 0 && g.by_v != 0)
      slanted[slanted_count++] = g;
    else if (g.by_u != 0)
      g.by_u > 0 ? columns.high = std::min(columns.high, -g.middle / g.by_u)
                 : columns.low = std::max(columns.low, -g.middle / g.by_u);
    else if (g.by_v != 0)
      g.by_v > 0 ? rows.high = std::min(rows.high, -g.middle / g.by_v)
                 : rows.low = std::max(rows.low, -g.middle / g.by_v);
  }
  if (columns.empty() || rows.empty()) return;
  // A plane of the solid's nearer side is passed from 1 / (growth / left) on; where left is not below 0 the eye is
  // beyond it, and must not come back.
  struct Front {
    Growth growth;
    double left;
  };
  std::array<Front, 6> fronts;
  const size_t front_count = shadow.fronts().size();
  for (size_t i = 0; i < front_count; ++i) {
    const HalfSpace& front = shadow.fronts()[i];
    fronts[i] = {growth(front.normal), front.offset - glm::dot(front.normal, eye_)};
    if (!(fronts[i].growth.least() < 0)) return;
  }
  const auto [first, end] = inner(rows);
  for (int row = first; row < end; ++row) {
    const double below = at_px(row), above = at_px(row + 1);
    Range over = columns;
    for (size_t i = 0; i < slanted_count; ++i) {
      const Growth& g = slanted[i];
      const double most = g.middle + std::max(g.by_v * below, g.by_v * above);
      if (std::abs(g.by_u) < kFlat)
        over.low = most + std::abs(g.by_u) > 0 ? kFar : over.low;
      else
        g.by_u > 0 ? over.high = std::min(over.high, -most / g.by_u) : over.low = std::max(over.low, -most / g.by_u);
    }
    if (over.empty()) continue;
    const auto [left, right] = inner(over);
    float* out = nearness_[face].data() + size_t(row) * kSidePx;
    for (int x = left; x < right; ++x) {
      double here = 1 / kNearM;
      for (size_t i = 0; i < front_count; ++i) {
        const Growth& g = fronts[i].growth;
        const double most =
            g.middle + std::max(g.by_u * at_px(x), g.by_u * at_px(x + 1)) + std::max(g.by_v * below, g.by_v * above);
        here = std::min(here, most > 0 ? 0 : fronts[i].left < 0 ? most / fronts[i].left : here);
      }
      out[x] = std::max(out[x], static_cast<float>(here * (1 - 1e-6)));
    }
  }
}

bool BoxView::blocks(const Placed& box, const std::vector<float>& nearness) const {
  const Range s{box.far_s, box.near_s};
  const auto [first, end] = outer(across(s, box.v0, box.v1));
  for (int row = first; row < end; ++row) {
    const double below = at_px(row), above = at_px(row + 1);
    const Range here = kept(s, box.v0, box.v1, below - kHair, above + kHair);
    if (here.empty()) continue;
    const auto [left, right] = outer(across(here, box.u0, box.u1));
    const double row_s = std::max(entry(below, box.v0, box.v1), entry(above, box.v0, box.v1));
    const float* blocked = nearness.data() + size_t(row) * kSidePx;
    const bool aside = box.u0 > 0 || box.u1 < 0;
    for (int x = left; x < right; ++x) {
      const double column_s = aside ? entry(at_px(box.u0 > 0 ? x + 1 : x), box.u0, box.u1) : kFar;
      const double nearest = std::max(box.far_s, std::min({box.near_s, row_s, column_s}));
      if (!(double(blocked[x]) > nearest)) return false;
    }
  }
  return true;
}

void BoxView::add(const Box& box) {
  Placed placed;
  for (uint32_t face = 0; face < kFaces; ++face)
    if ((wanted_ >> face & 1U) != 0 && place(box, face, placed)) draw(placed, nearness_[face]);
}

void BoxView::add(const BoxShadow& shadow) {
  for (uint32_t face = 0; face < kFaces; ++face)
    if ((wanted_ >> face & 1U) != 0) draw(shadow, face);
}

bool BoxView::hides(const Box& box) const {
  if (!(double(box.distance(glm::vec3(eye_))) >= 2 * kNearM)) return false;
  bool placed_somewhere = false;  // not so from an eye that is no number
  Placed placed;
  for (uint32_t face = 0; face < kFaces; ++face) {
    if ((wanted_ >> face & 1U) == 0 || !place(box, face, placed)) continue;
    if (!blocks(placed, nearness_[face])) return false;
    placed_somewhere = true;
  }
  return placed_somewhere;
}

}  // namespace promenade
