#include "layout/far_io.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <string_view>
#include <utility>

#include "codec/frame.h"
#include "layout/section_list.h"

namespace promenade {
namespace {

constexpr std::string_view kMagic = "PROMFARP";
constexpr uint32_t kVersion = 2;
constexpr uint64_t kListOffset = 96, kHeaderBytes = 200;
constexpr std::array<SectionKind, 3> kSections = {{{"far cells", 20}, {"far faces", 28}, {"far shells", 16}}};

struct FarFile {
  CellsOwner owner;
  FarTables tables;
};

void put(ByteWriter& w, const FarCellRecord& c) {
  w.put(c.place), w.put(c.first_face), w.put(c.face_count), w.put(c.parallax_rad);
}
void get(ByteReader& r, FarCellRecord& c) {
  c.place = r.get<uint64_t>(), c.first_face = r.get<uint32_t>();
  c.face_count = r.get<uint32_t>(), c.parallax_rad = r.get<float>();
}
void put(ByteWriter& w, const FarFaceRecord& f) {
  w.put(f.offset), w.put(f.stored_bytes), w.put(f.side), w.put(f.triangles), w.put(f.checksum);
}
void get(ByteReader& r, FarFaceRecord& f) {
  f.offset = r.get<uint64_t>(), f.stored_bytes = r.get<uint32_t>(), f.side = r.get<uint32_t>();
  f.triangles = r.get<uint32_t>(), f.checksum = r.get<uint64_t>();
}

void put(ByteWriter& w, const FarOuterShell& s) { w.put(s.box_m), w.put(s.times), w.put(uint32_t(0)); }
void get(ByteReader& r, FarOuterShell& s) {
  s.box_m = r.get<double>(), s.times = r.get<uint32_t>();
  static_cast<void>(r.get<uint32_t>());
}

std::vector<std::byte> header_of(const FarFile& file, std::span<const std::byte> list) {
  const FarTables& t = file.tables;
  ByteWriter w;
  for (const char c : kMagic) w.put(static_cast<uint8_t>(c));
  w.put(kVersion), w.put(static_cast<uint32_t>(kSections.size()));
  w.put(file.owner.tables_checksum), w.put(file.owner.nodes), w.put(t.face_levels);
  w.put(t.bound_rad), w.put(t.box_m), w.put(t.cell_m);
  for (int i = 0; i < 3; ++i) w.put(t.origin[i]);
  for (int i = 0; i < 3; ++i) w.put(t.counts[i]);
  w.put(uint32_t(t.has_depth ? 1 : 0));
  w.put_bytes(list);
  w.put(checksum(w.bytes()));
  return w.take();
}

Status check_header(std::span<const std::byte> header) {
  if (header.size() < kHeaderBytes)
    return Error{fmt::format("header: {} bytes, {} are due", header.size(), kHeaderBytes)};
  if (std::string_view(reinterpret_cast<const char*>(header.data()), kMagic.size()) != kMagic)
    return Error{"header: no far pictures of a model"};
  ByteReader reader(header.subspan(kMagic.size()));
  if (const auto version = reader.get<uint32_t>(); version != kVersion)
    return Error{
        fmt::format("header @0x8: version {}, this program reads {}; build the model again", version, kVersion)};
  if (const auto count = reader.get<uint32_t>(); count != kSections.size())
    return Error{fmt::format("header @0xc: {} sections, not {}", count, kSections.size())};
  constexpr uint64_t kSumOffset = kHeaderBytes - sizeof(uint64_t);
  const uint64_t stored = ByteReader(header.subspan(kSumOffset)).get<uint64_t>();
  if (const uint64_t found = checksum(header.first(kSumOffset)); found != stored)
    return Error{fmt::format("header @{:#x}: checksum {:016x} != {:016x}", kSumOffset, found, stored)};
  return Done{};
}

/// Everything in the header but the list.
FarFile fields_of(std::span<const std::byte> header) {
  FarFile file;
  FarTables& t = file.tables;
  ByteReader r(header.subspan(kMagic.size() + 2 * sizeof(uint32_t)));
  file.owner.tables_checksum = r.get<uint64_t>(), file.owner.nodes = r.get<uint32_t>();
  t.face_levels = r.get<uint32_t>();
  t.bound_rad = r.get<double>(), t.box_m = r.get<double>(), t.cell_m = r.get<double>();
  for (int i = 0; i < 3; ++i) t.origin[i] = r.get<double>();
  for (int i = 0; i < 3; ++i) t.counts[i] = r.get<uint32_t>();
  t.has_depth = r.get<uint32_t>() != 0;
  return file;
}

std::string find_range_defect(const FarTables& tables, uint64_t end) {
  for (size_t i = 0; i < tables.faces.size(); ++i) {
    const FarFaceRecord& f = tables.faces[i];
    if (f.offset < kHeaderBytes || f.offset > end || f.stored_bytes > end - f.offset)
      return fmt::format("far face {}: {} bytes @{:#x} are not between {:#x} and {:#x}", i, f.stored_bytes, f.offset,
                         kHeaderBytes, end);
  }
  return {};
}

Result<FarFile> read_tables(const RandomAccessFile& file) {
  std::vector<std::byte> header(std::min(file.size(), kHeaderBytes));
  PROMENADE_TRY(file.read(0, header));
  PROMENADE_TRY(check_header(header));
  ByteReader list(std::span<const std::byte>(header).subspan(kListOffset));
  const SectionEntry cells = get_section_entry(list), faces = get_section_entry(list), shells = get_section_entry(list);
  if (cells.offset < kHeaderBytes || cells.offset % kSectionAlignment != 0 || cells.offset > file.size())
    return Error{fmt::format("header: sections @{:#x} of {:#x} bytes", cells.offset, file.size())};
  std::vector<std::byte> sections(file.size() - cells.offset);
  PROMENADE_TRY(file.read(cells.offset, sections));
  FarFile read = fields_of(header);
  SectionReader reader(sections, cells.offset);
  PROMENADE_TRY(reader.read(cells, kSections[0], read.tables.cells, [](ByteReader& r, auto& e) { get(r, e); }));
  PROMENADE_TRY(reader.read(faces, kSections[1], read.tables.faces, [](ByteReader& r, auto& e) { get(r, e); }));
  PROMENADE_TRY(reader.read(shells, kSections[2], read.tables.outer, [](ByteReader& r, auto& e) { get(r, e); }));
  PROMENADE_TRY(reader.finish());
  std::string defect = find_defect(read.tables);
  if (defect.empty()) defect = find_range_defect(read.tables, cells.offset);
  if (!defect.empty()) return Error{defect};
  return read;
}

Status write_cell(AtomicFile& file, const StoredFarCell& cell, FarTables& tables) {
  FarCellRecord record;
  record.place = cell.place, record.parallax_rad = cell.parallax_rad;
  record.first_face = static_cast<uint32_t>(tables.faces.size());
  record.face_count = static_cast<uint32_t>(cell.faces.size());
  for (const StoredFarCell::Face& face : cell.faces) {
    tables.faces.push_back(
        {file.size(), static_cast<uint32_t>(face.bytes.size()), face.side, face.triangles, checksum(face.bytes)});
    PROMENADE_TRY(file.write(face.bytes));
  }
  tables.cells.push_back(record);
  return Done{};
}

/// By place, as they are looked for; their bytes stay where they came.
void sort_cells(FarTables& tables) {
  std::sort(tables.cells.begin(), tables.cells.end(),
            [](const FarCellRecord& a, const FarCellRecord& b) { return a.place < b.place; });
  std::vector<FarFaceRecord> faces;
  faces.reserve(tables.faces.size());
  for (FarCellRecord& cell : tables.cells) {
    const auto first = tables.faces.begin() + cell.first_face;
    cell.first_face = static_cast<uint32_t>(faces.size());
    faces.insert(faces.end(), first, first + cell.face_count);
  }
  tables.faces = std::move(faces);
}

}  // namespace

Result<uint64_t> write_far(const std::filesystem::path& path, FarTables tables, const CellsOwner& owner,
                           const FarCellSource& next_cells, FileSystem& files) {
  Result<AtomicFile> file = AtomicFile::create(path, files);
  if (!file) return file.error();
  PROMENADE_TRY(file->write(std::vector<std::byte>(kHeaderBytes)));  // known last
  while (true) {
    const Result<std::vector<StoredFarCell>> cells = next_cells();
    if (!cells) return cells.error();
    if (cells->empty()) break;
    for (const StoredFarCell& cell : *cells) PROMENADE_TRY(write_cell(*file, cell, tables));
  }
  sort_cells(tables);
  if (const std::string defect = find_defect(tables); !defect.empty())
    return Error{fmt::format("{}: refused to write unsound far pictures: {}", path.string(), defect)};
  while (file->size() % kSectionAlignment != 0) PROMENADE_TRY(file->write(std::array<std::byte, 1>{}));
  ByteWriter list;
  SectionWriter writer(file->size());
  writer.add(list, kSections[0], tables.cells, [](ByteWriter& w, const auto& entry) { put(w, entry); });
  writer.add(list, kSections[1], tables.faces, [](ByteWriter& w, const auto& entry) { put(w, entry); });
  writer.add(list, kSections[2], tables.outer, [](ByteWriter& w, const auto& entry) { put(w, entry); });
  PROMENADE_TRY(file->write(writer.take()));
  PROMENADE_TRY(file->write_at(0, header_of({owner, std::move(tables)}, list.bytes())));
  const uint64_t bytes = file->size();
  PROMENADE_TRY(file->commit());
  return bytes;
}

struct FarReader::State {
  std::string name;
  RandomAccessFile file;
  FarTables tables;
};

FarReader::FarReader(std::unique_ptr<State> state) : state_(std::move(state)) {}
FarReader::FarReader(FarReader&&) noexcept = default;
FarReader& FarReader::operator=(FarReader&&) noexcept = default;
FarReader::~FarReader() = default;

Result<FarReader> FarReader::open(const std::filesystem::path& path, const CellsOwner& owner, FileSystem& files) {
  Result<RandomAccessFile> file = RandomAccessFile::open(path, files);
  if (!file) return file.error();
  Result<FarFile> read = read_tables(*file);
  if (!read) return Error{fmt::format("{}: {}", path.string(), read.error().message)};
  if (read->owner != owner)
    return Error{
        fmt::format("{}: belongs to tables of {} nodes with checksum {:016x}, not {} and {:016x}; the files are "
                    "not of one build",
                    path.string(), read->owner.nodes, read->owner.tables_checksum, owner.nodes, owner.tables_checksum)};
  return FarReader(std::make_unique<State>(State{path.string(), std::move(*file), std::move(read->tables)}));
}

const FarTables& FarReader::tables() const { return state_->tables; }

Result<std::vector<std::byte>> FarReader::read_face(uint32_t face) const {
  const FarFaceRecord& record = state_->tables.faces[face];
  std::vector<std::byte> bytes(record.stored_bytes);
  PROMENADE_TRY(state_->file.read(record.offset, bytes));
  if (const uint64_t found = checksum(bytes); found != record.checksum)
    return Error{fmt::format("{}: far face {} @{:#x}: checksum {:016x} != {:016x}; copy or build the model again",
                             state_->name, face, record.offset, found, record.checksum)};
  return bytes;
}

}  // namespace promenade
