#include "codec/far_face.h"

#include <gtest/gtest.h>

#include "geometry/random.h"
#include "tests/golden.h"

namespace promenade {
namespace {

/// A wall with a slanted top before nothing, its triangles kept at random, depths on a plane with noise.
FarFace wall_under_nothing(uint32_t levels, uint64_t seed) {
  Random random(seed);
  FarFace face;
  face.grid.levels = levels;
  const uint32_t side = face.grid.side();
  face.colors = {side, side, {}};
  face.colors.pixels.resize(face.grid.vertices());
  face.kept.assign(face.grid.vertices(), 0);
  face.depth.assign(face.grid.vertices(), 0);
  for (uint32_t y = 0; y < side; ++y)
    for (uint32_t x = 0; x < side; ++x) {
      const bool wall = 3 * y > x;
      face.colors.at(x, y) = {uint8_t(x * 255 / side), uint8_t(y * 255 / side), 90, uint8_t(wall ? 255 : 0)};
      if (wall && random.chance(0.05)) face.kept[face.grid.index(x, y)] = 1;
    }
  close_halvings(face.grid, face.kept);
  for (uint32_t i = 0; i < face.grid.vertices(); ++i)
    if (face.kept[i] != 0) face.depth[i] = static_cast<uint16_t>(1 + (i * 7U + random.below(50)) % FarFace::kNearest);
  return face;
}

TEST(FarFaceCodec, keeps_triangles_and_where_something_is_exactly) {
  for (const uint32_t levels : {0U, 1U, 4U, 6U})
    for (const int quality : {0, 30, 90}) {
      const FarFace face = wall_under_nothing(levels, 3 + levels);
      const Result<std::vector<std::byte>> bytes = encode_far_face(face, {quality});
      ASSERT_TRUE(bytes.ok()) << bytes.error().message;
      const Result<FarFace> back = decode_far_face(*bytes);
      ASSERT_TRUE(back.ok()) << back.error().message;
      EXPECT_EQ(back->kept, face.kept);
      EXPECT_EQ(back->depth, face.depth);
      for (size_t i = 0; i < face.colors.pixels.size(); ++i) {
        const glm::u8vec4 &was = face.colors.pixels[i], &is = back->colors.pixels[i];
        ASSERT_EQ(is.a, was.a);
        if (quality == 0 && was.a != 0) {
          ASSERT_EQ(is, was);
        }
      }
      EXPECT_EQ(*encode_far_face(face, {quality}), *bytes) << "the same bytes again";
    }
}

TEST(FarFaceCodec, takes_few_bits_for_what_is_plain) {
  FarFace face = wall_under_nothing(8, 1);
  std::fill(face.kept.begin(), face.kept.end(), uint8_t(0));
  close_halvings(face.grid, face.kept);
  for (glm::u8vec4& pixel : face.colors.pixels) pixel = {10, 20, 30, 255};
  for (const uint32_t at : {0U, 256U, 256U * 257U, 257U * 257U - 1}) face.depth[at] = FarFace::kNearest;
  const FarFaceCoding exact{0};
  EXPECT_LT(encode_far_face(face, exact)->size(), 3000U);
}

TEST(FarFaceCodec, refuses_a_face_whose_arrays_do_not_fit) {
  FarFace face = wall_under_nothing(3, 1);
  face.depth.pop_back();
  EXPECT_FALSE(encode_far_face(face, {}).ok());
  face = wall_under_nothing(3, 1);
  face.grid.levels = kMostFaceLevels + 1;
  EXPECT_FALSE(encode_far_face(face, {}).ok());
}

TEST(FarFaceCodec, survives_every_truncation_and_any_changed_byte) {
  const std::vector<std::byte> bytes = *encode_far_face(wall_under_nothing(4, 9), {80});
  for (size_t size = 0; size < bytes.size(); ++size) {
    const Result<FarFace> cut = decode_far_face(std::span(bytes).first(size));
    if (cut) {
      EXPECT_EQ(cut->depth.size(), cut->grid.vertices());
    }
  }
  EXPECT_FALSE(decode_far_face(std::span(bytes).first(40)).ok());
  Random random(1);
  for (int i = 0; i < 500; ++i) {
    std::vector<std::byte> changed = bytes;
    changed[random.below(static_cast<uint32_t>(bytes.size()))] = std::byte(random.below(256));
    const Result<FarFace> back = decode_far_face(changed);
    if (!back) continue;
    EXPECT_LE(back->grid.levels, kMostFaceLevels);
    EXPECT_EQ(back->kept.size(), back->grid.vertices());
    std::vector<uint8_t> kept = back->kept;
    EXPECT_FALSE(close_halvings(back->grid, kept)) << "whatever the bytes say, triangles fit together";
    for (size_t k = 0; k < kept.size(); ++k) EXPECT_EQ(kept[k] != 0, back->depth[k] != 0);
  }
}

TEST(FarFaceCodec, refuses_other_magic_versions_and_sizes) {
  const std::vector<std::byte> bytes = *encode_far_face(wall_under_nothing(4, 9), {80});
  const auto changed = [&](size_t at, uint8_t value) {
    std::vector<std::byte> copy = bytes;
    copy[at] = std::byte(value);
    return decode_far_face(copy).ok();
  };
  EXPECT_FALSE(changed(0, 'Q'));
  EXPECT_FALSE(changed(4, 2));  // told against another: of a kind that is 0
  EXPECT_FALSE(changed(4, 3));
  EXPECT_FALSE(changed(5, 5));   // another size than the picture's
  EXPECT_FALSE(changed(5, 40));  // too large
  EXPECT_FALSE(changed(6, 1));
  EXPECT_FALSE(changed(11, 255));  // a picture beyond the end
}

TEST(FarFaceCodec, has_the_golden_bytes_of_version_1) {
  const FarFaceCoding exact{0};
  const FarFace face = wall_under_nothing(3, 2);
  expect_golden("far_face_v1.bin", *encode_far_face(face, exact));
  const Result<FarFace> back = decode_far_face(golden_bytes("far_face_v1.bin"));
  ASSERT_TRUE(back.ok()) << back.error().message;
  EXPECT_EQ(back->depth, face.depth);
}

TEST(FillColors, spreads_what_is_there_and_leaves_opacity) {
  Image image{3, 3, std::vector<glm::u8vec4>(9, {0, 0, 0, 0})};
  image.at(1, 1) = {200, 100, 50, 255};
  fill_colors(image);
  for (uint32_t y = 0; y < 3; ++y)
    for (uint32_t x = 0; x < 3; ++x) {
      EXPECT_EQ(image.at(x, y).r, 200);
      EXPECT_EQ(image.at(x, y).a, x == 1 && y == 1 ? 255 : 0);
    }
}

}  // namespace
}  // namespace promenade
