// The eye V lies in a cube of length v about the centre O of a picture, the drawn point Q and the true point P on a ray
// from O. With c = V . d along the ray and s the distance of V from it, the angle P V Q is
//
//     atan(s / (q - c)) - atan(s / (p - c)),    q = |OQ|, p = |OP|,
//
// which grows with s while s^2 < (q - c) (p - c), and with c: outside a ball about the cube, the cube's corners see the
// most. [xiong1996] takes the ray along an axis, where the four corners of a face have c = v / 2 and s = v / sqrt(2).
// But a ray that turns away from one corner by a little loses nothing of c in first order and gains s in first order:
// the worst ray has the direction (1, -e, -e) with e near 0.22, and sees (1 + e) / (1 + 2 e^2) = 1.11 times as much: s
// grows by 1 + e over the ray's length, and so does the distance of the box's side. So `everywhere` searches all rays.
#include "geometry/parallax.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/constants.hpp>
#include <limits>

namespace promenade {
namespace {

constexpr double kPi = glm::pi<double>();

/// Angle between two directions, exact for small ones, too.
double angle_between(const glm::dvec3& a, const glm::dvec3& b) {
  return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
}

/// From eye to the point `times` along the direction; infinitely far: the direction itself.
glm::dvec3 towards(const glm::dvec3& direction, double times, const glm::dvec3& eye) {
  return std::isinf(times) ? direction : direction * times - eye;
}

/// Of the ray through (1, y, z) on the side of a unit box.
double parallax_through(const FarCubes& cubes, double y, double z) {
  const double half_box_m = cubes.box_m / 2;
  return parallax_rad(glm::dvec3(cubes.cell_m / 2), {half_box_m, y * half_box_m, z * half_box_m}, 1,
                      cubes.reach_m / half_box_m);
}

/// The largest value of f over the unit square: of a grid's best point, and then uphill.
template <class F>
double largest_in_square(F&& f) {
  constexpr int kGrid = 12;
  constexpr double kFinest = 1e-7;  // the summit is flat: its height is exact to the square of this
  double y = 0, z = 0, best = f(0.0, 0.0);
  const auto take = [&](double at_y, double at_z) {
    at_y = std::clamp(at_y, 0.0, 1.0), at_z = std::clamp(at_z, 0.0, 1.0);
    const double value = f(at_y, at_z);
    if (value <= best) return false;
    best = value, y = at_y, z = at_z;
    return true;
  };
  for (int i = 0; i <= kGrid; ++i)
    for (int k = 0; k <= i; ++k) take(double(i) / kGrid, double(k) / kGrid);  // y and z may change places
  for (double step = 1.0 / kGrid; step > kFinest;) {
    const double from_y = y, from_z = z;
    bool better = false;
    for (const auto& [dy, dz] : {std::array{1.0, 0.0}, std::array{-1.0, 0.0}, std::array{0.0, 1.0},
                                 std::array{0.0, -1.0}, std::array{1.0, 1.0}, std::array{-1.0, -1.0}})
      better = take(from_y + dy * step, from_z + dz * step) || better;
    if (!better) step /= 2;
  }
  return best;
}

double parallax_of(const CellBound& bound, double cell_m) {
  const double model_m = std::max(bound.from_cell ? bound.model_m + cell_m : bound.model_m, bound.box_m);
  if (bound.rule == ParallaxRule::published) return published_parallax_rad(cell_m, bound.box_m, model_m);
  return largest_parallax_rad({cell_m, bound.box_m, std::max(model_m - cell_m / 2, bound.box_m / 2)});
}

}  // namespace

double parallax_rad(const glm::dvec3& half_m, const glm::dvec3& direction, double drawn, double true_one) {
  const double sum = half_m.x + half_m.y + half_m.z + direction.x + direction.y + direction.z;
  if (!std::isfinite(sum) || std::isnan(drawn) || std::isnan(true_one)) return kPi;
  double largest = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const glm::dvec3 eye((corner & 1) != 0 ? half_m.x : -half_m.x, (corner & 2) != 0 ? half_m.y : -half_m.y,
                         (corner & 4) != 0 ? half_m.z : -half_m.z);
    largest = std::max(largest, angle_between(towards(direction, drawn, eye), towards(direction, true_one, eye)));
  }
  return largest;
}

