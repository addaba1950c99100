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
#include "layout/node_forest.h"

namespace promenade {

/// vLODs of neighbouring cells, coded together (codec/id_set_block.h): what is read to get at any of them.
struct VlodBlock {
  uint64_t offset = 0;  ///< in cells.bin
  uint32_t stored_bytes = 0;
  uint32_t cells = 0;     ///< the next so many in the order of cells
  uint64_t checksum = 0;  ///< XXH3 of the stored bytes
  bool operator==(const VlodBlock&) const = default;
};

/// Most ids in a block of more than one vLOD. Bounds what reading one takes; measured: more cells to a block save
/// bytes up to some dozens, and vLODs have some thousand nodes.
constexpr uint64_t kMostBlockIds = 1 << 17;

/// The model that a cells.bin belongs to.
struct CellsOwner {
  uint64_t tables_checksum = 0;  ///< of the whole tables.bin
  uint32_t nodes = 0;
  bool operator==(const CellsOwner&) const = default;
};

/// The nodes to be drawn from a cell, ascending. Called once a cell, in the order of cells.
using VlodSource = std::function<Result<std::vector<NodeId>>(CellId)>;

/// Writes cells.bin, whole or not at all; returns its bytes. forest: of the owner's nodes. Errors: an unsound table, a
/// vLOD with a node and its ancestor, the source's, the disk's.
Result<uint64_t> write_cells(const std::filesystem::path& path, const CellTables& tables, const CellsOwner& owner,
                             const NodeForest& forest, const VlodSource& vlod_of,
                             FileSystem& files = real_file_system());

/// What a cell sees.
struct Vlod {
  std::vector<NodeId> nodes;  ///< ascending
  uint64_t bytes_read = 0;    ///< from disk for it; 0: what it is coded with had been read
};

/// An open cells.bin. All functions may be called from any thread at once.
class CellsReader {
 public:
  /// Reads and checks all but the vLODs. An error names file, section, offset, what was found and the limit.
  static Result<CellsReader> open(const std::filesystem::path& path, const CellsOwner& owner, NodeForest forest,
                                  FileSystem& files = real_file_system());
  CellsReader(CellsReader&&) noexcept;
  CellsReader& operator=(CellsReader&&) noexcept;
  ~CellsReader();

  const CellTables& tables() const;
  uint32_t vlod_nodes(CellId cell) const;  ///< how many nodes it sees
  std::span<const VlodBlock> blocks() const;
  /// What is in memory besides the tables, at most: the forest, and the blocks that were read last.
  uint64_t byte_size() const;
  /// Reads, checks and decodes, unless the cell's block is among the last that were. A block takes less than a
  /// millisecond.
  Result<Vlod> read_vlod(CellId cell) const;

 private:
  struct State;
  explicit CellsReader(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace promenade
