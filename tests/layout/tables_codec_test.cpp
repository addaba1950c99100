#include "layout/tables_codec.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <random>

#include "codec/frame.h"
#include "tests/golden.h"
#include "tests/layout/model_fixtures.h"

namespace promenade {
namespace {

using testing::HasSubstr;

void expect_equal(const ModelTables& a, const ModelTables& b) {
  EXPECT_EQ(a.nodes, b.nodes);
  EXPECT_EQ(a.children, b.children);
  EXPECT_EQ(a.roots, b.roots);
  EXPECT_EQ(a.materials, b.materials);
  EXPECT_EQ(a.textures, b.textures);
  EXPECT_EQ(a.node_textures, b.node_textures);
  EXPECT_EQ(a.segments, b.segments);
}

/// The tables of FORMAT.md's example.
ModelTables example_tables() {
  ModelTables tables;
  tables.materials = {Material{{255, 128, 0, 255}, 1, Wrap::repeat, Wrap::clamp, AlphaMode::mask, 100, true}};
  tables.roots = {NodeId{3}};
  tables.segments = {{SegmentRecord::Type::texture, 1, 0x1000, 0x234, 0x1122334455667788U}};
  return tables;
}

TEST(Tables, return_what_they_were_given) {
  for (const ModelTables& tables : {ModelTables{}, example_tables(), model_of_squares().tables}) {
    const Result<ModelTables> back = decode_tables(encode_tables(tables));
    ASSERT_TRUE(back) << back.error().message;
    expect_equal(*back, tables);
  }
}

TEST(Tables, are_the_golden_bytes_of_version_1) {
  expect_golden("tables_v1.bin", encode_tables(model_of_squares().tables));
  const Result<ModelTables> back = decode_tables(golden_bytes("tables_v1.bin"));
  ASSERT_TRUE(back) << back.error().message;
  expect_equal(*back, model_of_squares().tables);
}

TEST(Tables, are_the_bytes_that_the_format_shows) {
  std::ifstream in(std::filesystem::path(PROMENADE_SOURCE_DIR) / "layout" / "FORMAT.md");
  std::string shown;
  bool inside = false;
  for (std::string line; std::getline(in, line);) {
    if (line == "```hex") inside = true;
    if (line == "```") inside = false;
    const size_t colon = line.find(": ");
    if (inside && colon != std::string::npos) shown += line.substr(colon + 2, line.find("  #") - colon - 2) + " ";
  }
  std::string actual;
  for (const std::byte b : encode_tables(example_tables())) {
    constexpr const char* kDigits = "0123456789abcdef";
    actual += kDigits[std::to_integer<size_t>(b) / 16];
    actual += kDigits[std::to_integer<size_t>(b) % 16];
    actual += ' ';
  }
  EXPECT_EQ(shown, actual);
}

/// A second decoder, written from FORMAT.md, with no checks.
class SlowTables {
 public:
  explicit SlowTables(std::vector<std::byte> bytes) : bytes_(std::move(bytes)) {}

  uint64_t at(uint64_t offset, size_t size) const {
    uint64_t value = 0;
    for (size_t i = size; i-- > 0;) value = value * 256 + std::to_integer<uint64_t>(bytes_[offset + i]);
    return value;
  }
  uint32_t word(uint64_t offset) const { return static_cast<uint32_t>(at(offset, 4)); }
  float number(uint64_t offset) const {
    const uint32_t bits = word(offset);
    float value = 0;
    std::memcpy(&value, &bits, 4);
    return value;
  }
  glm::vec3 vector(uint64_t offset) const { return {number(offset), number(offset + 4), number(offset + 8)}; }

  /// Offset of entry i of a section; count of its entries.
  uint64_t entry(uint64_t section, uint64_t i) const {
    return at(16 + 32 * (section - 1) + 16, 8) + i * word(16 + 32 * (section - 1) + 4);
  }
  uint64_t count(uint64_t section) const { return at(16 + 32 * (section - 1) + 8, 8); }

