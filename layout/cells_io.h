#pragma once
// cells.bin: a model's view cells and what can be seen from each. FORMAT.md has the bytes. The tables are in memory
// while a model is open; what a cell sees (its vLOD) is read when it is asked for.

#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "layout/cells.h"
#include "layout/file_io.h"

namespace promenade {

/// Where a cell's vLOD lies. It is stored as a set of its own, or as the difference from the set of one other cell,
/// which is a set of its own: at most two reads.
struct VlodRecord {
  uint64_t offset = 0;        ///< in cells.bin
  uint32_t stored_bytes = 0;  ///< an id set of codec/
  uint32_t nodes = 0;         ///< in the vLOD
  CellId base = kNoCell;      ///< the difference from which cell; kNoCell: the set itself
  uint64_t checksum = 0;      ///< XXH3 of the stored bytes
  bool operator==(const VlodRecord&) const = default;
};

/// The model that a cells.bin belongs to.
struct CellsOwner {
  uint64_t tables_checksum = 0;  ///< of the whole tables.bin
  uint32_t nodes = 0;
  bool operator==(const CellsOwner&) const = default;
};

/// The nodes to be drawn from a cell, ascending. Called once a cell, in the order of cells.
using VlodSource = std::function<Result<std::vector<NodeId>>(CellId)>;

/// Writes cells.bin, whole or not at all; returns its bytes. Errors: an unsound table, the source's, the disk's.
Result<uint64_t> write_cells(const std::filesystem::path& path, const CellTables& tables, const CellsOwner& owner,
                             const VlodSource& vlod_of, FileSystem& files = real_file_system());

/// What a cell sees.
struct Vlod {
  std::vector<NodeId> nodes;  ///< ascending
  uint64_t bytes_read = 0;    ///< from disk for it
};

/// An open cells.bin. All functions may be called from any thread at once.
class CellsReader {
 public:
  /// Reads and checks all but the vLODs. An error names file, section, offset, what was found and the limit.
  static Result<CellsReader> open(const std::filesystem::path& path, const CellsOwner& owner,
                                  FileSystem& files = real_file_system());
  CellsReader(CellsReader&&) noexcept;
  CellsReader& operator=(CellsReader&&) noexcept;
  ~CellsReader();

  const CellTables& tables() const;
  std::span<const VlodRecord> vlods() const;
  /// Reads, checks and decodes.
  Result<Vlod> read_vlod(CellId cell) const;

 private:
  struct State;
  explicit CellsReader(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace promenade
