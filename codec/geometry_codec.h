#pragma once
// A node's mesh to bytes and back.

#include <cstddef>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "geometry/mesh.h"
#include "geometry/result.h"

namespace promenade {

enum class GeometryCodec : uint8_t { raw, meshopt, draco, grown };

std::string_view name_of(GeometryCodec codec);
std::optional<GeometryCodec> geometry_codec_named(std::string_view name);

/// Whether a codec keeps some positions on a finer grid than the others.
constexpr bool has_fine_grid(GeometryCodec codec) {
  return codec == GeometryCodec::meshopt || codec == GeometryCodec::grown;
}

struct GeometryEncodeOptions {
  GeometryCodec codec = GeometryCodec::grown;
  /// Grid on which positions are rounded, in metres: a power of two, > 0. All nodes of equal step share one grid
  /// (through the model's origin), so that points that coincide stay together. nullopt: keep the floats as they are.
  std::optional<float> position_step_m;
  int zstd_level = 9;
  /// Positions beside that grid are rounded to this finer one: at most 2^8 times as fine, a power of two. Those on the
  /// grid itself cost next to nothing more. 0: none. Codecs without one (has_fine_grid) and meshes without a grid pass
  /// it over.
  float fine_step_m = 0;
};

struct EncodedMesh {
  std::vector<std::byte> bytes;
  /// The farthest that a coded position lies from the given one, in metres: to be added to the node's error.
  float position_error_m = 0;
  /// What decode_mesh will return; at most what was given.
  uint32_t vertices = 0;
  uint32_t triangles = 0;
};

/// Encodes a sound mesh (find_defect empty). The same mesh and options give the same bytes. Pure; any thread.
/// raw: floats as they are (positions rounded to the grid where asked); nothing moves.
/// The others: triangles are sorted by material, the order of triangles and vertices and which corner comes
/// first change (never the winding); triangles that rounding collapses (two corners at one place), doubles of vertices
/// and unused ones go. Normals to 0.48 degrees. Texture coordinates to half of 2^-15 (1/16 texel of a picture 4096
/// wide); coarser only where they span more than 2^28 such steps (meshopt, grown) or 2^21 (draco: more than 64
/// repeats). Colours and materials exactly. Errors: the mesh has a defect; a step that is no power of two or outside
/// [2^-60, 2^60]; a mesh of more than 2^21 steps across for those (refused, not silently coarser).
Result<EncodedMesh> encode_mesh(const Mesh& mesh, const GeometryEncodeOptions& options);

/// The grid that a mesh was coded on, in metres; 0: none, or no mesh. Looks at the header only. Pure; any thread.
float position_step_m(std::span<const std::byte> bytes);

/// The finer grid that some of its positions may lie on, in metres; 0: none, or no mesh. Looks at the header only.
/// Pure; any thread.
float fine_step_m(std::span<const std::byte> bytes);

/// Decodes what encode_mesh wrote. Safe on any bytes: a wrong or truncated input is an error, never a crash, and never
/// allocates more than `max_bytes` (draco, grown: a small multiple of it while decoding). A decoded mesh is sound
/// (find_defect empty). Pure; any thread.
Result<Mesh> decode_mesh(std::span<const std::byte> bytes, uint64_t max_bytes = uint64_t(1) << 30);

}  // namespace promenade
