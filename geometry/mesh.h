#pragma once
// Indexed triangle meshes, their materials and pictures: the plain structs that every room passes around.

#include <cstdint>
#include <glm/gtc/type_precision.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <string>
#include <vector>

#include "geometry/box.h"

namespace promenade {

/// An indexed triangle mesh, structure of arrays. V vertices, T triangles.
/// Positions in metres in the mesh's own frame, z up; front faces are counter-clockwise.
struct Mesh {
  std::vector<glm::vec3> positions;  ///< V
  std::vector<glm::vec3> normals;    ///< V unit vectors (0: the triangle's own normal), or empty: 0 throughout
  std::vector<glm::vec2> texcoords;  ///< V, or empty: no triangle is textured. (0, 0) is the picture's top left
  std::vector<glm::u8vec4> colors;   ///< V, sRGB and linear opacity, or empty: white. Multiplies the material's colour
  std::vector<uint32_t> indices;     ///< 3 T, each < V
  std::vector<uint32_t> materials;   ///< T, or empty: material 0 throughout. Index into the owner's material table

  size_t vertex_count() const { return positions.size(); }
  size_t triangle_count() const { return indices.size() / 3; }
  uint32_t material_of(size_t triangle) const { return materials.empty() ? 0 : materials[triangle]; }
};

/// Box of all positions; empty for a mesh without vertices.
Box bounds(const Mesh& mesh);

/// Heap bytes that the mesh's arrays hold (their sizes, not their capacities).
uint64_t byte_size(const Mesh& mesh);

/// Whether sizes agree, every index is in range and every number finite. Otherwise says what is wrong, and where.
/// An empty string: sound.
std::string find_defect(const Mesh& mesh);

/// Appends b to a. Attributes that one of them lacks are filled (normals: 0; white; (0, 0)).
void append(Mesh& a, const Mesh& b);

/// The mesh in another frame. A mirroring transform (negative determinant) flips the winding, so that fronts stay
/// fronts; normals go by the inverse transpose. Computed in double, rounded once.
Mesh transformed(const Mesh& mesh, const glm::dmat4& to_from_mesh);

/// The given triangles, in the given order, with only the vertices that they use, in
/// order of first use.
Mesh submesh(const Mesh& mesh, const std::vector<uint32_t>& triangles);

/// The corners beside one in its triangle: indices into Mesh::indices.
inline uint32_t next_in_triangle(uint32_t corner) { return corner % 3 == 2 ? corner - 2 : corner + 1; }
inline uint32_t previous_in_triangle(uint32_t corner) { return corner % 3 == 0 ? corner + 2 : corner - 1; }

/// Normal of a triangle (not unit: its length is twice the area), counter-clockwise front.
glm::vec3 triangle_cross(const Mesh& mesh, size_t triangle);

/// Total area in square metres.
double surface_area_m2(const Mesh& mesh);

enum class AlphaMode : uint8_t { opaque, mask, blend };
enum class Wrap : uint8_t { repeat, mirror, clamp };

constexpr uint32_t kNoTexture = 0xffffffffU;
/// No triangle: of a mesh, or of a picture's pixel.
constexpr uint32_t kNoTriangle = 0xffffffffU;

/// How a triangle's surface looks. Lit diffusely: colour = material x vertex colour x texture, in sRGB as stored,
/// multiplied linearly.
struct Material {
  glm::u8vec4 color{255, 255, 255, 255};  ///< sRGB, linear opacity
  uint32_t texture = kNoTexture;          ///< index into the owner's texture table
  Wrap wrap_u = Wrap::repeat;
  Wrap wrap_v = Wrap::repeat;
  AlphaMode alpha = AlphaMode::opaque;
  uint8_t alpha_cutoff = 128;  ///< mask: texels with less opacity are not there
  bool two_sided = false;      ///< false: back faces are not drawn
  bool operator==(const Material&) const = default;
};

/// A picture, 8 bits a channel, RGBA, row 0 at the top, sRGB with linear opacity. width * height pixels.
struct Image {
  uint32_t width = 0;
  uint32_t height = 0;
  std::vector<glm::u8vec4> pixels;

  glm::u8vec4& at(uint32_t x, uint32_t y) { return pixels[size_t(y) * width + x]; }
  const glm::u8vec4& at(uint32_t x, uint32_t y) const { return pixels[size_t(y) * width + x]; }
};

/// sRGB byte to linear [0, 1] and back, to the nearest.
float srgb_to_linear(uint8_t value);
uint8_t linear_to_srgb(float value);

}  // namespace promenade
