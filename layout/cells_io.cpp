#include "layout/cells_io.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <mutex>
#include <utility>

#include "codec/frame.h"
#include "codec/id_set_block.h"
#include "layout/cells_codec.h"

namespace promenade {
namespace {

/// vLODs on their way to the file, a block at a time.
class VlodWriter {
 public:
  VlodWriter(AtomicFile& file, const NodeForest& forest)
      : file_(file), forest_(forest), rank_of_node_(rank_of_node(forest)) {}

  Status add(CellId cell, const std::vector<NodeId>& vlod) {
    std::vector<uint32_t> ranks;
    const bool ascending = std::adjacent_find(vlod.begin(), vlod.end(), std::greater_equal<>()) == vlod.end();
    if (!ascending || (!vlod.empty() && index_of(vlod.back()) >= rank_of_node_.size()))
      return Error{fmt::format("the vLOD of cell {} is no ascending set of nodes", index_of(cell))};
    ranks.reserve(vlod.size());
    for (const NodeId id : vlod) ranks.push_back(rank_of_node_[index_of(id)]);
    std::sort(ranks.begin(), ranks.end());
    if (!is_antichain(forest_.by_rank, ranks))
      return Error{fmt::format("the vLOD of cell {} has a node and its ancestor", index_of(cell))};
    const bool full = sets_.ends.size() == kMaxSetsInBlock || sets_.ids.size() + ranks.size() > kMostBlockIds;
    if (full && !sets_.ends.empty()) PROMENADE_TRY(flush());
    sets_.ids.insert(sets_.ids.end(), ranks.begin(), ranks.end());
    sets_.ends.push_back(static_cast<uint32_t>(sets_.ids.size()));
    nodes.push_back(static_cast<uint32_t>(vlod.size()));
    return Done{};
  }

  /// Writes what is left.
  Status flush() {
    if (sets_.ends.empty()) return Done{};
    const std::vector<std::byte> bytes = encode_block(forest_.by_rank, sets_);
    blocks.push_back(
        {file_.size(), static_cast<uint32_t>(bytes.size()), static_cast<uint32_t>(sets_.ends.size()), checksum(bytes)});
    sets_ = {};
    return file_.write(bytes);
  }

  std::vector<uint32_t> nodes;
  std::vector<VlodBlock> blocks;

 private:
  AtomicFile& file_;
  const NodeForest& forest_;
  std::vector<uint32_t> rank_of_node_;
  IdSetBlock sets_;
};

Status write_vlods(VlodWriter& writer, uint32_t count, const VlodSource& vlod_of) {
  for (uint32_t i = 0; i < count; ++i) {
    const Result<std::vector<NodeId>> vlod = vlod_of(CellId{i});
    if (!vlod) return vlod.error();
    PROMENADE_TRY(writer.add(CellId{i}, *vlod));
  }
  return writer.flush();
}

/// A block that was read: shared, so that one thread may use what another drops.
using DecodedBlock = std::shared_ptr<const IdSetBlock>;

/// The blocks that were read last: a step stays in one or goes to one beside it.
class BlockCache {
 public:
  static constexpr size_t kBlocks = 4;
  DecodedBlock find(size_t block) {
    const std::lock_guard lock(mutex_);
    for (size_t i = 0; i < kBlocks; ++i)
      if (entries_[i].second != nullptr && entries_[i].first == block) {
        std::rotate(entries_.begin(), entries_.begin() + static_cast<std::ptrdiff_t>(i),
                    entries_.begin() + static_cast<std::ptrdiff_t>(i) + 1);
        return entries_[0].second;
      }
    return nullptr;
  }
  void add(size_t block, DecodedBlock decoded) {
    const std::lock_guard lock(mutex_);
    std::rotate(entries_.begin(), entries_.end() - 1, entries_.end());
    entries_[0] = {block, std::move(decoded)};
  }

 private:
  std::mutex mutex_;
  std::array<std::pair<size_t, DecodedBlock>, kBlocks> entries_;  ///< guarded by mutex_; the last used first
};

}  // namespace

Result<uint64_t> write_cells(const std::filesystem::path& path, const CellTables& tables, const CellsOwner& owner,
                             const NodeForest& forest, const VlodSource& vlod_of, FileSystem& files) {
  if (const std::string defect = find_defect(tables); !defect.empty())
    return Error{fmt::format("{}: refused to write unsound cells: {}", path.string(), defect)};
  Result<AtomicFile> file = AtomicFile::create(path, files);
  if (!file) return file.error();
  // The header is known last.
  PROMENADE_TRY(file->write(std::vector<std::byte>(kCellsHeaderBytes)));
  VlodWriter writer(*file, forest);
  PROMENADE_TRY(write_vlods(writer, static_cast<uint32_t>(tables.cells.size()), vlod_of));
  constexpr uint64_t kAlignment = 8;
  while (file->size() % kAlignment != 0) PROMENADE_TRY(file->write(std::array<std::byte, 1>{}));
  const EncodedCells encoded =
      encode_cells({owner, tables, std::move(writer.nodes), std::move(writer.blocks)}, file->size());
  PROMENADE_TRY(file->write(encoded.sections));
  PROMENADE_TRY(file->write_at(0, encoded.header));
  const uint64_t bytes = file->size();
  PROMENADE_TRY(file->commit());
  return bytes;
}

struct CellsReader::State {
  State(std::string of, RandomAccessFile opened, CellsFile read, NodeForest nodes)
      : name(std::move(of)), file(std::move(opened)), content(std::move(read)), forest(std::move(nodes)) {
    for (uint32_t i = 0, first = 0; i < content.blocks.size(); first += content.blocks[i++].cells) {
      first_cells.push_back(first);
      uint64_t ids = 0;
      for (uint32_t k = 0; k < content.blocks[i].cells; ++k) ids += content.vlod_nodes[first + k];
      most_ids = std::max(most_ids, ids);
    }
  }

