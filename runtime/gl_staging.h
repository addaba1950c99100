#pragma once
// Meshes and pictures in the form that OpenGL takes, made away from the render thread.

#include <span>
#include <vector>

#include "runtime/renderer.h"

namespace promenade {

/// 28 bytes a vertex.
struct GlVertex {
  glm::vec3 position;
  uint32_t normal;  ///< three signed parts of 10 bits, x lowest
  glm::u8vec4 color;
  glm::vec2 texcoord;
};
static_assert(sizeof(GlVertex) == 28);

/// Triangles of one material, contiguous in the index buffer.
struct GlGroup {
  Material material;
  uint32_t first_index = 0;
  uint32_t index_count = 0;
};

/// What a group takes at most, staged or in the renderer: for bounds made before the groups are known.
constexpr uint64_t kGroupBytesMax = 48;
static_assert(sizeof(GlGroup) <= kGroupBytesMax);

/// Groups stand opaque, masked, blended; within a group triangles keep their order.
class GlStagedMesh final : public StagedMesh {
 public:
  uint64_t byte_size() const override { return buffer_bytes() + groups.size() * sizeof(GlGroup); }
  uint64_t buffer_bytes() const {
    return vertices.size() * sizeof(GlVertex) + indices16.size() * sizeof(uint16_t) +
           indices32.size() * sizeof(uint32_t);
  }

  std::vector<GlVertex> vertices;
  std::vector<uint16_t> indices16;  ///< either these, where vertices allow,
  std::vector<uint32_t> indices32;  ///< or these
  std::vector<GlGroup> groups;
  Box box;
  bool has_normals = false;  ///< else each triangle's own
  bool has_colors = false;   ///< else white
};

/// All levels, the whole picture first, each half the one before, the last 1 x 1.
class GlStagedTexture final : public StagedTexture {
 public:
  uint64_t byte_size() const override;
  std::vector<Image> levels;
};

GlStagedMesh stage_gl_mesh(const Mesh& mesh, std::span<const Material> materials);
uint64_t gl_mesh_bytes_bound(uint64_t vertices, uint64_t triangles);

/// max_side: larger pictures are halved until they fit.
GlStagedTexture stage_gl_texture(const Image& image, uint32_t max_side);
uint64_t gl_texture_bytes(uint32_t width, uint32_t height);

/// Half as wide and high, at least 1; box filter in linear light, colours weighted by opacity.
Image halved(const Image& image);

/// A unit vector in GL_INT_2_10_10_10_REV.
uint32_t pack_normal(const glm::vec3& normal);

}  // namespace promenade
