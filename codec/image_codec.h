#pragma once
// Pictures to bytes and back, through OpenImageIO.

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "geometry/mesh.h"
#include "geometry/result.h"

namespace promenade {

enum class ImageFormat : uint8_t { png, jpeg };

/// jpeg_quality: 1 to 100; JPEG drops opacity. Any thread.
Result<std::vector<std::byte>> encode_image(const Image& image, ImageFormat format, int jpeg_quality = 90);

/// Decodes PNG, JPEG, WebP, TGA, BMP, TIFF, GIF ... recognised by content. `name` is what a message calls the picture.
/// Refuses pictures of more than max_pixels before decoding. Safe on any bytes. Any thread.
Result<Image> decode_image(std::span<const std::byte> bytes, const std::string& name,
                           uint64_t max_pixels = uint64_t(1) << 28);

/// Size without decoding the pixels.
struct ImageSize {
  uint32_t width = 0, height = 0;
};
Result<ImageSize> image_size(std::span<const std::byte> bytes, const std::string& name);

/// Resampled to the given size in linear light, weighted by opacity: the mean over each new pixel's area along an axis
/// that shrinks, linear between pixel centres along one that grows. Pixels at the border repeat outwards.
Image resized(const Image& image, uint32_t width, uint32_t height);

/// One float or uint32 value a pixel, row 0 at the top, as TIFF or EXR by the ending of `name` (.tif, .tiff, .exr).
Result<std::vector<std::byte>> encode_float_image(std::span<const float> pixels, uint32_t width, uint32_t height,
                                                  const std::string& name);
Result<std::vector<std::byte>> encode_id_image(std::span<const uint32_t> pixels, uint32_t width, uint32_t height,
                                               const std::string& name);

}  // namespace promenade
