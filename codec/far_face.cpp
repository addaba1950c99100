#include "codec/far_face.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <string_view>

#include "codec/byte_io.h"
#include "codec/image_codec.h"
#include "codec/range_coder.h"

namespace promenade {
namespace {

constexpr std::string_view kMagic = "PFAR";
constexpr uint8_t kVersion = 1;
constexpr size_t kHeaderBytes = 12;

/// Contexts of all decisions of a face. Encoder and decoder go through the same ones.
struct Models {
  static constexpr size_t kLevels = HalvedGrid::kMostLevels * 2 + 2;
  static constexpr size_t kDepthBits = 17;  // of a difference, and one for 0
  std::array<BitModel, 64> there;
  std::array<std::array<BitModel, 2>, kLevels> kept;
  std::array<std::array<BitModel, kDepthBits + 1>, kLevels> magnitude;
  std::array<BitModel, kLevels> sign;
  std::array<std::array<BitModel, 4>, kDepthBits + 1> mantissa;  ///< its highest bits; those below share the last
};

/// Both ends of the coder have put(model, bit) in common: a decoder's returns what it reads and ignores the bit.
struct Putter {
  RangeEncoder& coder;
  uint32_t operator()(BitModel& model, uint32_t bit) { return coder.put(model, bit), bit; }
};
struct Getter {
  RangeDecoder& coder;
  uint32_t operator()(BitModel& model, uint32_t) { return coder.get(model); }
};

/// Where something is, row by row, told by the pixels around that are known.
template <class Coder>
void code_opacity(Coder& code, Models& models, uint32_t side, Image& colors) {
  const auto there = [&](int64_t x, int64_t y) -> uint32_t {
    if (x < 0 || y < 0 || x >= int64_t(side)) return 0;
    return colors.at(static_cast<uint32_t>(x), static_cast<uint32_t>(y)).a != 0 ? 1U : 0U;
  };
  for (int64_t y = 0; y < int64_t(side); ++y)
    for (int64_t x = 0; x < int64_t(side); ++x) {
      const uint32_t context = there(x - 1, y) | there(x - 2, y) << 1 | there(x, y - 1) << 2 |
                               there(x - 1, y - 1) << 3 | there(x + 1, y - 1) << 4 | there(x, y - 2) << 5;
      glm::u8vec4& pixel = colors.at(static_cast<uint32_t>(x), static_cast<uint32_t>(y));
      pixel.a = code(models.there[context], pixel.a != 0 ? 1U : 0U) != 0 ? 255 : 0;
    }
}

/// A difference: how many bits it has, its sign, the bits below the highest.
template <class Coder>
int32_t code_difference(Coder& code, Models& models, size_t level, int32_t difference) {
  const auto magnitude = static_cast<uint32_t>(difference < 0 ? -difference : difference);
  const auto bits = static_cast<uint32_t>(std::bit_width(magnitude));
  uint32_t n = 0;
  while (n < Models::kDepthBits && code(models.magnitude[level][n], n < bits ? 1U : 0U) != 0) ++n;
  if (n == 0) return 0;
  const bool negative = code(models.sign[level], difference < 0 ? 1U : 0U) != 0;
  uint32_t value = 1;
  for (uint32_t i = 1; i < n; ++i)
    value = value << 1 | code(models.mantissa[n][std::min(i - 1, 3U)], magnitude >> (n - 1 - i) & 1U);
  return negative ? -static_cast<int32_t>(value) : static_cast<int32_t>(value);
}

/// The finest are the longest in bits: by the hypotenuse's length, diagonal ones and straight ones apart.
size_t level_of(const HalvedGrid& grid, const HalvingPoint& p) {
  const uint32_t across = p.ends[1] - p.ends[0], rows = (across + grid.cells() / 2) / grid.side();
  if (rows == 0) return 2 * static_cast<size_t>(std::bit_width(across));
  const uint32_t columns = across % grid.side();
  return 2 * static_cast<size_t>(std::bit_width(rows)) + (columns == 0 ? 0 : 1);
}

/// Which vertices are kept, the coarsest first, and their depths: a vertex may be kept where both apexes are.
template <class Coder>
void code_triangles(Coder& code, Models& models, FarFace& face) {
  const HalvedGrid& grid = face.grid;
  const auto code_depth = [&](uint32_t at, int32_t guess, size_t level) {
    const int32_t found = guess + code_difference(code, models, level, int32_t(face.depth[at]) - guess);
    face.depth[at] = static_cast<uint16_t>(std::clamp<int32_t>(found, 1, FarFace::kNearest));
  };
  int32_t guess = FarFace::kNearest;
  for (const uint32_t y : {0U, grid.cells()})
    for (const uint32_t x : {0U, grid.cells()}) {
      const uint32_t at = grid.index(x, y);
      face.kept[at] = 1;
      code_depth(at, guess, 0);
      guess = face.depth[at];
    }
  uint32_t before = 0;
  for_each_halving_point(grid, true, [&](const HalvingPoint& p) {
    const size_t level = level_of(grid, p);
    if (face.kept[p.apexes[0]] == 0 || face.kept[p.apexes[1]] == 0) return;
    before = face.kept[p.at] = static_cast<uint8_t>(code(models.kept[level][before], face.kept[p.at] != 0 ? 1U : 0U));
    if (before != 0) code_depth(p.at, (int32_t(face.depth[p.ends[0]]) + face.depth[p.ends[1]]) / 2, level);
  });
}

Status check_face(const FarFace& face) {
  const uint64_t count = face.grid.vertices();
  if (face.grid.levels > kMostFaceLevels)
    return Error{fmt::format("far face of {} levels, at most {}", face.grid.levels, kMostFaceLevels)};
  if (face.colors.width != face.grid.side() || face.colors.height != face.grid.side() ||
      face.colors.pixels.size() != count || face.kept.size() != count || face.depth.size() != count)
    return Error{fmt::format("far face of {} pixels a side: its arrays have other sizes", face.grid.side())};
  return Done{};
}

}  // namespace

void fill_colors(Image& colors) {
  const uint32_t width = colors.width, height = colors.height;
  // From the nearest in the column, downwards first: what stands below a skyline is mostly what bounds it.
  std::vector<uint8_t> known(colors.pixels.size());
  for (size_t i = 0; i < known.size(); ++i) known[i] = colors.pixels[i].a != 0 ? 1 : 0;
  const auto take = [&](size_t to, size_t from) {
    if (known[to] != 0 || known[from] == 0) return;
    const glm::u8vec4& color = colors.pixels[from];
    colors.pixels[to] = {color.r, color.g, color.b, 0};
    known[to] = 1;
  };
  for (uint32_t y = height; y-- > 1;)
    for (uint32_t x = 0; x < width; ++x) take(size_t(y - 1) * width + x, size_t(y) * width + x);
  for (uint32_t y = 1; y < height; ++y)
    for (uint32_t x = 0; x < width; ++x) take(size_t(y) * width + x, size_t(y - 1) * width + x);
  for (uint32_t y = 0; y < height; ++y) {
    for (uint32_t x = 1; x < width; ++x) take(size_t(y) * width + x, size_t(y) * width + x - 1);
    for (uint32_t x = width; x-- > 1;) take(size_t(y) * width + x - 1, size_t(y) * width + x);
  }
}

Result<std::vector<std::byte>> encode_far_face(const FarFace& face, const FarFaceCoding& coding) {
  PROMENADE_TRY(check_face(face));
  Image opaque = face.colors;
  fill_colors(opaque);
  for (glm::u8vec4& pixel : opaque.pixels) pixel.a = 255;
  const bool exact = coding.jpeg_quality == 0;
  const Result<std::vector<std::byte>> picture =
      encode_image(opaque, exact ? ImageFormat::png : ImageFormat::jpeg, exact ? 1 : coding.jpeg_quality);
  if (!picture) return picture.error();
  ByteWriter writer;
  for (const char c : kMagic) writer.put(static_cast<uint8_t>(c));
  writer.put(kVersion), writer.put(static_cast<uint8_t>(face.grid.levels)), writer.put(uint16_t(0));
  writer.put(static_cast<uint32_t>(picture->size()));
  writer.put_bytes(*picture);
  std::vector<std::byte> bytes = writer.take();
  RangeEncoder coder(bytes);
  Putter code{coder};
  Models models;
  FarFace copy = face;
  code_opacity(code, models, face.grid.side(), copy.colors);
  code_triangles(code, models, copy);
  coder.finish();
  return bytes;
}

Result<FarFace> decode_far_face(std::span<const std::byte> bytes) {
  if (bytes.size() < kHeaderBytes)
    return Error{fmt::format("far face: {} bytes, a header has {}", bytes.size(), kHeaderBytes)};
  if (std::string_view(reinterpret_cast<const char*>(bytes.data()), kMagic.size()) != kMagic)
    return Error{"far face: no such magic at its start"};
  ByteReader reader(bytes.subspan(kMagic.size()));
  if (const auto version = reader.get<uint8_t>(); version != kVersion)
    return Error{fmt::format("far face @0x4: version {}, this program reads {}", version, kVersion)};
  FarFace face;
  face.grid.levels = reader.get<uint8_t>();
  if (face.grid.levels > kMostFaceLevels)
    return Error{fmt::format("far face @0x5: {} levels, at most {}", face.grid.levels, kMostFaceLevels)};
  if (const auto zero = reader.get<uint16_t>(); zero != 0)
    return Error{fmt::format("far face @0x6: {} is not 0", zero)};
  const auto picture_bytes = reader.get<uint32_t>();
  if (picture_bytes > reader.remaining())
    return Error{fmt::format("far face @0x8: a picture of {} bytes, {} are left", picture_bytes, reader.remaining())};
  const uint32_t side = face.grid.side();
  Result<Image> colors = decode_image(reader.get_bytes(picture_bytes), "far face", face.grid.vertices());
  if (!colors) return colors.error();
  if (colors->width != side || colors->height != side)
    return Error{
        fmt::format("far face: a picture of {} x {} pixels, {} a side are due", colors->width, colors->height, side)};
  face.colors = std::move(*colors);
  face.kept.assign(face.grid.vertices(), 0);
  face.depth.assign(face.grid.vertices(), 0);
  RangeDecoder coder(reader.get_bytes(reader.remaining()));
  Getter code{coder};
  Models models;
  code_opacity(code, models, side, face.colors);
  code_triangles(code, models, face);
  if (coder.overrun()) return Error{"far face: its triangles end too early"};
  return face;
}

}  // namespace promenade
