#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "codec/frame.h"
#include "layout/objects_codec.h"
#include "tests/golden.h"
#include "tests/layout/model_fixtures.h"
#include "tests/temporary_folder.h"

namespace promenade {
namespace {

using testing::HasSubstr;

constexpr CellsOwner kOwner{0x1122334455667788U, 3};

/// The second leaf of root_and_two_leaves as an object of its own that goes to and fro, and two classes.
ModelObjects one_that_moves() {
  ModelObjects objects;
  objects.animation.times = {0, 2};
  objects.animation.values = {0, 0, 0, 5, 0, 0};
  objects.animation.tracks = {{AnimationTrack::Way::linear, 3, 0, 0, 2, 2}};
  AnimationJoint joint;
  joint.tracks[AnimationJoint::translation_slot] = 0;
  joint.parent_from_rest[3] = {500000.1, -3, 0.25, 1};
  objects.animation.joints = {joint};
  objects.moving = {{0, NodeId{2}, glm::dmat4(0.5)}};
  objects.moving[0].joint_from_object[3][3] = 1;
  objects.moving_nodes = {{0, {{2, 0, 0}, {3, 1, 0}}}};
  objects.classes = {"", "wall", "chair = 2"};
  objects.class_shares = {{NodeId{1}, 0, 0.25F}, {NodeId{1}, 2, 0.75F}, {NodeId{2}, 1, 1}};
  return objects;
}

ModelTables two_trees() {
  ModelTables tables = root_and_two_leaves();
  tables.nodes[0].child_count = 1;
  tables.children = {NodeId{1}};
  tables.roots = {NodeId{0}, NodeId{2}};
  tables.nodes[2].parent = kNoNode, tables.nodes[2].level = 0;
  return tables;
}

void expect_same(const ModelObjects& a, const ModelObjects& b) {
  EXPECT_EQ(a.animation, b.animation);
  EXPECT_EQ(a.moving, b.moving);
  EXPECT_EQ(a.moving_nodes, b.moving_nodes);
  EXPECT_EQ(a.classes, b.classes);
  EXPECT_EQ(a.class_shares, b.class_shares);
  EXPECT_EQ(a.footprints, b.footprints);
}

std::string error_of(std::span<const std::byte> bytes, const CellsOwner& owner = kOwner) {
  const Result<ModelObjects> objects = decode_objects(bytes, owner);
  return objects ? "" : objects.error().message;
}

TEST(ObjectsCodec, objects_come_back) {
  const Result<ModelObjects> back = decode_objects(encode_objects(one_that_moves(), kOwner), kOwner);
  ASSERT_TRUE(back) << back.error().message;
  expect_same(*back, one_that_moves());
  EXPECT_TRUE(decode_objects(encode_objects({}, kOwner), kOwner)->empty());
}

TEST(ObjectsCodec, are_the_golden_bytes_of_version_1) {
  expect_golden("objects_v1.bin", encode_objects(one_that_moves(), kOwner));
  const Result<ModelObjects> back = decode_objects(golden_bytes("objects_v1.bin"), kOwner);
  ASSERT_TRUE(back) << back.error().message;
  expect_same(*back, one_that_moves());
}

TEST(ObjectsCodec, rejects_every_truncation_every_changed_byte_and_what_follows) {
  std::vector<std::byte> bytes = encode_objects(one_that_moves(), kOwner);
  for (size_t size = 0; size < bytes.size(); ++size) EXPECT_NE(error_of(std::span(bytes).first(size)), "") << size;
  for (std::byte& byte : bytes) {
    byte ^= std::byte{0x10};
    EXPECT_NE(error_of(bytes), "");
    byte ^= std::byte{0x10};
  }
  EXPECT_EQ(error_of(bytes), "");
  bytes.push_back(std::byte{0});
  EXPECT_NE(error_of(bytes), "");
}

TEST(ObjectsCodec, tells_another_builds_objects_and_another_version) {
  std::vector<std::byte> bytes = encode_objects(one_that_moves(), kOwner);
  EXPECT_THAT(error_of(bytes, {kOwner.tables_checksum + 1, 3}), HasSubstr("not of one build"));
  EXPECT_THAT(error_of(bytes, {kOwner.tables_checksum, 4}), HasSubstr("not of one build"));
  bytes[8] = std::byte{9};
  EXPECT_THAT(error_of(bytes), HasSubstr("version 9"));
}

Status write_model(const std::filesystem::path& path, const ModelTables& tables, const ModelObjects& objects) {
  Result<ModelWriter> writer = ModelWriter::create(path);
  if (!writer) return writer.error();
  PROMENADE_TRY(append_squares(*writer));
  PROMENADE_TRY(writer->stage(tables, manifest_of_squares(), objects));
  PROMENADE_TRY(writer->reorder(std::vector<uint32_t>{2, 0, 1}));
  return writer->publish();
}

/// A house with a yard, and a shed.
Footprints house_and_shed() {
  Footprints f;
  f.all = {{0, 9, 2}, {0.5F, 3, 3}};
  f.loop_ends = {4, 8, 11};
  f.points = {{0, 0}, {9, 0}, {9, 9}, {0, 9}, {3, 3}, {3, 6}, {6, 6}, {6, 3}, {20, 0}, {22, 0}, {21, 2}};
  return f;
}

TEST(ObjectsCodec, footprints_come_back_and_only_they_need_the_second_version) {
  ModelObjects objects = one_that_moves();
  const std::vector<std::byte> before = encode_objects(objects, kOwner);
  EXPECT_EQ(before[8], std::byte(1));
  objects.footprints = house_and_shed();
  const std::vector<std::byte> bytes = encode_objects(objects, kOwner);
  EXPECT_EQ(bytes[8], std::byte(2));
  const Result<ModelObjects> back = decode_objects(bytes, kOwner);
  ASSERT_TRUE(back) << back.error().message;
  expect_same(*back, objects);
  for (size_t size = 0; size < bytes.size(); ++size)
    EXPECT_NE(error_of(std::span(bytes).first(size)), "") << "cut off after " << size;
}

TEST(ModelWithObjects, opens_again_and_says_that_older_programs_cannot_read_it) {
  const TemporaryFolder folder;
  const Status written = write_model(folder.path() / "m.prom", two_trees(), one_that_moves());
  ASSERT_TRUE(written) << written.error().message;
  const Result<ModelReader> reader = ModelReader::open(folder.path() / "m.prom");
  ASSERT_TRUE(reader) << reader.error().message;
  expect_same(reader->model().objects, one_that_moves());
  EXPECT_EQ(reader->model().first_moving_node(), 2U);
  const auto manifest = *read_text_file(folder.path() / "m.prom" / "manifest.json", 1 << 20);
  EXPECT_THAT(manifest, HasSubstr("\"version\": 2"));
}

TEST(ModelWithObjects, without_any_is_as_before) {
  const TemporaryFolder folder;
  ASSERT_TRUE(write_model(folder.path() / "m.prom", root_and_two_leaves(), {}));
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "m.prom" / "objects.bin"));
  EXPECT_THAT(*read_text_file(folder.path() / "m.prom" / "manifest.json", 1 << 20), HasSubstr("\"version\": 1"));
}

