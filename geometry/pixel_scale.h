#pragma once
// Object-space error from screen-space error, for a viewer that may stand anywhere in a box and look anywhere.

#include <cstdint>

#include "geometry/box.h"

namespace promenade {

/// Which pixels a bound in pixels is meant for.
enum class ErrorAt : uint8_t {
  center,  ///< the picture's middle, as screen_error_px counts: what the viewer looks at
  corner,  ///< every pixel: towards the corners a perspective stretches, 2.4 times at 60 degrees and 16 : 9
};

/// What of a camera turns angles into pixels.
struct PixelScale {
  double focal_px = 0;    ///< eye to picture plane, > 0: height / (2 tan(fov / 2)), pixels
  double tan_corner = 0;  ///< tangent of the angle between the axis and the farthest pixel that the bound is meant for
  bool operator==(const PixelScale&) const = default;
};

/// width_px, height_px >= 1; vertical_fov_deg in (0, 180).
PixelScale pixel_scale(uint32_t width_px, uint32_t height_px, double vertical_fov_deg, ErrorAt where = ErrorAt::center);

/// The largest object-space error of a node, in metres, that stays within pixel_error pixels from every eye in the
/// cell: 0 when the boxes touch. Both boxes closed, metres, one frame. Pure; any thread.
/// Source: [chhugani2003] section 2.2, exact instead of for infinitesimal errors; derived in pixel_scale.cpp.
double allowed_error_m(const Box& cell, const Box& node_box, double pixel_error, const PixelScale& scale);

/// Smallest distance between two closed boxes, metres; 0 when they touch.
double distance_m(const Box& a, const Box& b);

}  // namespace promenade