  NodeRecord node(uint64_t i) const {
    const uint64_t e = entry(1, i);
    NodeRecord n;
    n.box = {vector(e), vector(e + 12)};
    n.error_m = number(e + 24), n.error_p99_m = number(e + 28);
    n.cone = {vector(e + 32), number(e + 44)};
    n.average_normal = vector(e + 48);
    n.surface_m2 = number(e + 60);
    n.parent = NodeId{word(e + 64)};
    n.first_child = word(e + 68), n.child_count = word(e + 72), n.level = word(e + 76);
    n.triangles = word(e + 80), n.textured_triangles = word(e + 84), n.vertices = word(e + 88);
    n.segment = word(e + 92), n.first_texture = word(e + 96), n.texture_count = word(e + 100);
    return n;
  }
  Material material(uint64_t i) const {
    const uint64_t e = entry(4, i);
    Material m;
    m.color = {at(e, 1), at(e + 1, 1), at(e + 2, 1), at(e + 3, 1)};
    m.texture = word(e + 4);
    m.wrap_u = static_cast<Wrap>(at(e + 8, 1)), m.wrap_v = static_cast<Wrap>(at(e + 9, 1));
    m.alpha = static_cast<AlphaMode>(at(e + 10, 1)), m.alpha_cutoff = static_cast<uint8_t>(at(e + 11, 1));
    m.two_sided = word(e + 12) == 1;
    return m;
  }
  SegmentRecord segment(uint64_t i) const {
    const uint64_t e = entry(7, i);
    return {static_cast<SegmentRecord::Type>(at(e, 2)), static_cast<uint16_t>(at(e + 2, 2)), at(e + 8, 8), word(e + 4),
            at(e + 16, 8)};
  }
  TextureRecord texture(uint64_t i) const {
    const uint64_t e = entry(5, i);
    return {word(e), word(e + 4), word(e + 8), word(e + 12)};
  }

