// Closing is exact. What triangles cover together ends only at loose edges, those with a triangle on one side alone: a
// square of the grid without any is covered as its corners are. One with covered corners and a loose edge is closed
// when nothing is left of it after every triangle is cut out.

#include "preprocess/visibility/wall_openings.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <limits>
#include <optional>
#include <span>
#include <utility>

namespace promenade {
namespace {

constexpr uint32_t kMostPoints = 4096;  // of the grid, along a side
constexpr size_t kMostUnited = 512;     // more are put into coarse squares first: bounds a quadratic search
constexpr uint32_t kCoarseSquares = 16;
constexpr double kNothingM2 = 1e-8;  // what rounding leaves between triangles
constexpr size_t kMostPieces = 64;   // of a square: what is cut into more counts as open

WallOpening together(const WallOpening& a, const WallOpening& b) {
  return {glm::min(a.low, b.low), glm::max(a.high, b.high)};
}
double area(const WallOpening& o) { return (o.high.x - o.low.x) * (o.high.y - o.low.y); }

/// Unites the two whose union adds least, until so many are left.
class Uniter {
 public:
  explicit Uniter(std::vector<WallOpening>& openings) : openings_(openings), best_(openings.size()) {
    for (size_t i = 0; i < openings_.size(); ++i) find_best(i);
  }

  void unite(size_t most) {
    for (size_t left = openings_.size(); left > most; --left) {
      size_t first = 0;
      for (size_t i = 1; i < best_.size(); ++i)
        if (best_[i].more_m2 < best_[first].more_m2) first = i;
      const size_t second = best_[first].with;
      openings_[first] = together(openings_[first], openings_[second]);
      best_[second] = {kNobody, kNever};
      for (size_t i = 0; i < best_.size(); ++i) {
        if (best_[i].with == kNobody && i != first) continue;
        if (i == first || best_[i].with == first || best_[i].with == second)
          find_best(i);
        else if (i < first)
          offer(i, first);
      }
    }
    size_t kept = 0;
    for (size_t i = 0; i < best_.size(); ++i)
      if (best_[i].with != kNobody) openings_[kept++] = openings_[i];
    openings_.resize(kept);
  }

 private:
  static constexpr size_t kNobody = std::numeric_limits<size_t>::max();
  static constexpr double kNever = std::numeric_limits<double>::infinity();
  struct Best {
    size_t with = 0;  ///< a later one; itself: there is none; kNobody: gone
    double more_m2 = kNever;
  };

  void offer(size_t i, size_t with) {
    const double more = area(together(openings_[i], openings_[with])) - area(openings_[i]) - area(openings_[with]);
    if (more < best_[i].more_m2) best_[i] = {with, more};
  }
  void find_best(size_t i) {
    best_[i] = {i, kNever};
    for (size_t k = i + 1; k < openings_.size(); ++k)
      if (best_[k].with != kNobody) offer(i, k);
  }

  std::vector<WallOpening>& openings_;
  std::vector<Best> best_;
};

/// One for each square of a coarse grid, by their middles.
std::vector<WallOpening> coarse(const std::vector<WallOpening>& openings, const glm::dvec2& low,
                                const glm::dvec2& high) {
  std::vector<WallOpening> squares(size_t(kCoarseSquares) * kCoarseSquares);
  std::vector<bool> used(squares.size(), false);
  for (const WallOpening& opening : openings) {
    const glm::dvec2 at = ((opening.low + opening.high) * 0.5 - low) / (high - low) * double(kCoarseSquares);
    const auto place = [](double x) { return static_cast<size_t>(std::clamp(x, 0.0, kCoarseSquares - 1.0)); };
    const size_t i = place(at.y) * kCoarseSquares + place(at.x);
    squares[i] = used[i] ? together(squares[i], opening) : opening;
    used[i] = true;
  }
  std::vector<WallOpening> left;
  for (size_t i = 0; i < squares.size(); ++i)
    if (used[i]) left.push_back(squares[i]);
  return left;
}

/// n . x <= d
struct HalfPlane {
  glm::dvec2 normal{0};
  double offset = 0;
  double beyond(const glm::dvec2& p) const { return glm::dot(normal, p) - offset; }
};

/// A triangle with its rim. At a sharp corner that would reach far out: the bounds of the triangle end it.
struct Grown {
  static constexpr size_t kSides = 7;  ///< its own three and those of its bounds
  std::array<HalfPlane, 3> sides;
  glm::dvec2 low{0}, high{0};

