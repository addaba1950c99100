#include "codec/id_set.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

namespace promenade {
namespace {

using testing::ElementsAre, testing::HasSubstr, testing::IsEmpty;

std::vector<std::byte> bytes(const std::vector<int>& values) {
  std::vector<std::byte> result;
  result.reserve(values.size());
  for (const int value : values) result.push_back(static_cast<std::byte>(value));
  return result;
}

/// Ids below `limit` in runs of some length.
std::vector<uint32_t> random_ids(std::mt19937& random, uint32_t limit) {
  const auto below = [&random](uint32_t end) { return std::uniform_int_distribution<uint32_t>(0, end - 1)(random); };
  std::vector<uint32_t> ids;
  const uint32_t spread = 1 + below(1000);
  for (uint64_t at = below(spread); at < limit; at += 1 + below(spread))
    for (uint32_t run = 1 + below(8); run > 0 && at < limit; --run) ids.push_back(static_cast<uint32_t>(at++));
  return ids;
}

TEST(IdSet, is_gaps_and_runs) {
  // 3, 4, 5; then 300: 293 after 7, the first that may come.
  EXPECT_EQ(encode_ids(std::vector<uint32_t>{3, 4, 5, 300}), bytes({3, 2, 0xa5, 0x02, 0}));
  EXPECT_THAT(encode_ids({}), IsEmpty());
}

TEST(IdSet, comes_back) {
  std::mt19937 random(3);
  for (int i = 0; i < 300; ++i) {
    const uint32_t limit = std::uniform_int_distribution<uint32_t>(1, 100000)(random);
    const std::vector<uint32_t> ids = random_ids(random, limit);
    const Result<std::vector<uint32_t>> decoded = decode_ids(encode_ids(ids), limit);
    ASSERT_TRUE(decoded) << decoded.error().message;
    ASSERT_EQ(*decoded, ids);
  }
}

TEST(IdSet, holds_the_largest_ids) {
  const std::vector<uint32_t> ids = {0, 0xfffffffcU, 0xfffffffdU, 0xfffffffeU};
  const Result<std::vector<uint32_t>> decoded = decode_ids(encode_ids(ids), 0xffffffffU);
  ASSERT_TRUE(decoded);
  EXPECT_EQ(*decoded, ids);
}

TEST(IdSet, every_truncation_is_an_error_or_a_smaller_set) {
  std::mt19937 random(4);
  const std::vector<uint32_t> ids = random_ids(random, 20000);
  const std::vector<std::byte> whole = encode_ids(ids);
  for (size_t size = 0; size < whole.size(); ++size)
    if (const auto decoded = decode_ids(std::span(whole).first(size), 20000); decoded) {
      EXPECT_LT(decoded->size(), ids.size());
    }
}

TEST(IdSet, any_bytes_are_an_error_or_ascend_below_the_limit) {
  std::mt19937 random(5);
  for (int i = 0; i < 20000; ++i) {
    std::vector<std::byte> noise(random() % 12U);
    for (std::byte& byte : noise) byte = static_cast<std::byte>(random() & 255U);
    const Result<std::vector<uint32_t>> decoded = decode_ids(noise, 1000);
    if (!decoded) continue;
    EXPECT_EQ(encode_ids(*decoded), noise) << "one code for each set";
    for (const uint32_t id : *decoded) ASSERT_LT(id, 1000U);
  }
}

TEST(IdSet, errors_say_where_and_what) {
  const auto message = [](const std::vector<int>& values) {
    const auto decoded = decode_ids(bytes(values), 100);
    return decoded ? "" : decoded.error().message;
  };
  EXPECT_THAT(message({5, 0, 99, 0}), HasSubstr("byte 2: ids 106 to 106, the limit is 100"));
  EXPECT_THAT(message({5, 0, 1}), HasSubstr("byte 2"));
  EXPECT_THAT(message({0x80, 0x00, 0}), HasSubstr("byte 0")) << "a longer number than need be";
  EXPECT_THAT(message({0xff, 0xff, 0xff, 0xff, 0x7f, 0}), HasSubstr("byte 0")) << "more than 32 bits";
  EXPECT_THAT(message({0, 0xff, 0xff, 0xff, 0xff, 0x0f}), HasSubstr("the limit is 100")) << "a run beyond any memory";
}

TEST(SymmetricDifference, of_a_set_and_a_difference_is_the_other_set) {
  std::mt19937 random(6);
  const std::vector<uint32_t> a = random_ids(random, 5000), b = random_ids(random, 5000);
  EXPECT_EQ(symmetric_difference(symmetric_difference(a, b), a), b);
  EXPECT_THAT(symmetric_difference(std::vector<uint32_t>{1, 2, 5}, std::vector<uint32_t>{2, 3}), ElementsAre(1, 3, 5));
}

}  // namespace
}  // namespace promenade
