#include "layout/cells_io.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

#include "codec/frame.h"
#include "codec/id_set.h"
#include "layout/cells_codec.h"

namespace promenade {
namespace {

/// Cells whose vLODs are told by their difference from one of them: neighbours in the order are neighbours in space.
/// More save bytes until the cells in a group are too far from each other.
constexpr uint32_t kGroup = 16;

/// vLODs on their way to the file, a group at a time.
class VlodWriter {
 public:
  explicit VlodWriter(AtomicFile& file) : file_(file) {}

  /// The sets of the cells from `first` on.
  Status write_group(uint32_t first, const std::vector<std::vector<uint32_t>>& sets) {
    const size_t key = sets.size() / 2;
    for (size_t i = 0; i < sets.size(); ++i) {
      std::vector<std::byte> bytes = encode_ids(sets[i]);
      CellId base = kNoCell;
      if (i != key) {
        std::vector<std::byte> delta = encode_ids(symmetric_difference(sets[i], sets[key]));
        if (delta.size() < bytes.size()) {
          bytes = std::move(delta);
          base = CellId{static_cast<uint32_t>(first + key)};
        }
      }
      records.push_back({file_.size(), static_cast<uint32_t>(bytes.size()), static_cast<uint32_t>(sets[i].size()), base,
                         checksum(bytes)});
      PROMENADE_TRY(file_.write(bytes));
    }
    return Done{};
  }

  std::vector<VlodRecord> records;

 private:
  AtomicFile& file_;
};

Status write_vlods(VlodWriter& writer, uint32_t count, uint32_t nodes, const VlodSource& vlod_of) {
  std::vector<std::vector<uint32_t>> sets;
  for (uint32_t first = 0; first < count; first += kGroup) {
    sets.clear();
    for (uint32_t i = first; i < std::min(first + kGroup, count); ++i) {
      const Result<std::vector<NodeId>> vlod = vlod_of(CellId{i});
      if (!vlod) return vlod.error();
      std::vector<uint32_t>& ids = sets.emplace_back();
      for (const NodeId id : *vlod) ids.push_back(index_of(id));
      const bool ascending = std::adjacent_find(ids.begin(), ids.end(), std::greater_equal<>()) == ids.end();
      if (!ascending || (!ids.empty() && ids.back() >= nodes))
        return Error{fmt::format("the vLOD of cell {} is no ascending set of nodes", i)};
    }
    PROMENADE_TRY(writer.write_group(first, sets));
  }
  return Done{};
}

}  // namespace

Result<uint64_t> write_cells(const std::filesystem::path& path, const CellTables& tables, const CellsOwner& owner,
                             const VlodSource& vlod_of, FileSystem& files) {
  if (const std::string defect = find_defect(tables); !defect.empty())
    return Error{fmt::format("{}: refused to write unsound cells: {}", path.string(), defect)};
  Result<AtomicFile> file = AtomicFile::create(path, files);
  if (!file) return file.error();
  // The header is known last.
  PROMENADE_TRY(file->write(std::vector<std::byte>(kCellsHeaderBytes)));
  VlodWriter writer(*file);
  PROMENADE_TRY(write_vlods(writer, static_cast<uint32_t>(tables.cells.size()), owner.nodes, vlod_of));
  constexpr uint64_t kAlignment = 8;
  while (file->size() % kAlignment != 0) PROMENADE_TRY(file->write(std::array<std::byte, 1>{}));
  const EncodedCells encoded = encode_cells({owner, tables, std::move(writer.records)}, file->size());
  PROMENADE_TRY(file->write(encoded.sections));
  PROMENADE_TRY(file->write_at(0, encoded.header));
  const uint64_t bytes = file->size();
  PROMENADE_TRY(file->commit());
  return bytes;
}

struct CellsReader::State {
  std::string name;
  RandomAccessFile file;
  CellsFile content;

  /// The stored set of a cell, or its difference.
  Result<std::vector<uint32_t>> read_ids(CellId cell, uint64_t& bytes_read) const {
    const VlodRecord& record = content.vlods[index_of(cell)];
    std::vector<std::byte> bytes(record.stored_bytes);
    PROMENADE_TRY(file.read(record.offset, bytes));
    bytes_read += bytes.size();
    const auto where = [&] { return fmt::format("{}: vLOD of cell {} @{:#x}", name, index_of(cell), record.offset); };
    if (const uint64_t found = checksum(bytes); found != record.checksum)
      return Error{fmt::format("{}: checksum {:016x} != {:016x}; copy or build the model again", where(), found,
                               record.checksum)};
    Result<std::vector<uint32_t>> ids = decode_ids(bytes, content.owner.nodes);
    if (!ids) return Error{fmt::format("{}: {}", where(), ids.error().message)};
    return ids;
  }
};

CellsReader::CellsReader(std::unique_ptr<State> state) : state_(std::move(state)) {}
CellsReader::CellsReader(CellsReader&&) noexcept = default;
CellsReader& CellsReader::operator=(CellsReader&&) noexcept = default;
CellsReader::~CellsReader() = default;

Result<CellsReader> CellsReader::open(const std::filesystem::path& path, const CellsOwner& owner, FileSystem& files) {
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
  return CellsReader(std::make_unique<State>(State{path.string(), std::move(*file), std::move(*content)}));
}

const CellTables& CellsReader::tables() const { return state_->content.tables; }
std::span<const VlodRecord> CellsReader::vlods() const { return state_->content.vlods; }

Result<Vlod> CellsReader::read_vlod(CellId cell) const {
  const VlodRecord& record = state_->content.vlods[index_of(cell)];
  Vlod vlod;
  Result<std::vector<uint32_t>> ids = state_->read_ids(cell, vlod.bytes_read);
  if (!ids) return ids.error();
  if (record.base != kNoCell) {
    const Result<std::vector<uint32_t>> base = state_->read_ids(record.base, vlod.bytes_read);
    if (!base) return base.error();
    *ids = symmetric_difference(*ids, *base);
  }
  if (ids->size() != record.nodes)
    return Error{fmt::format("{}: vLOD of cell {}: {} nodes, {} are due", state_->name, index_of(cell), ids->size(),
                             record.nodes)};
  vlod.nodes.reserve(ids->size());
  for (const uint32_t id : *ids) vlod.nodes.push_back(NodeId{id});
  return vlod;
}

}  // namespace promenade
