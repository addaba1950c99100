// Along a vertical line through a closed surface that faces outwards, the number of surfaces above that face up less
// those that face down (the label) is 1 inside and 0 outside. A ray from the air (0) into what the air cannot reach (1)
// crosses some surface from its front. The flood finds openings; the label finds what is closed only because its
// openings are finer than the grid (a cage has the label 0).

#include "preprocess/visibility/columns.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

#include "geometry/box.h"
#include "geometry/paged_array.h"

namespace promenade {
namespace {

constexpr float kFar = std::numeric_limits<float>::infinity();
constexpr float kThickSheetM = 0.3F;  // a touched slab up to this thick, solid above and below, is a sheet
constexpr float kLowGapM = 1.0F;      // gaps lower than this may be slips
constexpr float kStepM = 0.5F;        // a gap whose ceiling is so little above the air's floor leads under the ground
constexpr glm::dvec2 kOffMiddleM(0.00137, 0.00073);  // where a column is asked: off the lines that models like
constexpr double kPocketM2 = 300;  // smaller spaces under a low ceiling are flooded instead of remembered
constexpr uint32_t kBandRows = 64;
constexpr size_t kMostTouches = size_t(1) << 20;  // of a band before what hangs together is joined

/// A convex polygon with heights, clipped to a column.
struct Clip {
  std::array<glm::dvec3, 8> points;
  size_t count = 0;

  /// Keeps what has sign * coordinate <= bound.
  void keep(int axis, double sign, double bound) {
    Clip kept;
    for (size_t i = 0; i < count; ++i) {
      const glm::dvec3 &a = points[i], &b = points[(i + 1) % count];
      const double da = sign * a[axis] - bound, db = sign * b[axis] - bound;
      if (da <= 0) kept.points[kept.count++] = a;
      if ((da < 0 && db > 0) || (da > 0 && db < 0)) kept.points[kept.count++] = a + (b - a) * (da / (da - db));
    }
    *this = kept;
  }
  std::pair<double, double> range(int axis) const {
    double low = points[0][axis], high = low;
    for (size_t i = 1; i < count; ++i) low = std::min(low, points[i][axis]), high = std::max(high, points[i][axis]);
    return {low, high};
  }
};

/// A side of a triangle in the plan. The same bits for both directions but for the sign, so that every point belongs
/// to exactly one of two triangles that share a side.
struct PlanSide {
  glm::dvec2 from, way;
  double sign;  ///< 1, or -1: the inside is to the right of the way

  PlanSide(const glm::vec3& a, const glm::vec3& b, bool counter_clockwise) {
    const bool swap = a.x > b.x || (a.x == b.x && a.y > b.y);
    from = glm::dvec2(swap ? b : a), way = glm::dvec2(swap ? a : b) - from;
    sign = swap == counter_clockwise ? -1 : 1;
  }
  /// Twice the area of the triangle with a point; positive inside. A point on the line lies to the left of the way.
  double off(const glm::dvec2& p) const {
    const double left = way.x * (p.y - from.y) - way.y * (p.x - from.x);
    return sign * (left == 0 ? std::numeric_limits<double>::min() : left);
  }
  /// How much that changes, at most, when the point moves by `reach` along each axis.
  double slack(double reach) const { return reach * (std::abs(way.x) + std::abs(way.y)); }
};

/// Free heights of a column between what is touched.
struct Run {
  float floor, ceiling;
  int16_t label;
  bool reached = false, visited = false;
};

struct Contact {
  uint32_t run;
  uint32_t column;
  uint8_t way = 0;  ///< that led here: 0 to 3, towards +x, -x, +y, -y
};

class Flood {
 public:
  Flood(const ColumnGrid& grid, const ColumnOptions& options, PagedArray<Run> runs, PagedArray<uint32_t> first)
      : grid_(grid), options_(options), runs_(std::move(runs)), first_(std::move(first)) {}

