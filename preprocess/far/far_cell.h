#pragma once
// A far picture from the model's nodes.

#include "preprocess/far/far_scene.h"
#include "preprocess/far/far_shape.h"

namespace promenade {

/// What is seen beyond the box around a place of the grid, in triangles that keep the bound. tables: without cells.
/// Errors: reading the model. Any thread.
Result<ShapedFar> draw_far_cell(const FarScene& scene, const FarTables& tables, uint64_t place);

}  // namespace promenade
