#include "preprocess/visibility/occluders.h"

#include <tbb/parallel_pipeline.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <memory>
#include <optional>

#include "preprocess/visibility/columns.h"
#include "preprocess/visibility/contours.h"
#include "preprocess/visibility/known_plans.h"
#include "preprocess/visibility/leaf_meshes.h"

namespace promenade {
namespace {

constexpr float kFar = std::numeric_limits<float>::infinity();
constexpr uint32_t kNoRegion = 0xffffffffU;
constexpr size_t kMostTops = 6;      // of an occluder: flat roofs need one, hips some
constexpr double kLeastGain = 0.01;  // of the volume: what another top must add
constexpr double kLossM = 0.25;      // what may stick out of a wall to be cut off; and a quarter of the erosion
constexpr float kLeastLoopM = 1.0F;  // smaller loops hide next to nothing
constexpr double kGroundBlockM = 16;
constexpr uint64_t kMostTileBytes = uint64_t(128) << 20;  // half as much again as a dense city's tiles take
constexpr uint64_t kTileRoom = uint64_t(32) << 20;  // beside its columns: triangles, a band's touches, masks; measured
constexpr double kLeastTileM = 24;  // smaller ones are not worked through in quarters: their margins take the most

/// Whether what is solid lies around a loop, not within it.
bool is_hole(const Loop& loop) {
  double area = 0;
  for (size_t i = 0, last = loop.size() - 1; i < loop.size(); last = i++)
    area += double(loop[last].x) * double(loop[i].y) - double(loop[i].x) * double(loop[last].y);
  return area <= 0;
}

/// What a tile contributes, with its own numbering of loops and points.
struct TileResult {
  OccluderSet set;
  std::vector<std::pair<glm::dvec2, SolidColumns::Slip>> slips;  ///< where
  std::vector<std::pair<size_t, float>> ground;                  ///< squares that the tile's core meets: solid up to
};

using Ground = OccluderSet::Ground;

/// Squares of the ground that a rectangle meets: first x, first y, last x, last y.
std::array<size_t, 4> squares_of(const Ground& ground, const glm::dvec2& low, const glm::dvec2& high) {
  const glm::dvec2 most(ground.nx - 1, ground.ny - 1);
  const glm::dvec2 a = glm::clamp((low - ground.corner) / Ground::kSquareM, glm::dvec2(0), most);
  const glm::dvec2 b = glm::clamp((high - ground.corner) / Ground::kSquareM, glm::dvec2(0), most);
  return {static_cast<size_t>(a.x), static_cast<size_t>(a.y), static_cast<size_t>(b.x), static_cast<size_t>(b.y)};
}

/// The tile's solid columns turned into occluders.
class TileWork {
 public:
  /// ground: its squares' places; what is in them is not read.
  TileWork(const ColumnGrid& grid, const SolidColumns& solid, KnownPlans known, const Box& core, const Ground& ground,
           const OccluderOptions& options)
      : grid_(grid), solid_(solid), known_(std::move(known)), core_(core), squares_(ground), options_(options) {}

  TileResult run() {
    find_ground();
    label_regions();
    known_.assign(region_of_);
    for (uint32_t region = 0; region < regions_.size(); ++region)
      if (is_ours(regions_[region])) add_occluder(regions_[region], region);
    survey_ground();
    return std::move(result_);
  }

 private:
  struct Region {
    uint32_t x0, y0, x1, y1;  ///< columns, inclusive
    std::vector<uint32_t> columns;
  };
  glm::dvec2 place(double x, double y) const { return grid_.low + glm::dvec2(x, y) * grid_.column_m; }
  void find_ground();
  void survey_ground();
  void label_regions();
  bool is_ours(const Region& region) const;
  void add_occluder(const Region& region, uint32_t number);
  std::vector<float> choose_tops(const Region& region) const;
  std::vector<float> tops_of(const Region& region, uint32_t number) const;
  using LoopsByErosion = std::array<std::vector<OccluderLoop>, 9>;
  void add_loops(const Region& region, uint32_t number, float top_m, LoopsByErosion& loops);
  void add_known(const KnownPlans::Outline& outline, LoopsByErosion& loops);
  template <class Points>
  void add_loop(const Points& points, bool hole, float top_m, float base_m, std::vector<OccluderLoop>& loops);
  float ground_at(uint32_t column) const {
    const uint32_t x = column % grid_.nx / block_, y = column / grid_.nx / block_;
    return ground_[size_t(y) * blocks_x_ + x];
  }
  bool raised(uint32_t column) const {
    return solid_.top_m[column] > -kFar && double(solid_.top_m[column] - ground_at(column)) >= options_.least_rise_m;
  }

