#pragma once
// One block of the city with the near halves of its streets: everything that stands on it.

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <string>
#include <vector>

#include "datasets/city_building.h"
#include "datasets/city_plan.h"
#include "datasets/city_prop.h"

namespace promenade {

/// Geometry that exists once.
struct UniqueObject {
  std::string name, class_name;
  Mesh mesh;
  glm::dvec3 origin{0};                ///< of the mesh in the world
  std::optional<FacadeSketch> facade;  ///< textured buildings
};

struct PropInstance {
  PropKind kind;
  glm::dvec3 position{0};
  double yaw_rad = 0, scale = 1;
};

struct CityBlock {
  std::vector<UniqueObject> objects;
  std::vector<PropInstance> props;
  uint64_t unique_triangles = 0;
  uint64_t triangles = 0;  ///< instances counted each
  uint32_t buildings = 0;
  double facade_m2 = 0;  ///< of the buildings that are to be textured
};

struct BlockOptions {
  double detail = 2;      ///< [0, kMaxTier]
  bool counting = false;  ///< no meshes, names or props: only counts
};

/// The block in cell (x, y) of the plan: a function of the plan's options, x, y and `options` only. Any thread.
CityBlock make_block(const CityPlan& plan, uint32_t x, uint32_t y, const BlockOptions& options, PropLibrary& props);

/// How far from the kerb a walker on the pavement keeps, metres into the block.
double walking_line_m(const CityOptions& options);
/// Parked cars keep so far from a block's corners, metres.
constexpr double kClearCornerM = 9;

}  // namespace promenade
