#pragma once
// Footprints that a source tells of, held against the columns of a tile: where columns know an outline to a hand's
// breadth, footprints know it exactly.

#include <optional>
#include <span>
#include <vector>

#include "layout/footprints.h"
#include "preprocess/plan_polygons.h"
#include "preprocess/visibility/columns.h"

namespace promenade {

class KnownPlans {
 public:
  /// Of the numbered footprints those that lie on the grid as a whole and stand in the ground: where what is solid all
  /// the way down reaches their base in every column that they touch.
  KnownPlans(const Footprints& footprints, std::span<const uint32_t> numbers, const ColumnGrid& grid,
             const SolidColumns& solid);

  /// Whether a footprint touches the column. What stands wall to wall meets there, for columns with a wall in them are
  /// not solid by themselves.
  bool touches(uint32_t column) const { return !touched_.empty() && touched_[column]; }

  /// Says which columns hang together: by column.
  void assign(std::span<const uint32_t> region_of);

  /// A region's heights at which footprints end, ascending.
  std::vector<float> tops_of(uint32_t region) const;

  struct Outline {
    PlanLoops loops;  ///< united
    float top_m = 0;  ///< all of it is solid up to here, all the way down from here
  };
  /// What the region's footprints fill up to a height or above, if that is about what the given columns are; those
  /// that stand wall to wall as one.
  std::optional<Outline> outline_of(uint32_t region, float top_m, std::span<const uint32_t> columns) const;

 private:
  struct Plan {
    PlanLoops loops;
    float top_m = 0;
    std::vector<uint32_t> inside;  ///< columns with their middle in it, ascending
    uint32_t region = 0;
  };
  std::vector<Plan> plans_;
  std::vector<bool> touched_;  ///< by column; empty: none is
};

}  // namespace promenade