  void run() {
    seed();
    spread();
    flood_pockets();
  }
  SolidColumns solid() const;

 private:
  void reach(uint32_t run, uint32_t column) {
    if (runs_[run].reached) return;
    runs_[run].reached = true;
    open_.push_back({run, column});
  }
  void seed();
  void spread();
  void flood_pockets();
  std::vector<Contact> pocket_around(uint32_t run, uint32_t column);
  /// Calls visit(contact) for every run of the four neighbours that shares heights with a run.
  template <class Visit>
  void neighbours(size_t run, uint32_t column, const Visit& visit) const;
  bool is_bottom(size_t run, uint32_t column) const { return run == first_[column]; }
  bool at_border(uint32_t column) const {
    const uint32_t x = column % grid_.nx, y = column / grid_.nx;
    return x == 0 || y == 0 || x + 1 == grid_.nx || y + 1 == grid_.ny;
  }
  bool leads_under_ground(const Run& from, size_t to, uint32_t column) const {
    const Run& run = runs_[to];
    if (run.label <= from.label) return false;
    if (is_bottom(to, column)) return true;
    return run.ceiling - run.floor < kLowGapM && (from.floor == -kFar || run.ceiling <= from.floor + kStepM);
  }

  ColumnGrid grid_;
  ColumnOptions options_;
  PagedArray<Run> runs_;
  PagedArray<uint32_t> first_;  ///< by column, and the end; runs from the bottom up
  PagedArray<Contact> open_;
  std::vector<Contact> slips_;
};

template <class Visit>
void Flood::neighbours(size_t run, uint32_t column, const Visit& visit) const {
  const float floor = runs_[run].floor + ColumnBuilder::kSealedGapM;
  const float ceiling = runs_[run].ceiling - ColumnBuilder::kSealedGapM;
  const auto look = [&](uint32_t other, uint8_t way) {
    for (uint32_t r = first_[other]; r < first_[other + 1] && runs_[r].floor < ceiling; ++r)
      if (runs_[r].ceiling > floor) visit(Contact{r, other, way});
  };
  const uint32_t x = column % grid_.nx, y = column / grid_.nx;
  if (x + 1 < grid_.nx) look(column + 1, 0);
  if (x > 0) look(column - 1, 1);
  if (y + 1 < grid_.ny) look(column + grid_.nx, 2);
  if (y > 0) look(column - grid_.nx, 3);
}

/// The sky is air; at the border so is everything but what lies under the ground.
void Flood::seed() {
  for (uint32_t column = 0; column < grid_.count(); ++column) {
    reach(first_[column + 1] - 1, column);
    if (!at_border(column)) continue;
    for (uint32_t r = first_[column]; r < first_[column + 1]; ++r) {
      const Run& run = runs_[r];
      const bool under = run.label > 0 && (is_bottom(r, column) || run.ceiling - run.floor < kLowGapM);
      if (!under || options_.rule == SlipRule::open) reach(r, column);
    }
  }
}

void Flood::spread() {
  while (!open_.empty()) {
    const Contact at = open_.back();
    open_.pop_back();
    neighbours(at.run, at.column, [&](const Contact& next) {
      if (runs_[next.run].reached) return;
      if (options_.rule == SlipRule::remember && leads_under_ground(runs_[at.run], next.run, next.column))
        slips_.push_back(next);
      else
        reach(next.run, next.column);
    });
  }
}

/// What hangs together with a run that the air has not reached.
std::vector<Contact> Flood::pocket_around(uint32_t run, uint32_t column) {
  std::vector<Contact> pocket = {{run, column}};
  runs_[run].visited = true;
  for (size_t i = 0; i < pocket.size(); ++i) {
    const Contact at = pocket[i];
    neighbours(at.run, at.column, [&](const Contact& next) {
      if (runs_[next.run].reached || runs_[next.run].visited) return;
      runs_[next.run].visited = true;
      pocket.push_back(next);
    });
  }
  return pocket;
}

/// Air gets into a slip. Where little hangs together with it (the space under a zebra crossing) that is simply air.
void Flood::flood_pockets() {
  const double most = kPocketM2 / (grid_.column_m * grid_.column_m);
  for (const Contact& slip : slips_) {
    if (runs_[slip.run].reached || runs_[slip.run].visited) continue;
    const std::vector<Contact> pocket = pocket_around(slip.run, slip.column);
    if (double(pocket.size()) > most) continue;
    for (const Contact& part : pocket) runs_[part.run].reached = true;
  }
}

SolidColumns Flood::solid() const {
  SolidColumns solid;
  solid.base_m.assign(grid_.count(), kFar);
  solid.top_m.assign(grid_.count(), -kFar);
  for (uint32_t column = 0; column < grid_.count(); ++column) {
    const auto is_solid = [&](size_t r) { return !runs_[r].reached && runs_[r].label > 0; };
    const size_t end = first_[column + 1];
    for (size_t r = first_[column]; r < end; ++r) {
      if (!is_solid(r)) continue;
      // A thin sheet below is the solid's own bottom.
      const bool thin = r > first_[column] && runs_[r].floor - runs_[r - 1].ceiling <= kThickSheetM;
      const float inside_m = runs_[r].floor, base_m = thin ? runs_[r - 1].ceiling : inside_m;
      while (r + 1 < end && is_solid(r + 1) && runs_[r + 1].floor - runs_[r].ceiling <= kThickSheetM) ++r;
      if (options_.spans) solid.spans.push_back({column, inside_m, runs_[r].ceiling});
      if (solid.top_m[column] == -kFar) solid.base_m[column] = base_m, solid.top_m[column] = runs_[r].ceiling;
    }
  }
  for (const Contact& slip : slips_)
    if (!runs_[slip.run].reached) solid.slips.push_back({slip.column, runs_[slip.run].ceiling, slip.way});
  return solid;
}

}  // namespace

ColumnBuilder::ColumnBuilder(const ColumnGrid& grid, const ColumnOptions& options)
    : grid_(grid), options_(options), bands_((grid.ny + kBandRows - 1) / kBandRows) {}

void ColumnBuilder::add(const Mesh& mesh, std::span<const Material> materials) {
  for (size_t t = 0; t < mesh.triangle_count(); ++t) {
    const uint32_t material = mesh.material_of(t);
    if (material < materials.size() && materials[material].alpha != AlphaMode::opaque) continue;
    Triangle triangle;
    for (size_t k = 0; k < 3; ++k) triangle[k] = mesh.positions[mesh.indices[t * 3 + k]];
    add_triangle(triangle);
  }
}

void ColumnBuilder::add_triangle(const Triangle& triangle) {
  Box box;
  for (const glm::vec3& corner : triangle) box.add(corner);
  const auto index = [&](float at, int axis) { return std::floor((double(at) - grid_.low[axis]) / grid_.column_m); };
  const double y0 = std::max(index(box.min.y, 1), 0.0), y1 = std::min(index(box.max.y, 1), double(grid_.ny) - 1);
  if (y0 > y1 || index(box.max.x, 0) < 0 || index(box.min.x, 0) > double(grid_.nx) - 1 || too_much_) return;
  if (triangles_.size() >= options_.most_triangles) settle();
  for (size_t band = size_t(y0) / kBandRows; band <= size_t(y1) / kBandRows; ++band)
    bands_[band].triangles.push_back(static_cast<uint32_t>(triangles_.size()));
  triangles_.push_back(triangle);
}

void ColumnBuilder::touch(size_t band, const Triangle& corners, Touches& touches) const {
  const glm::dvec3 a(corners[0]), b(corners[1]), c(corners[2]);
  const glm::dvec3 low = glm::min(glm::min(a, b), c), high = glm::max(glm::max(a, b), c);
  const auto index = [&](double at, int axis) { return std::floor((at - grid_.low[axis]) / grid_.column_m); };
  const double x0 = std::max(index(low.x, 0), 0.0), x1 = std::min(index(high.x, 0), double(grid_.nx) - 1);
  const double first_y = double(band * kBandRows), last_y = std::min(first_y + kBandRows, double(grid_.ny)) - 1;
  const double y0 = std::max(index(low.y, 1), 0.0), y1 = std::min(index(high.y, 1), double(grid_.ny) - 1);
  constexpr double kRoundM = 0.001;  // touches reach outwards by more than the rounding to float
  const auto add = [&](double x, double y, double from, double to, int32_t facing) {
    const auto column = static_cast<uint32_t>(y - first_y) * grid_.nx + static_cast<uint32_t>(x);
    touches.push_back({column, facing, static_cast<float>(from - kRoundM), static_cast<float>(to + kRoundM)});
  };
  const double area = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
  const std::array<PlanSide, 3> sides = {PlanSide(corners[0], corners[1], area > 0),
                                         PlanSide(corners[1], corners[2], area > 0),
                                         PlanSide(corners[2], corners[0], area > 0)};
  const glm::dvec3 normal = glm::cross(b - a, c - a);
  const double slope_x = -normal.x / normal.z, slope_y = -normal.y / normal.z;
  const bool flat = area != 0 && std::abs(slope_x) + std::abs(slope_y) < 4;
  const double half = grid_.column_m / 2;
  const double reach = half + 2 * kOffMiddleM.x;  // from the middle, as it is used, to all of the column
  const Clip whole{{a, b, c}, 3};
  constexpr double kNear = 1e-6;  // of a column: rows reach into the columns that they touch
  for (double y = std::max(y0, first_y); y <= std::min(y1, last_y); ++y) {
    const double low_y = grid_.low.y + y * grid_.column_m;
    Clip row = whole;
    if (y0 != y1) row.keep(1, -1, -low_y), row.keep(1, 1, low_y + 2 * half);
    if (row.count == 0) continue;
    const auto [row_low, row_high] = row.range(0);
    const double first_x = std::max(index(row_low - kNear * grid_.column_m, 0), x0);
    const double last_x = std::min(index(row_high + kNear * grid_.column_m, 0), x1);
    for (double x = first_x; x <= last_x; ++x) {
      const glm::dvec2 corner(grid_.low.x + x * grid_.column_m, low_y);
      bool middle_in = area != 0, all_in = flat;
      for (const PlanSide& side : sides) {
        const double off = side.off(corner + half + kOffMiddleM);
        middle_in &= off > 0, all_in &= off > side.slack(reach);
      }
      const int32_t facing = middle_in ? (area > 0 ? 1 : -1) : 0;
      if (all_in) {
        const double z = a.z + slope_x * (corner.x + half - a.x) + slope_y * (corner.y + half - a.y);
        const double lift = (std::abs(slope_x) + std::abs(slope_y)) * half;
        add(x, y, z - lift, z + lift, facing);
      } else {
        Clip part = row;
        if (x0 != x1) part.keep(0, -1, -corner.x), part.keep(0, 1, corner.x + 2 * half);
        if (part.count == 0) continue;
        const auto [z0, z1] = part.range(2);
        add(x, y, z0, z1, facing);
      }
    }
  }
}

/// Turns the band's triangles into touches.
void ColumnBuilder::touch_all(size_t number) {
  Band& band = bands_[number];
  for (const uint32_t triangle : band.triangles) {
    touch(number, triangles_[triangle], band.touches);
    if (band.touches.size() > 2 * band.touches_joined + kMostTouches) join(band);
  }
  band.triangles.clear();
}

void ColumnBuilder::sort_by_column(const Touches& touches) {
  begin_.assign(size_t(kBandRows) * grid_.nx + 1, 0);
  for (const Touch& t : touches) ++begin_[t.column + 1];
  std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
  sorted_.resize(touches.size());
  for (const Touch& t : touches) sorted_[begin_[t.column]++] = t;
  std::copy_backward(begin_.begin(), begin_.end() - 1, begin_.end());
  begin_[0] = 0;
  for (size_t i = 0; i + 1 < begin_.size(); ++i)
    std::sort(sorted_.begin() + std::ptrdiff_t(begin_[i]), sorted_.begin() + std::ptrdiff_t(begin_[i + 1]),
              [](const Touch& a, const Touch& b) { return a.low < b.low; });
}

template <class Visit>
void ColumnBuilder::for_each_joined(std::span<const Touch> column, const Visit& visit) const {
  for (size_t i = 0; i < column.size();) {
    const float low = column[i].low;
    float high = column[i].high;
    int32_t facing = 0;
    for (; i < column.size() && column[i].low <= high + kSealedGapM; ++i) {
      high = std::max(high, column[i].high);
      facing += column[i].facing;
    }
    visit(low, high, facing);
  }
}

/// Joins touches that hang together: whatever comes between or beside them later hangs together with all of them, so
/// that in the end the same do.
void ColumnBuilder::join(Band& band) {
  sort_by_column(band.touches);
  size_t count = 0;
  for (uint32_t column = 0; column + 1 < begin_.size(); ++column)
    for_each_joined({sorted_.data() + begin_[column], begin_[column + 1] - begin_[column]},
                    [&](float low, float high, int32_t facing) {
                      sorted_[count++] = {column, facing, low, high};
                    });
  band.touches.release();
  band.touches.append(std::span(sorted_.data(), count));
  band.touches_joined = count;
}

/// Lets go of the triangles.
void ColumnBuilder::settle() {
  size_t touches = 0;
  for (size_t b = 0; b < bands_.size(); ++b) {
    touch_all(b);
    if (bands_[b].touches.size() > 2 * bands_[b].touches_joined) join(bands_[b]);
    touches += bands_[b].touches.size();
  }
  triangles_.clear();
  too_much_ = is_too_much(touches, 0);
}

bool ColumnBuilder::is_too_much(size_t touches, size_t runs) const {
  const uint64_t bytes = touches * sizeof(Touch) + runs * sizeof(Run) +
                         grid_.count() * (sizeof(Contact) + sizeof(uint32_t) + 2 * sizeof(float));
  return options_.most_bytes && bytes > *options_.most_bytes;
}

std::optional<SolidColumns> ColumnBuilder::finish() {
  PagedArray<Run> runs;
  PagedArray<uint32_t> first;
  first.push_back(0);
  Touches room;
  for (size_t b = 0; b < bands_.size() && !too_much_; ++b) {
    if (bands_[b].touches.empty()) std::swap(bands_[b].touches, room);
    touch_all(b);
    sort_by_column(bands_[b].touches);
    room = std::move(bands_[b].touches);
    room.clear();
    bands_[b] = {};
    for (size_t column = 0; column + 1 < begin_.size() && first.size() <= grid_.count(); ++column) {
      const std::span<const Touch> here(sorted_.data() + begin_[column], begin_[column + 1] - begin_[column]);
      int32_t label = 0;
      for (const Touch& t : here) label += t.facing;
      float floor = -kFar;
      for_each_joined(here, [&](float low, float high, int32_t facing) {
        runs.push_back({floor, low, static_cast<int16_t>(std::clamp(label, -30000, 30000))});
        floor = high;
        label -= facing;
      });
      runs.push_back({floor, kFar, 0});
      first.push_back(static_cast<uint32_t>(runs.size()));
    }
    too_much_ = is_too_much(0, runs.size());
  }
  triangles_ = {}, begin_ = {};
  sorted_.release(), room.release();
  if (too_much_) return std::nullopt;
  Flood flood(grid_, options_, std::move(runs), std::move(first));
  flood.run();
  return flood.solid();
}

}  // namespace promenade
