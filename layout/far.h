#pragma once
// Far pictures as a model has them: a grid of cubic view cells, and for each cell in which one may be the sides of a
// box around it on which everything beyond the box is drawn. Source: [xiong1996].

#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>
#include <string>
#include <vector>

#include "geometry/box.h"

namespace promenade {

/// A far cell's place in the model's list.
enum class FarCellId : uint32_t {};
constexpr uint32_t index_of(FarCellId id) { return static_cast<uint32_t>(id); }

/// A cell with pictures, or one from which nothing beyond the box is seen (no faces).
struct FarCellRecord {
  uint64_t place = 0;  ///< in its shell's grid: x + counts.x (y + counts.y z), and all places of the shells within
  uint32_t first_face = 0, face_count = 0;
  float parallax_rad = 0;  ///< measured: no pixel's parallax is larger, from anywhere in the cell
  bool operator==(const FarCellRecord&) const = default;
};

/// A side of a cell's box that shows something.
struct FarFaceRecord {
  uint64_t offset = 0;  ///< in far.bin
  uint32_t stored_bytes = 0;
  uint32_t side = 0;       ///< 0 to 5: +x, -x, +y, -y, +z, -z, as raster/view.h has them
  uint32_t triangles = 0;  ///< no more are decoded
  uint64_t checksum = 0;   ///< XXH3 of the stored bytes
  bool operator==(const FarFaceRecord&) const = default;
};

/// A shell around the ones within ([xiong1996] chapter 4): larger cells on the same origin, larger boxes. Pictures of
/// the shell within show nothing far beyond the box of the cell around theirs: this shell's pictures do.
struct FarOuterShell {
  double box_m = 0;    ///< length of the box around each cell's centre, above that of the shell within
  uint32_t times = 1;  ///< its cells are so many times as long as those of the shell within: each of those lies in one
  bool operator==(const FarOuterShell&) const = default;
};

struct FarTables {
  double bound_rad = 0;              ///< what the pictures were made for: parallax from anywhere in a cell
  double box_m = 0;                  ///< length of the box around each cell's centre; of the innermost shell
  double cell_m = 0;                 ///< length of a cell, below the box's; the same
  glm::dvec3 origin{0};              ///< the grid's smallest corner, metres, model space
  glm::uvec3 counts{0};              ///< of places along the axes; of the innermost shell
  std::vector<FarOuterShell> outer;  ///< further shells, from within outwards; mostly none
  uint32_t face_levels = 0;          ///< pictures have 2^levels + 1 pixels a side
  bool has_depth = false;            ///< false: faces lie flat on the box
  std::vector<FarCellRecord> cells;  ///< by FarCellId, ascending places
  std::vector<FarFaceRecord> faces;  ///< each cell's, contiguous, ascending sides

  uint64_t byte_size() const {
    return cells.capacity() * sizeof(FarCellRecord) + faces.capacity() * sizeof(FarFaceRecord) +
           outer.capacity() * sizeof(FarOuterShell);
  }
};

/// Most places of a grid. Bounds what a hostile header can claim; a 10 km city at 2 m has 10^9.
constexpr uint64_t kMostFarPlaces = uint64_t(1) << 40;

constexpr size_t kMostFarShells = 8;  // each is some twice as large as the one within: more than any model needs

/// A shell's own grid.
struct FarShell {
  double box_m = 0, cell_m = 0;
  glm::uvec3 counts{0};
  uint64_t first_place = 0;  ///< of its places
  uint64_t places() const { return uint64_t(counts.x) * counts.y * counts.z; }
};
/// The innermost first, as many as tables.outer and one. Sound tables only, as all below.
std::vector<FarShell> shells_of(const FarTables& tables);
/// The shell of a place, by its number from within, and where in its grid the place is.
struct FarGridPlace {
  uint32_t shell = 0;
  FarShell grid;
  glm::uvec3 at{0};
};
FarGridPlace grid_place_of(const FarTables& tables, uint64_t place);
/// The place in the next shell that holds a place; nullopt: of the outermost.
std::optional<uint64_t> place_around(const FarTables& tables, uint64_t place);
/// A cell and those of the outer shells around it, from within outwards: their pictures together show all that is far.
std::vector<FarCellId> chain_of(const FarTables& tables, FarCellId cell);

/// The cell that stands or would stand at a place of the grid.
DBox box_of_place(const FarTables& tables, uint64_t place);
DBox cell_box(const FarTables& tables, FarCellId id);
/// Everything that meets it is drawn as geometry from the cell: what the cell's pictures leave out.
Box near_box(const FarTables& tables, FarCellId id);
Box near_box(const FarTables& tables, uint64_t place);
/// The place of a point of model space, in the innermost shell; nullopt: beside the grid, or no number.
std::optional<uint64_t> far_place_at(const FarTables& tables, const glm::dvec3& point);
/// The cell at a place, at a point; nullopt: there is none.
std::optional<FarCellId> far_cell_of_place(const FarTables& tables, uint64_t place);
std::optional<FarCellId> far_cell_at(const FarTables& tables, const glm::dvec3& point);

/// Empty when numbers, places, ranges and sides are sound; else what is wrong.
std::string find_defect(const FarTables& tables);

}  // namespace promenade
