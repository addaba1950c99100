#pragma once
// Relief: parallel planes one behind the other, such as a wall and the panes in its windows. Far away they are one.

#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "preprocess/work_mesh.h"

namespace promenade {

/// Flat faces of a surface that look the same way, with edges that lead from one to the next.
struct Relief {
  glm::vec3 normal{0};
  float low_m = 0, high_m = 0;   ///< along the normal, of its places
  std::vector<uint32_t> places;  ///< ascending
  float depth_m() const { return high_m - low_m; }
};

/// Finds reliefs with at least one large face among the living triangles, shallow ones first: the same wall may come
/// again in deeper ones, with what lies farther behind it. most_depth_m: deeper ones are left out. Deterministic.
/// Linear time but for places with many triangles. Any thread.
std::vector<Relief> find_reliefs(const WorkMesh& work, float most_depth_m);

}  // namespace promenade
