#pragma once
// Meshes from formats that give points one by one in double precision, and polygons.

#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "preprocess/import_polygon.h"
#include "preprocess/repair.h"
#include "preprocess/scene.h"

namespace promenade {

/// A vertex as a file has it.
struct SourceVertex {
  glm::dvec3 position{0};
  std::optional<glm::vec3> normal;
  std::optional<glm::vec2> texcoord;
  std::optional<glm::u8vec4> color;
};

/// Collects one mesh. Positions stay double until finish() has taken off an offset, so that a building at UTM
/// coordinates keeps its millimetres. Attributes that only some vertices have are filled in (white, (0, 0), the
/// triangle's normal).
class MeshBuilder {
 public:
  uint32_t add_vertex(const SourceVertex& vertex);
  const glm::dvec3& position(uint32_t vertex) const { return positions_[vertex]; }
  size_t vertex_count() const { return positions_.size(); }
  size_t triangle_count() const { return mesh_.indices.size() / 3; }

  /// Vertices must be there.
  void add_triangle(uint32_t a, uint32_t b, uint32_t c, uint32_t material);
  /// A polygon by its rings' vertices, one ring after the other; triangulated. Adds to faces_non_planar,
  /// faces_degenerate (no area), faces_unclean (crosses itself).
  void add_polygon(std::span<const uint32_t> corners, std::span<const uint32_t> ring_sizes, uint32_t material,
                   Counts& counts);

  /// The mesh, and where its origin lies in the source. The offset is a multiple of 1024 units, so that meshes beside
  /// each other round to the same places and small coordinates stay as they are. The builder is empty afterwards.
  Mesh finish(glm::dvec3& offset);

 private:
  void fill_normals();

  Mesh mesh_;
  std::vector<glm::dvec3> positions_;
};

/// Adds the builder's mesh with an instance of it to the scene, unless it has no triangle. is_solid: as in
/// SceneInstance.
void add_object(Scene& scene, MeshBuilder& builder, const std::string& name, const std::string& class_name,
                bool is_solid = false);

}  // namespace promenade
