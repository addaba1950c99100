#pragma once
// What a model's tables hold: always in memory while a model is open. FORMAT.md says how each is written.

#include <cstdint>
#include <glm/vec3.hpp>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "codec/geometry_codec.h"
#include "geometry/box.h"
#include "geometry/cone.h"
#include "geometry/mesh.h"
#include "geometry/node_id.h"
#include "layout/objects.h"

namespace promenade {

/// One run of bytes in one of the model's data files: what is read as a unit, incrementally ([funkhouser1993]
/// section 5.1).
struct SegmentRecord {
  enum class Type : uint16_t { mesh = 1, texture = 2 };
  Type type = Type::mesh;
  uint16_t file = 0;  ///< index into ModelManifest::files
  uint64_t offset = 0;
  uint32_t stored_bytes = 0;
  uint64_t checksum = 0;  ///< XXH3 of the stored bytes
  bool operator==(const SegmentRecord&) const = default;
};

/// One node of the HLOD tree.
struct NodeRecord {
  Box box;  ///< bounds the node's mesh and all its descendants' (so that culling the node culls them)
  float error_m =
      0;  ///< bound on the two-sided distance between the node's surface and the source's; 0 only for exact leaves
  float error_p99_m = 0;        ///< 99th percentile of the same distances, sampled; <= error_m
  NormalCone cone;              ///< over the node's mesh and all its descendants'; cos -1 if any is two-sided
  glm::vec3 average_normal{0};  ///< area-weighted mean of the mesh's normals, unit, or 0 ([lakhia2004] section 3.3)
  float surface_m2 = 0;
  NodeId parent = kNoNode;   ///< kNoNode: a root
  uint32_t first_child = 0;  ///< into ModelTables::children
  uint32_t child_count = 0;  ///< 0: a leaf, which holds source triangles
  uint32_t level = 0;        ///< 0: root
  uint32_t triangles = 0;
  uint32_t textured_triangles = 0;
  uint32_t vertices = 0;
  uint32_t segment = 0;        ///< into ModelTables::segments: the mesh
  uint32_t first_texture = 0;  ///< into ModelTables::node_textures
  uint32_t texture_count = 0;  ///< textures that must be resident to draw the node
  bool operator==(const NodeRecord&) const = default;
};

/// Which of a node's two errors a front is chosen by: the bound, or the 99th percentile, which most of the surface
/// keeps. What is hidden is always decided by the bound.
enum class ErrorKind : uint8_t { bound, p99 };
inline float error_m(const NodeRecord& node, ErrorKind kind) {
  return kind == ErrorKind::bound ? node.error_m : node.error_p99_m;
}

/// A texture: a picture in a segment of its own, shared by the nodes that name it.
struct TextureRecord {
  uint32_t width = 0;
  uint32_t height = 0;
  uint32_t segment = 0;
  uint32_t flags = 0;  ///< bit 0: has opacity below 255; bit 1: an atlas baked for one inner node
  static constexpr uint32_t kHasOpacity = 1, kAtlas = 2;
  bool operator==(const TextureRecord&) const = default;
};

struct ModelTables {
  std::vector<NodeRecord> nodes;  ///< by NodeId
  std::vector<NodeId> children;   ///< each node's children, contiguous
  std::vector<NodeId> roots;
  std::vector<Material> materials;  ///< Mesh::materials of every node index this; Material::texture indexes `textures`
  std::vector<TextureRecord> textures;
  std::vector<uint32_t> node_textures;  ///< each node's texture indices, contiguous
  std::vector<SegmentRecord> segments;
};

/// What a person asks of a model: counts, settings, provenance. JSON on disk.
struct ModelManifest {
  static constexpr uint32_t kVersion = 2;       ///< the newest that is read
  static constexpr uint32_t kVersionPlain = 1;  ///< of models without objects.bin
  std::string tool_version;
  uint64_t input_hash = 0;  ///< of the source's bytes and every setting that affects the output
  glm::dvec3 origin{0};     ///< world position of model space's zero: model = world - origin
  DBox world_box;
  uint64_t source_triangles = 0;  ///< after repair, instances counted each
  GeometryCodec geometry_codec = GeometryCodec::meshopt;
  struct File {
    std::string name;
    uint64_t bytes = 0;
    bool operator==(const File&) const = default;
  };
  std::vector<File> files;                        ///< the data files that segments lie in, and "tables.bin" last
  std::map<std::string, std::string> settings;    ///< of the build, by option name
  std::vector<std::string> sources;               ///< names as given, without machine-specific folders
  std::map<std::string, uint64_t> import_counts;  ///< what import found and repaired
  std::vector<std::string> notes;                 ///< warnings: missing textures by name, ...
};

struct Model {
  ModelManifest manifest;
  ModelTables tables;
  ModelObjects objects = {};

  /// Nodes from this one on are of objects that move: their boxes hold what they sweep, their meshes are in the
  /// objects' own spaces.
  uint32_t first_moving_node() const {
    return static_cast<uint32_t>(tables.nodes.size() - objects.moving_nodes.size());
  }
  bool is_moving(NodeId id) const { return index_of(id) >= first_moving_node(); }
  std::span<const NodeId> children_of(NodeId id) const {
    const NodeRecord& node = tables.nodes[index_of(id)];
    return {tables.children.data() + node.first_child, node.child_count};
  }
  std::span<const uint32_t> textures_of(NodeId id) const {
    const NodeRecord& node = tables.nodes[index_of(id)];
    return {tables.node_textures.data() + node.first_texture, node.texture_count};
  }
};

/// Model space from each moving object's own space. Pure; any thread.
std::vector<glm::dmat4> model_from_objects(const Model& model, double time_s);

/// Empty when every index, range, box and number in the tables is sound (children partition the nodes under the roots,
/// no cycles, parents' boxes contain children's, errors fall from parent to child, segments lie inside their files);
/// else what is wrong.
std::string find_defect(const Model& model);

}  // namespace promenade
