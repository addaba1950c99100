#pragma once
// One side of a far picture as bytes: colours, where something is, and how far away, as triangles over the picture.
// FORMAT.md has the bytes.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "geometry/halved_grid.h"
#include "geometry/mesh.h"
#include "geometry/result.h"

namespace promenade {

/// A side of the box around a view cell, seen from the cell's centre: 90 degrees between the outermost pixels' centres,
/// which are the vertices of the grid.
struct FarFace {
  HalvedGrid grid;
  Image colors;                 ///< side x side; opacity 255: something is there; 0: nothing
  std::vector<uint8_t> kept;    ///< one a vertex, closed (geometry/halved_grid.h): the triangles' corners
  std::vector<uint16_t> depth;  ///< one a vertex; at kept ones the box's half length over the depth, 1 to kNearest
  static constexpr uint16_t kNearest = 65535;
};

/// Largest grid of a face: 1025 x 1025 pixels, twelve to a degree. Bounds what decoding takes.
constexpr uint32_t kMostFaceLevels = 10;

/// How colours are stored. Opacity and triangles are always exact.
struct FarFaceCoding {
  int jpeg_quality = 85;  ///< 1 to 100; 0: PNG, exact
};

/// Deterministic. Any thread. Errors: a face whose arrays do not fit its grid; the picture coder's.
Result<std::vector<std::byte>> encode_far_face(const FarFace& face, const FarFaceCoding& coding);

/// Depths at vertices that are not kept come out 0, and colours where nothing is those of something near. Safe on any
/// bytes; allocates no more than a face of kMostFaceLevels takes. Any thread.
Result<FarFace> decode_far_face(std::span<const std::byte> bytes);

/// Where nothing is, colours of something near in place of what is there, so that coders and filters find no edge.
/// Opacities stay.
void fill_colors(Image& colors);

}  // namespace promenade