  HalfPlane side(size_t i) const {
    switch (i) {
      case 3:
        return {{-1, 0}, -low.x};
      case 4:
        return {{0, -1}, -low.y};
      case 5:
        return {{1, 0}, high.x};
      case 6:
        return {{0, 1}, high.y};
      default:
        return sides[i];
    }
  }
};

std::optional<Grown> grown(const FlatTriangle& triangle) {
  std::array<glm::dvec2, 3> p = {triangle[0], triangle[1], triangle[2]};
  const double twice = (p[1].x - p[0].x) * (p[2].y - p[0].y) - (p[1].y - p[0].y) * (p[2].x - p[0].x);
  if (twice == 0) return std::nullopt;
  if (twice < 0) std::swap(p[1], p[2]);
  Grown out;
  for (size_t i = 0; i < 3; ++i) {
    const glm::dvec2 side = p[(i + 1) % 3] - p[i];
    const double length = glm::length(side);
    if (!(length > 0)) return std::nullopt;
    const glm::dvec2 normal = glm::dvec2(side.y, -side.x) / length;
    out.sides[i] = {normal, glm::dot(normal, p[i]) + kWallRimM};
  }
  out.low = glm::min(glm::min(p[0], p[1]), p[2]) - kWallRimM;
  out.high = glm::max(glm::max(p[0], p[1]), p[2]) + kWallRimM;
  return out;
}

/// Convex.
struct Polygon {
  static constexpr size_t kMostCorners = 12;
  std::array<glm::dvec2, kMostCorners> corners;
  size_t count = 0;

  void add(const glm::dvec2& p) {
    if (count < kMostCorners) corners[count] = p;
    ++count;
  }
  bool has_room() const { return count <= kMostCorners; }
  std::span<const glm::dvec2> all() const { return {corners.data(), count}; }
  double area() const {
    double twice = 0;
    for (size_t i = 2; i < count; ++i) {
      const glm::dvec2 a = corners[i - 1] - corners[0], b = corners[i] - corners[0];
      twice += a.x * b.y - a.y * b.x;
    }
    return std::abs(twice) / 2;
  }
};

/// The parts of a polygon within a line and beyond it.
void split(const Polygon& polygon, const HalfPlane& side, Polygon& within, Polygon& beyond) {
  within.count = beyond.count = 0;
  for (size_t i = 0; i < polygon.count; ++i) {
    const glm::dvec2 &a = polygon.corners[i], &b = polygon.corners[i + 1 == polygon.count ? 0 : i + 1];
    const double at_a = side.beyond(a), at_b = side.beyond(b);
    (at_a <= 0 ? within : beyond).add(a);
    if ((at_a <= 0) == (at_b <= 0)) continue;
    const glm::dvec2 between = a + (b - a) * (at_a / (at_a - at_b));
    within.add(between), beyond.add(between);
  }
}

/// Appends what a triangle leaves of a polygon, in convex pieces; false when one has too many corners.
bool cut_out(const Polygon& polygon, const Grown& triangle, std::vector<Polygon>& left) {
  std::array<size_t, Grown::kSides> cutting;
  size_t cuts = 0;
  for (size_t i = 0; i < Grown::kSides; ++i) {
    const HalfPlane side = triangle.side(i);
    const auto beyond = std::ranges::count_if(polygon.all(), [&](const glm::dvec2& p) { return side.beyond(p) >= 0; });
    if (static_cast<size_t>(beyond) == polygon.count) {
      left.push_back(polygon);
      return true;
    }
    if (beyond > 0) cutting[cuts++] = i;
  }
  std::array<Polygon, 2> rest;
  const Polygon* whole = &polygon;
  Polygon beyond;
  for (size_t i = 0; i < cuts; ++i) {
    Polygon& within = rest[i % 2];
    split(*whole, triangle.side(cutting[i]), within, beyond);
    if (!within.has_room() || !beyond.has_room()) return false;
    if (beyond.area() > kNothingM2) left.push_back(beyond);
    whole = &within;
  }
  return true;
}

/// Bounds of what triangles leave of a rectangle; nullopt where they close it.
std::optional<WallOpening> left_of(const WallOpening& square, std::span<const Grown* const> triangles) {
  Polygon whole;
  whole.add(square.low), whole.add({square.high.x, square.low.y});
  whole.add(square.high), whole.add({square.low.x, square.high.y});
  std::vector<Polygon> pieces = {whole}, next;
  for (const Grown* triangle : triangles) {
    next.clear();
    for (const Polygon& piece : pieces)
      if (!cut_out(piece, *triangle, next)) return square;
    pieces.swap(next);
    if (pieces.empty()) return std::nullopt;
    if (pieces.size() > kMostPieces) return square;
  }
  WallOpening bounds{square.high, square.low};
  for (const Polygon& piece : pieces)
    for (const glm::dvec2& p : piece.all()) bounds = {glm::min(bounds.low, p), glm::max(bounds.high, p)};
  return bounds;
}

struct Edge {
  glm::vec2 from, to;
  std::array<float, 4> ends() const { return {from.x, from.y, to.x, to.y}; }
};

/// Edges with triangles on one side alone.
std::vector<Edge> loose_edges(const std::vector<FlatTriangle>& triangles) {
  struct Side {
    Edge edge;
    bool above;  ///< on which side the triangle is
  };
  std::vector<Side> sides;
  sides.reserve(3 * triangles.size());
  for (const FlatTriangle& triangle : triangles)
    for (size_t i = 0; i < 3; ++i) {
      Edge edge{triangle[i], triangle[(i + 1) % 3]};
      const glm::dvec2 along = glm::dvec2(edge.to) - glm::dvec2(edge.from);
      const glm::dvec2 other = glm::dvec2(triangle[(i + 2) % 3]) - glm::dvec2(edge.from);
      const double turn = along.x * other.y - along.y * other.x;
      const bool swapped = std::pair(edge.to.x, edge.to.y) < std::pair(edge.from.x, edge.from.y);
      if (swapped) std::swap(edge.from, edge.to);
      if (turn != 0) sides.push_back({edge, (turn > 0) != swapped});
    }
  std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) { return a.edge.ends() < b.edge.ends(); });
  std::vector<Edge> loose;
  for (size_t i = 0; i < sides.size();) {
    bool above = false, below = false;
    const size_t first = i;
    for (; i < sides.size() && sides[i].edge.ends() == sides[first].edge.ends(); ++i)
      (sides[i].above ? above : below) = true;
    if (!above || !below) loose.push_back(sides[first].edge);
  }
  return loose;
}

