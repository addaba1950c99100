#pragma once
// What a source's solids are known to fill, from the ground up: plans of buildings, each with the height to which all
// of it is solid.

#include <glm/mat4x4.hpp>
#include <optional>
#include <span>

#include "geometry/mesh.h"
#include "layout/footprints.h"

namespace promenade {

/// The footprints of a mesh that is said to be a solid, in its own space, z up: prisms that its opaque surface closes
/// in, from just above its lowest point to as far as nothing cuts them; of a stepped tower one for each step. Proved,
/// not believed: none where the surface has a hole (where two triangles do not use an edge both ways), and none but
/// where it winds around what is within. Outlines keep 2 mm within the walls. Pure. Time: triangles times outline.
Footprints footprints_of(const Mesh& mesh, std::span<const Material> materials);

/// The footprints somewhere else. Nullopt: they would not stand upright there, or lie mirrored.
std::optional<Footprints> placed(const Footprints& footprints, const glm::dmat4& world_from_mesh);

}  // namespace promenade
