#pragma once
// One side of a far picture as bytes: colours, where something is, and how far away, as triangles over the picture.
// FORMAT.md has the bytes.

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>
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
  bool shifts = true;     ///< deltas: what was foretold may be moved aside, block by block
};

/// Deterministic. Any thread. Errors: a face whose arrays do not fit its grid; the picture coder's.
Result<std::vector<std::byte>> encode_far_face(const FarFace& face, const FarFaceCoding& coding);

/// Another cell's picture, against which sides are told.
struct FarReference {
  std::array<const FarFace*, 6> sides{};  ///< as decoded, all of one grid; null: nothing is seen there
  glm::dvec3 offset{0};                   ///< from its centre to the other cell's, in half lengths of the box
  std::array<int8_t, 3> places{};         ///< of the grid, from the other cell to it: for who reads the side
};

/// FarReference::offset for a grid of cells of this length, in boxes of that one.
inline glm::dvec3 offset_from_reference(const std::array<int8_t, 3>& places, double cell_m, double box_m) {
  return glm::dvec3(-places[0], -places[1], -places[2]) * (2 * cell_m / box_m);
}

/// How a side is foretold from a reference.
enum class FarForetelling : uint8_t {
  still = 1,   ///< each pixel by the reference's of the same direction: right for what is infinitely far
  warped = 2,  ///< by the place of its point: where the side's triangles say, seen in the reference
};

/// The same side by its differences from what a reference foretells. side: geometry/cube_side.h. Errors: as above, and
/// a reference of another grid or more than 16 half boxes away. No delta is exact: differences beyond 127 are cut off.
Result<std::vector<std::byte>> encode_far_delta(const FarFace& face, const FarFaceCoding& coding, uint32_t side,
                                                const FarReference& reference, FarForetelling how);

/// Depths at vertices that are not kept come out 0, and colours where nothing is, as far as filters reach, those of
/// something near. reference: what the side was told against, decoded; only for those that were. Safe on any bytes;
/// allocates no more than a few faces of kMostFaceLevels take. Any thread.
Result<FarFace> decode_far_face(std::span<const std::byte> bytes, uint32_t side = 0,
                                const FarReference* reference = nullptr);

/// Where the reference of a side lies, as FarReference::places; nullopt: it stands alone, or is none.
std::optional<std::array<int8_t, 3>> reference_of_far_face(std::span<const std::byte> bytes);

/// Bytes of the side's colours: the rest tell triangles and where something is. 0: it is no side.
size_t picture_bytes_of_far_face(std::span<const std::byte> bytes);

/// Where nothing is, colours of something near in place of what is there, so that coders and filters find no edge.
/// Opacities stay.
void fill_colors(Image& colors);

}  // namespace promenade