class OpeningFinder {
 public:
  OpeningFinder(const glm::dvec2& low, const glm::dvec2& high, double step_m)
      : low_(low), high_(high), x_(axis_of(low.x, high.x, step_m)), y_(axis_of(low.y, high.y, step_m)) {
    covered_.assign(size_t(x_.points) * y_.points, 0);
    closed_ = loose_ = covered_;
  }

  std::vector<WallOpening> run(const std::vector<Grown>& triangles, const std::vector<Edge>& loose, size_t most) {
    for (const Grown& triangle : triangles) cover(triangle);
    for (const Edge& edge : loose) mark(edge);
    judge_squares(triangles);
    std::vector<WallOpening> openings = united_squares();
    if (openings.size() > kMostUnited) openings = coarse(openings, low_, high_);
    if (openings.size() > most) Uniter(openings).unite(most);
    return openings;
  }

 private:
  /// The outermost points stand a rim inside the rectangle; the squares there stand for what is beyond them, too.
  struct Axis {
    double first = 0, step = 1;
    uint32_t points = 2;
    double at(uint32_t i) const { return first + step * i; }
    uint32_t first_from(double x) const { return clamped(std::ceil((x - first) / step)); }
    uint32_t end_at(double x) const { return clamped(std::floor((x - first) / step) + 1); }
    uint32_t square_at(double x) const {
      return static_cast<uint32_t>(std::clamp(std::floor((x - first) / step), 0.0, double(points - 2)));
    }
    uint32_t clamped(double i) const { return static_cast<uint32_t>(std::clamp(i, 0.0, double(points))); }
  };
  struct Doubt {
    uint32_t x, y;
    bool operator<(const Doubt& other) const { return std::pair(y, x) < std::pair(other.y, other.x); }
  };

  static Axis axis_of(double low, double high, double step_m) {
    const double seal = std::min(kWallRimM, (high - low) / 4), length = high - low - 2 * seal;
    Axis axis;
    axis.points = static_cast<uint32_t>(std::clamp(std::ceil(length / step_m) + 1, 2.0, double(kMostPoints)));
    axis.first = low + seal;
    axis.step = length / double(axis.points - 1);
    return axis;
  }

