#pragma once
// What an eye may look through inside buildings: all space within the view cells' tree cut into regions (its leaves,
// also those that hold no cell), and the open parts of the faces between them. FORMAT.md says how openings.bin holds
// them. Source: [funkhouser1993] section 4.1 finds what an eye sees through the portals between cells.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "geometry/result.h"
#include "layout/cells.h"

namespace promenade {

/// Surfaces that are this near to a face count as in it: openings are as thick, to both sides, and as much wider.
constexpr float kOpeningSlackM = 0.002F;

struct Openings {
  static constexpr uint32_t kMost = 24;  ///< of a face, one way
  CellTables regions;                    ///< cells are regions; portals are not used
  /// By face * 2 + way (1: towards larger coordinates), and the end: into boxes. A face that has none is closed to
  /// those who look that way. The same surface may close one way and not the other.
  std::vector<uint32_t> first;
  std::vector<Box> boxes;  ///< with their slack

  std::span<const Box> of(uint32_t face, bool up) const {
    const size_t i = 2 * size_t(face) + (up ? 1 : 0);
    return {boxes.data() + first[i], first[i + 1] - first[i]};
  }
  uint64_t byte_size() const;
};

/// Every leaf of the cells' tree as a cell of its own, in the order of the tree, with its faces. Errors: find_faces'.
Result<CellTables> regions_of(const CellTables& cells);

/// The bytes of openings.bin. tables_checksum: of the whole tables.bin. They come back up to a 255th of their face
/// wider at each side, never narrower.
std::vector<std::byte> encode_openings(const Openings& openings, uint64_t tables_checksum);
/// cells: those that the openings were made for. Safe on any bytes. Errors: what and where.
Result<Openings> decode_openings(std::span<const std::byte> bytes, const CellTables& cells, uint64_t tables_checksum);

}  // namespace promenade
