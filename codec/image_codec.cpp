#include "codec/image_codec.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <exception>
#include <memory>
#include <string_view>

namespace promenade {
namespace {

constexpr int kMaxChannels = 16;  // bounds memory a pixel on hostile input; pictures have four

struct OpenImage {
  std::unique_ptr<OIIO::Filesystem::IOMemReader> memory;  // outlives the input, which reads from it
  std::unique_ptr<OIIO::ImageInput> input;
};

std::string one_line(std::string text) {
  while (!text.empty() && (text.back() == '\n' || text.back() == '.')) text.pop_back();
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text;
}

/// Runs calls of OpenImageIO, which may throw on bad bytes or want of memory.
template <class Call>
auto guarded(const std::string& name, Call call) -> decltype(call()) {
  try {
    return call();
  } catch (const std::exception& e) {
    return Error{fmt::format("{}: cannot process the picture: {}", name, one_line(e.what()))};
  }
}

bool has_at(std::span<const std::byte> bytes, size_t offset, std::string_view signature) {
  if (bytes.size() < offset + signature.size()) return false;
  return std::equal(signature.begin(), signature.end(), bytes.begin() + static_cast<std::ptrdiff_t>(offset),
                    [](char c, std::byte b) { return static_cast<std::byte>(c) == b; });
}

/// Targa has no signature at its start: its header must make sense.
bool looks_like_targa(std::span<const std::byte> bytes) {
  constexpr size_t kHeaderBytes = 18;
  if (bytes.size() < kHeaderBytes) return false;
  const auto at = [&](size_t i) { return std::to_integer<unsigned>(bytes[i]); };
  const unsigned color_map = at(1), type = at(2), depth = at(16);
  const bool known_type = type == 1 || type == 2 || type == 3 || type == 9 || type == 10 || type == 11;
  const bool known_depth = depth == 8 || depth == 15 || depth == 16 || depth == 24 || depth == 32;
  return color_map <= 1 && known_type && known_depth && (at(12) | at(13)) != 0 && (at(14) | at(15)) != 0;
}

/// OpenImageIO's name of the format that the first bytes show; empty: none that we read.
std::string_view format_of(std::span<const std::byte> bytes) {
  using namespace std::string_view_literals;
  if (has_at(bytes, 0, "\x89PNG\r\n\x1a\n"sv)) return "png";
  if (has_at(bytes, 0, "\xff\xd8\xff"sv)) return "jpeg";
  if (has_at(bytes, 0, "RIFF"sv) && has_at(bytes, 8, "WEBP"sv)) return "webp";
  if (has_at(bytes, 0, "GIF8"sv)) return "gif";
  if (has_at(bytes, 0, "BM"sv)) return "bmp";
  if (has_at(bytes, 0, "II*\0"sv) || has_at(bytes, 0, "MM\0*"sv)) return "tiff";
  if (has_at(bytes, 0, "\x76\x2f\x31\x01"sv)) return "openexr";
  if (has_at(bytes, 0, "#?RADIANCE"sv) || has_at(bytes, 0, "#?RGBE"sv)) return "hdr";
  if (has_at(bytes, 0, "8BPS"sv)) return "psd";
  if (looks_like_targa(bytes)) return "targa";
  return {};
}

/// Little-endian bits of a header; 0 beyond the end.
uint32_t bits_at(std::span<const std::byte> bytes, size_t offset, size_t count) {
  uint32_t value = 0;
  for (size_t i = 0; i < count && offset + i < bytes.size(); ++i)
    value |= std::to_integer<uint32_t>(bytes[offset + i]) << (8 * i);
  return value;
}

/// Pixels that a WebP or GIF claims in its own header: OpenImageIO allocates those when it opens the picture, before
/// anyone can object. 0: another format, which allocates when it reads.
uint64_t pixels_claimed(std::span<const std::byte> bytes, std::string_view format) {
  if (format == "gif") return uint64_t(bits_at(bytes, 6, 2)) * bits_at(bytes, 8, 2);
  if (format != "webp") return 0;
  if (has_at(bytes, 12, "VP8X")) return (uint64_t(bits_at(bytes, 24, 3)) + 1) * (uint64_t(bits_at(bytes, 27, 3)) + 1);
  if (has_at(bytes, 12, "VP8L")) {
    const uint32_t sizes = bits_at(bytes, 21, 4);
    return (uint64_t(sizes & 0x3fffU) + 1) * (uint64_t((sizes >> 14U) & 0x3fffU) + 1);
  }
  return uint64_t(bits_at(bytes, 26, 2) & 0x3fffU) * (bits_at(bytes, 28, 2) & 0x3fffU);
}

Error too_large(const std::string& name, uint64_t pixels, uint64_t max_pixels) {
  return Error{
      fmt::format("{}: picture of {} pixels, at most {} are allowed; scale it down", name, pixels, max_pixels)};
}

/// Opens and checks the header; no pixel is decoded.
Result<OpenImage> open_image(std::span<const std::byte> bytes, const std::string& name, uint64_t max_pixels) {
  const std::string_view format = format_of(bytes);
  if (format.empty())
    return Error{fmt::format("{}: {} bytes that are no picture known here (PNG, JPEG, WebP, TGA, BMP, TIFF, GIF, ...)",
                             name, bytes.size())};
  if (const uint64_t pixels = pixels_claimed(bytes, format); pixels > max_pixels)
    return too_large(name, pixels, max_pixels);
  OpenImage image;
  image.memory = std::make_unique<OIIO::Filesystem::IOMemReader>(bytes.data(), bytes.size());
  image.input = OIIO::ImageInput::create(std::string(format));
  if (!image.input) return Error{fmt::format("{}: {} pictures cannot be read here", name, format)};
  image.input->threads(1);
  image.input->set_ioproxy(image.memory.get());
  OIIO::ImageSpec config;
  config.attribute("oiio:UnassociatedAlpha", 1);  // our opacity does not multiply the colour
  OIIO::ImageSpec spec;
  if (!image.input->open("picture." + std::string(format), spec, config))
    return Error{fmt::format("{}: bad {} picture: {}", name, format, one_line(image.input->geterror()))};
  const auto side = [](int value) { return static_cast<uint64_t>(std::max(value, 0)); };
  if (spec.width <= 0 || spec.height <= 0 || spec.depth > 1)
    return Error{fmt::format("{}: picture of {} x {} x {} pixels", name, spec.width, spec.height, spec.depth)};
  const uint64_t pixels = side(spec.width) * side(spec.height);
  // A tile may be larger than its picture and is allocated whole.
  const uint64_t tile = side(spec.tile_width) * side(spec.tile_height);
  if (std::max(pixels, tile) > max_pixels) return too_large(name, std::max(pixels, tile), max_pixels);
  if (spec.nchannels < 1 || spec.nchannels > kMaxChannels)
    return Error{fmt::format("{}: picture of {} channels, at most {} are allowed", name, spec.nchannels, kMaxChannels)};
  return image;
}

bool is_float(const OIIO::ImageSpec& spec) {
  const auto base = spec.format.basetype;
  return base == OIIO::TypeDesc::FLOAT || base == OIIO::TypeDesc::HALF || base == OIIO::TypeDesc::DOUBLE;
}

/// Grey or colour, with or without opacity, to RGBA.
void spread_channels(std::span<const uint8_t> samples, size_t channels, bool has_opacity,
                     std::vector<glm::u8vec4>& pixels) {
  const size_t colors = channels - (has_opacity ? 1 : 0);
  for (size_t i = 0; i < pixels.size(); ++i) {
    const uint8_t* p = samples.data() + i * channels;
    pixels[i].r = p[0];
    pixels[i].g = colors >= 3 ? p[1] : p[0];
    pixels[i].b = colors >= 3 ? p[2] : p[0];
    pixels[i].a = has_opacity ? p[colors] : uint8_t(255);
  }
}

Result<Image> read_pixels(OIIO::ImageInput& input, const std::string& name) {
  const OIIO::ImageSpec& spec = input.spec();
  const int channels = std::min(spec.nchannels, 4);
  const bool has_opacity = (channels == 2 || channels == 4) && spec.alpha_channel == channels - 1;
  Image image;
  image.width = static_cast<uint32_t>(spec.width);
  image.height = static_cast<uint32_t>(spec.height);
  image.pixels.resize(size_t(image.width) * image.height);
  std::vector<uint8_t> samples(image.pixels.size() * static_cast<size_t>(channels));
  bool read = false;
  if (is_float(spec)) {  // light, not sRGB
    std::vector<float> light(samples.size());
    read = input.read_image(0, 0, 0, channels, OIIO::TypeDesc::FLOAT, light.data());
    for (size_t i = 0; i < light.size(); ++i) {
      const bool opacity = has_opacity && i % static_cast<size_t>(channels) == static_cast<size_t>(channels) - 1;
      const float value = std::isfinite(light[i]) ? std::clamp(light[i], 0.0F, 1.0F) : 0.0F;
      samples[i] = opacity ? static_cast<uint8_t>(std::lround(value * 255)) : linear_to_srgb(value);
    }
  } else {
    read = input.read_image(0, 0, 0, channels, OIIO::TypeDesc::UINT8, samples.data());
  }
  if (!read) return Error{fmt::format("{}: bad {} picture: {}", name, input.format_name(), one_line(input.geterror()))};
  spread_channels(samples, static_cast<size_t>(channels), has_opacity, image.pixels);
  return image;
}

/// Writes scanlines to memory in the given format.
Result<std::vector<std::byte>> write_pixels(const char* format, OIIO::ImageSpec spec, OIIO::TypeDesc type,
                                            const void* samples) {
  return guarded(format, [&]() -> Result<std::vector<std::byte>> {
    const std::unique_ptr<OIIO::ImageOutput> output = OIIO::ImageOutput::create(format);
    if (!output) return Error{fmt::format("{} pictures cannot be written here", format)};
    OIIO::Filesystem::IOVecOutput memory;
    output->threads(1);
    output->set_ioproxy(&memory);
    spec.attribute("oiio:UnassociatedAlpha", 1);
    if (!output->open(std::string("picture.") + format, spec) || !output->write_image(type, samples) ||
        !output->close())
      return Error{fmt::format("cannot write a {} x {} {} picture: {}", spec.width, spec.height, format,
                               one_line(output->geterror()))};
    const std::span<const std::byte> bytes = std::as_bytes(std::span(memory.buffer()));
    return std::vector<std::byte>(bytes.begin(), bytes.end());
  });
}

Result<std::vector<std::byte>> write_single_channel(const std::string& name, OIIO::TypeDesc type, const void* samples,
                                                    size_t count, uint32_t width, uint32_t height) {
  if (width == 0 || height == 0 || count != size_t(width) * height)
    return Error{fmt::format("{}: {} values for {} x {} pixels", name, count, width, height)};
  const bool tiff = name.ends_with(".tif") || name.ends_with(".tiff");
  if (!tiff && !name.ends_with(".exr"))
    return Error{fmt::format("{}: one value a pixel is written as .tif, .tiff or .exr; choose such a name", name)};
  OIIO::ImageSpec spec(static_cast<int>(width), static_cast<int>(height), 1, type);
  spec.attribute("compression", "zip");
  return write_pixels(tiff ? "tiff" : "openexr", spec, type, samples);
}

/// What share each source sample has in one resampled sample.
struct Weights {
  uint32_t first = 0;
  std::vector<float> shares;
};

/// Along one axis: the exact overlap of areas when shrinking, linear between centres when growing.
std::vector<Weights> resampling_weights(uint32_t from, uint32_t to) {
  std::vector<Weights> all(to);
  const double step = double(from) / double(to);
  for (uint32_t i = 0; i < to; ++i) {
    Weights& w = all[i];
    if (from >= to) {
      const double begin = i * step, end = (i + 1) * step;
      w.first = static_cast<uint32_t>(begin);
      for (uint32_t s = w.first; s < from && s < end; ++s) {
        const double overlap = std::min(end, s + 1.0) - std::max(begin, double(s));
        if (overlap > 1e-9 * step) w.shares.push_back(static_cast<float>(overlap / step));
      }
    } else {
      const double center = std::clamp((i + 0.5) * step - 0.5, 0.0, double(from - 1));
      w.first = std::min(static_cast<uint32_t>(center), from > 1 ? from - 2 : 0);
      const auto share = static_cast<float>(center - w.first);
      w.shares = {1 - share};
      if (from > 1) w.shares.push_back(share);
    }
  }
  return all;
}

// Clear texels weigh a little too, so that their colour survives where there is nothing else: filters look across the
// borders of cut-out shapes.
constexpr float kClearWeight = 1e-3F;

glm::vec4 weighted_light(const glm::u8vec4& p) {
  const float weight = float(p.a) / 255.0F + kClearWeight;
  return {srgb_to_linear(p.r) * weight, srgb_to_linear(p.g) * weight, srgb_to_linear(p.b) * weight, weight};
}

glm::u8vec4 stored(const glm::vec4& light) {
  const float opacity = std::clamp(light.a - kClearWeight, 0.0F, 1.0F);
  return {linear_to_srgb(light.r / light.a), linear_to_srgb(light.g / light.a), linear_to_srgb(light.b / light.a),
          static_cast<uint8_t>(std::lround(opacity * 255.0F))};
}

}  // namespace

Result<std::vector<std::byte>> encode_image(const Image& image, ImageFormat format, int jpeg_quality) {
  if (image.width == 0 || image.height == 0 || image.pixels.size() != size_t(image.width) * image.height)
    return Error{fmt::format("picture of {} x {} with {} pixels cannot be encoded", image.width, image.height,
                             image.pixels.size())};
  const bool opaque = format == ImageFormat::jpeg ||
                      std::all_of(image.pixels.begin(), image.pixels.end(), [](const auto& p) { return p.a == 255; });
  const size_t channels = opaque ? 3 : 4;
  std::vector<uint8_t> samples;
  samples.reserve(image.pixels.size() * channels);
  for (const glm::u8vec4& p : image.pixels) {
    samples.insert(samples.end(), {p.r, p.g, p.b});
    if (!opaque) samples.push_back(p.a);
  }
  OIIO::ImageSpec spec(static_cast<int>(image.width), static_cast<int>(image.height), static_cast<int>(channels),
                       OIIO::TypeDesc::UINT8);
  if (format == ImageFormat::png) return write_pixels("png", spec, OIIO::TypeDesc::UINT8, samples.data());
  const int quality = std::clamp(jpeg_quality, 1, 100);
  spec.attribute("Compression", fmt::format("jpeg:{}", quality));
  // Whoever asks for high quality wants sharp colours too.
  constexpr int kFullColorQuality = 90;
  spec.attribute("jpeg:subsampling", quality >= kFullColorQuality ? "4:4:4" : "4:2:0");
  return write_pixels("jpeg", spec, OIIO::TypeDesc::UINT8, samples.data());
}

Result<Image> decode_image(std::span<const std::byte> bytes, const std::string& name, uint64_t max_pixels) {
  return guarded(name, [&]() -> Result<Image> {
    const Result<OpenImage> image = open_image(bytes, name, max_pixels);
    if (!image) return image.error();
    return read_pixels(*image->input, name);
  });
}

Result<ImageSize> image_size(std::span<const std::byte> bytes, const std::string& name) {
  return guarded(name, [&]() -> Result<ImageSize> {
    const Result<OpenImage> image = open_image(bytes, name, uint64_t(1) << 32);
    if (!image) return image.error();
    const OIIO::ImageSpec& spec = image->input->spec();
    return ImageSize{static_cast<uint32_t>(spec.width), static_cast<uint32_t>(spec.height)};
  });
}

Image resized(const Image& image, uint32_t width, uint32_t height) {
  Image out;
  out.width = width;
  out.height = height;
  out.pixels.resize(size_t(width) * height);
  if (image.pixels.empty() || out.pixels.empty()) return out;
  const std::vector<Weights> columns = resampling_weights(image.width, width);
  const std::vector<Weights> rows = resampling_weights(image.height, height);
  std::vector<glm::vec4> row(image.width);
  for (uint32_t y = 0; y < height; ++y) {
    std::fill(row.begin(), row.end(), glm::vec4(0));
    for (size_t s = 0; s < rows[y].shares.size(); ++s) {
      const glm::u8vec4* source = &image.at(0, rows[y].first + static_cast<uint32_t>(s));
      for (uint32_t x = 0; x < image.width; ++x) row[x] += rows[y].shares[s] * weighted_light(source[x]);
    }
    for (uint32_t x = 0; x < width; ++x) {
      glm::vec4 light(0);
      for (size_t s = 0; s < columns[x].shares.size(); ++s) light += columns[x].shares[s] * row[columns[x].first + s];
      out.at(x, y) = stored(light);
    }
  }
  return out;
}

Result<std::vector<std::byte>> encode_float_image(std::span<const float> pixels, uint32_t width, uint32_t height,
                                                  const std::string& name) {
  return write_single_channel(name, OIIO::TypeDesc::FLOAT, pixels.data(), pixels.size(), width, height);
}

Result<std::vector<std::byte>> encode_id_image(std::span<const uint32_t> pixels, uint32_t width, uint32_t height,
                                               const std::string& name) {
  return write_single_channel(name, OIIO::TypeDesc::UINT32, pixels.data(), pixels.size(), width, height);
}

}  // namespace promenade
