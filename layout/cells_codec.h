#pragma once
// The header and the tables of cells.bin as bytes.

#include <cstddef>
#include <span>
#include <vector>

#include "layout/cells_io.h"

namespace promenade {

constexpr uint32_t kCellsVersion = 4;
constexpr uint64_t kCellsHeaderBytes = 312;

/// What stands around the vLODs in cells.bin.
struct CellsFile {
  CellsOwner owner;
  CellTables tables;
  std::vector<uint32_t> vlod_nodes;  ///< by CellId: how many there are
  std::vector<VlodBlock> blocks;     ///< of all cells in order
};

struct EncodedCells {
  std::vector<std::byte> header;    ///< kCellsHeaderBytes, the file's first
  std::vector<std::byte> sections;  ///< from sections_offset to the file's end, as stored
};
/// sections_offset: where the vLODs end, a multiple of 8.
EncodedCells encode_cells(CellsFile file, uint64_t sections_offset);

/// Where the sections begin, from a header that is sound by itself.
Result<uint64_t> sections_offset_of(std::span<const std::byte> header, uint64_t file_bytes);
/// sections: the file's bytes from there to its end, as stored. Checks everything but the vLODs themselves. Safe on any
/// bytes.
Result<CellsFile> decode_cells(std::span<const std::byte> header, std::span<const std::byte> sections,
                               uint64_t file_bytes);

}  // namespace promenade