  std::string name;
  RandomAccessFile file;
  CellsFile content;
  NodeForest forest;
  std::vector<uint32_t> first_cells;  ///< by block
  uint64_t most_ids = 0;              ///< in a block
  BlockCache cache;

  size_t block_of(CellId cell) const {
    const auto after = std::upper_bound(first_cells.begin(), first_cells.end(), index_of(cell));
    return static_cast<size_t>(after - first_cells.begin()) - 1;
  }

  Result<DecodedBlock> read_block(size_t number) const {
    const VlodBlock& record = content.blocks[number];
    std::vector<std::byte> bytes(record.stored_bytes);
    PROMENADE_TRY(file.read(record.offset, bytes));
    const auto where = [&] { return fmt::format("{}: vLOD block {} @{:#x}", name, number, record.offset); };
    if (const uint64_t found = checksum(bytes); found != record.checksum)
      return Error{fmt::format("{}: checksum {:016x} != {:016x}; copy or build the model again", where(), found,
                               record.checksum)};
    IdSetBlock sets;
    uint64_t ids = 0;
    for (uint32_t i = 0; i < record.cells; ++i) ids += content.vlod_nodes[first_cells[number] + i];
    sets.ids.resize(ids);
    sets.ends.resize(record.cells);
    const Status decoded = decode_block(forest.by_rank, bytes, sets.ids, sets.ends);
    if (!decoded) return Error{fmt::format("{}: {}", where(), decoded.error().message)};
    for (uint32_t i = 0; i < record.cells; ++i)
      if (const uint32_t due = content.vlod_nodes[first_cells[number] + i]; sets.set(i).size() != due)
        return Error{fmt::format("{}: cell {} has {} nodes, {} are due", where(), first_cells[number] + i,
                                 sets.set(i).size(), due)};
    return std::make_shared<const IdSetBlock>(std::move(sets));
  }
};

CellsReader::CellsReader(std::unique_ptr<State> state) : state_(std::move(state)) {}
CellsReader::CellsReader(CellsReader&&) noexcept = default;
CellsReader& CellsReader::operator=(CellsReader&&) noexcept = default;
CellsReader::~CellsReader() = default;

Result<CellsReader> CellsReader::open(const std::filesystem::path& path, const CellsOwner& owner, NodeForest forest,
                                      FileSystem& files) {
  Result<RandomAccessFile> file = RandomAccessFile::open(path, files);
  if (!file) return file.error();
  const auto failed = [&path](const Error& error) {
    return Error{fmt::format("{}: {}", path.string(), error.message)};
  };
  std::vector<std::byte> header(std::min(file->size(), kCellsHeaderBytes));
  PROMENADE_TRY(file->read(0, header));
  const Result<uint64_t> begin = sections_offset_of(header, file->size());
  if (!begin) return failed(begin.error());
  std::vector<std::byte> sections(file->size() - *begin);
  PROMENADE_TRY(file->read(*begin, sections));
  Result<CellsFile> content = decode_cells(header, sections, file->size());
  if (!content) return failed(content.error());
  if (content->owner != owner)
    return failed(
        Error{fmt::format("belongs to tables of {} nodes with checksum {:016x}, not {} and {:016x}; the files "
                          "are not of one build",
                          content->owner.nodes, content->owner.tables_checksum, owner.nodes, owner.tables_checksum)});
  return CellsReader(std::make_unique<State>(path.string(), std::move(*file), std::move(*content), std::move(forest)));
}

const CellTables& CellsReader::tables() const { return state_->content.tables; }
uint32_t CellsReader::vlod_nodes(CellId cell) const { return state_->content.vlod_nodes[index_of(cell)]; }
std::span<const VlodBlock> CellsReader::blocks() const { return state_->content.blocks; }

uint64_t CellsReader::byte_size() const {
  const CellsFile& content = state_->content;
  // The cached blocks, and one on its way.
  const uint64_t decoded = (BlockCache::kBlocks + 1) * (state_->most_ids + kMaxSetsInBlock) * sizeof(uint32_t);
  return state_->forest.byte_size() + decoded + content.vlod_nodes.size() * sizeof(uint32_t) +
         content.blocks.size() * (sizeof(VlodBlock) + sizeof(uint32_t));
}

Result<Vlod> CellsReader::read_vlod(CellId cell) const {
  const size_t number = state_->block_of(cell);
  Vlod vlod;
  DecodedBlock block = state_->cache.find(number);
  if (block == nullptr) {
    Result<DecodedBlock> read = state_->read_block(number);
    if (!read) return read.error();
    block = std::move(*read);
    state_->cache.add(number, block);
    vlod.bytes_read = state_->content.blocks[number].stored_bytes;
  }
  const std::span<const uint32_t> ranks = block->set(index_of(cell) - state_->first_cells[number]);
  vlod.nodes.reserve(ranks.size());
  for (const uint32_t rank : ranks) vlod.nodes.push_back(NodeId{state_->forest.node_of_rank[rank]});
  std::sort(vlod.nodes.begin(), vlod.nodes.end());
  return vlod;
}

}  // namespace promenade
