#include "preprocess/visibility/known_plans.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace promenade {
namespace {

constexpr float kFar = std::numeric_limits<float>::infinity();
constexpr uint32_t kNoRegion = 0xffffffffU;
constexpr float kSameTopM = 0.05F;
constexpr double kSame = 0.98;         // of the columns: what footprints must cover to stand for them
constexpr double kSeamM = 0.006;       // between footprints that stand wall to wall: each keeps 2 mm within its own
constexpr double kTouchedPart = 0.75;  // of a column's side: columns whose middle is so near to a border touch it

double distance(const glm::dvec2& p, const glm::dvec2& a, const glm::dvec2& b) {
  const glm::dvec2 way = b - a, from = p - a;
  const double length2 = way.x * way.x + way.y * way.y;
  const double t = length2 > 0 ? std::clamp((from.x * way.x + from.y * way.y) / length2, 0.0, 1.0) : 0.0;
  return std::hypot(from.x - way.x * t, from.y - way.y * t);
}

bool is_near(const PlanLoops& loops, const glm::dvec2& p, double within) {
  for (const PlanLoop& loop : loops)
    for (size_t i = 0, last = loop.size() - 1; i < loop.size(); last = i++)
      if (distance(p, loop[last], loop[i]) < within) return true;
  return false;
}

PlanLoops loops_of(const Footprints& footprints, uint32_t number) {
  PlanLoops loops;
  for (uint32_t l = footprints.first_loop(number); l < footprints.all[number].loops_end; ++l) {
    const std::span<const glm::vec2> points = footprints.loop(l);
    loops.emplace_back(points.begin(), points.end());
  }
  return loops;
}

}  // namespace

KnownPlans::KnownPlans(const Footprints& footprints, std::span<const uint32_t> numbers, const ColumnGrid& grid,
                       const SolidColumns& solid) {
  for (const uint32_t number : numbers) {
    const Footprint& footprint = footprints.all[number];
    Plan plan{loops_of(footprints, number), footprint.top_m, {}, kNoRegion};
    glm::dvec2 low(std::numeric_limits<double>::max()), high(-low);
    for (const glm::dvec2& p : plan.loops[0]) low = glm::min(low, p), high = glm::max(high, p);
    low = (low - grid.low) / grid.column_m, high = (high - grid.low) / grid.column_m;
    if (low.x < 1 || low.y < 1 || high.x > grid.nx - 1.0 || high.y > grid.ny - 1.0) continue;
    bool sound = true;
    std::vector<uint32_t> touched;
    const auto x1 = static_cast<uint32_t>(high.x) + 1, y1 = static_cast<uint32_t>(high.y) + 1;
    for (auto y = static_cast<uint32_t>(low.y) - 1; sound && y <= std::min(y1, grid.ny - 1); ++y)
      for (auto x = static_cast<uint32_t>(low.x) - 1; sound && x <= std::min(x1, grid.nx - 1); ++x) {
        const glm::dvec2 middle = grid.low + (glm::dvec2(x, y) + 0.5) * grid.column_m;
        const bool inside = contains(plan.loops, middle);
        if (!inside && !is_near(plan.loops, middle, kTouchedPart * grid.column_m)) continue;
        const uint32_t column = y * grid.nx + x;
        sound = solid.base_m[column] == -kFar && solid.top_m[column] >= footprint.base_m - ColumnBuilder::kSealedGapM;
        if (inside) plan.inside.push_back(column);
        touched.push_back(column);
      }
    if (!sound || plan.inside.empty()) continue;
    touched_.resize(grid.count(), false);
    for (const uint32_t column : touched) touched_[column] = true;
    plans_.push_back(std::move(plan));
  }
}

void KnownPlans::assign(std::span<const uint32_t> region_of) {
  for (Plan& plan : plans_)
    for (const uint32_t column : plan.inside)
      if (plan.region == kNoRegion) plan.region = region_of[column];
}

std::vector<float> KnownPlans::tops_of(uint32_t region) const {
  std::vector<float> tops;
  for (const Plan& plan : plans_)
    if (plan.region == region) tops.push_back(plan.top_m);
  std::sort(tops.begin(), tops.end());
  tops.erase(std::unique(tops.begin(), tops.end(), [](float a, float b) { return b - a < kSameTopM; }), tops.end());
  return tops;
}

std::optional<KnownPlans::Outline> KnownPlans::outline_of(uint32_t region, float top_m,
                                                          std::span<const uint32_t> columns) const {
  Outline outline{{}, kFar};
  std::vector<uint32_t> inside;
  PlanLoops grown;
  for (const Plan& plan : plans_) {
    if (plan.region != region || plan.top_m < top_m - kSameTopM) continue;
    outline.top_m = std::min(outline.top_m, plan.top_m);
    inside.insert(inside.end(), plan.inside.begin(), plan.inside.end());
    const PlanLoops wider = shrunk(plan.loops, -kSeamM / 2);
    grown.insert(grown.end(), wider.begin(), wider.end());
  }
  std::sort(inside.begin(), inside.end());
  const auto covered = std::count_if(columns.begin(), columns.end(), [&](uint32_t column) {
    return std::binary_search(inside.begin(), inside.end(), column);
  });
  if (inside.empty() || double(covered) < kSame * double(columns.size())) return std::nullopt;
  outline.loops = shrunk(united(grown), kSeamM / 2 + kPlanStepM);
  return outline;
}

}  // namespace promenade
