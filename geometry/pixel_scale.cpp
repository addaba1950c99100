// Let the eye be v, a point of the source p, and p' the point that is drawn for it, |p - p'| <= e. The node's box holds
// both, so that L = |p - v| >= d, the distance between cell and box. Seen from v, p' lies within asin(e / L) <=
// asin(e / d) =: a of p (the ball of radius e about p seen from v; d > e).
//
// The picture of a direction at the angle t from the camera's axis lies f tan t pixels from the middle. Two directions
// within a of each other, one of them at most m off the axis, are farthest apart in the picture when both lie in one
// plane with the axis, the first at m, the second at m + a: the derivative of the tangent, 1 / cos^2, grows with the
// angle, and across that plane the stretch is 1 / cos only. So the picture moves by at most f (tan(m + a) - tan m), and
// that is at most s pixels exactly when
//
//     a <= atan(tan m + s / f) - m,    e <= d sin(atan(tan m + s / f) - m).
//
// For small errors this is s d cos^2(m) / f, which is the paper's s / S with S = (f + z)^2 / (f L) at its largest:
// nearest, and at the rim of the field of view. m = 0 gives the bound in the middle of the picture.
#include "geometry/pixel_scale.h"

#include <cmath>
#include <glm/trigonometric.hpp>

namespace promenade {

PixelScale pixel_scale(uint32_t width_px, uint32_t height_px, double vertical_fov_deg, ErrorAt where) {
  const double tan_y = std::tan(glm::radians(vertical_fov_deg) / 2);
  const double tan_x = tan_y * double(width_px) / double(height_px);
  return {double(height_px) / (2 * tan_y), where == ErrorAt::corner ? std::hypot(tan_x, tan_y) : 0.0};
}

double distance_m(const Box& a, const Box& b) {
  const DBox first{a.min, a.max}, second{b.min, b.max};
  return glm::length(glm::max(glm::max(first.min - second.max, second.min - first.max), glm::dvec3(0)));
}

double allowed_error_m(const Box& cell, const Box& node_box, double pixel_error, const PixelScale& scale) {
  const double angle = std::atan(scale.tan_corner + pixel_error / scale.focal_px) - std::atan(scale.tan_corner);
  return distance_m(cell, node_box) * std::sin(angle);
}

}  // namespace promenade
