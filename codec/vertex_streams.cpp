// A vertex that completes a triangle beside one that is known is expected where the parallelogram of the two ends:
// walls are full of rectangles, whose fourth corner then costs nothing. Others are expected where a known corner of
// their triangle is, or else where the vertex before was. Source: Touma and Gotsman, Triangle Mesh Compression, 1998.
#include "codec/vertex_streams.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <limits>

#include "codec/byte_planes.h"
#include "codec/vertex_guesses.h"
#include "codec/vertex_kinds.h"

namespace promenade {
namespace {

// How things are told, in a byte of their own.
constexpr uint8_t kWideTexcoords = 1, kColorDifferences = 2;

/// How far back a vertex in the same place is looked for: what fits a byte.
constexpr uint32_t kTwinReach = 255;

/// For each vertex how many vertices back the last one in the same place is; 0: none within reach. Vertices share a
/// place where colours or normals meet.
std::vector<uint32_t> find_twins(const std::vector<glm::u32vec3>& positions) {
  constexpr uint32_t kFree = 0xffffffffU;
  std::vector<uint32_t> table(std::bit_ceil(positions.size() * 2 + 1),
                              kFree);  // open addressing: the last vertex there
  std::vector<uint32_t> twins(positions.size(), 0);
  for (uint32_t v = 0; v < positions.size(); ++v) {
    const glm::u32vec3& p = positions[v];
    const uint64_t hash =
        ((uint64_t(p.x) * 0x9e3779b97f4a7c15ULL ^ p.y) * 0xbf58476d1ce4e5b9ULL ^ p.z) * 0x94d049bb133111ebULL;
    size_t slot = (hash >> 32U) & (table.size() - 1);
    while (table[slot] != kFree && positions[table[slot]] != p) slot = (slot + 1) & (table.size() - 1);
    if (table[slot] != kFree && v - table[slot] <= kTwinReach) twins[v] = v - table[slot];
    table[slot] = v;
  }
  return twins;
}

template <class Vec>
bool needs_32_bits(const std::vector<Vec>& values) {
  return std::any_of(values.begin(), values.end(), [](const Vec& v) {
    for (int i = 0; i < Vec::length(); ++i)
      if (static_cast<uint32_t>(v[i]) > std::numeric_limits<uint16_t>::max()) return true;
    return false;
  });
}

template <class Vec>
void put_differences(const std::vector<Vec>& values, const std::vector<Guess>& guesses, bool wide, ByteWriter& writer) {
  std::vector<uint32_t> codes;
  for (int i = 0; i < Vec::length(); ++i) {
    codes.clear();
    for (size_t v = 0; v < values.size(); ++v)
      codes.push_back(folded(static_cast<uint32_t>(values[v][i]) - expected(values, guesses[v], i), wide));
    put_planes(codes, wide ? 4 : 2, writer);
  }
}

/// twins: as find_twins, or empty. Vertices that have one take its value.
template <class Vec>
bool get_differences(ByteReader& reader, const std::vector<Guess>& guesses, const std::vector<uint32_t>& twins,
                     bool wide, std::vector<Vec>& values) {
  using Value = typename Vec::value_type;
  values.resize(guesses.size());
  std::vector<uint32_t> codes(
      guesses.size() -
      static_cast<size_t>(std::count_if(twins.begin(), twins.end(), [](uint32_t back) { return back != 0; })));
  const uint32_t mask = wide ? 0xffffffffU : 0xffffU;
  for (int i = 0; i < Vec::length(); ++i) {
    if (!get_planes(reader, wide ? 4 : 2, codes)) return false;
    size_t at = 0;
    for (size_t v = 0; v < values.size(); ++v)
      values[v][i] = !twins.empty() && twins[v] != 0
                         ? values[v - twins[v]][i]
                         : static_cast<Value>((expected(values, guesses[v], i) + unfolded(codes[at++])) & mask);
  }
  return true;
}

/// What the vertex that the guess begins with has; 0 where there is none.
uint32_t beside(const std::vector<glm::u32vec3>& values, const Guess& guess, int i) {
  return guess.known == 0 ? 0 : values[guess.a][i];
}

/// The positions on the grid itself, rounded down.
std::vector<glm::u32vec3> without_fine_bits(const QuantizedMesh& mesh) {
  std::vector<glm::u32vec3> coarse = mesh.positions;
  for (glm::u32vec3& p : coarse) p = p >> uint32_t(mesh.fine_bits);
  return coarse;
}

/// For each vertex without a twin whether it lies beside the grid; then how far, of those that do, less that of the
/// vertex that their guess begins with.
void put_fine_bits(const QuantizedMesh& mesh, const std::vector<Guess>& guesses, const std::vector<uint32_t>& twins,
                   ByteWriter& writer) {
  const uint32_t mask = (1U << mesh.fine_bits) - 1;
  const auto is_told = [&](size_t v) { return twins[v] == 0 && (mesh.positions[v] & mask) != glm::u32vec3(0); };
  for (size_t v = 0; v < mesh.positions.size(); ++v)
    if (twins[v] == 0) writer.put(uint8_t(is_told(v)));
  for (int i = 0; i < 3; ++i)
    for (size_t v = 0; v < mesh.positions.size(); ++v)
      if (is_told(v))
        writer.put(static_cast<uint8_t>((mesh.positions[v][i] - beside(mesh.positions, guesses[v], i)) & mask));
}

bool get_fine_bits(ByteReader& reader, const std::vector<Guess>& guesses, const std::vector<uint32_t>& twins,
                   QuantizedMesh& mesh) {
  const uint32_t mask = (1U << mesh.fine_bits) - 1;
  std::vector<uint32_t> told;
  for (uint32_t v = 0; v < mesh.positions.size(); ++v)
    if (twins[v] == 0 && reader.get<uint8_t>() != 0) told.push_back(v);
  if (!reader.ok() || told.size() > reader.remaining() / 3) return false;
  for (glm::u32vec3& p : mesh.positions) p = p << uint32_t(mesh.fine_bits);
  std::vector<uint8_t> is_told(mesh.positions.size(), 0);
  for (const uint32_t v : told) is_told[v] = 1;
  for (int i = 0; i < 3; ++i)
    for (size_t v = 0; v < mesh.positions.size(); ++v)
      if (twins[v] != 0)
        mesh.positions[v][i] = mesh.positions[v - twins[v]][i];
      else if (is_told[v] != 0)
        mesh.positions[v][i] |= (reader.get<uint8_t>() + beside(mesh.positions, guesses[v], i)) & mask;
  return reader.ok();
}

uint32_t bytes_of_codes(size_t colors) { return colors < 256 ? 1 : colors < 65536 ? 2 : 4; }

/// Red above all, so that colours in order have small steps of red.
uint32_t packed(const glm::u8vec4& c) {
  return uint32_t(c.r) << 24U | uint32_t(c.g) << 16U | uint32_t(c.b) << 8U | uint32_t(c.a);
}
glm::u8vec4 unpacked(uint32_t c) { return {c >> 24U, (c >> 16U) & 0xffU, (c >> 8U) & 0xffU, c & 0xffU}; }

constexpr uint32_t kRed = 0xff000000U;

/// Byte by byte, modulo 256.
uint32_t byte_differences(uint32_t a, uint32_t b) {
  constexpr uint32_t kHigh = 0x80808080U;
  return ((a | kHigh) - (b & ~kHigh)) ^ ((a ^ ~b) & kHigh);
}
uint32_t byte_sums(uint32_t a, uint32_t b) {
  constexpr uint32_t kHigh = 0x80808080U;
  return ((a & ~kHigh) + (b & ~kHigh)) ^ ((a ^ b) & kHigh);
}

/// The colours that occur, in order, and for each vertex 0 for the colour of the vertex that the guess begins with,
/// else its place among them, from 1 on.
void put_colors(const std::vector<glm::u8vec4>& colors, const std::vector<Guess>& guesses, ByteWriter& writer) {
  std::vector<uint32_t> palette, codes;
  palette.reserve(colors.size()), codes.reserve(colors.size());
  for (const glm::u8vec4& c : colors) palette.push_back(packed(c));
  std::sort(palette.begin(), palette.end());
  palette.erase(std::unique(palette.begin(), palette.end()), palette.end());
  for (size_t v = 0; v < colors.size(); ++v) {
    const bool as_expected = guesses[v].known > 0 && colors[guesses[v].a] == colors[v];
    const auto place = std::lower_bound(palette.begin(), palette.end(), packed(colors[v])) - palette.begin();
    codes.push_back(as_expected ? 0 : static_cast<uint32_t>(place) + 1);
  }
  writer.put(static_cast<uint32_t>(palette.size()));
  for (size_t i = palette.size(); i-- > 1;) palette[i] = byte_differences(palette[i], palette[i - 1]);
  put_planes(palette, 4, writer);
  put_planes(codes, bytes_of_codes(palette.size()), writer);
}

/// by_differences: every byte of a colour is told less that of the one before, otherwise red alone.
Status get_colors(ByteReader& reader, const std::vector<Guess>& guesses, bool by_differences,
                  std::vector<glm::u8vec4>& colors) {
  const auto count = reader.get<uint32_t>();
  if (count > guesses.size()) return Error{fmt::format("mesh: {} colours for {} vertices", count, guesses.size())};
  std::vector<uint32_t> palette(count), codes(guesses.size());
  if (!get_planes(reader, 4, palette) || !get_planes(reader, bytes_of_codes(count), codes))
    return Error{"mesh: colours reach beyond the end"};
  for (size_t i = 1; i < palette.size(); ++i)
    palette[i] = byte_sums(palette[i], by_differences ? palette[i - 1] : palette[i - 1] & kRed);
  colors.reserve(codes.size());
  for (size_t v = 0; v < codes.size(); ++v) {
    if (codes[v] > count || (codes[v] == 0 && guesses[v].known == 0))
      return Error{fmt::format("mesh: vertex {} has colour {} of {}", v, codes[v], count)};
    if (codes[v] == 0) {
      const glm::u8vec4 same = colors[guesses[v].a];
      colors.push_back(same);
      continue;
    }
    colors.push_back(unpacked(palette[codes[v] - 1]));
  }
  return Done{};
}

}  // namespace

void put_vertices(const QuantizedMesh& mesh, ByteWriter& writer) {
  const Result<std::vector<Guess>> guesses = guess_vertices(mesh.indices, mesh.positions.size());
  const std::vector<glm::u32vec3> positions = without_fine_bits(mesh);
  const bool wide_positions = needs_32_bits(positions), wide_texcoords = needs_32_bits(mesh.texcoords);
  writer.put(uint8_t(wide_positions));
  writer.put(static_cast<uint8_t>((wide_texcoords ? kWideTexcoords : 0U) | kColorDifferences));
  // Bits of floats do not continue linearly.
  const std::vector<Guess> single = mesh.on_grid ? std::vector<Guess>() : without_parallelograms(*guesses);
  const std::vector<uint32_t> twins = find_twins(mesh.positions);
  put_planes(twins, 1, writer);
  put_positions(positions, mesh.on_grid ? *guesses : single, twins, wide_positions, writer);
  if (mesh.fine_bits > 0) put_fine_bits(mesh, *guesses, twins, writer);
  if (!mesh.normals.empty()) put_normals(mesh, *guesses, twins, writer);
  put_differences(mesh.texcoords, *guesses, wide_texcoords, writer);
  if (!mesh.colors.empty()) put_colors(mesh.colors, *guesses, writer);
}

Status get_vertices(ByteReader& reader, size_t vertices, bool normals, bool texcoords, bool colors,
                    QuantizedMesh& mesh) {
  const Result<std::vector<Guess>> guesses = guess_vertices(mesh.indices, vertices);
  if (!guesses) return guesses.error();
  const bool wide_positions = reader.get<uint8_t>() != 0;
  const auto ways = reader.get<uint8_t>();
  if (ways > (kWideTexcoords | kColorDifferences)) return Error{fmt::format("mesh: unknown ways {:#x}", ways)};
  const bool wide_texcoords = (ways & kWideTexcoords) != 0;
  const Error short_streams{fmt::format("mesh: streams of {} vertices reach beyond the end", vertices)};
  // Bits of floats do not continue linearly.
  const std::vector<Guess> single = mesh.on_grid ? std::vector<Guess>() : without_parallelograms(*guesses);
  std::vector<uint32_t> twins(vertices);
  if (!get_planes(reader, 1, twins)) return short_streams;
  for (size_t v = 0; v < vertices; ++v)
    if (twins[v] > v) return Error{fmt::format("mesh: vertex {} lies where one {} before it does", v, twins[v])};
  const std::vector<Guess>& of_positions = mesh.on_grid ? *guesses : single;
  if (mesh.by_kinds)
    PROMENADE_TRY(get_positions(reader, of_positions, twins, wide_positions, mesh.positions));
  else if (!get_differences(reader, of_positions, twins, wide_positions, mesh.positions))
    return short_streams;
  if (mesh.fine_bits > 0 && !get_fine_bits(reader, *guesses, twins, mesh)) return short_streams;
  if (normals && mesh.by_kinds)
    PROMENADE_TRY(get_normals(reader, *guesses, twins, mesh));
  else if (normals && !get_differences(reader, *guesses, {}, false, mesh.normals))
    return short_streams;
  if (texcoords && !get_differences(reader, *guesses, {}, wide_texcoords, mesh.texcoords)) return short_streams;
  if (colors) PROMENADE_TRY(get_colors(reader, *guesses, (ways & kColorDifferences) != 0, mesh.colors));
  if (!reader.ok() || reader.remaining() != 0)
    return Error{fmt::format("mesh: {} bytes follow the vertices", reader.remaining())};
  return Done{};
}

}  // namespace promenade