  const ColumnGrid& grid_;
  const SolidColumns& solid_;
  KnownPlans known_;
  Box core_;
  const Ground& squares_;
  const OccluderOptions& options_;
  uint32_t block_ = 1, blocks_x_ = 0, blocks_y_ = 0;
  std::vector<float> ground_;  ///< the lowest solid top or base around each block
  std::vector<uint32_t> region_of_;
  std::vector<Region> regions_;
  TileResult result_;
};

/// The lowest solid height within a block and those around it: what rises above that may hide something.
void TileWork::find_ground() {
  block_ = std::max(1U, static_cast<uint32_t>(kGroundBlockM / grid_.column_m));
  blocks_x_ = (grid_.nx + block_ - 1) / block_, blocks_y_ = (grid_.ny + block_ - 1) / block_;
  std::vector<float> lowest(size_t(blocks_x_) * blocks_y_, kFar);
  for (uint32_t column = 0; column < grid_.count(); ++column) {
    if (solid_.top_m[column] == -kFar) continue;
    float& low = lowest[size_t(column / grid_.nx / block_) * blocks_x_ + column % grid_.nx / block_];
    low = std::min(low, solid_.base_m[column] > -kFar ? solid_.base_m[column] : solid_.top_m[column]);
  }
  ground_.assign(lowest.size(), kFar);
  for (uint32_t y = 0; y < blocks_y_; ++y)
    for (uint32_t x = 0; x < blocks_x_; ++x)
      for (uint32_t v = y == 0 ? 0 : y - 1; v <= std::min(y + 1, blocks_y_ - 1); ++v)
        for (uint32_t u = x == 0 ? 0 : x - 1; u <= std::min(x + 1, blocks_x_ - 1); ++u)
          ground_[size_t(y) * blocks_x_ + x] =
              std::min(ground_[size_t(y) * blocks_x_ + x], lowest[size_t(v) * blocks_x_ + u]);
}

/// Slips, and how far the squares of the ground that the core meets are solid from below.
void TileWork::survey_ground() {
  for (const SolidColumns::Slip& slip : solid_.slips)
    result_.slips.emplace_back(place(slip.column % grid_.nx, slip.column / grid_.nx), slip);
  const auto steps = std::max(1U, static_cast<uint32_t>(0.5 / grid_.column_m));
  const glm::dvec2 beyond(grid_.column_m * (steps + 1));
  const auto around = squares_of(squares_, glm::dvec2(core_.min) - beyond, glm::dvec2(core_.max) + beyond);
  const size_t width = around[2] - around[0] + 1;
  std::vector<float> solid_m(width * (around[3] - around[1] + 1), kFar);
  for (uint32_t y = 0; y < grid_.ny; y += steps)
    for (uint32_t x = 0; x < grid_.nx; x += steps) {
      const glm::dvec2 low = place(x, y), high = place(x + steps, y + steps);
      if (high.x < double(core_.min.x) || low.x > double(core_.max.x) || high.y < double(core_.min.y) ||
          low.y > double(core_.max.y))
        continue;
      float lowest = kFar;
      for (uint32_t v = y; v < std::min(y + steps, grid_.ny); ++v)
        for (uint32_t u = x; u < std::min(x + steps, grid_.nx); ++u) {
          const size_t column = size_t(v) * grid_.nx + u;
          lowest = std::min(lowest, solid_.base_m[column] == -kFar ? solid_.top_m[column] : -kFar);
        }
      // To every square that the block may reach into.
      const auto into = squares_of(squares_, low, high);
      for (const size_t px : {into[0], into[2]})
        for (const size_t py : {into[1], into[3]}) {
          float& square = solid_m[(py - around[1]) * width + px - around[0]];
          square = std::min(square, lowest);
        }
    }
  for (size_t i = 0; i < solid_m.size(); ++i)
    if (solid_m[i] < kFar)
      result_.ground.emplace_back((around[1] + i / width) * squares_.nx + around[0] + i % width, solid_m[i]);
}

/// Raised columns that hang together over their sides, or over those that known footprints touch.
void TileWork::label_regions() {
  region_of_.assign(grid_.count(), kNoRegion);
  const auto belongs = [&](uint32_t column) { return raised(column) || known_.touches(column); };
  for (uint32_t seed = 0; seed < grid_.count(); ++seed) {
    if (region_of_[seed] != kNoRegion || !belongs(seed)) continue;
    const auto number = static_cast<uint32_t>(regions_.size());
    Region region{grid_.nx, grid_.ny, 0, 0, {seed}};
    region_of_[seed] = number;
    for (size_t i = 0; i < region.columns.size(); ++i) {
      const uint32_t column = region.columns[i], x = column % grid_.nx, y = column / grid_.nx;
      region.x0 = std::min(region.x0, x), region.x1 = std::max(region.x1, x);
      region.y0 = std::min(region.y0, y), region.y1 = std::max(region.y1, y);
      const auto take = [&](uint32_t other) {
        if (region_of_[other] != kNoRegion || !belongs(other)) return;
        region_of_[other] = number;
        region.columns.push_back(other);
      };
      if (x > 0) take(column - 1);
      if (x + 1 < grid_.nx) take(column + 1);
      if (y > 0) take(column - grid_.nx);
      if (y + 1 < grid_.ny) take(column + grid_.nx);
    }
    regions_.push_back(std::move(region));
  }
}

/// Each region belongs to the tile with its middle; one that the tile's margin cuts off also to the tiles it reaches.
bool TileWork::is_ours(const Region& region) const {
  const glm::dvec2 low = place(region.x0, region.y0), high = place(region.x1 + 1, region.y1 + 1);
  if (std::min(high.x - low.x, high.y - low.y) < double(kLeastLoopM)) return false;
  const glm::dvec2 middle = (low + high) * 0.5, core_low(core_.min), core_high(core_.max);
  if (glm::all(glm::greaterThanEqual(middle, core_low)) && glm::all(glm::lessThan(middle, core_high))) return true;
  const bool cut = region.x0 == 0 || region.y0 == 0 || region.x1 + 1 == grid_.nx || region.y1 + 1 == grid_.ny;
  return cut && glm::all(glm::lessThan(low, core_high)) && glm::all(glm::greaterThan(high, core_low));
}

/// The heights at which to cut a region: those that keep the most of its volume, each the top of some column.
/// Dynamic programming over a histogram.
std::vector<float> TileWork::choose_tops(const Region& region) const {
  std::vector<float> heights;
  heights.reserve(region.columns.size());
  for (const uint32_t column : region.columns)
    if (raised(column)) heights.push_back(solid_.top_m[column]);
  if (heights.empty()) return {};
  std::sort(heights.begin(), heights.end());
  // Steps of the sorted heights: bins[i] starts at a height and holds what is less than a bin above it.
  struct Bin {
    float low;
    double count;
  };
  const float width = std::max(0.05F, (heights.back() - heights.front()) / 200);
  std::vector<Bin> bins;
  for (const float h : heights) {
    if (bins.empty() || h > bins.back().low + width) bins.push_back({h, 0});
    bins.back().count += 1;
  }
  const size_t n = bins.size();
  std::vector<double> above(n + 1, 0);  // columns from a bin up
  for (size_t i = n; i-- > 0;) above[i] = above[i + 1] + bins[i].count;
  // best[k][i]: most volume with k cuts, the lowest of them at bin i.
  std::vector<std::vector<double>> best(kMostTops + 1, std::vector<double>(n, 0));
  std::vector<std::vector<size_t>> next(kMostTops + 1, std::vector<size_t>(n, n));
  const float floor = bins.front().low - static_cast<float>(options_.least_rise_m);
  for (size_t k = 1; k <= kMostTops; ++k)
    for (size_t i = n; i-- > 0;) {
      const double rise = double(bins[i].low - floor);
      best[k][i] = rise * above[i];
      for (size_t j = i + 1; k > 1 && j < n; ++j)
        if (const double v = best[k - 1][j] + rise * (above[i] - above[j]); v > best[k][i])
          best[k][i] = v, next[k][i] = j;
    }
  std::vector<float> tops;
  const auto most = [&](size_t k) { return *std::max_element(best[k].begin(), best[k].end()); };
  size_t cuts = 1;
  while (cuts < kMostTops && most(cuts + 1) > most(cuts) * (1 + kLeastGain)) ++cuts;
  size_t at = static_cast<size_t>(std::max_element(best[cuts].begin(), best[cuts].end()) - best[cuts].begin());
  for (size_t k = cuts; k > 0 && at < n; --k) {
    tops.push_back(bins[at].low);
    at = next[k][at];
  }
  return tops;
}

/// Where to cut a region: as its columns ask for, and where footprints end.
std::vector<float> TileWork::tops_of(const Region& region, uint32_t number) const {
  constexpr float kSameTopM = 0.05F;
  std::vector<float> tops = choose_tops(region);
  const std::vector<float> known = known_.tops_of(number);
  for (size_t i = 0; i < std::min(known.size(), kMostTops); ++i)
    if (std::none_of(tops.begin(), tops.end(), [&](float top) { return std::abs(top - known[i]) < kSameTopM; }))
      tops.push_back(known[i]);
  return tops;
}

/// Points in model space.
template <class Points>
void TileWork::add_loop(const Points& points, bool hole, float top_m, float base_m, std::vector<OccluderLoop>& loops) {
  OccluderLoop entry{
      top_m, base_m, static_cast<uint32_t>(result_.set.points.size()), static_cast<uint32_t>(points.size()), hole,
      {},    {}};
  Box bounds;
  for (const auto& p : points) bounds.add({glm::vec2(p), 0});
  if (!hole && std::max(bounds.size().x, bounds.size().y) < kLeastLoopM) return;
  for (const auto& p : points) result_.set.points.push_back(glm::vec2(p));
  entry.low = glm::vec2(bounds.min), entry.high = glm::vec2(bounds.max);
  loops.push_back(entry);
}

void TileWork::add_known(const KnownPlans::Outline& outline, LoopsByErosion& loops) {
  for (size_t k = 0; k < OccluderSet::kErosionsM.size(); ++k) {
    const PlanLoops made = shrunk(outline.loops, double(OccluderSet::kErosionsM[k]) + kPlanStepM);
    for (const PlanLoop& loop : made) add_loop(loop, area_m2({loop}) <= 0, outline.top_m, -kFar, loops[k]);
    if (made.empty()) break;
  }
}

void TileWork::add_loops(const Region& region, uint32_t number, float top_m, LoopsByErosion& loops) {
  std::vector<uint32_t> columns;
  float base_m = -kFar;
  for (const uint32_t column : region.columns) {
    if (solid_.top_m[column] < top_m || region_of_[column] != number) continue;
    columns.push_back(column);
    base_m = std::max(base_m, solid_.base_m[column]);
  }
  if (columns.empty()) return;
  if (const auto outline = known_.outline_of(number, top_m, columns)) return add_known(*outline, loops);
  Mask mask{region.x1 - region.x0 + 3, region.y1 - region.y0 + 3, {}};
  mask.inside.assign(size_t(mask.nx) * mask.ny, 0);
  for (const uint32_t column : columns) {
    const uint32_t x = column % grid_.nx - region.x0 + 1, y = column / grid_.nx - region.y0 + 1;
    mask.inside[size_t(y) * mask.nx + x] = 1;
  }
  const std::vector<float> depths = squared_depths(mask);
  const glm::dvec2 low = place(double(region.x0) - 1, double(region.y0) - 1);
  for (size_t k = 0; k < OccluderSet::kErosionsM.size(); ++k) {
    const double erosion = double(OccluderSet::kErosionsM[k]);
    std::vector<Loop> made =
        loops_at_depth(mask, depths, erosion / grid_.column_m, (kLossM + 0.25 * erosion) / grid_.column_m);
    for (Loop& loop : made) {
      const bool hole = is_hole(loop);
      for (glm::vec2& p : loop) p = glm::vec2(low + glm::dvec2(p) * grid_.column_m);
      add_loop(loop, hole, top_m, base_m, loops[k]);
    }
    if (made.empty()) break;  // deeper there is nothing either
  }
}

void TileWork::add_occluder(const Region& region, uint32_t number) {
  std::array<std::vector<OccluderLoop>, 9> loops;
  for (const float top_m : tops_of(region, number)) add_loops(region, number, top_m, loops);
  Occluder occluder;
  occluder.base_m = -kFar;
  occluder.first_loop = static_cast<uint32_t>(result_.set.loops.size());
  for (size_t k = 0; k < loops.size(); ++k) {
    for (const OccluderLoop& loop : loops[k]) {
      occluder.base_m = std::max(occluder.base_m, loop.base_m);
      for (const glm::vec2& p : result_.set.points_of(loop)) occluder.box.add({p, loop.top_m});
      result_.set.loops.push_back(loop);
    }
    occluder.loops_end[k] = static_cast<uint32_t>(result_.set.loops.size());
  }
  if (!occluder.box.empty()) result_.set.occluders.push_back(occluder);
}

void append(OccluderSet& all, const OccluderSet& tile) {
  const auto loops = static_cast<uint32_t>(all.loops.size()), points = static_cast<uint32_t>(all.points.size());
  for (Occluder occluder : tile.occluders) {
    occluder.first_loop += loops;
    for (uint32_t& end : occluder.loops_end) end += loops;
    all.occluders.push_back(occluder);
  }
  for (OccluderLoop loop : tile.loops) {
    loop.first_point += points;
    all.loops.push_back(loop);
  }
  all.points.append(tile.points);
}

void append(TileResult& all, const TileResult& part) {
  append(all.set, part.set);
  all.slips.insert(all.slips.end(), part.slips.begin(), part.slips.end());
  all.ground.insert(all.ground.end(), part.ground.begin(), part.ground.end());
}

/// What tiles are worked through for, and with what.
struct TileSource {
  const ModelReader& model;
  const Box& model_box;
  const Ground& ground;
  const OccluderOptions& options;
  JobMonitor& monitor;
  std::vector<Box> footprints;  ///< of each the plan
};

std::vector<Box> plans_of(const Footprints& footprints) {
  std::vector<Box> boxes(footprints.all.size());
  for (size_t i = 0; i < boxes.size(); ++i)
    for (uint32_t l = footprints.first_loop(i); l < footprints.all[i].loops_end; ++l)
      for (const glm::vec2& p : footprints.loop(l)) boxes[i].add({p, 0});
  return boxes;
}

/// Footprints that lie within an area as a whole.
std::vector<uint32_t> footprints_in(const TileSource& source, const Box& area) {
  std::vector<uint32_t> numbers;
  for (uint32_t i = 0; i < source.footprints.size(); ++i) {
    const Box& plan = source.footprints[i];
    if (plan.min.x >= area.min.x && plan.min.y >= area.min.y && plan.max.x <= area.max.x && plan.max.y <= area.max.y)
      numbers.push_back(i);
  }
  return numbers;
}

/// Reads what a tile needs and works through it; where that takes too much, through its quarters.
Result<TileResult> work_tile(const TileSource& source, const Box& core) {
  const OccluderOptions& options = source.options;
  const auto margin = static_cast<float>(options.margin_m), column = static_cast<float>(options.column_m);
  Box around = core;
  around.min -= glm::vec3(margin, margin, 0), around.max += glm::vec3(margin, margin, 0);
  // Beyond the model there is only air: a column or two of it.
  around.min = glm::max(around.min, source.model_box.min - 2 * column),
  around.max = glm::min(around.max, source.model_box.max + 2 * column);
  ColumnGrid grid;
  grid.column_m = options.column_m;
  grid.low = glm::dvec2(around.min);
  grid.nx = static_cast<uint32_t>(std::ceil(double(around.size().x) / grid.column_m)) + 1;
  grid.ny = static_cast<uint32_t>(std::ceil(double(around.size().y) / grid.column_m)) + 1;
  ColumnOptions columns;
  const bool divisible = double(core.size().x) > kLeastTileM;
  if (divisible) columns.most_bytes = most_tile_bytes(options);
  std::optional<SolidColumns> solid;
  {
    ColumnBuilder builder(grid, columns);
    PROMENADE_TRY(for_each_mesh_near(source.model, around, source.monitor, [&](const Mesh& mesh) {
      builder.add(mesh, source.model.model().tables.materials);  // what moves hides nothing
    }));
    solid = builder.finish();
  }
  if (solid) {
    KnownPlans known(source.model.model().objects.footprints, footprints_in(source, around), grid, *solid);
    return TileWork(grid, *solid, std::move(known), core, source.ground, options).run();
  }
  TileResult made;
  for (const float y : {0.0F, 0.5F})
    for (const float x : {0.0F, 0.5F}) {
      Box quarter = core;
      quarter.min += core.size() * glm::vec3(x, y, 0);
      if (quarter.min.x > source.model_box.max.x || quarter.min.y > source.model_box.max.y) continue;
      quarter.max.x = quarter.min.x + core.size().x / 2, quarter.max.y = quarter.min.y + core.size().y / 2;
      const Result<TileResult> part = work_tile(source, quarter);
      if (!part.ok()) return part.error();
      append(made, *part);
    }
  return made;
}

Ground make_ground(const Box& box) {
  Ground ground;
  ground.corner = glm::dvec2(box.min) - Ground::kSquareM;
  ground.nx = static_cast<uint32_t>(double(box.size().x) / Ground::kSquareM) + 4;
  ground.ny = static_cast<uint32_t>(double(box.size().y) / Ground::kSquareM) + 4;
  ground.solid_m.assign(size_t(ground.nx) * ground.ny, kFar);
  ground.slips = SlipMap(ground.nx, ground.ny);
  return ground;
}

void add_tile(Ground& ground, const TileResult& tile) {
  for (const auto& [at, slip] : tile.slips) {
    const auto square = squares_of(ground, at, at);
    ground.slips.add(slip.way, square[0], square[1]);
    ground.slips_top_m = std::max(ground.slips_top_m, slip.top_m);
  }
  for (const auto& [square, solid_m] : tile.ground) ground.solid_m[square] = std::min(ground.solid_m[square], solid_m);
}

void complete(Ground& ground) {
  ground.slips.complete();
  for (float& solid : ground.solid_m)
    if (solid == kFar) solid = -kFar;  // beyond the model
}

/// Looks for slips between two boxes: halves rectangles of squares as long as they hold some.
class SlipSearch {
 public:
  SlipSearch(const Ground& ground, const Box& from, const Box& to) : ground_(ground), from_(from), to_(to) {}