TEST(ModelWithObjects, unsound_ones_are_refused) {
  const TemporaryFolder folder;
  const auto refused = [&folder](auto&& spoil) {
    ModelObjects objects = one_that_moves();
    spoil(objects);
    return !write_model(folder.path() / "m.prom", two_trees(), objects);
  };
  EXPECT_FALSE(refused([](ModelObjects&) {}));
  EXPECT_TRUE(refused([](ModelObjects& o) { o.moving[0].joint = 1; }));
  EXPECT_TRUE(refused([](ModelObjects& o) { o.moving[0].root = NodeId{0}; }));
  EXPECT_TRUE(refused([](ModelObjects& o) { o.moving[0].joint_from_object[0][0] = std::nan(""); }));
  EXPECT_TRUE(refused([](ModelObjects& o) { o.moving_nodes[0].object = 1; }));
  EXPECT_TRUE(refused([](ModelObjects& o) { o.moving_nodes[0].box = {}; }));
  EXPECT_TRUE(refused([](ModelObjects& o) { o.moving_nodes.resize(4); }));
  EXPECT_TRUE(refused([](ModelObjects& o) { o.moving_nodes.resize(2, o.moving_nodes[0]); }));  // a child of what stands
  EXPECT_TRUE(refused([](ModelObjects& o) { o.class_shares[0].leaf = NodeId{3}; }));
  EXPECT_TRUE(refused([](ModelObjects& o) { o.class_shares[0].class_index = 3; }));
  EXPECT_TRUE(refused([](ModelObjects& o) { o.class_shares[0].area_m2 = -1; }));
  EXPECT_TRUE(refused([](ModelObjects& o) { o.animation.values[0] = std::nanf(""); }));
  EXPECT_FALSE(refused([](ModelObjects& o) { o.footprints = house_and_shed(); }));
  EXPECT_TRUE(refused([](ModelObjects& o) { o.footprints = house_and_shed(), o.footprints.points.pop_back(); }));
}

}  // namespace
}  // namespace promenade
