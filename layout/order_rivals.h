#pragma once
// Other orders of columns, to compare the tour with.

#include <glm/vec3.hpp>

#include "layout/incidence.h"

namespace promenade {

/// By the places of their nodes along a curve that fills space, 21 bits an axis of the box of all. points: metres, by
/// column. Ties by number. Sources: G. M. Morton, 1966; D. Hilbert, 1891, by J. Skilling, Programming the Hilbert
/// curve, 2004.
ColumnOrder morton_order(std::span<const glm::vec3> points);
ColumnOrder hilbert_order(std::span<const glm::vec3> points);

/// Halves the columns so that rows fall into one half or the other, and so on. Deterministic. Time in proportion to
/// the ones times the logarithm of the columns. Source: L. Dhulipala et al., Compressing graphs and indexes with
/// recursive graph bisection, 2016.
ColumnOrder bisection_order(const Incidence& matrix);

}  // namespace promenade
