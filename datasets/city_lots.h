#pragma once
// How a block is divided: rows, columns, and what stands on each lot.

#include <array>
#include <vector>

#include "datasets/city_plan.h"

namespace promenade {

enum class LotUse : uint8_t { empty, park, fountain, building };

/// Sides in the order south, east, north, west.
struct Lot {
  PlanRect rect;  ///< of the plan
  LotUse use = LotUse::empty;
  std::array<bool, 4> street{};
  double height_m = 0;  ///< of a building
  uint64_t seed = 0;
};

struct BlockLots {
  bool park = false;  ///< the whole block is one park
  bool tree_lined = false;
  std::vector<Lot> lots;
  std::vector<PlanRect> alleys;
};

/// Pure. Source: [xiong1996] appendix A.1.
BlockLots lots_of_block(const CityPlan& plan, uint32_t x, uint32_t y);

}  // namespace promenade
