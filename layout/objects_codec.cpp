#include "layout/objects_codec.h"

#include <fmt/format.h>

#include <array>
#include <string_view>

#include "codec/byte_io.h"
#include "codec/frame.h"
#include "layout/section_list.h"

namespace promenade {
namespace {

constexpr std::string_view kMagic = "PROMOBJS";
constexpr uint64_t kHeaderBytes = 32;
constexpr std::array<SectionKind, 11> kSections = {{{"joints", 192},
                                                    {"tracks", 24},
                                                    {"times", 4},
                                                    {"values", 4},
                                                    {"moving", 104},
                                                    {"moving_nodes", 28},
                                                    {"class_names", 1},
                                                    {"class_shares", 12},
                                                    {"footprints", 12},
                                                    {"loops", 4},
                                                    {"points", 8}}};
constexpr size_t kFirstSections = 8;  // those of version 1

/// Models without footprints are as they always were.
size_t sections_in(uint32_t version) { return version == 1 ? kFirstSections : kSections.size(); }
uint64_t list_bytes(uint32_t version) { return sections_in(version) * SectionEntry::kBytes; }

// Bounds memory on hostile input: keys that repeat each other come to a tenth, never to a thousandth.
constexpr uint64_t kMostExpansion = 1024, kLeastContent = 1 << 16;

void put(ByteWriter& w, uint8_t value) { w.put(value); }
void put(ByteWriter& w, float value) { w.put(value); }
void put(ByteWriter& w, uint32_t value) { w.put(value); }
void put(ByteWriter& w, const glm::vec2& v) { w.put(v.x), w.put(v.y); }
void put(ByteWriter& w, const Footprint& f) { w.put(f.base_m), w.put(f.top_m), w.put(f.loops_end); }
void put(ByteWriter& w, const glm::dmat4& m) {
  for (int column = 0; column < 4; ++column)
    for (int row = 0; row < 3; ++row) w.put(m[column][row]);
}
template <size_t N, class T>
void put(ByteWriter& w, const std::array<T, N>& numbers) {
  for (const T& number : numbers) w.put(number);
}
void put(ByteWriter& w, const AnimationJoint& j) {
  w.put(j.parent), put(w, j.tracks), put(w, j.parent_from_rest);
  put(w, j.translation), put(w, j.rotation), put(w, j.scale);
}
void put(ByteWriter& w, const AnimationTrack& t) {
  w.put(static_cast<uint32_t>(t.way)), w.put(t.components), w.put(t.first_time), w.put(t.first_value), w.put(t.keys);
  w.put(t.period_s);
}
void put(ByteWriter& w, const MovingObject& o) { w.put(o.joint), w.put(index_of(o.root)), put(w, o.joint_from_object); }
void put(ByteWriter& w, const MovingNode& n) {
  w.put(n.object);
  for (const glm::vec3& corner : {n.box.min, n.box.max})
    for (int i = 0; i < 3; ++i) w.put(corner[i]);
}
void put(ByteWriter& w, const ClassShare& s) { w.put(index_of(s.leaf)), w.put(s.class_index), w.put(s.area_m2); }

void get(ByteReader& r, uint8_t& value) { value = r.get<uint8_t>(); }
void get(ByteReader& r, float& value) { value = r.get<float>(); }
void get(ByteReader& r, uint32_t& value) { value = r.get<uint32_t>(); }
void get(ByteReader& r, glm::vec2& v) { v.x = r.get<float>(), v.y = r.get<float>(); }
void get(ByteReader& r, Footprint& f) {
  f.base_m = r.get<float>(), f.top_m = r.get<float>(), f.loops_end = r.get<uint32_t>();
}
void get(ByteReader& r, glm::dmat4& m) {
  m = glm::dmat4(1);
  for (int column = 0; column < 4; ++column)
    for (int row = 0; row < 3; ++row) m[column][row] = r.get<double>();
}
template <size_t N, class T>
void get(ByteReader& r, std::array<T, N>& numbers) {
  for (T& number : numbers) number = r.get<T>();
}
void get(ByteReader& r, AnimationJoint& j) {
  j.parent = r.get<uint32_t>(), get(r, j.tracks), get(r, j.parent_from_rest);
  get(r, j.translation), get(r, j.rotation), get(r, j.scale);
}
void get(ByteReader& r, AnimationTrack& t) {
  t.way = static_cast<AnimationTrack::Way>(std::min<uint32_t>(r.get<uint32_t>(), 0xff));
  for (uint32_t* value : {&t.components, &t.first_time, &t.first_value, &t.keys}) *value = r.get<uint32_t>();
  t.period_s = r.get<float>();
}
void get(ByteReader& r, MovingObject& o) {
  o.joint = r.get<uint32_t>(), o.root = NodeId{r.get<uint32_t>()}, get(r, o.joint_from_object);
}
void get(ByteReader& r, MovingNode& n) {
  n.object = r.get<uint32_t>();
  for (glm::vec3* corner : {&n.box.min, &n.box.max})
    for (int i = 0; i < 3; ++i) (*corner)[i] = r.get<float>();
}
void get(ByteReader& r, ClassShare& s) {
  s.leaf = NodeId{r.get<uint32_t>()}, s.class_index = r.get<uint32_t>(), s.area_m2 = r.get<float>();
}

/// Calls visit(kind, table) for each section of a version in order. names: each ends with a zero.
template <class Objects, class Names, class Visit>
void for_each_section(uint32_t version, Objects& objects, Names& names, Visit visit) {
  visit(kSections[0], objects.animation.joints);
  visit(kSections[1], objects.animation.tracks);
  visit(kSections[2], objects.animation.times);
  visit(kSections[3], objects.animation.values);
  visit(kSections[4], objects.moving);
  visit(kSections[5], objects.moving_nodes);
  visit(kSections[6], names);
  visit(kSections[7], objects.class_shares);
  if (version == 1) return;
  visit(kSections[8], objects.footprints.all);
  visit(kSections[9], objects.footprints.loop_ends);
  visit(kSections[10], objects.footprints.points);
}

struct Content {
  uint32_t version = 0;
  std::vector<std::byte> bytes;
};

Result<Content> read_content(std::span<const std::byte> bytes, const CellsOwner& owner) {
  ByteReader reader(bytes);
  const std::span<const std::byte> magic = reader.get_bytes(kMagic.size());
  if (!reader.ok() || std::string_view(reinterpret_cast<const char*>(magic.data()), magic.size()) != kMagic)
    return Error{"header: no objects of a model"};
  const auto version = reader.get<uint32_t>();
  if (version < 1 || version > kObjectsVersion)
    return Error{fmt::format("header @0x8: version {}, this program reads 1 to {}; build the model again", version,
                             kObjectsVersion)};
  CellsOwner found;
  found.nodes = reader.get<uint32_t>(), found.tables_checksum = reader.get<uint64_t>();
  const auto stored = reader.get<uint64_t>();
  if (!reader.ok()) return Error{fmt::format("header: {} bytes, {} are due", bytes.size(), kHeaderBytes)};
  if (found != owner)
    return Error{
        fmt::format("belongs to tables of {} nodes with checksum {:016x}, not {} and {:016x}; the files are "
                    "not of one build",
                    found.nodes, found.tables_checksum, owner.nodes, owner.tables_checksum)};
  const std::span<const std::byte> frame = bytes.subspan(kHeaderBytes);
  if (const uint64_t sum = checksum(frame); sum != stored)
    return Error{fmt::format("sections @{:#x}: checksum {:016x} != {:016x}", kHeaderBytes, sum, stored)};
  Result<std::vector<std::byte>> content = decompress_frame(frame, kLeastContent + kMostExpansion * frame.size());
  if (!content) return Error{fmt::format("sections @{:#x}: {}", kHeaderBytes, content.error().message)};
  if (content->size() < list_bytes(version))
    return Error{
        fmt::format("sections @{:#x}: {} bytes, {} are due", kHeaderBytes, content->size(), list_bytes(version))};
  return Content{version, std::move(*content)};
}

}  // namespace

std::vector<std::byte> encode_objects(const ModelObjects& objects, const CellsOwner& owner) {
  std::vector<uint8_t> names;
  for (const std::string& name : objects.classes) {
    for (const char c : name) names.push_back(static_cast<uint8_t>(c == '\0' ? ' ' : c));
    names.push_back(0);
  }
  const uint32_t version = objects.footprints.empty() ? 1 : kObjectsVersion;
  ByteWriter content;
  SectionWriter sections(list_bytes(version));
  for_each_section(version, objects, names, [&](const SectionKind& kind, const auto& table) {
    sections.add(content, kind, table, [](ByteWriter& w, const auto& entry) { put(w, entry); });
  });
  content.put_bytes(sections.take());
  const std::vector<std::byte> frame = compress_frame(content.bytes());
  ByteWriter file;
  for (const char c : kMagic) file.put(static_cast<uint8_t>(c));
  file.put(version), file.put(owner.nodes), file.put(owner.tables_checksum), file.put(checksum(frame));
  file.put_bytes(frame);
  return file.take();
}

Result<ModelObjects> decode_objects(std::span<const std::byte> bytes, const CellsOwner& owner) {
  const Result<Content> content = read_content(bytes, owner);
  if (!content) return content.error();
  const uint64_t list_end = list_bytes(content->version);
  ModelObjects objects;
  std::vector<uint8_t> names;
  ByteReader list(content->bytes);
  SectionReader sections(std::span<const std::byte>(content->bytes).subspan(list_end), list_end);
  Status status = Done{};
  for_each_section(content->version, objects, names, [&](const SectionKind& kind, auto& table) {
    const SectionEntry entry = get_section_entry(list);
    if (status) status = sections.read(entry, kind, table, [](ByteReader& r, auto& e) { get(r, e); });
  });
  if (status) status = sections.finish();
  if (!status) return status.error();
  if (!names.empty() && names.back() != 0) return Error{"class_names: the last name does not end"};
  for (size_t i = 0; i < names.size(); ++i) {
    if (i == 0 || names[i - 1] == 0) objects.classes.emplace_back();
    if (names[i] != 0) objects.classes.back().push_back(static_cast<char>(names[i]));
  }
  return objects;
}

uint64_t ModelObjects::byte_size() const {
  const auto bytes = [](const auto& v) { return uint64_t(v.capacity()) * sizeof(v[0]); };
  return bytes(animation.times) + bytes(animation.values) + bytes(animation.tracks) + bytes(animation.joints) +
         bytes(moving) + bytes(moving_nodes) + bytes(class_shares) + bytes(footprints.all) +
         bytes(footprints.loop_ends) + bytes(footprints.points);
}

}  // namespace promenade
