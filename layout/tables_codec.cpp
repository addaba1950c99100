#include "layout/tables_codec.h"

#include <fmt/format.h>

#include <array>
#include <string_view>

#include "layout/section_list.h"

namespace promenade {
namespace {

constexpr std::string_view kMagic = "PROMTABL";
constexpr size_t kHeaderBytes = 16;
constexpr std::array<SectionKind, 7> kSections = {{{"nodes", 104},
                                                   {"children", 4},
                                                   {"roots", 4},
                                                   {"materials", 16},
                                                   {"textures", 16},
                                                   {"node_textures", 4},
                                                   {"segments", 24}}};
constexpr size_t kListBytes = kHeaderBytes + kSections.size() * SectionEntry::kBytes;
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

Result<std::vector<SectionEntry>> read_list(std::span<const std::byte> bytes) {
  ByteReader reader(bytes);
  const std::span<const std::byte> magic = reader.get_bytes(kMagic.size());
  if (!reader.ok() || std::string_view(reinterpret_cast<const char*>(magic.data()), magic.size()) != kMagic)
    return Error{"header: no tables of a model"};
  if (const auto version = reader.get<uint32_t>(); version != kTablesVersion)
    return Error{fmt::format("header @0x8: version {}, this program reads {}; use the program that wrote it", version,
                             kTablesVersion)};
  if (const auto count = reader.get<uint32_t>(); count != kSections.size())
    return Error{fmt::format("header @0xc: {} sections, not {}", count, kSections.size())};
  std::vector<SectionEntry> list(kSections.size());
  for (SectionEntry& entry : list) entry = get_section_entry(reader);
  const auto stored = reader.get<uint64_t>();
  if (!reader.ok()) return Error{fmt::format("header: {} bytes, {} are due", bytes.size(), kFirstSection)};
  if (const uint64_t found = checksum(bytes.first(kListBytes)); found != stored)
    return Error{fmt::format("header @{:#x}: checksum {:016x} != {:016x}", kListBytes, found, stored)};
  return list;
}

}  // namespace

std::vector<std::byte> encode_tables(const ModelTables& tables) {
  ByteWriter list;
  SectionWriter sections(kFirstSection);
  for (const char c : kMagic) list.put(static_cast<uint8_t>(c));
  list.put(kTablesVersion);
  list.put(static_cast<uint32_t>(kSections.size()));
  for_each_section(tables, [&](const SectionKind& kind, const auto& table) {
    sections.add(list, kind, table, [](ByteWriter& w, const auto& entry) { put(w, entry); });
  });
  list.put(checksum(list.bytes()));
  list.put_bytes(sections.take());
  return list.take();
}

Result<ModelTables> decode_tables(std::span<const std::byte> bytes) {
  const Result<std::vector<SectionEntry>> list = read_list(bytes);
  if (!list) return list.error();
  ModelTables tables;
  SectionReader sections(bytes.subspan(kFirstSection), kFirstSection);
  Status status = Done{};
  size_t next = 0;
  for_each_section(tables, [&](const SectionKind& kind, auto& table) {
    const SectionEntry& entry = (*list)[next++];
    if (status) status = sections.read(entry, kind, table, [](ByteReader& r, auto& e) { get(r, e); });
  });
  if (status) status = sections.finish();
  if (!status) return status.error();
  return tables;
}

}  // namespace promenade
