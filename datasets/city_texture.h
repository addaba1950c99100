#pragma once
// Pictures of facades, painted one by one: no two buildings share theirs.

#include "datasets/city_building.h"

namespace promenade {

/// The unrolled walls of a building: bricks or plaster, weathered, with what its panes reflect. Pure; any thread.
Image paint_facade(const FacadeSketch& sketch, uint32_t width, uint32_t height, uint64_t seed);

}  // namespace promenade
