#include "layout/tables_codec.h"

#include <fmt/format.h>

#include <array>
#include <string_view>

#include "codec/byte_io.h"
#include "codec/frame.h"

namespace promenade {
namespace {

constexpr std::string_view kMagic = "PROMTABL";
constexpr size_t kHeaderBytes = 16;
constexpr size_t kEntryBytes = 32;  // of the list of sections
constexpr size_t kAlignment = 8;

enum class Section : uint32_t { nodes = 1, children, roots, materials, textures, node_textures, segments };

struct SectionKind {
  Section section;
  std::string_view name;
  uint32_t entry_bytes;
};
constexpr std::array<SectionKind, 7> kSections = {{{Section::nodes, "nodes", 104},
                                                   {Section::children, "children", 4},
                                                   {Section::roots, "roots", 4},
                                                   {Section::materials, "materials", 16},
                                                   {Section::textures, "textures", 16},
                                                   {Section::node_textures, "node_textures", 4},
                                                   {Section::segments, "segments", 24}}};
constexpr size_t kListBytes = kHeaderBytes + kSections.size() * kEntryBytes;
constexpr size_t kFirstSection = kListBytes + sizeof(uint64_t);  // after the checksum of header and list

// ---- entries

void put(ByteWriter& w, const glm::vec3& v) { w.put(v.x), w.put(v.y), w.put(v.z); }
void put(ByteWriter& w, uint32_t value) { w.put(value); }
void put(ByteWriter& w, NodeId id) { w.put(index_of(id)); }

void put(ByteWriter& w, const NodeRecord& n) {
  put(w, n.box.min), put(w, n.box.max);
  w.put(n.error_m), w.put(n.error_p99_m);
  put(w, n.cone.axis), w.put(n.cone.cos_angle);
  put(w, n.average_normal), w.put(n.surface_m2);
  put(w, n.parent);
  for (const uint32_t value : {n.first_child, n.child_count, n.level, n.triangles, n.textured_triangles, n.vertices,
                               n.segment, n.first_texture, n.texture_count})
    w.put(value);
}

void put(ByteWriter& w, const Material& m) {
  w.put(m.color.r), w.put(m.color.g), w.put(m.color.b), w.put(m.color.a);
  w.put(m.texture);
  w.put(static_cast<uint8_t>(m.wrap_u)), w.put(static_cast<uint8_t>(m.wrap_v));
  w.put(static_cast<uint8_t>(m.alpha)), w.put(m.alpha_cutoff);
  w.put(static_cast<uint32_t>(m.two_sided ? 1 : 0));
}

void put(ByteWriter& w, const TextureRecord& t) { w.put(t.width), w.put(t.height), w.put(t.segment), w.put(t.flags); }

void put(ByteWriter& w, const SegmentRecord& s) {
  w.put(static_cast<uint16_t>(s.type)), w.put(s.file), w.put(s.stored_bytes), w.put(s.offset), w.put(s.checksum);
}

void get(ByteReader& r, glm::vec3& v) {
  for (int i = 0; i < 3; ++i) v[i] = r.get<float>();
}
void get(ByteReader& r, uint32_t& value) { value = r.get<uint32_t>(); }
void get(ByteReader& r, NodeId& id) { id = NodeId{r.get<uint32_t>()}; }

void get(ByteReader& r, NodeRecord& n) {
  get(r, n.box.min), get(r, n.box.max);
  n.error_m = r.get<float>(), n.error_p99_m = r.get<float>();
  get(r, n.cone.axis), n.cone.cos_angle = r.get<float>();
  get(r, n.average_normal), n.surface_m2 = r.get<float>();
  get(r, n.parent);
  for (uint32_t* value : {&n.first_child, &n.child_count, &n.level, &n.triangles, &n.textured_triangles, &n.vertices,
                          &n.segment, &n.first_texture, &n.texture_count})
    *value = r.get<uint32_t>();
}

void get(ByteReader& r, Material& m) {
  for (int i = 0; i < 4; ++i) m.color[i] = r.get<uint8_t>();
  m.texture = r.get<uint32_t>();
  m.wrap_u = static_cast<Wrap>(r.get<uint8_t>()), m.wrap_v = static_cast<Wrap>(r.get<uint8_t>());
  m.alpha = static_cast<AlphaMode>(r.get<uint8_t>()), m.alpha_cutoff = r.get<uint8_t>();
  m.two_sided = r.get<uint32_t>() != 0;
}

void get(ByteReader& r, TextureRecord& t) {
  for (uint32_t* value : {&t.width, &t.height, &t.segment, &t.flags}) *value = r.get<uint32_t>();
}

void get(ByteReader& r, SegmentRecord& s) {
  s.type = static_cast<SegmentRecord::Type>(r.get<uint16_t>());
  s.file = r.get<uint16_t>(), s.stored_bytes = r.get<uint32_t>();
  s.offset = r.get<uint64_t>(), s.checksum = r.get<uint64_t>();
}

// ---- sections

/// Calls visit(kind, table) for each section in order.
template <class Tables, class Visit>
void for_each_section(Tables& tables, Visit visit) {
  visit(kSections[0], tables.nodes);
  visit(kSections[1], tables.children);
  visit(kSections[2], tables.roots);
  visit(kSections[3], tables.materials);
  visit(kSections[4], tables.textures);
  visit(kSections[5], tables.node_textures);
  visit(kSections[6], tables.segments);
}

/// A section as the list at the front has it.
struct ListEntry {
  uint32_t section = 0;
  uint32_t entry_bytes = 0;
  uint64_t count = 0;
  uint64_t offset = 0;
  uint64_t checksum = 0;
};

void put(ByteWriter& w, const ListEntry& e) {
  w.put(e.section), w.put(e.entry_bytes), w.put(e.count), w.put(e.offset), w.put(e.checksum);
}

void get(ByteReader& r, ListEntry& e) {
  e.section = r.get<uint32_t>(), e.entry_bytes = r.get<uint32_t>();
  e.count = r.get<uint64_t>(), e.offset = r.get<uint64_t>(), e.checksum = r.get<uint64_t>();
}

Result<std::vector<ListEntry>> read_list(std::span<const std::byte> bytes) {
  ByteReader reader(bytes);
  const std::span<const std::byte> magic = reader.get_bytes(kMagic.size());
  if (!reader.ok() || std::string_view(reinterpret_cast<const char*>(magic.data()), magic.size()) != kMagic)
    return Error{"header: no tables of a model"};
  if (const auto version = reader.get<uint32_t>(); version != kTablesVersion)
    return Error{fmt::format("header @0x8: version {}, this program reads {}; use the program that wrote it", version,
                             kTablesVersion)};
  if (const auto count = reader.get<uint32_t>(); count != kSections.size())
    return Error{fmt::format("header @0xc: {} sections, not {}", count, kSections.size())};
  std::vector<ListEntry> list(kSections.size());
  for (ListEntry& entry : list) get(reader, entry);
  const auto stored = reader.get<uint64_t>();
  if (!reader.ok()) return Error{fmt::format("header: {} bytes, {} are due", bytes.size(), kFirstSection)};
  if (const uint64_t found = checksum(bytes.first(kListBytes)); found != stored)
    return Error{fmt::format("header @{:#x}: checksum {:016x} != {:016x}", kListBytes, found, stored)};
  return list;
}

/// Where the next section begins.
uint64_t aligned(uint64_t offset) { return (offset + kAlignment - 1) / kAlignment * kAlignment; }

template <class Entry>
Status read_section(std::span<const std::byte> bytes, const ListEntry& entry, const SectionKind& kind, uint64_t due,
                    std::vector<Entry>& table) {
  if (entry.section != static_cast<uint32_t>(kind.section) || entry.entry_bytes != kind.entry_bytes ||
      entry.offset != due)
    return Error{fmt::format("{} @{:#x}: section {} with entries of {} bytes @{:#x}, not {}, {}, @{:#x}", kind.name,
                             entry.offset, entry.section, entry.entry_bytes, entry.offset,
                             static_cast<uint32_t>(kind.section), kind.entry_bytes, due)};
  if (entry.offset > bytes.size() || entry.count > (bytes.size() - entry.offset) / kind.entry_bytes)
    return Error{fmt::format("{} @{:#x}: {} entries of {} bytes reach beyond the end @{:#x}", kind.name, entry.offset,
                             entry.count, kind.entry_bytes, bytes.size())};
  const std::span<const std::byte> section = bytes.subspan(entry.offset, entry.count * kind.entry_bytes);
  if (const uint64_t found = checksum(section); found != entry.checksum)
    return Error{fmt::format("{} @{:#x}: checksum {:016x} != {:016x}", kind.name, entry.offset, found, entry.checksum)};
  ByteReader reader(section);
  table.resize(entry.count);
  for (Entry& e : table) get(reader, e);
  return Done{};
}

}  // namespace

std::vector<std::byte> encode_tables(const ModelTables& tables) {
  ByteWriter list, sections;
  for (const char c : kMagic) list.put(static_cast<uint8_t>(c));
  list.put(kTablesVersion);
  list.put(static_cast<uint32_t>(kSections.size()));
  for_each_section(tables, [&](const SectionKind& kind, const auto& table) {
    while (sections.size() % kAlignment != 0) sections.put(uint8_t(0));
    const size_t begin = sections.size();
    for (const auto& entry : table) put(sections, entry);
    put(list, ListEntry{static_cast<uint32_t>(kind.section), kind.entry_bytes, table.size(), kFirstSection + begin,
                        checksum(sections.bytes().subspan(begin))});
  });
  list.put(checksum(list.bytes()));
  list.put_bytes(sections.bytes());
  return list.take();
}

Result<ModelTables> decode_tables(std::span<const std::byte> bytes) {
  const Result<std::vector<ListEntry>> list = read_list(bytes);
  if (!list) return list.error();
  ModelTables tables;
  Status status = Done{};
  size_t next = 0;
  uint64_t end = kFirstSection;
  for_each_section(tables, [&](const SectionKind& kind, auto& table) {
    const ListEntry& entry = (*list)[next++];
    if (!status) return;
    status = read_section(bytes, entry, kind, aligned(end), table);
    end = entry.offset + entry.count * kind.entry_bytes;
  });
  if (!status) return status.error();
  if (end != bytes.size())
    return Error{fmt::format("end @{:#x}: {} bytes follow the last section", end, bytes.size() - end)};
  return tables;
}

}  // namespace promenade
