#pragma once
// The building's structure as closed solids: walls with their openings, floors, ceilings, stairs, roof, ground.

#include <string>
#include <vector>

#include "datasets/building_plan.h"
#include "geometry/mesh.h"

namespace promenade {

/// One object of the structure; its mesh stands in the frame of world_from_part.
struct StructurePart {
  std::string name, class_name;  ///< classes: wall, floor, ceiling, slab, stairs, roof, parapet, ledge, ground
  uint32_t mesh = 0;
  glm::dmat4 world_from_part{1};
};

struct Structure {
  std::vector<Mesh> meshes;
  std::vector<StructurePart> parts;
};

/// Everything that is no furniture, coloured by room. Pure; any thread.
Structure build_structure(const BuildingPlan& plan, uint64_t seed);

}  // namespace promenade
