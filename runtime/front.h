#pragma once
// How large a front is: what a view asks for, whatever is resident.

#include <cstdint>

#include "geometry/camera.h"
#include "layout/model.h"

namespace promenade {

struct FrontSize {
  uint64_t nodes = 0;
  uint64_t triangles = 0;
};

/// The coarsest front whose projected error stays within a bound, beside full detail, which is all leaves.
struct FrontCount {
  FrontSize front;           ///< in all directions
  FrontSize front_in_view;   ///< nodes whose box meets the frustum
  FrontSize leaves;          ///< full detail in all directions
  FrontSize leaves_in_view;  ///< full detail in the frustum
};

/// Counts the front that `Policy::static_error` would draw, with everything resident. pixel_error: pixels, >= 0.
/// Pure; any thread.
FrontCount count_front(const Model& model, const Camera& camera, double pixel_error, ErrorKind kind);

}  // namespace promenade
