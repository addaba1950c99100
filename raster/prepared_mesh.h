#pragma once
// A mesh as the rasteriser wants it: once a mesh, for all frames.

#include <array>
#include <span>
#include <vector>

#include "geometry/mesh.h"
#include "geometry/result.h"
#include "raster/kernel.h"

namespace promenade {

/// Largest coordinate of a mesh, in metres: beyond it single precision overflows on the way to the picture.
constexpr float kMaxCoordinateM = 1e12F;

struct PrepareOptions {
  /// Keeps what shading and holes need (normals, texture coordinates, colours). Without: depth and ids only, and
  /// surfaces with holes are solid. Saves up to half of the memory.
  bool attributes = true;
};

/// Whole numbers in two bytes each where all of them fit, else in four.
class PackedNumbers {
 public:
  PackedNumbers() = default;
  explicit PackedNumbers(std::span<const uint32_t> numbers);
  raster_kernel::Numbers view() const {
    return {narrow_.empty() ? nullptr : narrow_.data(), wide_.empty() ? nullptr : wide_.data()};
  }
  uint64_t byte_size() const { return narrow_.size() * sizeof(uint16_t) + wide_.size() * sizeof(uint32_t); }

 private:
  std::vector<uint16_t> narrow_;
  std::vector<uint32_t> wide_;
};

/// What shading and holes need of a mesh, by its own numbering.
struct PreparedAttributes {
  /// Records of `words`: the place of the vertex' position among the blocks', and what it has of a normal (packed, see
  /// raster_kernel::kNoNormal), a colour (RGBA8) and two texture coordinates (floats).
  std::vector<uint32_t> vertices;
  uint32_t words = 1;
  uint32_t normal_at = 0, color_at = 0, texcoord_at = 0;  ///< words into a record; 0: vertices have none
  PackedNumbers indices;                                  ///< 3 a triangle
  PackedNumbers materials;                                ///< 1 a triangle, or empty: 0 throughout
  uint64_t byte_size() const {
    return vertices.size() * sizeof(uint32_t) + indices.byte_size() + materials.byte_size();
  }
};

/// A mesh cut into blocks of up to 64 vertices and 128 triangles that lie close together and face alike, positions in
/// separate arrays a coordinate. Constant once made; any thread may draw it. Holds all that it needs of the mesh.
struct PreparedMesh {
  Box box;
  std::vector<raster_kernel::Block> blocks;
  std::vector<float> x, y, z;                   ///< vertices of the blocks
  std::array<std::vector<uint8_t>, 3> corners;  ///< of the blocks' triangles
  PackedNumbers triangle_of;                    ///< number in the mesh as given
  uint32_t triangle_count = 0;                  ///< of the mesh as given
  PreparedAttributes attributes;                ///< without PrepareOptions::attributes empty

  uint64_t byte_size() const;
};

/// Upper bound of byte_size() for a mesh of this size with all attributes.
uint64_t prepared_bytes_bound(uint64_t vertices, uint64_t triangles);

/// Whether some of its surface is seen through (AlphaMode::blend).
bool has_blended(const PreparedMesh& mesh);

/// Refuses meshes that find_defect refuses, and coordinates beyond kMaxCoordinateM. Triangles without an area are
/// left out: they cover no pixel. A triangle whose material is not in `materials` counts as opaque and one-sided.
/// Pure; any thread; the same mesh gives the same blocks.
Result<PreparedMesh> prepare(const Mesh& mesh, std::span<const Material> materials, const PrepareOptions& options = {});

}  // namespace promenade