  bool run() {
    const glm::vec2 low(glm::min(from_.min, to_.min)), high(glm::max(from_.max, to_.max));
    // A ray that meets a slip towards +x starts on its -x side and ends on its +x side.
    const std::array<std::array<glm::vec2, 2>, 4> ranges = {{{{{from_.min.x, low.y}, {to_.max.x, high.y}}},
                                                             {{{to_.min.x, low.y}, {from_.max.x, high.y}}},
                                                             {{{low.x, from_.min.y}, {high.x, to_.max.y}}},
                                                             {{{low.x, to_.min.y}, {high.x, from_.max.y}}}}};
    for (size_t way = 0; way < 4; ++way) {
      const auto [first, last] = ranges[way];
      if (first.x > last.x || first.y > last.y) continue;
      const auto square = squares_of(ground_, glm::dvec2(first) - 0.5, glm::dvec2(last) + 0.5);
      if (search(way, square[0], square[1], square[2] + 1, square[3] + 1)) return true;
    }
    return false;
  }

 private:
  bool search(size_t way, size_t x0, size_t y0, size_t x1, size_t y1) const {
    if (ground_.slips.surely_none(way, x0, y0, x1, y1)) return false;
    if (beside(x0, y0, x1, y1)) return false;
    if (x1 - x0 == 1 && y1 - y0 == 1) return true;
    if (x1 - x0 >= y1 - y0) {
      const size_t middle = (x0 + x1) / 2;
      return search(way, x0, y0, middle, y1) || search(way, middle, y0, x1, y1);
    }
    const size_t middle = (y0 + y1) / 2;
    return search(way, x0, y0, x1, middle) || search(way, x0, middle, x1, y1);
  }

