#include "datasets/city_lots.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace promenade {
namespace {

constexpr double kSmallestLotM = 9;  // narrower ones stay empty
constexpr double kAlleyM = 5;
constexpr double kSetbackM = 1.2;  // between the pavement and a building

/// Cuts of [low, high] into parts at random spacing, none smaller than 0.5 of an even part.
std::vector<double> random_cuts(double low, double high, uint32_t parts, Random& random) {
  std::vector<double> weights(parts);
  double sum = 0;
  for (double& w : weights) sum += w = random.range(0.55, 1.45);
  std::vector<double> cuts = {low};
  for (const double w : weights) cuts.push_back(cuts.back() + (high - low) * w / sum);
  cuts.back() = high;
  return cuts;
}

/// A number up to `most`, at least `least` where that allows it.
uint32_t at_least(uint32_t least, uint32_t most, Random& random) {
  const uint32_t low = std::min(least, most);
  return low + random.below(most - low + 1);
}

/// Buildings are tallest in the middle of the city.
double height_at(const CityPlan& plan, const glm::dvec2& at, Random& random) {
  const glm::dvec2 from_middle = (at - plan.size() * 0.5) / (plan.size() * 0.5);
  const double middle = std::exp(-1.6 * glm::dot(from_middle, from_middle));
  const double high = plan.options().max_height_m;
  const double dice = random.unit();
  return std::min(high, high * (0.13 + 0.1 * random.unit() + (0.2 + 0.62 * middle) * std::pow(dice, 1.9)));
}

void fill_lot(const CityPlan& plan, Lot& lot, Random random) {
  const glm::dvec2 size = lot.rect.size();
  const double least = std::min(size.x, size.y);
  lot.seed = random.next();
  if (least < kSmallestLotM) return;
  const bool at_street = lot.street[0] || lot.street[1] || lot.street[2] || lot.street[3];
  const double dice = random.unit();
  lot.use = dice < (at_street ? 0.07 : 0.3)   ? LotUse::park
            : dice < (at_street ? 0.1 : 0.42) ? LotUse::fountain
                                              : LotUse::building;
  if (lot.use != LotUse::building) return;
  lot.height_m = std::min(height_at(plan, (lot.rect.low + lot.rect.high) * 0.5, random), 4.5 * least);
  lot.height_m = std::max(lot.height_m, std::min(6.5, plan.options().max_height_m));
}

}  // namespace

BlockLots lots_of_block(const CityPlan& plan, uint32_t x, uint32_t y) {
  const CityOptions& options = plan.options();
  Random random(options.seed, {0xb10c, x, y});
  BlockLots result;
  const PlanRect inner = plan.block(x, y).inset(options.curb_width_m);
  result.park = options.blocks_x * options.blocks_y > 3 && random.chance(0.07);
  result.tree_lined = options.tree_distance_m > 0 && random.chance(0.55);
  const glm::dvec2 size = inner.size();
  if (result.park || size.x < kSmallestLotM || size.y < kSmallestLotM) return result;
  // One row only where blocks are thin, and at least three columns if there may be: no building fills a block.
  const uint32_t least_rows = size.y > 40 ? 2 : 1, least_columns = size.x > 60 ? 3 : 2;
  const uint32_t rows = at_least(least_rows, options.max_rows, random);
  const std::vector<double> row_cuts = random_cuts(inner.low.y, inner.high.y, rows, random);
  const uint32_t alley = rows > 1 && random.chance(0.5) ? 1 + random.below(rows - 1) : rows;
  for (uint32_t r = 0; r < rows; ++r) {
    PlanRect row{{inner.low.x, row_cuts[r]}, {inner.high.x, row_cuts[r + 1]}};
    row.low.y += r == 0 ? kSetbackM : r == alley ? kAlleyM / 2 : 0.6;
    row.high.y -= r + 1 == rows ? kSetbackM : r + 1 == alley ? kAlleyM / 2 : 0.6;
    const uint32_t columns = at_least(least_columns, options.max_columns, random);
    const std::vector<double> cuts = random_cuts(row.low.x, row.high.x, columns, random);
    for (uint32_t c = 0; c < columns; ++c) {
      const double gap = random.chance(0.3) ? random.range(1.0, 2.5) : 0.4;
      Lot lot;
      lot.rect = {{cuts[c] + (c == 0 ? kSetbackM : gap), row.low.y},
                  {cuts[c + 1] - (c + 1 == columns ? kSetbackM : gap), row.high.y}};
      lot.street = {r == 0, c + 1 == columns, r + 1 == rows, c == 0};
      fill_lot(plan, lot, random.fork(r * 64 + c));
      result.lots.push_back(lot);
    }
  }
  if (alley < rows)
    result.alleys.push_back(
        {{inner.low.x, row_cuts[alley] - kAlleyM / 2}, {inner.high.x, row_cuts[alley] + kAlleyM / 2}});
  return result;
}

}  // namespace promenade