  size_t index(uint32_t x, uint32_t y) const { return size_t(y) * x_.points + x; }
  bool corners_covered(uint32_t x, uint32_t y) const {
    const uint8_t* low = covered_.data() + index(x, y);
    const uint8_t* high = low + x_.points;
    return (low[0] & low[1] & high[0] & high[1]) != 0;
  }
  WallOpening square(uint32_t x, uint32_t y) const { return {{x_.at(x), y_.at(y)}, {x_.at(x + 1), y_.at(y + 1)}}; }

  void cover(const Grown& triangle);
  void mark(const Edge& edge);
  void judge_squares(const std::vector<Grown>& triangles);
  std::vector<WallOpening> united_squares() const;

  glm::dvec2 low_, high_;
  Axis x_, y_;
  std::vector<uint8_t> covered_;                      ///< by point
  std::vector<uint8_t> closed_;                       ///< by square, numbered as its lowest corner
  std::vector<uint8_t> loose_;                        ///< by square: a loose edge comes near it
  std::vector<std::pair<Doubt, WallOpening>> slits_;  ///< in order: squares open between covered corners
};

/// Marks the points within a triangle.
void OpeningFinder::cover(const Grown& triangle) {
  for (uint32_t y = y_.first_from(triangle.low.y); y < y_.end_at(triangle.high.y); ++y) {
    double from = triangle.low.x, to = triangle.high.x;
    for (const HalfPlane& side : triangle.sides) {
      const double left = side.offset - side.normal.y * y_.at(y);
      if (side.normal.x > 0)
        to = std::min(to, left / side.normal.x);
      else if (side.normal.x < 0)
        from = std::max(from, left / side.normal.x);
      else if (left < 0)
        to = from - 1;
    }
    if (to < from) continue;
    const uint32_t first = x_.first_from(from), end = x_.end_at(to);
    const auto row = covered_.begin() + static_cast<std::ptrdiff_t>(index(0, y));
    if (first < end) std::fill(row + first, row + end, uint8_t{1});
  }
}

/// Marks the squares that an edge comes near, row by row.
void OpeningFinder::mark(const Edge& edge) {
  const glm::dvec2 a = edge.from, b = edge.to;
  const double reach = 2 * kWallRimM;
  for (uint32_t y = y_.square_at(std::min(a.y, b.y) - reach); y <= y_.square_at(std::max(a.y, b.y) + reach); ++y) {
    // Where it passes the row.
    double first = 0, last = 1;
    if (a.y != b.y) {
      const double t0 = (y_.at(y) - reach - a.y) / (b.y - a.y), t1 = (y_.at(y + 1) + reach - a.y) / (b.y - a.y);
      first = std::clamp(std::min(t0, t1), 0.0, 1.0), last = std::clamp(std::max(t0, t1), 0.0, 1.0);
    }
    const double x0 = a.x + (b.x - a.x) * first, x1 = a.x + (b.x - a.x) * last;
    for (uint32_t x = x_.square_at(std::min(x0, x1) - reach); x <= x_.square_at(std::max(x0, x1) + reach); ++x)
      loose_[index(x, y)] = 1;
  }
}

