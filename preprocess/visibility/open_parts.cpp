#include "preprocess/visibility/open_parts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

namespace promenade {
namespace {

constexpr uint32_t kSquares = 32;     // a side of the cell's plan
constexpr uint32_t kMostParts = 6;    // measured: study hiders; more edges cost more than they hide
constexpr int kTightenings = 2;       // of a side, each to a 32nd: a cell of 16 m ends within 2 cm of a wall
constexpr double kFullEnough = 0.85;  // open share of a part from which on it is not divided
constexpr double kLeastCut = 0.9;     // what a division must leave of a part's area

/// Squares from x0, y0 to before x1, y1.
struct Squares {
  uint32_t x0, y0, x1, y1;
  uint32_t area() const { return (x1 - x0) * (y1 - y0); }
};

/// The plan of a cell in squares, and which of them somebody may stand in.
class CellPlanGrid {
 public:
  explicit CellPlanGrid(const Box& cell)
      : cell_(cell), low_(cell.min), step_(glm::dvec2(cell.size()) / double(kSquares)) {
    open_.fill(1);
  }

  /// No square is open that lies wholly within one of the loops and meets no hole among them.
  void fill(const OccluderSet& set, std::span<const OccluderLoop> loops) {
    for (uint32_t y = 0; y < kSquares; ++y) {
      Row solid{};
      for (const bool holes : {false, true})
        for (const OccluderLoop& loop : loops)
          if (loop.is_hole == holes) draw_row(y, set.points_of(loop), holes, solid);
      for (uint32_t x = 0; x < kSquares; ++x)
        if (solid[x] != 0) open_[size_t(y) * kSquares + x] = 0;
    }
  }

  bool all_open() const {
    return std::all_of(open_.begin(), open_.end(), [](uint8_t open) { return open != 0; });
  }

  /// Open squares in rectangles.
  std::vector<Squares> parts() const {
    std::vector<Squares> open = {bounds({0, 0, kSquares, kSquares})}, done;
    while (!open.empty()) {
      const Squares part = open.back();
      open.pop_back();
      if (part.area() == 0) continue;
      const std::array<Squares, 2> halves = divide(part);
      if (open.size() + done.size() + 2 > kMostParts || count(part) > kFullEnough * part.area() ||
          halves[0].area() + halves[1].area() > kLeastCut * part.area())
        done.push_back(part);
      else
        open.insert(open.end(), halves.begin(), halves.end());
    }
    return done;
  }

  /// Around all that is open.
  std::optional<Box> open_box() const {
    const Squares open = bounds({0, 0, kSquares, kSquares});
    if (open.area() == 0) return std::nullopt;
    return box_of(open);
  }

  Box box_of(const Squares& part) const {
    Box box = cell_;
    const auto at = [&](uint32_t i, int axis) { return static_cast<float>(low_[axis] + step_[axis] * i); };
    if (part.x0 > 0) box.min.x = at(part.x0, 0);
    if (part.y0 > 0) box.min.y = at(part.y0, 1);
    if (part.x1 < kSquares) box.max.x = at(part.x1, 0);
    if (part.y1 < kSquares) box.max.y = at(part.y1, 1);
    return box;
  }

 private:
  using Row = std::array<uint8_t, kSquares>;

  /// Squares of a row that no side of the polygon comes into are inside or outside as their middles are. Those inside
  /// are made solid; of a hole, those inside or touched are not.
  void draw_row(uint32_t y, std::span<const glm::vec2> polygon, bool is_hole, Row& solid) const {
    constexpr double kSlack = 1e-3;  // squares
    const double bottom = y - kSlack, top = y + 1 + kSlack, middle = y + 0.5;
    Row touched{}, inside{};
    for (size_t i = 0, last = polygon.size() - 1; i < polygon.size(); last = i++) {
      const glm::dvec2 a = (glm::dvec2(polygon[last]) - low_) / step_, b = (glm::dvec2(polygon[i]) - low_) / step_;
      if (std::max(a.y, b.y) < bottom || std::min(a.y, b.y) > top) continue;
      const auto x_at = [&](double h) {
        return a.y == b.y ? a.x : a.x + (b.x - a.x) * std::clamp((h - a.y) / (b.y - a.y), 0.0, 1.0);
      };
      const double from = a.y == b.y ? std::min(a.x, b.x) : std::min(x_at(bottom), x_at(top));
      const double to = a.y == b.y ? std::max(a.x, b.x) : std::max(x_at(bottom), x_at(top));
      for (uint32_t x = 0; x < kSquares; ++x)
        if (x + 1 + kSlack >= from && x - kSlack <= to) touched[x] = 1;
      if ((a.y > middle) == (b.y > middle)) continue;
      const double crossing = x_at(middle);
      for (uint32_t x = 0; x < kSquares; ++x)
        if (x + 0.5 > crossing) inside[x] ^= 1U;
    }
    for (uint32_t x = 0; x < kSquares; ++x) {
      if (is_hole && (inside[x] != 0 || touched[x] != 0)) solid[x] = 0;
      if (!is_hole && inside[x] != 0 && touched[x] == 0) solid[x] = 1;
    }
  }

