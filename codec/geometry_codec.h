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

enum class GeometryCodec : uint8_t { raw, meshopt, draco };

std::string_view name_of(GeometryCodec codec);
std::optional<GeometryCodec> geometry_codec_named(std::string_view name);

struct GeometryEncodeOptions {
  GeometryCodec codec = GeometryCodec::meshopt;
  /// Grid on which positions are rounded, in metres: a power of two, > 0. All nodes of equal step share one grid
  /// (through the model's origin), so that points that coincide stay together. nullopt: keep the floats as they are.
  std::optional<float> position_step_m;
  int zstd_level = 9;
};

struct EncodedMesh {
  std::vector<std::byte> bytes;
  /// The farthest that a coded position lies from the given one, in metres: to be added to the node's error.
  float position_error_m = 0;
};

/// Encodes a sound mesh (find_defect empty). Triangles keep their materials; their order, their vertices' order and
/// which corner comes first may change (never the winding). Normals to about 0.1 degrees, texture coordinates to 1/4096
/// of a texel of a 16-bit range or better. The same mesh and options give the same bytes. Errors: a mesh too large for
/// the step (more than 2^21 steps across for quantised codecs: the step is then refused, not silently changed). Pure;
/// any thread.
Result<EncodedMesh> encode_mesh(const Mesh& mesh, const GeometryEncodeOptions& options);

/// Decodes what encode_mesh wrote. Safe on any bytes: a wrong or truncated input is an error, never a crash, and never
/// allocates more than `max_bytes`. A decoded mesh is sound (find_defect empty). Pure; any thread.
Result<Mesh> decode_mesh(std::span<const std::byte> bytes, uint64_t max_bytes = uint64_t(1) << 30);

}  // namespace promenade
