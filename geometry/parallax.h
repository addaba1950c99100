#pragma once
// How far off a picture of what is far away may look to an eye that is not where the picture was taken, and how large
// the eye's cell may be for that. Source: [xiong1996] chapters 2 and 4.

#include <glm/vec3.hpp>

#include "geometry/result.h"

namespace promenade {

/// The largest angle, in radians, at which an eye in a box about the origin sees two points of one ray from the origin
/// apart: a point as it is drawn, and the one that it is drawn for. half_m: half the box's size along each axis, >= 0.
/// direction: not 0, of any length; drawn and true: in lengths of it, > 0; infinity: infinitely far. The corners of the
/// box are asked: none of its points sees more while both points lie outside the ball around it. Pi for what is no
/// number. Pure; any thread.
double parallax_rad(const glm::dvec3& half_m, const glm::dvec3& direction, double drawn, double true_one);

/// What a ray from a box's centre makes of an eye in the box: how far it may be along the ray, and aside of it.
struct EyeReach {
  double along_m = 0, aside_m = 0;
};
/// half_m: as above; unit_direction: of length 1.
EyeReach eye_reach(const glm::dvec3& half_m, const glm::dvec3& unit_direction);

/// Never below the parallax of two points of the ray, metres from the centre, for any eye in the box, and near it where
/// that is small: by inverse distances alone. A right angle where one of them is not beyond the box. Pure; any thread.
double parallax_bound_rad(const EyeReach& reach, double drawn_m, double true_m);

/// The distances from the centre at which a point of the ray may be drawn whose true distance is given, by the same
/// bound, which is below a right angle: none where `from` is above `to`; `to` may be infinite.
struct DistanceRange {
  double from_m = 0, to_m = 0;
};
DistanceRange drawable_range(const EyeReach& reach, double true_m, double bound_rad);

/// Cubes about one centre: the eye's cell, the box on whose sides everything beyond is drawn, and how far that reaches.
struct FarCubes {
  double cell_m = 0;   ///< length of the cell, >= 0, below the box's
  double box_m = 0;    ///< length of the box, > 0
  double reach_m = 0;  ///< along an axis from the centre to the farthest point, at least half the box; may be infinite
};

/// The largest parallax of any point beyond the box, drawn where its ray from the centre leaves the box, over all eyes
/// in the cell. Pi where the cubes are none. Pure; any thread.
double largest_parallax_rad(const FarCubes& cubes);

/// The same by [xiong1996] equation 2.2, which looks for it straight ahead only (reach = model - cell / 2): up to
/// a ninth too small, for the worst ray leaves the cell a little off its corner's.
double published_parallax_rad(double cell_m, double box_m, double model_m);

/// Which of the two decides how large cells may be.
enum class ParallaxRule : uint8_t {
  everywhere,  ///< over all rays and eyes
  published,   ///< straight ahead only, as published
};

/// What a view cell is to keep.
struct CellBound {
  double bound_rad = 0;    ///< parallax, (0, pi / 2)
  double box_m = 0;        ///< length of the box, > 0
  double model_m = 0;      ///< length of the model, >= the box's: nothing is farther than this from an eye in the cell
  bool from_cell = false;  ///< model_m leaves out the cell: from its near side on
  ParallaxRule rule = ParallaxRule::everywhere;
};

/// The length of the largest cubic view cell that keeps the bound, metres; the box's own where every cell does. Rounded
/// down. Refuses what is no number or out of range, with a message. Source: [xiong1996] equation 2.2, solved for the
/// cell.
Result<double> view_cell_length_m(const CellBound& bound);

}  // namespace promenade
