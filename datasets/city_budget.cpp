#include "datasets/city_budget.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace promenade {
namespace {

constexpr double kUsualDetail = 2.6;    // recessed windows with sills and frames on most facades
constexpr uint64_t kMostSamples = 768;  // blocks differ by half their mean: their mean is then known to about 2 %
constexpr int kSteps = 9;               // halvings of the detail's range

struct Sums {
  uint64_t triangles = 0, unique = 0;
  double facade_m2 = 0;
};

uint64_t block_count(const CityOptions& options) { return uint64_t(options.blocks_x) * options.blocks_y; }

/// Expected totals of the whole city.
CityBudget count(const CityOptions& options, double detail, PropLibrary& props) {
  const CityPlan plan(options);
  const uint64_t blocks = block_count(options), samples = std::min(blocks, kMostSamples);
  std::vector<Sums> sums(samples);
  tbb::parallel_for(uint64_t(0), samples, [&](uint64_t i) {
    // One block at random out of each of as many equal runs.
    const uint64_t low = blocks * i / samples, high = blocks * (i + 1) / samples;
    const uint64_t b = low + Random(options.seed, {0x5a3, i}).next() % (high - low);
    const CityBlock block = make_block(plan, static_cast<uint32_t>(b % options.blocks_x),
                                       static_cast<uint32_t>(b / options.blocks_x), {detail, true}, props);
    sums[i] = {block.triangles, block.unique_triangles, block.facade_m2};
  });
  CityBudget budget{options, detail, 0, 0, 0};
  for (const Sums& s : sums)
    budget.triangles += static_cast<double>(s.triangles), budget.unique_triangles += static_cast<double>(s.unique),
        budget.facade_m2 += s.facade_m2;
  const double scale = static_cast<double>(blocks) / static_cast<double>(samples);
  budget.triangles *= scale, budget.unique_triangles *= scale, budget.facade_m2 *= scale;
  return budget;
}

/// As many blocks as the triangles ask for at the usual detail, the city about as long as wide.
CityOptions with_blocks(CityOptions options, PropLibrary& props) {
  if (options.blocks_x > 0 && options.blocks_y > 0) return options;
  CityOptions trial = options;
  trial.blocks_x = trial.blocks_y = 16;
  const double per_block = count(trial, kUsualDetail, props).triangles / 256;
  const double blocks = std::max(1.0, static_cast<double>(options.triangles) / per_block);
  const double length = options.block_length_m + options.street_width_m,
               width = options.block_width_m + options.street_width_m;
  const auto whole = [](double value) { return static_cast<uint32_t>(std::clamp(std::round(value), 1.0, 1e6)); };
  if (options.blocks_x == 0 && options.blocks_y == 0)
    options.blocks_y = whole(std::ceil(std::sqrt(blocks * length / width) - 0.3));
  if (options.blocks_x == 0)
    options.blocks_x = whole(std::ceil(blocks / options.blocks_y - 0.3));
  else if (options.blocks_y == 0)
    options.blocks_y = whole(blocks / options.blocks_x);
  return options;
}

}  // namespace

CityBudget plan_budget(const CityOptions& options, PropLibrary& props) {
  const CityOptions sized = with_blocks(options, props);
  const auto wish = static_cast<double>(options.triangles);
  double low = 0, high = kMaxTier + 0.5;
  CityBudget best;
  double best_error = INFINITY;
  for (int step = 0; step < kSteps; ++step) {
    const double middle = step == 0 ? std::min(kUsualDetail, high) : (low + high) / 2;
    const CityBudget budget = count(sized, middle, props);
    const double error = std::abs(budget.triangles - wish);
    if (error < best_error) best = budget, best_error = error;
    (budget.triangles < wish ? low : high) = middle;
    if (error < 0.004 * wish) break;
  }
  return best;
}

}  // namespace promenade
