#include "codec/image_codec.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <random>

#ifdef __SANITIZE_ADDRESS__
#include <sanitizer/lsan_interface.h>
#endif

namespace promenade {
namespace {

using testing::HasSubstr;

/// OpenImageIO 2.4 leaks a string of its own whenever libpng jumps out of it over an error. Not ours to mend, so not
/// reported while this lives.
class LeaksOfPngErrors {
#ifdef __SANITIZE_ADDRESS__
  __lsan::ScopedDisabler disabler_;
#endif
};

Image image_of(uint32_t width, uint32_t height, const glm::u8vec4& color) {
  return {width, height, std::vector<glm::u8vec4>(size_t(width) * height, color)};
}

/// Every pixel of its own colour; opacity varies where asked.
Image gradient(uint32_t width, uint32_t height, bool clear_parts) {
  Image image = image_of(width, height, {0, 0, 0, 255});
  for (uint32_t y = 0; y < height; ++y)
    for (uint32_t x = 0; x < width; ++x)
      image.at(x, y) = {x * 255 / width, y * 255 / height, (x + y) % 256, clear_parts ? (x * 7) % 256 : 255};
  return image;
}

std::vector<std::byte> encoded(const Image& image, ImageFormat format, int quality = 90) {
  Result<std::vector<std::byte>> bytes = encode_image(image, format, quality);
  EXPECT_TRUE(bytes);
  return bytes ? *bytes : std::vector<std::byte>{};
}

std::vector<std::byte> bytes_of(std::initializer_list<int> values) {
  std::vector<std::byte> bytes;
  for (const int v : values) bytes.push_back(static_cast<std::byte>(v));
  return bytes;
}

TEST(Png, returns_every_pixel_with_its_opacity) {
  for (const bool clear_parts : {false, true}) {
    const Image image = gradient(37, 21, clear_parts);
    const Result<Image> back = decode_image(encoded(image, ImageFormat::png), "test");
    ASSERT_TRUE(back) << back.error().message;
    EXPECT_EQ(back->width, 37U);
    EXPECT_EQ(back->height, 21U);
    EXPECT_EQ(back->pixels, image.pixels);
  }
}

TEST(Png, is_the_same_bytes_each_time) {
  const Image image = gradient(64, 64, true);
  EXPECT_EQ(encoded(image, ImageFormat::png), encoded(image, ImageFormat::png));
}

TEST(Jpeg, comes_near_the_picture_and_drops_opacity) {
  const Image image = gradient(64, 48, true);
  const Result<Image> back = decode_image(encoded(image, ImageFormat::jpeg, 95), "test");
  ASSERT_TRUE(back) << back.error().message;
  ASSERT_EQ(back->pixels.size(), image.pixels.size());
  for (size_t i = 0; i < image.pixels.size(); ++i) {
    EXPECT_EQ(back->pixels[i].a, 255);
    EXPECT_NEAR(back->pixels[i].r, image.pixels[i].r, 24);
    EXPECT_NEAR(back->pixels[i].g, image.pixels[i].g, 24);
  }
}

TEST(Jpeg, is_smaller_at_lower_quality) {
  const Image image = gradient(64, 64, false);
  EXPECT_LT(encoded(image, ImageFormat::jpeg, 50).size(), encoded(image, ImageFormat::jpeg, 95).size());
}

TEST(EncodeImage, rejects_a_picture_without_pixels) {
  EXPECT_FALSE(encode_image(Image{}, ImageFormat::png));
  EXPECT_FALSE(encode_image(Image{2, 2, {}}, ImageFormat::jpeg));
}

TEST(ImageSize, needs_only_the_header) {
  std::vector<std::byte> bytes = encoded(gradient(300, 200, false), ImageFormat::png);
  bytes.resize(100);
  const Result<ImageSize> size = image_size(bytes, "test");
  ASSERT_TRUE(size) << size.error().message;
  EXPECT_EQ(size->width, 300U);
  EXPECT_EQ(size->height, 200U);
}

TEST(DecodeImage, rejects_more_pixels_than_allowed_before_decoding) {
  const std::vector<std::byte> bytes = encoded(gradient(30, 20, false), ImageFormat::png);
  EXPECT_TRUE(decode_image(bytes, "test", 600));
  EXPECT_THAT(decode_image(bytes, "facade.png", 599).error().message, HasSubstr("facade.png: picture of 600 pixels"));
}

TEST(DecodeImage, rejects_a_webp_and_a_gif_that_claim_too_much) {
  const auto webp = bytes_of({'R', 'I', 'F', 'F', 30, 0, 0, 0, 'W', 'E',  'B',  'P', 'V',  'P',  '8',
                              'X', 10,  0,   0,   0,  0, 0, 0, 0,   0xff, 0xff, 0,   0xff, 0xff, 0});
  EXPECT_THAT(decode_image(webp, "a").error().message, HasSubstr("picture of 4294967296 pixels"));
  const auto gif = bytes_of({'G', 'I', 'F', '8', '9', 'a', 0xff, 0xff, 0xff, 0xff, 0, 0, 0});
  EXPECT_THAT(decode_image(gif, "a").error().message, HasSubstr("picture of 4294836225 pixels"));
}

TEST(DecodeImage, knows_formats_by_content) {
  const auto tga = bytes_of({0, 0, 2, 0, 0, 0, 0, 0, 0, 0, 0, 0, 2, 0, 1, 0, 24, 0x20, /*bgr*/ 1, 2, 3, 4, 5, 6});
  Result<Image> image = decode_image(tga, "a");
  ASSERT_TRUE(image) << image.error().message;
  EXPECT_EQ(image->pixels, (std::vector<glm::u8vec4>{{3, 2, 1, 255}, {6, 5, 4, 255}}));
  const auto bmp =
      bytes_of({'B', 'M', 58, 0, 0, 0, 0, 0, 0, 0, 54, 0, 0, 0, 40, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0,  1,  0,  24,
                0,   0,   0,  0, 0, 4, 0, 0, 0, 0, 0,  0, 0, 0, 0,  0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 10, 20, 30, 0});
  image = decode_image(bmp, "a");
  ASSERT_TRUE(image) << image.error().message;
  EXPECT_EQ(image->pixels, (std::vector<glm::u8vec4>{{30, 20, 10, 255}}));
  EXPECT_THAT(decode_image(bytes_of({'h', 'e', 'l', 'l', 'o'}), "notes.txt").error().message,
              HasSubstr("notes.txt: 5 bytes that are no picture"));
}

TEST(DecodeImage, survives_every_truncation_and_rejects_those_of_png) {
  [[maybe_unused]] const LeaksOfPngErrors ignored;
  for (const ImageFormat format : {ImageFormat::png, ImageFormat::jpeg}) {
    const std::vector<std::byte> bytes = encoded(gradient(16, 16, true), format);
    for (size_t n = 0; n < bytes.size(); n += 23) {
      const Result<Image> image = decode_image(std::span(bytes).first(n), "test");
      if (image) {
        EXPECT_EQ(image->pixels.size(), 256U);
      }
      if (format == ImageFormat::png && n + 20 < bytes.size()) {
        EXPECT_FALSE(image) << n;
      }
    }
  }
}

TEST(DecodeImage, survives_random_changes) {
  [[maybe_unused]] const LeaksOfPngErrors ignored;
  std::mt19937 random(1);
  for (const ImageFormat format : {ImageFormat::png, ImageFormat::jpeg}) {
    const std::vector<std::byte> sound = encoded(gradient(16, 16, true), format);
    for (int round = 0; round < 30; ++round) {
      std::vector<std::byte> bytes = sound;
      for (int change = 0; change < 3; ++change)
        bytes[random() % bytes.size()] = static_cast<std::byte>(random() % 256);
      const Result<Image> image = decode_image(bytes, "test", 1U << 16U);
      if (image) {
        EXPECT_EQ(image->pixels.size(), size_t(image->width) * image->height);
      }
    }
  }
}

TEST(Resized, averages_light_and_not_code_values) {
  Image image = image_of(2, 1, {0, 0, 0, 255});
  image.at(1, 0) = {255, 255, 255, 255};
  EXPECT_EQ(resized(image, 1, 1).at(0, 0), glm::u8vec4(188, 188, 188, 255));
}

TEST(Resized, weighs_by_opacity_and_keeps_the_colour_of_clear_parts) {
  Image image = image_of(2, 1, {255, 0, 0, 255});
  image.at(1, 0) = {0, 0, 255, 0};
  const glm::u8vec4 mean = resized(image, 1, 1).at(0, 0);
  EXPECT_GE(mean.r, 254);
  EXPECT_LE(mean.b, 10);
  EXPECT_EQ(mean.a, 128);
  EXPECT_EQ(resized(image_of(4, 4, {10, 20, 30, 0}), 2, 2).at(1, 1), glm::u8vec4(10, 20, 30, 0));
}

TEST(Resized, keeps_a_plain_colour_at_any_size) {
  const Image image = image_of(7, 5, {90, 120, 200, 255});
  for (const uint32_t side : {1U, 3U, 5U, 7U, 12U})
    for (const glm::u8vec4& p : resized(image, side, side + 1).pixels) EXPECT_EQ(p, image.pixels[0]);
}

TEST(Resized, to_the_same_size_changes_nothing) {
  const Image image = gradient(9, 6, true);
  EXPECT_EQ(resized(image, 9, 6).pixels, image.pixels);
}

TEST(SingleChannelImages, are_written_for_known_endings_only) {
  const std::vector<float> depths(6, 2.5F);
  const std::vector<uint32_t> ids(6, 0xfffffffeU);
  for (const char* name : {"a.tif", "a.tiff", "a.exr"}) {
    EXPECT_TRUE(encode_float_image(depths, 3, 2, name));
    EXPECT_TRUE(encode_id_image(ids, 3, 2, name));
    EXPECT_FALSE(encode_id_image(ids, 3, 3, name));
  }
  EXPECT_THAT(encode_float_image(depths, 3, 2, "a.png").error().message, HasSubstr("choose such a name"));
}

TEST(SingleChannelImages, decode_as_pictures) {
  const std::vector<float> light = {0, 0.5F, 1, 2};
  for (const char* name : {"a.tif", "a.exr"}) {
    const auto bytes = encode_float_image(light, 2, 2, name);
    ASSERT_TRUE(bytes) << bytes.error().message;
    const Result<Image> image = decode_image(*bytes, name);
    ASSERT_TRUE(image) << image.error().message;
    EXPECT_EQ(image->at(0, 0).r, 0);
    EXPECT_EQ(image->at(1, 0).g, 188);
    EXPECT_EQ(image->at(0, 1).b, 255);
    EXPECT_EQ(image->at(1, 1).b, 255);
  }
}

}  // namespace
}  // namespace promenade
