// A vertex that completes a triangle beside one that is known is expected where the parallelogram of the two ends:
// walls are full of rectangles, whose fourth corner then costs nothing. Others are expected where a known corner of
// their triangle is, or else where the vertex before was. Source: Touma and Gotsman, Triangle Mesh Compression, 1998.
#include "codec/vertex_streams.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <unordered_map>

namespace promenade {
namespace {

/// How many triangles back a neighbour is looked for: orders that are good for caches have it within a few.
constexpr size_t kLookBack = 24;

/// Vertices known when a new one is met: a + b - c, or a, or nothing.
struct Guess {
  uint32_t a = 0, b = 0, c = 0;
  uint8_t known = 0;  ///< 0, 1 or 3
};

/// The corner of an earlier triangle across the edge between a and b.
bool find_across(std::span<const uint32_t> indices, size_t triangle, Guess& guess) {
  const size_t first = triangle > kLookBack ? triangle - kLookBack : 0;
  for (size_t t = triangle; t-- > first;) {
    const uint32_t* v = &indices[3 * t];
    const auto has = [v](uint32_t i) { return v[0] == i || v[1] == i || v[2] == i; };
    if (!has(guess.a) || !has(guess.b)) continue;
    for (size_t c = 0; c < 3; ++c)
      if (v[c] != guess.a && v[c] != guess.b) {
        guess.c = v[c];
        return true;
      }
  }
  return false;
}

/// A guess for every vertex, in order. Fails where the triangles do not meet vertices in order, or not all of them.
Result<std::vector<Guess>> guess_vertices(std::span<const uint32_t> indices, size_t vertices) {
  if (vertices > indices.size())
    return Error{fmt::format("mesh: {} vertices for {} corners of triangles", vertices, indices.size())};
  std::vector<Guess> guesses;
  guesses.reserve(vertices);
  for (size_t t = 0; t < indices.size() / 3; ++t) {
    std::array<uint32_t, 3> v{indices[3 * t], indices[3 * t + 1], indices[3 * t + 2]};
    std::sort(v.begin(), v.end());
    for (size_t i = 0; i < 3; ++i) {
      const auto next = static_cast<uint32_t>(guesses.size());
      if (v[i] < next) continue;
      if (v[i] > next || next >= vertices)
        return Error{fmt::format("mesh: triangle {} has vertex {}, {} is next of {}", t, v[i], next, vertices)};
      Guess guess;
      guess.known = i == 0 ? 0 : 1;
      if (i > 0) guess.a = v[i - 1];
      if (i == 2 && v[1] < v[2]) {
        guess.b = v[0];
        if (v[1] != v[0] && find_across(indices, t, guess)) guess.known = 3;
      }
      if (i == 0 && next > 0) guess.known = 1, guess.a = next - 1;
      guesses.push_back(guess);
    }
  }
  if (guesses.size() != vertices)
    return Error{fmt::format("mesh: triangles use {} of {} vertices", guesses.size(), vertices)};
  return guesses;
}

/// What is expected of one component, modulo 2^32.
template <class Vec>
uint32_t expected(const std::vector<Vec>& values, const Guess& guess, int i) {
  const auto at = [&](uint32_t v) { return static_cast<uint32_t>(values[v][i]); };
  if (guess.known == 0) return 0;
  return guess.known == 3 ? at(guess.a) + at(guess.b) - at(guess.c) : at(guess.a);
}

/// The same guesses without parallelograms, for what does not continue linearly.
std::vector<Guess> without_parallelograms(std::vector<Guess> guesses) {
  for (Guess& guess : guesses) guess.known = std::min<uint8_t>(guess.known, 1);
  return guesses;
}

/// Differences of 16 or 32 bits, small ones of either sign small.
uint32_t folded(uint32_t difference, bool wide) {
  if (!wide) difference = static_cast<uint32_t>(static_cast<int32_t>(static_cast<int16_t>(difference & 0xffffU)));
  return (difference << 1U) ^ (0U - (difference >> 31U));
}
uint32_t unfolded(uint32_t code) { return (code >> 1U) ^ (0U - (code & 1U)); }

/// How far back a vertex in the same place is looked for: what fits a byte.
constexpr uint32_t kTwinReach = 255;

/// For each vertex how many vertices back the last one in the same place is; 0: none within reach. Vertices share a
/// place where colours or normals meet.
std::vector<uint32_t> find_twins(const std::vector<glm::u32vec3>& positions) {
  struct Hash {
    size_t operator()(const glm::u32vec3& p) const {
      return (uint64_t(p.x) * 0x9e3779b97f4a7c15ULL ^ uint64_t(p.y)) * 0xbf58476d1ce4e5b9ULL ^ p.z;
    }
  };
  std::unordered_map<glm::u32vec3, uint32_t, Hash> last;
  last.reserve(positions.size());
  std::vector<uint32_t> twins(positions.size(), 0);
  for (uint32_t v = 0; v < positions.size(); ++v) {
    const auto [found, is_new] = last.try_emplace(positions[v], v);
    if (is_new) continue;
    if (v - found->second <= kTwinReach) twins[v] = v - found->second;
    found->second = v;
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

/// One byte of every number after the other, least significant bytes first.
void put_planes(const std::vector<uint32_t>& numbers, uint32_t bytes, ByteWriter& writer) {
  for (uint32_t plane = 0; plane < bytes; ++plane)
    for (const uint32_t number : numbers) writer.put(static_cast<uint8_t>((number >> (8 * plane)) & 0xffU));
}

bool get_planes(ByteReader& reader, uint32_t bytes, std::vector<uint32_t>& numbers) {
  std::fill(numbers.begin(), numbers.end(), 0U);
  for (uint32_t plane = 0; plane < bytes; ++plane) {
    const std::span<const std::byte> run = reader.get_bytes(numbers.size());
    if (run.size() != numbers.size()) return false;
    for (size_t i = 0; i < run.size(); ++i) numbers[i] |= std::to_integer<uint32_t>(run[i]) << (8 * plane);
  }
  return true;
}

/// skipped: vertices that are not written (not 0), or empty.
template <class Vec>
void put_differences(const std::vector<Vec>& values, const std::vector<Guess>& guesses,
                     const std::vector<uint32_t>& skipped, bool wide, ByteWriter& writer) {
  std::vector<uint32_t> codes;
  for (int i = 0; i < Vec::length(); ++i) {
    codes.clear();
    for (size_t v = 0; v < values.size(); ++v)
      if (skipped.empty() || skipped[v] == 0)
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
        writer.put(static_cast<uint8_t>((mesh.positions[v][i] - expected(mesh.positions, guesses[v], i)) & mask));
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
        mesh.positions[v][i] |= (reader.get<uint8_t>() + expected(mesh.positions, guesses[v], i)) & mask;
  return reader.ok();
}

uint32_t bytes_of_codes(size_t colors) { return colors < 256 ? 1 : colors < 65536 ? 2 : 4; }

/// Red above all, so that colours in order have small steps of red.
uint32_t packed(const glm::u8vec4& c) {
  return uint32_t(c.r) << 24U | uint32_t(c.g) << 16U | uint32_t(c.b) << 8U | uint32_t(c.a);
}
glm::u8vec4 unpacked(uint32_t c) { return {c >> 24U, (c >> 16U) & 0xffU, (c >> 8U) & 0xffU, c & 0xffU}; }

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
  // Only red is told as a difference: the others begin anew with every red.
  for (size_t i = palette.size(); i-- > 1;) palette[i] -= palette[i - 1] & 0xff000000U;
  put_planes(palette, 4, writer);
  put_planes(codes, bytes_of_codes(palette.size()), writer);
}

Status get_colors(ByteReader& reader, const std::vector<Guess>& guesses, std::vector<glm::u8vec4>& colors) {
  const auto count = reader.get<uint32_t>();
  if (count > guesses.size()) return Error{fmt::format("mesh: {} colours for {} vertices", count, guesses.size())};
  std::vector<uint32_t> palette(count), codes(guesses.size());
  if (!get_planes(reader, 4, palette) || !get_planes(reader, bytes_of_codes(count), codes))
    return Error{"mesh: colours reach beyond the end"};
  for (size_t i = 1; i < palette.size(); ++i) palette[i] += palette[i - 1] & 0xff000000U;
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
  writer.put(uint8_t(wide_texcoords));
  const std::vector<Guess> single = without_parallelograms(*guesses);
  const std::vector<uint32_t> twins = find_twins(mesh.positions);
  put_planes(twins, 1, writer);
  // Bits of floats do not continue linearly.
  put_differences(positions, mesh.on_grid ? *guesses : single, twins, wide_positions, writer);
  if (mesh.fine_bits > 0) put_fine_bits(mesh, single, twins, writer);
  put_differences(mesh.normals, *guesses, {}, false, writer);
  put_differences(mesh.texcoords, *guesses, {}, wide_texcoords, writer);
  if (!mesh.colors.empty()) put_colors(mesh.colors, single, writer);
}

Status get_vertices(ByteReader& reader, size_t vertices, bool normals, bool texcoords, bool colors,
                    QuantizedMesh& mesh) {
  const Result<std::vector<Guess>> guesses = guess_vertices(mesh.indices, vertices);
  if (!guesses) return guesses.error();
  const bool wide_positions = reader.get<uint8_t>() != 0, wide_texcoords = reader.get<uint8_t>() != 0;
  const Error short_streams{fmt::format("mesh: streams of {} vertices reach beyond the end", vertices)};
  const std::vector<Guess> single = without_parallelograms(*guesses);
  std::vector<uint32_t> twins(vertices);
  if (!get_planes(reader, 1, twins)) return short_streams;
  for (size_t v = 0; v < vertices; ++v)
    if (twins[v] > v) return Error{fmt::format("mesh: vertex {} lies where one {} before it does", v, twins[v])};
  if (!get_differences(reader, mesh.on_grid ? *guesses : single, twins, wide_positions, mesh.positions))
    return short_streams;
  if (mesh.fine_bits > 0 && !get_fine_bits(reader, single, twins, mesh)) return short_streams;
  if (normals && !get_differences(reader, *guesses, {}, false, mesh.normals)) return short_streams;
  if (texcoords && !get_differences(reader, *guesses, {}, wide_texcoords, mesh.texcoords)) return short_streams;
  if (colors) PROMENADE_TRY(get_colors(reader, single, mesh.colors));
  if (!reader.ok() || reader.remaining() != 0)
    return Error{fmt::format("mesh: {} bytes follow the vertices", reader.remaining())};
  return Done{};
}

}  // namespace promenade
