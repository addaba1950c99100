#pragma once
// A scene: what one part of a source holds, read once, instances not flattened.

#include <cstdint>
#include <filesystem>
#include <glm/mat4x4.hpp>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "geometry/animation.h"
#include "geometry/mesh.h"

namespace promenade {

/// A texture as the source has it: encoded bytes (embedded, or read from a file beside the source), decoded when
/// needed.
struct SourceTexture {
  std::string name;                ///< for messages: file name or image name
  std::vector<std::byte> encoded;  ///< empty: missing or unreadable; drawn in a plain colour and named in the report
};

/// An object: a mesh placed in the world.
struct SceneInstance {
  uint32_t mesh = 0;
  glm::dmat4 world_from_mesh{
      1.0};                ///< double: a mesh at UTM coordinates keeps small numbers in the mesh and the offset here
  std::string name;        ///< as in the source; may be empty
  std::string class_name;  ///< "chair", "Building", ...; may be empty
  /// What the object hangs on; kNoJoint: it stands still. world_from_mesh is then where it rests while nothing plays.
  uint32_t joint = kNoJoint;
  glm::dmat4 joint_from_mesh{1.0};
  bool is_solid = false;  ///< the source says that the mesh is the surface of something solid
};

/// What import found and mended. Names of counts are stable: they go into the manifest and --json.
struct ImportReport {
  /// Keys: triangles (each instance's), triangles_unique, vertices, instances, meshes; textures_missing,
  /// materials_missing, vertices_non_finite, vertices_out_of_range, attributes_non_finite, faces_degenerate,
  /// faces_duplicate, faces_non_planar, faces_unclean (crossing themselves), faces_reoriented, faces_dropped,
  /// instances_dropped, nodes_skipped, primitives_skipped, features_skipped; moving_objects,
  /// animation_channels_dropped, animations_dropped (objects that stand still after all). A count of 0 may be absent.
  std::map<std::string, uint64_t> counts;
  std::vector<std::string> warnings;  ///< one line each, e.g. "missing texture facade.png"
};

/// Metres, z up, world coordinates.
struct Scene {
  std::vector<Mesh> meshes;         ///< Mesh::materials index `materials`; find_defect empty for each
  std::vector<Material> materials;  ///< Material::texture indexes `textures`; at least one
  std::vector<SourceTexture> textures;
  std::vector<SceneInstance> instances;
  Animation animation;  ///< in the world: metres, z up
  ImportReport report;
};

}  // namespace promenade
