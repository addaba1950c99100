#pragma once
// How large and how detailed a city must be to have about as many triangles as were asked for.

#include "datasets/city_block.h"
#include "geometry/job_monitor.h"

namespace promenade {

struct CityBudget {
  CityOptions options;  ///< with blocks_x, blocks_y set
  double detail = 2;
  double triangles = 0;         ///< expected
  double unique_triangles = 0;  ///< expected
  double facade_m2 = 0;         ///< expected; textured cities only
};

/// Counts sample blocks without building them. Uses the calling thread's task arena; the same result for any number of
/// threads.
CityBudget plan_budget(const CityOptions& options, PropLibrary& props);

}  // namespace promenade
