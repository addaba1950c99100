#pragma once
// Cells to try hiders on, for models that have none of their own.

#include <vector>

#include "preprocess/visibility/node_meshes.h"

namespace promenade {

enum class StudyPlace : uint8_t {
  street,  ///< on the ground: nothing above but the sky
  roof,    ///< in the air, up to a third above the highest point
};

struct StudyCellOptions {
  uint64_t seed = 1;
  uint32_t cells = 20;
  StudyPlace place = StudyPlace::street;
  float side_m = 4;    ///< across
  float height_m = 2;  ///< street cells; roof cells are cubes
};

/// Random cells. Fewer than asked for when the model has no such places. Deterministic by seed. Errors: reading the
/// model.
Result<std::vector<Box>> study_cells(const NodeMeshes& meshes, const StudyCellOptions& options);

}  // namespace promenade
