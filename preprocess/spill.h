#pragma once
// Triangles on their way to their chunks: written to one file in blocks as they come, read back a chunk at a time.

#include <cstdint>
#include <vector>

#include "geometry/mesh.h"
#include "preprocess/class_runs.h"
#include "preprocess/work_folder.h"

namespace promenade {

/// Where a chunk's triangles lie in the spill file.
struct SpillBlock {
  uint64_t offset = 0;
  uint64_t bytes = 0;
  uint64_t checksum = 0;
};
struct ChunkSpill {
  uint64_t triangles = 0;
  uint64_t mesh_bytes = 0;  ///< as a Mesh in memory
  std::vector<SpillBlock> blocks;
  std::vector<ClassRun> classes;  ///< of the triangles in their order
};
struct SpillIndex {
  std::vector<ChunkSpill> chunks;
  uint64_t file_bytes = 0;
};

/// Collects small meshes by chunk and writes them as compressed blocks. One thread.
class SpillWriter {
 public:
  /// buffer_bytes: what may wait in memory, all chunks together.
  static Result<SpillWriter> create(const WorkFolder& folder, uint32_t chunks, uint64_t buffer_bytes);

  /// The piece is all of one class.
  Status add(uint32_t chunk, const Mesh& piece, uint32_t class_index = 0);
  /// Writes what still waits and publishes the file.
  Result<SpillIndex> finish();

 private:
  SpillWriter(AtomicFile file, uint32_t chunks, uint64_t buffer_bytes);
  Status write_block(uint32_t chunk);
  uint32_t fullest() const;

  AtomicFile file_;
  uint64_t buffer_bytes_;
  uint64_t block_bytes_;
  uint64_t waiting_bytes_ = 0;
  std::vector<Mesh> buffers_;
  std::vector<uint64_t> buffer_sizes_;
  SpillIndex index_;
};

/// One chunk's triangles in the order in which they came. Any thread.
Result<Mesh> read_spill(const RandomAccessFile& file, const ChunkSpill& chunk);

/// Name of the spill file in the work folder.
constexpr const char* kSpillFile = "spill.bin";

}  // namespace promenade
