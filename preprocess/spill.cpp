#include "preprocess/spill.h"

#include <algorithm>

#include "codec/frame.h"
#include "preprocess/unit_io.h"

namespace promenade {

namespace {

constexpr uint64_t kLargestBlock = uint64_t(4) << 20;  // larger ones compress no better
constexpr int kSpillLevel = 1;                         // written once, read once: zstd's fastest

}  // namespace

SpillWriter::SpillWriter(AtomicFile file, uint32_t chunks, uint64_t buffer_bytes)
    : file_(std::move(file)),
      buffer_bytes_(buffer_bytes),
      // Half: a growing vector holds its old and its new place for a moment.
      block_bytes_(std::min(kLargestBlock, buffer_bytes / 2)),
      buffers_(chunks),
      buffer_sizes_(chunks) {
  index_.chunks.resize(chunks);
}

Result<SpillWriter> SpillWriter::create(const WorkFolder& folder, uint32_t chunks, uint64_t buffer_bytes) {
  Result<AtomicFile> file = AtomicFile::create(folder.path_of(kSpillFile), folder.files());
  if (!file.ok()) return file.error();
  return SpillWriter(std::move(*file), chunks, buffer_bytes);
}

Status SpillWriter::add(uint32_t chunk, const Mesh& piece, uint32_t class_index) {
  add_run(index_.chunks[chunk].classes, class_index, piece.triangle_count());
  append(buffers_[chunk], piece);
  const uint64_t bytes = byte_size(buffers_[chunk]);
  waiting_bytes_ += bytes - buffer_sizes_[chunk];
  buffer_sizes_[chunk] = bytes;
  if (bytes >= block_bytes_) PROMENADE_TRY(write_block(chunk));
  while (waiting_bytes_ > buffer_bytes_ / 2) PROMENADE_TRY(write_block(fullest()));
  return Done{};
}

uint32_t SpillWriter::fullest() const {
  return static_cast<uint32_t>(std::max_element(buffer_sizes_.begin(), buffer_sizes_.end()) - buffer_sizes_.begin());
}

Status SpillWriter::write_block(uint32_t chunk) {
  const Mesh mesh = std::move(buffers_[chunk]);
  buffers_[chunk] = {};
  waiting_bytes_ -= buffer_sizes_[chunk];
  buffer_sizes_[chunk] = 0;
  UnitWriter writer;
  writer.mesh(mesh);
  const std::vector<std::byte> frame = compress_frame(writer.bytes(), kSpillLevel);
  ChunkSpill& spill = index_.chunks[chunk];
  spill.triangles += mesh.triangle_count();
  spill.mesh_bytes += byte_size(mesh);
  spill.blocks.push_back({file_.size(), frame.size(), checksum(frame)});
  return file_.write(frame);
}

Result<SpillIndex> SpillWriter::finish() {
  for (uint32_t chunk = 0; chunk < buffers_.size(); ++chunk)
    if (buffer_sizes_[chunk] > 0) PROMENADE_TRY(write_block(chunk));
  index_.file_bytes = file_.size();
  PROMENADE_TRY(file_.commit());
  return std::move(index_);
}

Result<Mesh> read_spill(const RandomAccessFile& file, const ChunkSpill& chunk) {
  Mesh whole;
  whole.indices.reserve(chunk.triangles * 3);
  for (const SpillBlock& block : chunk.blocks) {
    std::vector<std::byte> frame(block.bytes);
    PROMENADE_TRY(file.read(block.offset, frame));
    const Error damaged{"spill.bin: damaged; remove the .work folder and build again"};
    if (checksum(frame) != block.checksum) return damaged;
    Result<std::vector<std::byte>> bytes = decompress_frame(frame, uint64_t(1) << 32);
    if (!bytes.ok()) return damaged;
    UnitReader reader(*bytes);
    const Mesh mesh = reader.mesh();
    if (!reader.ok()) return damaged;
    append(whole, mesh);
  }
  return whole;
}

}  // namespace promenade
