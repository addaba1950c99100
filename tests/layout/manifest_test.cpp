#include "layout/manifest.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "codec/frame.h"
#include "tests/golden.h"
#include "tests/layout/model_fixtures.h"

namespace promenade {
namespace {

using testing::HasSubstr;

StoredManifest stored_squares() { return {model_of_squares().manifest, 0xfedcba9876543210U}; }

std::string message_of(const std::string& text) {
  const Result<StoredManifest> stored = parse_manifest(text);
  return stored ? "parsed" : stored.error().message;
}

/// The text with one part replaced and the checksum made right again.
std::string changed(const std::string& from, const std::string& to) {
  std::string text = manifest_text(stored_squares());
  text.replace(text.find(from), from.size(), to);
  const size_t at = text.rfind("\n \"checksum\"");
  char sum[20];
  static_cast<void>(std::snprintf(sum, sizeof sum, "%016llx",
                                  static_cast<unsigned long long>(checksum(std::as_bytes(std::span(text).first(at))))));
  return text.replace(at + 15, 16, sum);
}

TEST(Manifest, returns_every_field) {
  const StoredManifest stored = stored_squares();
  const Result<StoredManifest> back = parse_manifest(manifest_text(stored));
  ASSERT_TRUE(back) << back.error().message;
  const ModelManifest &a = stored.manifest, &b = back->manifest;
  EXPECT_EQ(a.tool_version, b.tool_version);
  EXPECT_EQ(a.input_hash, b.input_hash);
  EXPECT_EQ(a.origin, b.origin);
  EXPECT_EQ(a.world_box, b.world_box);
  EXPECT_EQ(a.source_triangles, b.source_triangles);
  EXPECT_EQ(a.geometry_codec, b.geometry_codec);
  EXPECT_EQ(a.files, b.files);
  EXPECT_EQ(a.settings, b.settings);
  EXPECT_EQ(a.sources, b.sources);
  EXPECT_EQ(a.import_counts, b.import_counts);
  EXPECT_EQ(a.notes, b.notes);
  EXPECT_EQ(back->tables_checksum, stored.tables_checksum);
}

TEST(Manifest, is_the_golden_text_of_version_1) {
  expect_golden("manifest_v1.json", std::string_view(manifest_text(stored_squares())));
  EXPECT_TRUE(parse_manifest(golden_text("manifest_v1.json")));
}

TEST(Manifest, replaces_bytes_that_are_no_utf8) {
  StoredManifest stored = stored_squares();
  stored.manifest.sources = {"caf\xe9.obj"};
  const Result<StoredManifest> back = parse_manifest(manifest_text(stored));
  ASSERT_TRUE(back) << back.error().message;
  EXPECT_EQ(back->manifest.sources[0], "caf\xef\xbf\xbd.obj");
}

TEST(ParseManifest, rejects_every_truncation_and_changed_byte) {
  const std::string sound = manifest_text(stored_squares());
  for (size_t n = 0; n < sound.size(); ++n) {
    EXPECT_NE(message_of(sound.substr(0, n)), "parsed") << n;
    std::string text = sound;
    text[n] = static_cast<char>(text[n] ^ 1);
    EXPECT_NE(message_of(text), "parsed") << n;
  }
  EXPECT_NE(message_of(sound + " "), "parsed");
}

TEST(ParseManifest, says_which_field_is_wrong) {
  EXPECT_EQ(message_of(changed("0.0.1", "0.0.2")), "parsed");
  EXPECT_THAT(message_of("{}"), HasSubstr("\"format\" is not"));
  EXPECT_THAT(message_of("[1]"), HasSubstr("no JSON object"));
  EXPECT_THAT(message_of(changed("\"version\": 1", "\"version\": 3")), HasSubstr("version 3 of the model's format"));
  EXPECT_THAT(message_of(changed("\"notes\"", "\"motes\"")), HasSubstr("\"notes\" is missing"));
  EXPECT_THAT(message_of(changed("\"0.0.1\"", "1")), HasSubstr("\"tool_version\" is number"));
  EXPECT_THAT(message_of(changed("500000.1", "\"x\"")), HasSubstr("\"origin_m\""));
  EXPECT_THAT(message_of(changed("\"source_triangles\": 4", "\"source_triangles\": -4")),
              HasSubstr("\"source_triangles\""));
  EXPECT_THAT(message_of(changed("0123456789abcdef", "0123456789abcdeg")), HasSubstr("\"input_hash\" is not 16"));
  EXPECT_THAT(message_of(changed("meshopt", "zip")), HasSubstr("\"geometry_codec\" is \"zip\""));
  EXPECT_THAT(message_of(changed("\"bytes\": 300", "\"bytes\": 3.5")), HasSubstr("\"files\""));
}

}  // namespace
}  // namespace promenade
