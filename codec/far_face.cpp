#include "codec/far_face.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <string_view>

#include "codec/byte_io.h"
#include "codec/far_coding.h"
#include "codec/far_delta.h"
#include "codec/far_warp.h"
#include "codec/image_codec.h"

namespace promenade {
namespace {

using namespace far_coding;

constexpr std::string_view kMagic = "PFAR";
constexpr uint8_t kAloneVersion = 1, kDeltaVersion = 2;
constexpr size_t kHeaderBytes = 12, kPlacesBytes = 4;
/// A reference lies a few cells away, which have a quarter of the box at most. Bounds numbers on hostile input.
constexpr double kMostOffset = 16;

/// Where something is, row by row, told by the pixels around that are known, and by what was foretold, if anything was.
template <class Coder>
void code_opacity(Coder& code, Models& models, uint32_t side, Image& colors, const Image* foretold) {
  const auto shown = [side](const Image& image, int64_t x, int64_t y) -> uint32_t {
    if (x < 0 || y < 0 || x >= int64_t(side) || y >= int64_t(side)) return 0;
    return image.at(static_cast<uint32_t>(x), static_cast<uint32_t>(y)).a != 0 ? 1U : 0U;
  };
  const auto there = [&](int64_t x, int64_t y) { return shown(colors, x, y); };
  for (int64_t y = 0; y < int64_t(side); ++y)
    for (int64_t x = 0; x < int64_t(side); ++x) {
      uint32_t context = there(x - 1, y) | there(x - 2, y) << 1 | there(x, y - 1) << 2 | there(x - 1, y - 1) << 3 |
                         there(x + 1, y - 1) << 4 | there(x, y - 2) << 5;
      if (foretold != nullptr)
        context |= shown(*foretold, x, y) << 6 | shown(*foretold, x + 1, y) << 7 | shown(*foretold, x, y + 1) << 8;
      glm::u8vec4& pixel = colors.at(static_cast<uint32_t>(x), static_cast<uint32_t>(y));
      pixel.a = code(models.there[context], pixel.a != 0 ? 1U : 0U) != 0 ? 255 : 0;
    }
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

/// As a JPEG file, or exact.
Result<std::vector<std::byte>> encode_colors(const Image& opaque, int jpeg_quality) {
  const bool exact = jpeg_quality == 0;
  return encode_image(opaque, exact ? ImageFormat::png : ImageFormat::jpeg, exact ? 1 : jpeg_quality);
}

Image opaque_colors(const Image& colors) {
  Image opaque = colors;
  fill_colors(opaque);
  for (glm::u8vec4& pixel : opaque.pixels) pixel.a = 255;
  flatten_empty_blocks(colors, opaque);
  return opaque;
}

/// Everything before the decisions. kind: 0, or a FarForetelling; then `reference` says of what.
std::vector<std::byte> head_of(const FarFace& face, uint8_t kind, const FarReference* reference,
                               std::span<const std::byte> picture) {
  ByteWriter writer;
  for (const char c : kMagic) writer.put(static_cast<uint8_t>(c));
  writer.put(reference != nullptr ? kDeltaVersion : kAloneVersion);
  writer.put(static_cast<uint8_t>(face.grid.levels)), writer.put(kind), writer.put(uint8_t(0));
  writer.put(static_cast<uint32_t>(picture.size()));
  if (reference != nullptr) {
    for (const int8_t places : reference->places) writer.put(static_cast<uint8_t>(places));
    writer.put(uint8_t(0));
  }
  writer.put_bytes(picture);
  return writer.take();
}

Status check_reference(const HalvedGrid& grid, uint32_t side, const FarReference& reference) {
  if (side > 5) return Error{fmt::format("far face: there is no side {}", side)};
  for (int i = 0; i < 3; ++i)
    if (!(std::abs(reference.offset[i]) <= kMostOffset))
      return Error{fmt::format("far face: its reference is {} half boxes away", reference.offset[i])};
  for (const FarFace* from : reference.sides)
    if (from != nullptr && (from->grid.levels != grid.levels || from->colors.width != grid.side() ||
                            from->colors.height != grid.side() || from->colors.pixels.size() != grid.vertices()))
      return Error{fmt::format("far face of {} levels: its reference has other sizes", grid.levels)};
  return Done{};
}

/// What stands before the decisions.
struct Head {
  uint8_t version = 0, kind = 0;
  HalvedGrid grid;
  std::array<int8_t, 3> places{};
  std::span<const std::byte> picture, decisions;
};

Result<Head> read_head(std::span<const std::byte> bytes) {
  if (bytes.size() < kHeaderBytes)
    return Error{fmt::format("far face: {} bytes, a header has {}", bytes.size(), kHeaderBytes)};
  if (std::string_view(reinterpret_cast<const char*>(bytes.data()), kMagic.size()) != kMagic)
    return Error{"far face: no such magic at its start"};
  ByteReader reader(bytes.subspan(kMagic.size()));
  Head head;
  head.version = reader.get<uint8_t>();
  if (head.version != kAloneVersion && head.version != kDeltaVersion)
    return Error{fmt::format("far face @0x4: version {}, this program reads {} and {}", head.version, kAloneVersion,
                             kDeltaVersion)};
  head.grid.levels = reader.get<uint8_t>();
  if (head.grid.levels > kMostFaceLevels)
    return Error{fmt::format("far face @0x5: {} levels, at most {}", head.grid.levels, kMostFaceLevels)};
  head.kind = reader.get<uint8_t>();
  const auto last = static_cast<uint8_t>(FarForetelling::warped);
  if (head.version == kAloneVersion ? head.kind != 0 : head.kind == 0 || head.kind > last)
    return Error{fmt::format("far face @0x6: kind {} in version {}", head.kind, head.version)};
  if (const auto zero = reader.get<uint8_t>(); zero != 0) return Error{fmt::format("far face @0x7: {} is not 0", zero)};
  const auto picture_bytes = reader.get<uint32_t>();
  if (head.version == kDeltaVersion) {
    if (reader.remaining() < kPlacesBytes) return Error{"far face @0xc: ends before the place of its reference"};
    for (int8_t& places : head.places) places = static_cast<int8_t>(reader.get<uint8_t>());
    if (const auto zero = reader.get<uint8_t>(); zero != 0)
      return Error{fmt::format("far face @0xf: {} is not 0", zero)};
  }
  if (picture_bytes > reader.remaining())
    return Error{fmt::format("far face @0x8: a picture of {} bytes, {} are left", picture_bytes, reader.remaining())};
  head.picture = reader.get_bytes(picture_bytes);
  head.decisions = reader.get_bytes(reader.remaining());
  return head;
}

Result<Image> decode_colors(const Head& head) {
  Result<Image> colors = decode_image(head.picture, "far face", head.grid.vertices());
  if (!colors) return colors.error();
  if (const uint32_t side = head.grid.side(); colors->width != side || colors->height != side)
    return Error{
        fmt::format("far face: a picture of {} x {} pixels, {} a side are due", colors->width, colors->height, side)};
  return colors;
}

FarFace empty_face(const HalvedGrid& grid) {
  FarFace face;
  face.grid = grid;
  face.kept.assign(grid.vertices(), 0);
  face.depth.assign(grid.vertices(), 0);
  return face;
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
  const Result<std::vector<std::byte>> picture = encode_colors(opaque_colors(face.colors), coding.jpeg_quality);
  if (!picture) return picture.error();
  std::vector<std::byte> bytes = head_of(face, 0, nullptr, *picture);
  RangeEncoder coder(bytes);
  Putter code{coder};
  Models models;
  FarFace copy = face;
  code_opacity(code, models, face.grid.side(), copy.colors, nullptr);
  code_triangles(code, models, copy);
  coder.finish();
  return bytes;
}

Result<std::vector<std::byte>> encode_far_delta(const FarFace& face, const FarFaceCoding& coding, uint32_t side,
                                                const FarReference& reference, FarForetelling how) {
  PROMENADE_TRY(check_face(face));
  PROMENADE_TRY(check_reference(face.grid, side, reference));
  const Image foretold = foretell(face, side, reference, how);
  Image wanted = opaque_colors(face.colors);
  for (size_t i = 0; i < wanted.pixels.size(); ++i) wanted.pixels[i].a = face.colors.pixels[i].a;
  std::vector<Block> blocks = choose_blocks(wanted, foretold, coding.shifts);
  const Result<std::vector<std::byte>> picture =
      encode_colors(differences(wanted, base_of(blocks, foretold)), coding.jpeg_quality);
  if (!picture) return picture.error();
  std::vector<std::byte> bytes = head_of(face, static_cast<uint8_t>(how), &reference, *picture);
  RangeEncoder coder(bytes);
  Putter code{coder};
  Models models;
  FarFace copy = face;
  code_triangles(code, models, copy);
  code_opacity(code, models, face.grid.side(), copy.colors, &foretold);
  code_blocks(code, blocks_across(face.grid.side()), blocks);
  coder.finish();
  return bytes;
}

Result<FarFace> decode_far_face(std::span<const std::byte> bytes, uint32_t side, const FarReference* reference) {
  const Result<Head> head = read_head(bytes);
  if (!head) return head.error();
  if (head->version == kDeltaVersion) {
    if (reference == nullptr) return Error{"far face: told against another, which is not there"};
    PROMENADE_TRY(check_reference(head->grid, side, *reference));
  }
  Result<Image> colors = decode_colors(*head);
  if (!colors) return colors.error();
  FarFace face = empty_face(head->grid);
  RangeDecoder coder(head->decisions);
  Getter code{coder};
  Models models;
  if (head->version == kAloneVersion) {
    face.colors = std::move(*colors);
    code_opacity(code, models, face.grid.side(), face.colors, nullptr);
    code_triangles(code, models, face);
  } else {
    code_triangles(code, models, face);
    const Image foretold = foretell(face, side, *reference, static_cast<FarForetelling>(head->kind));
    code_opacity(code, models, face.grid.side(), *colors, &foretold);
    const uint32_t across = blocks_across(face.grid.side());
    std::vector<Block> blocks(size_t(across) * across);
    code_blocks(code, across, blocks);
    face.colors = base_of(blocks, foretold);
    add_differences(*colors, face.colors);
  }
  if (coder.overrun()) return Error{"far face: its triangles end too early"};
  return face;
}

std::optional<std::array<int8_t, 3>> reference_of_far_face(std::span<const std::byte> bytes) {
  const Result<Head> head = read_head(bytes);
  if (!head || head->version != kDeltaVersion) return std::nullopt;
  return head->places;
}

size_t picture_bytes_of_far_face(std::span<const std::byte> bytes) {
  const Result<Head> head = read_head(bytes);
  return head ? head->picture.size() : 0;
}

}  // namespace promenade