  /// Whether squares lie outside the hull of the two plans: beyond a line through like corners that both keep to.
  bool beside(size_t x0, size_t y0, size_t x1, size_t y1) const {
    const glm::dvec2 low = ground_.corner + glm::dvec2(x0, y0) * Ground::kSquareM - 0.5;
    const glm::dvec2 high = ground_.corner + glm::dvec2(x1, y1) * Ground::kSquareM + 0.5;
    const auto corner = [](const glm::dvec2& a, const glm::dvec2& b, unsigned i) {
      return glm::dvec2((i & 1U) != 0 ? b.x : a.x, (i & 2U) != 0 ? b.y : a.y);
    };
    for (unsigned i = 0; i < 4; ++i) {
      const glm::dvec2 p = corner(glm::dvec2(from_.min), glm::dvec2(from_.max), i);
      const glm::dvec2 way = corner(glm::dvec2(to_.min), glm::dvec2(to_.max), i) - p;
      const auto range = [&](const glm::dvec2& a, const glm::dvec2& b) {
        double least = std::numeric_limits<double>::infinity(), most = -least;
        for (unsigned k = 0; k < 4; ++k) {
          const glm::dvec2 d = corner(a, b, k) - p;
          const double side = way.x * d.y - way.y * d.x;
          least = std::min(least, side), most = std::max(most, side);
        }
        return std::pair(least, most);
      };
      const auto a = range(glm::dvec2(from_.min), glm::dvec2(from_.max));
      const auto b = range(glm::dvec2(to_.min), glm::dvec2(to_.max));
      const auto squares = range(low, high);
      if (squares.first > std::max(a.second, b.second) || squares.second < std::min(a.first, b.first)) return true;
    }
    return false;
  }