 private:
  std::vector<std::byte> bytes_;
};

TEST(Tables, agree_with_a_slow_decoder_written_from_the_format) {
  const ModelTables tables = model_of_squares().tables;
  const SlowTables slow(encode_tables(tables));
  ModelTables back;
  for (uint64_t i = 0; i < slow.count(1); ++i) back.nodes.push_back(slow.node(i));
  for (uint64_t i = 0; i < slow.count(2); ++i) back.children.push_back(NodeId{slow.word(slow.entry(2, i))});
  for (uint64_t i = 0; i < slow.count(3); ++i) back.roots.push_back(NodeId{slow.word(slow.entry(3, i))});
  for (uint64_t i = 0; i < slow.count(4); ++i) back.materials.push_back(slow.material(i));
  for (uint64_t i = 0; i < slow.count(5); ++i) back.textures.push_back(slow.texture(i));
  for (uint64_t i = 0; i < slow.count(6); ++i) back.node_textures.push_back(slow.word(slow.entry(6, i)));
  for (uint64_t i = 0; i < slow.count(7); ++i) back.segments.push_back(slow.segment(i));
  expect_equal(back, tables);
}

TEST(DecodeTables, rejects_every_truncation_and_a_trailing_byte) {
  std::vector<std::byte> bytes = encode_tables(model_of_squares().tables);
  for (size_t n = 0; n < bytes.size(); ++n) EXPECT_FALSE(decode_tables(std::span(bytes).first(n))) << n;
  bytes.push_back(std::byte{0});
  EXPECT_THAT(decode_tables(bytes).error().message, HasSubstr("1 bytes follow the last section"));
}

TEST(DecodeTables, rejects_every_changed_byte_that_means_something) {
  const std::vector<std::byte> sound = encode_tables(model_of_squares().tables);
  for (size_t i = 0; i < sound.size(); ++i) {
    std::vector<std::byte> bytes = sound;
    bytes[i] ^= std::byte{0x10};
    const Result<ModelTables> tables = decode_tables(bytes);
    if (tables) {
      EXPECT_EQ(sound[i], std::byte{0}) << "byte " << i << " is not between two sections";
      EXPECT_EQ(tables->nodes, model_of_squares().tables.nodes);
    }
  }
}

TEST(DecodeTables, names_the_section_that_is_damaged) {
  std::vector<std::byte> bytes = encode_tables(model_of_squares().tables);
  bytes[300] ^= std::byte{1};
  EXPECT_THAT(decode_tables(bytes).error().message, HasSubstr("nodes @0xf8: checksum"));
}

/// Changes bytes of the list and makes its checksum right again.
std::string message_with_list_change(size_t at, uint64_t value, size_t size) {
  std::vector<std::byte> bytes = encode_tables(model_of_squares().tables);
  for (size_t i = 0; i < size; ++i) bytes[at + i] = static_cast<std::byte>((value >> (8 * i)) & 0xffU);
  const uint64_t sum = checksum(std::span(bytes).first(240));
  for (size_t i = 0; i < 8; ++i) bytes[240 + i] = static_cast<std::byte>((sum >> (8 * i)) & 0xffU);
  const Result<ModelTables> tables = decode_tables(bytes);
  return tables ? "decoded" : tables.error().message;
}

TEST(DecodeTables, refuses_newer_versions_and_lists_that_lie) {
  EXPECT_THAT(message_with_list_change(0, 'X', 1), HasSubstr("no tables"));
  EXPECT_THAT(message_with_list_change(8, 2, 4), HasSubstr("version 2, this program reads 1"));
  EXPECT_THAT(message_with_list_change(12, 8, 4), HasSubstr("8 sections"));
  EXPECT_THAT(message_with_list_change(16, 9, 4), HasSubstr("nodes @0xf8: section 9"));
  EXPECT_THAT(message_with_list_change(20, 100, 4), HasSubstr("entries of 100 bytes"));
  EXPECT_THAT(message_with_list_change(24, ~uint64_t(0), 8), HasSubstr("reach beyond the end"));
  EXPECT_THAT(message_with_list_change(24, uint64_t(1) << 62, 8), HasSubstr("reach beyond the end"));
  EXPECT_THAT(message_with_list_change(32, 0x1000000, 8), HasSubstr("nodes @0x1000000"));
}

TEST(DecodeTables, survives_random_changes_under_right_checksums) {
  std::mt19937 random(5);
  const std::vector<std::byte> sound = encode_tables(model_of_squares().tables);
  const Result<ModelTables> read = decode_tables(sound);
  for (int round = 0; round < 2000; ++round) {
    std::vector<std::byte> bytes = sound;
    const size_t at = 248 + random() % (bytes.size() - 248);
    bytes[at] = static_cast<std::byte>(random());
    for (uint64_t section = 1; section <= 7; ++section) {  // make the checksums right again
      const SlowTables slow(bytes);
      const uint64_t begin = slow.entry(section, 0), size = slow.entry(section, slow.count(section)) - begin;
      const uint64_t sum = checksum(std::span(bytes).subspan(begin, size));
      for (size_t i = 0; i < 8; ++i)
        bytes[16 + 32 * (section - 1) + 24 + i] = static_cast<std::byte>((sum >> (8 * i)) & 0xffU);
    }
    const uint64_t sum = checksum(std::span(bytes).first(240));
    for (size_t i = 0; i < 8; ++i) bytes[240 + i] = static_cast<std::byte>((sum >> (8 * i)) & 0xffU);
    const Result<ModelTables> tables = decode_tables(bytes);
    ASSERT_TRUE(tables) << tables.error().message;
    Model model = model_of_squares();
    model.tables = *tables;
    const std::string defect = find_defect(model);  // must terminate, and neither crash nor read out of range
    EXPECT_EQ(defect.find('\n'), std::string::npos);
  }
}

}  // namespace
}  // namespace promenade
