#include "layout/cells_codec.h"

#include <fmt/format.h>

#include <array>
#include <string_view>

#include "codec/id_set_block.h"
#include "layout/cell_faces.h"
#include "layout/section_list.h"

namespace promenade {
namespace {

constexpr std::string_view kMagic = "PROMCELL";

constexpr std::array<SectionKind, 7> kSections = {{{"tree", 16},
                                                   {"cells", 32},
                                                   {"faces", 20},
                                                   {"faces_of_cells", 4},
                                                   {"portals", 24},
                                                   {"vlod_nodes", 4},
                                                   {"vlod_blocks", 24}}};
constexpr uint64_t kListOffset = 80;
constexpr uint64_t kFrameSumOffset = 28;
// Bounds memory on hostile input: boxes that share most of their coordinates come to a tenth, never to a thousandth.
constexpr uint64_t kMostExpansion = 1024, kLeastContent = 1 << 16;
static_assert(kListOffset + kSections.size() * SectionEntry::kBytes + sizeof(uint64_t) == kCellsHeaderBytes);

void put(ByteWriter& w, const Box& box) {
  for (const glm::vec3& corner : {box.min, box.max})
    for (int i = 0; i < 3; ++i) w.put(corner[i]);
}
void put(ByteWriter& w, const CellTreeNode& n) { w.put(n.axis), w.put(n.split_m), w.put(n.below), w.put(n.above); }
void put(ByteWriter& w, const CellRecord& c) { put(w, c.box), w.put(c.first_face), w.put(c.face_count); }
void put(ByteWriter& w, const CellFace& f) {
  w.put(index_of(f.below)), w.put(index_of(f.above)), w.put(f.axis), w.put(f.first_portal), w.put(f.portal_count);
}
void put(ByteWriter& w, uint32_t value) { w.put(value); }
void put(ByteWriter& w, const VlodBlock& b) {
  w.put(b.offset), w.put(b.stored_bytes), w.put(b.cells), w.put(b.checksum);
}

void get(ByteReader& r, Box& box) {
  for (glm::vec3* corner : {&box.min, &box.max})
    for (int i = 0; i < 3; ++i) (*corner)[i] = r.get<float>();
}
void get(ByteReader& r, CellTreeNode& n) {
  n.axis = r.get<uint32_t>(), n.split_m = r.get<float>();
  n.below = r.get<uint32_t>(), n.above = r.get<uint32_t>();
}
void get(ByteReader& r, CellRecord& c) {
  get(r, c.box);
  c.first_face = r.get<uint32_t>(), c.face_count = r.get<uint32_t>();
}
void get(ByteReader& r, CellFace& f) {
  f.below = CellId{r.get<uint32_t>()}, f.above = CellId{r.get<uint32_t>()}, f.axis = r.get<uint32_t>();
  f.first_portal = r.get<uint32_t>(), f.portal_count = r.get<uint32_t>();
}
void get(ByteReader& r, uint32_t& value) { value = r.get<uint32_t>(); }
void get(ByteReader& r, VlodBlock& b) {
  b.offset = r.get<uint64_t>(), b.stored_bytes = r.get<uint32_t>();
  b.cells = r.get<uint32_t>(), b.checksum = r.get<uint64_t>();
}

/// Calls visit(kind, table) for each section in order.
template <class File, class Visit>
void for_each_section(File& file, Visit visit) {
  visit(kSections[0], file.tables.tree);
  visit(kSections[1], file.tables.cells);
  visit(kSections[2], file.tables.faces);
  visit(kSections[3], file.tables.faces_of_cells);
  visit(kSections[4], file.tables.portals);
  visit(kSections[5], file.vlod_nodes);
  visit(kSections[6], file.blocks);
}

Status check_header(std::span<const std::byte> header) {
  if (header.size() < kCellsHeaderBytes)
    return Error{fmt::format("header: {} bytes, {} are due", header.size(), kCellsHeaderBytes)};
  if (std::string_view(reinterpret_cast<const char*>(header.data()), kMagic.size()) != kMagic)
    return Error{"header: no cells of a model"};
  ByteReader reader(header.subspan(kMagic.size()));
  if (const auto version = reader.get<uint32_t>(); version != kCellsVersion)
    return Error{
        fmt::format("header @0x8: version {}, this program reads {}; build the model again", version, kCellsVersion)};
  if (const auto count = reader.get<uint32_t>(); count != kSections.size())
    return Error{fmt::format("header @0xc: {} sections, not {}", count, kSections.size())};
  constexpr uint64_t kSumOffset = kCellsHeaderBytes - sizeof(uint64_t);
  const uint64_t stored = ByteReader(header.subspan(kSumOffset)).get<uint64_t>();
  if (const uint64_t found = checksum(header.first(kSumOffset)); found != stored)
    return Error{fmt::format("header @{:#x}: checksum {:016x} != {:016x}", kSumOffset, found, stored)};
  return Done{};
}

/// Faces that follow from the cells are not stored.
void drop_faces(CellTables& tables) {
  tables.faces.clear(), tables.faces_of_cells.clear(), tables.portals.clear();
  for (CellRecord& cell : tables.cells) cell.first_face = cell.face_count = 0;
}

std::string find_vlod_defect(const CellsFile& file, uint64_t vlods_end) {
  if (file.vlod_nodes.size() != file.tables.cells.size())
    return fmt::format("{} cells with {} vLODs", file.tables.cells.size(), file.vlod_nodes.size());
  for (size_t i = 0; i < file.vlod_nodes.size(); ++i)
    if (file.vlod_nodes[i] > file.owner.nodes)
      return fmt::format("vLOD {}: {} of {} nodes", i, file.vlod_nodes[i], file.owner.nodes);
  size_t cell = 0;
  for (size_t i = 0; i < file.blocks.size(); ++i) {
    const VlodBlock& b = file.blocks[i];
    if (b.offset < kCellsHeaderBytes || b.offset > vlods_end || b.stored_bytes > vlods_end - b.offset)
      return fmt::format("vLOD block {}: {} bytes @{:#x} are not between {:#x} and {:#x}", i, b.stored_bytes, b.offset,
                         kCellsHeaderBytes, vlods_end);
    if (b.cells == 0 || b.cells > kMaxSetsInBlock || b.cells > file.vlod_nodes.size() - cell)
      return fmt::format("vLOD block {}: {} cells, at most {} are left and {} in a block", i, b.cells,
                         file.vlod_nodes.size() - cell, kMaxSetsInBlock);
    uint64_t ids = 0;
    for (const size_t end = cell + b.cells; cell < end; ++cell) ids += file.vlod_nodes[cell];
    if (b.cells > 1 && ids > kMostBlockIds)
      return fmt::format("vLOD block {}: {} ids in {} cells, at most {}", i, ids, b.cells, kMostBlockIds);
  }
  if (cell != file.vlod_nodes.size())
    return fmt::format("vLOD blocks: hold {} of {} cells", cell, file.vlod_nodes.size());
  return {};
}

}  // namespace

EncodedCells encode_cells(CellsFile file, uint64_t sections_offset) {
  if (faces_follow(file.tables)) drop_faces(file.tables);
  ByteWriter list;
  SectionWriter writer(sections_offset);
  for_each_section(file, [&](const SectionKind& kind, const auto& table) {
    writer.add(list, kind, table, [](ByteWriter& w, const auto& entry) { put(w, entry); });
  });
  std::vector<std::byte> sections = compress_frame(writer.take());
  ByteWriter header;
  for (const char c : kMagic) header.put(static_cast<uint8_t>(c));
  header.put(kCellsVersion), header.put(static_cast<uint32_t>(kSections.size()));
  header.put(file.owner.tables_checksum), header.put(file.owner.nodes);
  header.put(static_cast<uint32_t>(checksum(sections)));
  const FrontBound& bound = file.tables.bound;
  header.put(bound.pixel_error), header.put(bound.scale.focal_px), header.put(bound.scale.tan_corner);
  put(header, file.tables.box);
  header.put_bytes(list.bytes());
  header.put(checksum(header.bytes()));
  return {header.take(), std::move(sections)};
}

Result<uint64_t> sections_offset_of(std::span<const std::byte> header, uint64_t file_bytes) {
  PROMENADE_TRY(check_header(header));
  ByteReader reader(header.subspan(kListOffset));
  const uint64_t offset = get_section_entry(reader).offset;
  if (offset < kCellsHeaderBytes || offset % kSectionAlignment != 0 || offset > file_bytes)
    return Error{fmt::format("header: sections @{:#x} of {:#x} bytes", offset, file_bytes)};
  return offset;
}

Result<CellsFile> decode_cells(std::span<const std::byte> header, std::span<const std::byte> sections,
                               uint64_t file_bytes) {
  const Result<uint64_t> begin = sections_offset_of(header, file_bytes);
  if (!begin) return begin.error();
  if (sections.size() != file_bytes - *begin)
    return Error{fmt::format("sections: {} bytes, {} are due", sections.size(), file_bytes - *begin)};
  const Result<std::vector<std::byte>> content =
      decompress_frame(sections, kLeastContent + kMostExpansion * sections.size());
  if (!content) return Error{fmt::format("sections @{:#x}: {}", *begin, content.error().message)};
  const auto stored = ByteReader(header.subspan(kFrameSumOffset)).get<uint32_t>();
  if (const auto found = static_cast<uint32_t>(checksum(sections)); found != stored)
    return Error{fmt::format("sections @{:#x}: checksum {:08x} != {:08x}", *begin, found, stored)};
  CellsFile file;
  ByteReader reader(header.subspan(kMagic.size() + 2 * sizeof(uint32_t)));
  file.owner.tables_checksum = reader.get<uint64_t>();
  file.owner.nodes = reader.get<uint32_t>();
  reader.get<uint32_t>();
  FrontBound& bound = file.tables.bound;
  bound.pixel_error = reader.get<double>();
  bound.scale.focal_px = reader.get<double>(), bound.scale.tan_corner = reader.get<double>();
  get(reader, file.tables.box);
  Status status = Done{};
  SectionReader reads(*content, *begin);
  for_each_section(file, [&](const SectionKind& kind, auto& table) {
    const SectionEntry entry = get_section_entry(reader);
    if (status) status = reads.read(entry, kind, table, [](ByteReader& r, auto& e) { get(r, e); });
  });
  if (status) status = reads.finish();
  if (!status) return status.error();
  std::string defect = find_defect(file.tables);
  if (defect.empty()) defect = find_vlod_defect(file, *begin);
  if (!defect.empty()) return Error{defect};
  if (file.tables.faces.empty()) PROMENADE_TRY(find_faces(file.tables));
  return file;
}

}  // namespace promenade
