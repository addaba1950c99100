#pragma once
// far.bin: a model's far pictures. FORMAT.md has the bytes. The tables are in memory while a model is open; faces are
// read when they are asked for.

#include <filesystem>
#include <functional>
#include <memory>
#include <vector>

#include "layout/cells_io.h"
#include "layout/far.h"
#include "layout/file_io.h"

namespace promenade {

/// A cell as it goes to the file.
struct StoredFarCell {
  uint64_t place = 0;
  float parallax_rad = 0;
  struct Face {
    uint32_t side = 0, triangles = 0;
    std::vector<std::byte> bytes;  ///< codec/far_face.h
  };
  std::vector<Face> faces;
};
/// The next cells, in any order of places; empty: no more.
using FarCellSource = std::function<Result<std::vector<StoredFarCell>>()>;

/// Writes far.bin, whole or not at all; returns its bytes. tables: without cells and faces. Errors: unsound tables, the
/// source's, the disk's.
Result<uint64_t> write_far(const std::filesystem::path& path, FarTables tables, const CellsOwner& owner,
                           const FarCellSource& next_cells, FileSystem& files = real_file_system());

/// An open far.bin. All functions may be called from any thread at once.
class FarReader {
 public:
  /// Reads and checks all but the faces. An error names file, section, offset, what was found and the limit.
  static Result<FarReader> open(const std::filesystem::path& path, const CellsOwner& owner,
                                FileSystem& files = real_file_system());
  FarReader(FarReader&&) noexcept;
  FarReader& operator=(FarReader&&) noexcept;
  ~FarReader();

  const FarTables& tables() const;
  /// The stored bytes of a face, checked.
  Result<std::vector<std::byte>> read_face(uint32_t face) const;

 private:
  struct State;
  explicit FarReader(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace promenade
