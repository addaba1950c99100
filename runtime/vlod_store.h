#pragma once
// The vLODs that are in memory: of the cell that the eye is in, of those beside it, and of those it came from.

#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <vector>

#include "layout/cells_io.h"
#include "runtime/model_source.h"

namespace promenade {

/// want() and find() on the render thread, load_next() on the loader's: a frame never waits for a vLOD. Everything
/// shared is guarded by one mutex that is not held while reading.
class VlodStore {
 public:
  /// source must outlive it.
  explicit VlodStore(const ModelSource& source);

  /// The most that the sets in memory take, with what reading one takes: two at least, some dozens if they are small.
  uint64_t bound_bytes() const { return bound_bytes_; }

  /// Cells in the order in which they matter. Others stay while there is room.
  void want(std::span<const CellId> cells);
  /// Null: not there (yet).
  std::shared_ptr<const Vlod> find(CellId cell) const;

  struct Step {
    bool worked = false;
    uint64_t bytes = 0;  ///< read from disk
  };
  /// Reads the most important one that is not there. A cell whose vLOD cannot be read is never asked for again.
  Step load_next();

  uint64_t loaded() const;      ///< vLODs, since the beginning
  uint64_t bytes_read() const;  ///< for them
  std::vector<std::string> failures() const;

 private:
  uint64_t bytes_of(CellId cell) const { return uint64_t(source_.vlod_nodes(cell)) * sizeof(NodeId); }
  bool make_room(uint64_t bytes, size_t importance);

  const ModelSource& source_;
  uint64_t capacity_bytes_ = 0;  ///< of the sets
  uint64_t bound_bytes_ = 0;     ///< with what reading takes
  mutable std::mutex mutex_;
  std::vector<CellId> wanted_;                            ///< guarded by mutex_, as all below
  std::map<CellId, std::shared_ptr<const Vlod>> loaded_;  ///< null: cannot be read
  uint64_t used_bytes_ = 0;
  uint64_t loaded_count_ = 0, bytes_read_ = 0;
  std::vector<std::string> failures_;
};

}  // namespace promenade
