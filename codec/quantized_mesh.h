#pragma once
// A mesh in small integers: what the meshopt and Draco codecs write.

#include <array>
#include <cstdint>
#include <glm/gtc/type_precision.hpp>
#include <optional>
#include <vector>

#include "geometry/mesh.h"
#include "geometry/result.h"

namespace promenade {

/// Triangles in a row that have one material.
struct MaterialRun {
  uint32_t material = 0;
  uint32_t triangles = 0;
};

struct QuantizedMesh {
  bool on_grid = false;          ///< positions are steps from the base; otherwise the bits of floats
  bool has_materials = false;    ///< false: Mesh::materials is empty
  int8_t position_exponent = 0;  ///< the grid's step is 2^exponent metres
  uint8_t fine_bits = 0;         ///< positions and their base count steps 2^fine_bits times as fine
  bool by_kinds = true;          ///< meshopt: vertices are told by kinds (vertex_kinds.h), else by differences alone
  int8_t texcoord_exponent = 0;  ///< a step is 2^exponent of the texture's side
  std::array<int64_t, 3> position_base{};
  std::array<int64_t, 2> texcoord_base{};
  std::vector<glm::u32vec3> positions;
  std::vector<glm::i16vec2> normals;    ///< octahedral, see normal_of_octahedral; empty: none
  std::vector<glm::u32vec2> texcoords;  ///< steps from the base; empty: none
  std::vector<glm::u8vec4> colors;      ///< empty: none
  std::vector<uint32_t> indices;
  std::vector<MaterialRun> runs;  ///< ascending by material; together all triangles
};

/// Most steps that a grid position lies from the mesh's base: what Draco's predictors compute without overflow.
constexpr int64_t kMaxPositionSteps = int64_t(1) << 21;

/// How much finer than the grid some positions may be: their rest fits a byte.
constexpr int kMaxFineBits = 8;

/// position_step_m: a power of two in [2^-60, 2^60], or nullopt to keep the floats. fine_bits: positions are rounded
/// to steps that much finer, 0 to kMaxFineBits; what lies on the grid itself costs next to nothing. max_texcoord_steps:
/// texture coordinates are rounded to 2^-15, or coarser where the mesh's range would take more steps than that.
/// Triangles are sorted by material; those with two corners at one place, vertices that no triangle uses and doubles of
/// vertices are dropped. Errors: the mesh reaches farther than kMaxPositionSteps or so far from the origin that steps
/// cannot be counted. Pure; any thread.
Result<QuantizedMesh> quantize(const Mesh& mesh, std::optional<float> position_step_m, int fine_bits,
                               int64_t max_texcoord_steps);

/// The inverse, to rounding. Sizes and indices must agree (a decoder checks them); values may be any.
Mesh dequantize(const QuantizedMesh& mesh);

/// Sorts triangles by the given materials (one a triangle; stable), drops triangles with two corners at one place,
/// merges doubles of vertices and drops unused ones. Sets `runs`.
void tidy(QuantizedMesh& mesh, const std::vector<uint32_t>& materials);

/// A point rounded to the grid of that step, as a float. Coincident points stay so, whatever mesh they are in.
glm::vec3 snapped(const glm::vec3& position, float step_m);

/// The code of a normal of length 0, off the octahedron's square: the triangle's own.
constexpr glm::i16vec2 kNoNormal{512, 512};

/// Unit normals as points of an octahedron unfolded to a square of +-256: at most 0.48 degrees off; axes and face
/// diagonals exact. A normal of length 0 has a code of its own.
glm::i16vec2 octahedral_of_normal(const glm::vec3& normal);
glm::vec3 normal_of_octahedral(const glm::i16vec2& code);

}  // namespace promenade
