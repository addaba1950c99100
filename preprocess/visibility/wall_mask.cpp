#include "preprocess/visibility/wall_mask.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

namespace promenade {
namespace {

constexpr double kRimM = 0.001;      // beside a triangle: neighbours are rounded apart
constexpr size_t kMostUnited = 512;  // more are put into coarse squares first: bounds a quadratic search
constexpr uint32_t kCoarseSquares = 16;

using Opening = WallMask::Opening;

Opening together(const Opening& a, const Opening& b) { return {glm::min(a.low, b.low), glm::max(a.high, b.high)}; }
double area(const Opening& o) { return (o.high.x - o.low.x) * (o.high.y - o.low.y); }

/// Unites the two whose union adds least, until so many are left.
void unite(std::vector<Opening>& openings, size_t most) {
  while (openings.size() > most) {
    size_t first = 0, second = 1;
    double least = std::numeric_limits<double>::infinity();
    for (size_t i = 0; i < openings.size(); ++i)
      for (size_t k = i + 1; k < openings.size(); ++k) {
        const double more = area(together(openings[i], openings[k])) - area(openings[i]) - area(openings[k]);
        if (more < least) least = more, first = i, second = k;
      }
    openings[first] = together(openings[first], openings[second]);
    openings.erase(openings.begin() + static_cast<std::ptrdiff_t>(second));
  }
}

/// One for each square of a coarse grid, by their middles.
std::vector<Opening> coarse(const std::vector<Opening>& openings, const glm::dvec2& low, const glm::dvec2& high) {
  std::vector<Opening> squares(size_t(kCoarseSquares) * kCoarseSquares);
  std::vector<bool> used(squares.size(), false);
  for (const Opening& opening : openings) {
    const glm::dvec2 at = ((opening.low + opening.high) * 0.5 - low) / (high - low) * double(kCoarseSquares);
    const auto place = [](double x) { return static_cast<size_t>(std::clamp(x, 0.0, kCoarseSquares - 1.0)); };
    const size_t i = place(at.y) * kCoarseSquares + place(at.x);
    squares[i] = used[i] ? together(squares[i], opening) : opening;
    used[i] = true;
  }
  std::vector<Opening> left;
  for (size_t i = 0; i < squares.size(); ++i)
    if (used[i]) left.push_back(squares[i]);
  return left;
}

}  // namespace

WallMask::Axis WallMask::axis_of(double low, double high, double step_m) {
  const double seal = std::min(kSealM, (high - low) / 4), length = high - low - 2 * seal;
  Axis axis;
  axis.points = static_cast<uint32_t>(std::clamp(std::ceil(length / step_m) + 1, 2.0, double(kMostPoints)));
  axis.first = low + seal;
  axis.step = length / double(axis.points - 1);
  return axis;
}

uint64_t WallMask::points_of(const glm::dvec2& low, const glm::dvec2& high, double step_m) {
  return uint64_t(axis_of(low.x, high.x, step_m).points) * axis_of(low.y, high.y, step_m).points;
}

WallMask::WallMask(const glm::dvec2& low, const glm::dvec2& high, double step_m)
    : low_(low), high_(high), x_(axis_of(low.x, high.x, step_m)), y_(axis_of(low.y, high.y, step_m)) {
  bits_.assign(size_t(x_.points) * y_.points, false);
}

void WallMask::cover(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) {
  std::array<glm::dvec2, 3> p = {a, b, c};
  const double twice = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
  if (twice == 0) return;
  if (twice < 0) std::swap(p[1], p[2]);
  // Sides as lines n . x = d, n outwards; what lies within the rim of all three is covered. At a sharp corner that
  // would reach far out: the bounds of the triangle end it.
  std::array<glm::dvec2, 3> normals;
  std::array<double, 3> offsets;
  for (size_t i = 0; i < 3; ++i) {
    const glm::dvec2 side = p[(i + 1) % 3] - p[i];
    const double length = glm::length(side);
    if (!(length > 0)) return;
    normals[i] = glm::dvec2(side.y, -side.x) / length;
    offsets[i] = glm::dot(normals[i], p[i]) + kRimM;
  }
  const glm::dvec2 low = glm::min(glm::min(a, b), c) - kRimM, high = glm::max(glm::max(a, b), c) + kRimM;
  const auto first = [](const Axis& axis, double at) {
    return static_cast<uint32_t>(std::clamp(std::ceil((at - axis.first) / axis.step), 0.0, double(axis.points)));
  };
  const auto end = [](const Axis& axis, double at) {
    return static_cast<uint32_t>(std::clamp(std::floor((at - axis.first) / axis.step) + 1, 0.0, double(axis.points)));
  };
  for (uint32_t y = first(y_, low.y); y < end(y_, high.y); ++y) {
    double from = low.x, to = high.x;
    for (size_t i = 0; i < 3; ++i) {
      const double left = offsets[i] - normals[i].y * y_.at(y);
      if (normals[i].x > 0)
        to = std::min(to, left / normals[i].x);
      else if (normals[i].x < 0)
        from = std::max(from, left / normals[i].x);
      else if (left < 0)
        to = from - 1;
    }
    if (to < from) continue;
    const size_t row = size_t(y) * x_.points;
    for (uint32_t x = first(x_, from); x < end(x_, to); ++x) bits_[row + x] = true;
  }
}

std::vector<Opening> WallMask::openings(size_t most) const {
  struct Run {
    uint32_t x0, x1, y0, y1;  ///< squares, ends beyond
  };
  std::vector<Run> done, above, row;
  for (uint32_t y = 0; y + 1 < y_.points; ++y) {
    row.clear();
    for (uint32_t x = 0; x + 1 < x_.points; ++x) {
      if (!open_square(x, y)) continue;
      const uint32_t x0 = x;
      while (x + 1 < x_.points && open_square(x, y)) ++x;
      row.push_back({x0, x, y, y + 1});
    }
    // A run goes on where one of the row before has the same ends.
    for (Run& run : row) {
      const auto same =
          std::find_if(above.begin(), above.end(), [&](const Run& a) { return a.x0 == run.x0 && a.x1 == run.x1; });
      if (same == above.end()) continue;
      run.y0 = same->y0;
      above.erase(same);
    }
    done.insert(done.end(), above.begin(), above.end());
    above.swap(row);
  }
  done.insert(done.end(), above.begin(), above.end());
  const auto place = [](const Axis& axis, uint32_t i, double low, double high) {
    return i == 0 ? low : i + 1 == axis.points ? high : axis.at(i);
  };
  std::vector<Opening> openings;
  openings.reserve(done.size());
  for (const Run& run : done)
    openings.push_back({{place(x_, run.x0, low_.x, high_.x), place(y_, run.y0, low_.y, high_.y)},
                        {place(x_, run.x1, low_.x, high_.x), place(y_, run.y1, low_.y, high_.y)}});
  if (openings.size() > kMostUnited) openings = coarse(openings, low_, high_);
  unite(openings, most);
  return openings;
}

}  // namespace promenade