  const Ground& ground_;
  const Box &from_, &to_;
};

}  // namespace

float OccluderSet::Ground::solid_below(const Box& rectangle) const {
  if (solid_m.empty()) return -kFar;
  const auto square = squares_of(*this, glm::dvec2(rectangle.min), glm::dvec2(rectangle.max));
  if (square[2] - square[0] > 64 || square[3] - square[1] > 64) return -kFar;  // bounds the time
  float lowest = kFar;
  for (size_t y = square[1]; y <= square[3]; ++y)
    for (size_t x = square[0]; x <= square[2]; ++x) lowest = std::min(lowest, solid_m[y * nx + x]);
  return lowest;
}

bool OccluderSet::Ground::has_slips(const Box& from, const Box& to) const {
  return slips_top_m > -kFar && SlipSearch(*this, from, to).run();
}

uint64_t most_tile_bytes(const OccluderOptions& options) { return std::min(options.memory_bytes / 2, kMostTileBytes); }

Result<OccluderSet> extract_occluders(const ModelReader& model, const OccluderOptions& options, JobMonitor& monitor) {
  const ModelTables& tables = model.model().tables;
  Box box;
  for (const NodeId root : tables.roots) box.add(tables.nodes[index_of(root)].box);
  OccluderSet set;
  if (box.empty()) return set;
  const auto tiles_x = static_cast<size_t>(double(box.size().x) / options.tile_m) + 1;
  const auto tiles_y = static_cast<size_t>(double(box.size().y) / options.tile_m) + 1;
  const auto side = static_cast<float>(options.tile_m);
  const size_t tiles = tiles_x * tiles_y;
  set.ground = make_ground(box);
  // Appended in order as they are made: what waits is little.
  std::optional<Error> failure;
  std::atomic<bool> stop = false;
  size_t next = 0, done = 0;
  using Made = std::shared_ptr<Result<TileResult>>;
  const TileSource source{model, box, set.ground, options, monitor, plans_of(model.model().objects.footprints)};
  tbb::parallel_pipeline(
      std::clamp<size_t>(options.memory_bytes / (most_tile_bytes(options) + kTileRoom), 1,
                         2 * static_cast<size_t>(tbb::this_task_arena::max_concurrency())),
      tbb::make_filter<void, size_t>(tbb::filter_mode::serial_in_order, [&](tbb::flow_control& flow) {
        if (next == tiles || stop) flow.stop();
        return next++;
      }) & tbb::make_filter<size_t, Made>(tbb::filter_mode::parallel, [&](size_t i) {
        Box core = box;
        core.min.x += side * float(i % tiles_x), core.min.y += side * float(i / tiles_x);
        core.max.x = core.min.x + side, core.max.y = core.min.y + side;
        return std::make_shared<Result<TileResult>>(work_tile(source, core));
      }) & tbb::make_filter<Made, void>(tbb::filter_mode::serial_in_order, [&](const Made& tile) {
        if (!tile->ok()) {
          if (!failure) failure = tile->error();
          stop = true;
        } else if (!failure) {
          append(set, (*tile)->set);
          add_tile(set.ground, **tile);
        }
        monitor.progress("occluders", ++done, tiles);
      }));
  if (failure) return *failure;
  complete(set.ground);
  return set;
}

}  // namespace promenade