/// Closes what is covered, but for the slits found on the way.
void OpeningFinder::judge_squares(const std::vector<Grown>& triangles) {
  std::vector<Doubt> doubts;
  std::vector<size_t> row_first(y_.points, 0);
  for (uint32_t y = 0; y + 1 < y_.points; ++y) {
    row_first[y] = doubts.size();
    for (uint32_t x = 0; x + 1 < x_.points; ++x) {
      const bool covered = corners_covered(x, y);
      closed_[index(x, y)] = covered ? 1 : 0;
      if (covered && loose_[index(x, y)] != 0) doubts.push_back({x, y});
    }
  }
  row_first.back() = doubts.size();
  if (doubts.empty()) return;
  const auto first_doubt = [&](const Doubt& from) {
    const auto begin = doubts.begin() + static_cast<std::ptrdiff_t>(row_first[from.y]);
    const auto end = doubts.begin() + static_cast<std::ptrdiff_t>(row_first[from.y + 1]);
    return static_cast<size_t>(std::lower_bound(begin, end, from) - doubts.begin());
  };
  std::vector<std::pair<uint32_t, const Grown*>> met;  // doubt, triangle: a triangle after those before it
  for (const Grown& triangle : triangles) {
    const uint32_t first_row = y_.first_from(triangle.low.y), first = x_.first_from(triangle.low.x);
    const uint32_t end_row = std::min(y_.end_at(triangle.high.y), y_.points - 1), end = x_.end_at(triangle.high.x);
    for (uint32_t y = first_row == 0 ? 0 : first_row - 1; y < end_row; ++y)
      for (size_t i = first_doubt({first == 0 ? 0 : first - 1, y}); i < row_first[y + 1] && doubts[i].x < end; ++i) {
        const Doubt& doubt = doubts[i];
        const WallOpening at = square(doubt.x, doubt.y);
        const bool apart = std::any_of(triangle.sides.begin(), triangle.sides.end(), [&](const HalfPlane& side) {
          const glm::dvec2 nearest(side.normal.x > 0 ? at.low.x : at.high.x, side.normal.y > 0 ? at.low.y : at.high.y);
          return side.beyond(nearest) >= 0;
        });
        if (!apart) met.emplace_back(static_cast<uint32_t>(i), &triangle);
      }
  }
  std::stable_sort(met.begin(), met.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<const Grown*> near;
  for (size_t i = 0; i < met.size();) {
    const uint32_t doubt = met[i].first;
    near.clear();
    for (; i < met.size() && met[i].first == doubt; ++i) near.push_back(met[i].second);
    const auto [x, y] = doubts[doubt];
    const std::optional<WallOpening> left = left_of(square(x, y), near);
    if (!left) continue;
    slits_.emplace_back(doubts[doubt], *left);
    closed_[index(x, y)] = 0;
  }
}

std::vector<WallOpening> OpeningFinder::united_squares() const {
  struct Run {
    uint32_t x0, x1;  ///< squares, end beyond
    WallOpening bounds;
  };
  // The outermost squares stand for what is beyond them, too.
  const auto to_border = [&](WallOpening bounds) {
    const glm::dvec2 first(x_.first, y_.first), last(x_.at(x_.points - 1), y_.at(y_.points - 1));
    constexpr double kSame = 1e-9;
    for (int axis = 0; axis < 2; ++axis) {
      if (bounds.low[axis] <= first[axis] + kSame) bounds.low[axis] = low_[axis];
      if (bounds.high[axis] >= last[axis] - kSame) bounds.high[axis] = high_[axis];
    }
    return bounds;
  };
  std::vector<Run> done, above, row;
  auto slit = slits_.begin();
  for (uint32_t y = 0; y + 1 < y_.points; ++y) {
    row.clear();
    for (uint32_t x = 0; x + 1 < x_.points; ++x) {
      if (closed_[index(x, y)] != 0) continue;
      Run run{x, x + 1, square(x, y)};
      if (corners_covered(x, y)) run.bounds = (slit++)->second;
      for (; x + 2 < x_.points && closed_[index(x + 1, y)] == 0; ++x) {
        const WallOpening next = corners_covered(x + 1, y) ? (slit++)->second : square(x + 1, y);
        run.bounds = together(run.bounds, next);
        ++run.x1;
      }
      run.bounds = to_border(run.bounds);
      row.push_back(run);
    }
    // A run goes on where one of the row before has the same ends.
    for (Run& run : row) {
      const auto same =
          std::find_if(above.begin(), above.end(), [&](const Run& a) { return a.x0 == run.x0 && a.x1 == run.x1; });
      if (same == above.end()) continue;
      run.bounds = together(run.bounds, same->bounds);
      above.erase(same);
    }
    done.insert(done.end(), above.begin(), above.end());
    above.swap(row);
  }
  done.insert(done.end(), above.begin(), above.end());
  std::vector<WallOpening> openings;
  openings.reserve(done.size());
  for (const Run& run : done) openings.push_back(run.bounds);
  return openings;
}

}  // namespace

std::vector<WallOpening> find_wall_openings(const glm::dvec2& low, const glm::dvec2& high,
                                            std::vector<FlatTriangle>& triangles, double step_m, size_t most) {
  const auto flat = [](const FlatTriangle& t) { return std::array{t[0].x, t[0].y, t[1].x, t[1].y, t[2].x, t[2].y}; };
  std::sort(triangles.begin(), triangles.end(),
            [&](const FlatTriangle& a, const FlatTriangle& b) { return flat(a) < flat(b); });
  std::vector<Grown> rimmed;
  rimmed.reserve(triangles.size());
  for (const FlatTriangle& triangle : triangles)
    if (std::optional<Grown> one = grown(triangle)) rimmed.push_back(*one);
  return OpeningFinder(low, high, step_m).run(rimmed, loose_edges(triangles), most);
}

}  // namespace promenade
