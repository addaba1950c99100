#pragma once
// One geometry of CityJSON: nested boundaries, semantics, materials and textures to a mesh.

#include <glm/vec3.hpp>
#include <string>
#include <vector>

#include "preprocess/cityjson_appearance.h"
#include "preprocess/import_builder.h"
#include "preprocess/import_json.h"

namespace promenade {

/// A geometry's "lod" ("2.2", or a number in old files); -1: none.
double city_lod(const Json& geometry);

/// Whether it is a solid, or several.
bool is_city_solid(const Json& geometry);

/// Adds the surfaces of a geometry (MultiSurface, CompositeSurface, Solid, MultiSolid, CompositeSolid) to the builder.
/// Other types are counted (primitives_skipped). Indices out of range drop their face (faces_dropped).
void add_city_geometry(const Json& geometry, const std::vector<glm::dvec3>& vertices, const std::string& object_type,
                       CityAppearance& appearance, MeshBuilder& builder, Counts& counts);

}  // namespace promenade
