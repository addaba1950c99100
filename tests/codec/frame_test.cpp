#include "codec/frame.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string_view>

namespace promenade {
namespace {

using testing::HasSubstr;

std::vector<std::byte> bytes_of(std::string_view text) {
  const auto bytes = std::as_bytes(std::span(text));
  return {bytes.begin(), bytes.end()};
}

TEST(Checksum, is_xxh3_with_a_seed) {
  EXPECT_EQ(checksum({}), 0x2d06800538d394c2U);  // the reference value of XXH3 for no bytes
  EXPECT_NE(checksum(bytes_of("abc")), checksum(bytes_of("abd")));
  EXPECT_NE(checksum(bytes_of("abc")), checksum(bytes_of("abc"), 1));
}

TEST(Frame, returns_what_it_was_given) {
  for (const std::vector<std::byte>& bytes :
       {std::vector<std::byte>{}, bytes_of("a"), std::vector<std::byte>(100000)}) {
    for (const int level : {1, 9, 19}) {
      const auto back = decompress_frame(compress_frame(bytes, level), bytes.size());
      ASSERT_TRUE(back) << back.error().message;
      EXPECT_EQ(*back, bytes);
    }
  }
}

TEST(Frame, rejects_every_truncation_and_a_trailing_byte) {
  std::vector<std::byte> frame = compress_frame(bytes_of("some text that is some text that is some text"));
  for (size_t n = 0; n < frame.size(); ++n) EXPECT_FALSE(decompress_frame(std::span(frame).first(n), 1000)) << n;
  frame.push_back(std::byte{0});
  EXPECT_THAT(decompress_frame(frame, 1000).error().message, HasSubstr("1 bytes follow"));
}

TEST(Frame, rejects_a_claim_of_more_than_the_limit_before_allocating) {
  const std::vector<std::byte> frame = compress_frame(std::vector<std::byte>(1000));
  EXPECT_TRUE(decompress_frame(frame, 1000));
  EXPECT_THAT(decompress_frame(frame, 999).error().message, HasSubstr("claims 1000 bytes, at most 999"));
}

TEST(Frame, rejects_a_frame_without_content_size) {
  // Magic, descriptor (no size, no checksum), window, one empty last block.
  std::vector<std::byte> frame;
  for (const int b : {0x28, 0xb5, 0x2f, 0xfd, 0x00, 0x58, 0x01, 0x00, 0x00}) frame.push_back(std::byte(b));
  EXPECT_THAT(decompress_frame(frame, 1000).error().message, HasSubstr("no content size"));
}

}  // namespace
}  // namespace promenade