  uint32_t count(const Squares& in) const {
    uint32_t sum = 0;
    for (uint32_t y = in.y0; y < in.y1; ++y)
      for (uint32_t x = in.x0; x < in.x1; ++x) sum += open_[size_t(y) * kSquares + x];
    return sum;
  }

  /// Of the open squares; no area: there are none.
  Squares bounds(const Squares& in) const {
    Squares tight{in.x1, in.y1, in.x0, in.y0};
    for (uint32_t y = in.y0; y < in.y1; ++y)
      for (uint32_t x = in.x0; x < in.x1; ++x) {
        if (open_[size_t(y) * kSquares + x] == 0) continue;
        tight.x0 = std::min(tight.x0, x), tight.x1 = std::max(tight.x1, x + 1);
        tight.y0 = std::min(tight.y0, y), tight.y1 = std::max(tight.y1, y + 1);
      }
    return tight.x0 < tight.x1 ? tight : Squares{0, 0, 0, 0};
  }

  /// The straight cut that leaves least area.
  std::array<Squares, 2> divide(const Squares& part) const {
    std::array<Squares, 2> best = {part, part};
    const auto consider = [&](const Squares& low, const Squares& high) {
      const std::array<Squares, 2> halves = {bounds(low), bounds(high)};
      if (halves[0].area() + halves[1].area() < best[0].area() + best[1].area()) best = halves;
    };
    for (uint32_t x = part.x0 + 1; x < part.x1; ++x)
      consider({part.x0, part.y0, x, part.y1}, {x, part.y0, part.x1, part.y1});
    for (uint32_t y = part.y0 + 1; y < part.y1; ++y)
      consider({part.x0, part.y0, part.x1, y}, {part.x0, y, part.x1, part.y1});
    return best;
  }

  Box cell_;
  glm::dvec2 low_, step_;
  std::array<uint8_t, size_t(kSquares) * kSquares> open_{};
};

/// Whether one of two boxes lies above or below the other.
bool share_plan(const Box& a, const Box& b) {
  return a.min.x <= b.max.x && b.min.x <= a.max.x && a.min.y <= b.max.y && b.min.y <= a.max.y;
}

/// Marks what of a cell's plan is solid from its bottom to its top.
void fill_solid(const Box& cell, const OccluderSet& set, const std::vector<UsableOccluder>& usable,
                CellPlanGrid& plan) {
  for (const UsableOccluder& each : usable) {
    if (each.distance_m > 0 || !share_plan(each.occluder->box, cell)) continue;
    // Those of one top lie one after the other; so do tops.
    const std::span<const OccluderLoop> loops = eroded_loops(set, each, 0).loops;
    for (size_t first = 0, end = 0; first < loops.size(); first = end) {
      while (end < loops.size() && loops[end].top_m == loops[first].top_m) ++end;
      const OccluderLoop& any = loops[first];
      if (any.top_m - each.error_m >= cell.max.z && any.base_m + each.error_m <= cell.min.z)
        plan.fill(set, loops.subspan(first, end - first));
    }
  }
}

/// A part of a cell without what is solid along its sides: the outermost of the cell's squares there in finer ones, and
/// the outermost of these again.
Box tightened(Box part, const Box& cell, const OccluderSet& set, const std::vector<UsableOccluder>& usable) {
  for (const int axis : {0, 1})
    for (const bool low : {true, false}) {
      float width = cell.size()[axis];
      for (int i = 0; i < kTightenings; ++i) {
        width /= static_cast<float>(kSquares);
        Box strip = part;
        if (low)
          strip.max[axis] = std::min(part.min[axis] + width, part.max[axis]);
        else
          strip.min[axis] = std::max(part.max[axis] - width, part.min[axis]);
        if (strip.min[axis] >= strip.max[axis]) break;
        CellPlanGrid plan(strip);
        fill_solid(strip, set, usable, plan);
        const std::optional<Box> open = plan.open_box();
        if (low)
          part.min[axis] = open ? open->min[axis] : strip.max[axis];
        else
          part.max[axis] = open ? open->max[axis] : strip.min[axis];
      }
    }
  return part;
}

}  // namespace

ErodedLoops eroded_loops(const OccluderSet& set, const UsableOccluder& usable, float erosion_m) {
  const auto& levels = OccluderSet::kErosionsM;
  const float need = erosion_m + usable.error_m;
  const size_t level = size_t(std::lower_bound(levels.begin(), levels.end(), need) - levels.begin());
  if (level == levels.size()) return {{}, 0};
  return {set.loops_of(*usable.occluder, level), levels[level]};
}

std::vector<Box> open_parts(const Box& cell, const OccluderSet& set, const std::vector<UsableOccluder>& usable) {
  if (cell.min.x >= cell.max.x || cell.min.y >= cell.max.y) return {cell};  // an eye, not a place
  CellPlanGrid plan(cell);
  fill_solid(cell, set, usable, plan);
  if (plan.all_open()) return {cell};
  std::vector<Box> boxes;
  for (const Squares& part : plan.parts()) boxes.push_back(tightened(plan.box_of(part), cell, set, usable));
  if (boxes.empty()) boxes.push_back(cell);  // nobody is to stand there: whoever does shall see something
  return boxes;
}

}  // namespace promenade