// Of the angle's tangent, s (p - q) / ((q - c) (p - c) + s^2): leaving out s^2, and with the largest c and s of all
// eyes, it only grows, to s (1 / (q - c) - 1 / (p - c)).
EyeReach eye_reach(const glm::dvec3& half_m, const glm::dvec3& unit_direction) {
  const glm::dvec3 along = glm::abs(half_m * unit_direction);
  // The corner that is least far along the ray, either way, is the farthest aside.
  const double least = std::min({std::abs(along.x + along.y - along.z), std::abs(along.x - along.y + along.z),
                                 std::abs(along.y + along.z - along.x), along.x + along.y + along.z});
  return {along.x + along.y + along.z, std::sqrt(std::max(0.0, glm::dot(half_m, half_m) - least * least))};
}

double parallax_bound_rad(const EyeReach& reach, double drawn_m, double true_m) {
  const double drawn = drawn_m - reach.along_m, true_one = true_m - reach.along_m;
  if (!(drawn > 0 && true_one > 0)) return kPi / 2;
  return std::atan(reach.aside_m * std::abs(1 / drawn - 1 / true_one));
}

DistanceRange drawable_range(const EyeReach& reach, double true_m, double bound_rad) {
  const double beyond = true_m - reach.along_m;
  if (!(beyond > 0)) return {1, 0};
  const double slack = std::tan(bound_rad) / std::max(reach.aside_m, 1e-300);
  const double farther = 1 / beyond - slack;
  return {1 / (1 / beyond + slack) + reach.along_m,
          farther > 0 ? 1 / farther + reach.along_m : std::numeric_limits<double>::infinity()};
}

double largest_parallax_rad(const FarCubes& cubes) {
  const bool sound =
      cubes.cell_m >= 0 && cubes.cell_m < cubes.box_m && std::isfinite(cubes.box_m) && cubes.reach_m >= cubes.box_m / 2;
  if (!sound) return kPi;
  return largest_in_square([&](double y, double z) { return parallax_through(cubes, y, z); });
}

double published_parallax_rad(double cell_m, double box_m, double model_m) {
  const bool sound = cell_m >= 0 && cell_m < box_m && std::isfinite(box_m) && model_m >= box_m;
  if (!sound) return kPi;
  const double aside = cell_m * glm::root_two<double>() / 2;  // s; the corner is half a cell nearer to both points
  return std::atan2(aside, (box_m - cell_m) / 2) - std::atan2(aside, model_m - cell_m);
}

Result<double> view_cell_length_m(const CellBound& bound) {
  if (!(bound.bound_rad > 0 && bound.bound_rad < kPi / 2))
    return Error{fmt::format("parallax bound of {} radians: must be between 0 and a right angle", bound.bound_rad)};
  if (!(bound.box_m > 0 && std::isfinite(bound.box_m)))
    return Error{fmt::format("box of {} m: must be above 0", bound.box_m)};
  if (!(bound.from_cell ? bound.model_m > 0 : bound.model_m >= bound.box_m))
    return Error{fmt::format("model of {} m: must be at least the box's {} m", bound.model_m, bound.box_m)};
  // The angle grows from 0, but a model that ends just behind the box may end that: the first crossing counts.
  constexpr int kSteps = 64, kHalvings = 50;
  double low = 0, high = bound.box_m;
  for (int i = 1; i < kSteps; ++i) {
    const double cell_m = bound.box_m * i / kSteps;
    if (parallax_of(bound, cell_m) > bound.bound_rad) {
      high = cell_m;
      break;
    }
    low = cell_m;
  }
  if (high == bound.box_m && parallax_of(bound, std::nextafter(high, 0.0)) <= bound.bound_rad) return high;
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = (low + high) / 2;
    (parallax_of(bound, middle) > bound.bound_rad ? high : low) = middle;
  }
  return low;
}

}  // namespace promenade
