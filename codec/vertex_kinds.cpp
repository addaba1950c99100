// The kinds are described in FORMAT.md.
#include "codec/vertex_kinds.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>

#include "codec/byte_planes.h"

namespace promenade {
namespace {

// Of a component: as expected; as one of likely_vertices; told.
constexpr uint32_t kExpected = 0, kLikely = 1, kTold = 4, kComponentKinds = 5;
constexpr uint32_t kPositionKinds = kComponentKinds * kComponentKinds * kComponentKinds;

// Of a normal: none; what the triangles around let expect; as the vertex in the same place; as one of likely_vertices;
// told.
constexpr uint8_t kNone = 0, kForetold = 1, kTwin = 2, kLikelyNormal = 3, kToldNormal = 6;

/// The kinds of three components from the one byte that holds them.
constexpr auto kKindsOfByte = [] {
  std::array<std::array<uint8_t, 3>, kPositionKinds> kinds{};
  for (uint32_t k = 0; k < kPositionKinds; ++k)
    kinds[k] = {static_cast<uint8_t>(k % kComponentKinds), static_cast<uint8_t>(k / kComponentKinds % kComponentKinds),
                static_cast<uint8_t>(k / kComponentKinds / kComponentKinds)};
  return kinds;
}();

uint32_t mask_of(bool wide) { return wide ? 0xffffffffU : 0xffffU; }

/// The sum of the normals of the triangles that have the vertex, by area; modulo 2^64, so that it is the same
/// everywhere. Only of vertices that are wanted (not 0).
std::vector<std::array<uint64_t, 3>> normals_around(const QuantizedMesh& mesh, const std::vector<uint8_t>& is_wanted) {
  std::vector<std::array<uint64_t, 3>> sums(mesh.positions.size());
  for (size_t t = 0; t < mesh.indices.size() / 3; ++t) {
    const uint32_t* v = &mesh.indices[3 * t];
    if ((is_wanted[v[0]] | is_wanted[v[1]] | is_wanted[v[2]]) == 0) continue;
    std::array<uint64_t, 3> p{}, q{};
    for (int i = 0; i < 3; ++i) {
      const uint64_t from = mesh.positions[v[0]][i];
      p[size_t(i)] = mesh.positions[v[1]][i] - from, q[size_t(i)] = mesh.positions[v[2]][i] - from;
    }
    const std::array<uint64_t, 3> cross{p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2],
                                        p[0] * q[1] - p[1] * q[0]};
    for (size_t corner = 0; corner < 3; ++corner)
      for (size_t i = 0; i < 3; ++i) sums[v[corner]][i] += cross[i];
  }
  return sums;
}

/// The same as octahedral_of_normal, in whole numbers; two's complement.
glm::i16vec2 octahedral_of_sum(const std::array<uint64_t, 3>& sum) {
  constexpr int kMostBits = 50;  // so that nothing below overflows
  std::array<uint64_t, 3> size{};
  std::array<bool, 3> negative{};
  for (size_t i = 0; i < 3; ++i) {
    negative[i] = static_cast<int64_t>(sum[i]) < 0;
    size[i] = negative[i] ? 0 - sum[i] : sum[i];
  }
  const int shift = std::max(int(std::bit_width(size[0] | size[1] | size[2])) - kMostBits, 0);
  for (uint64_t& s : size) s >>= static_cast<unsigned>(shift);
  const uint64_t all = size[0] + size[1] + size[2];
  if (all == 0) return {0, 0};
  const uint64_t x = negative[2] ? all - size[1] : size[0], y = negative[2] ? all - size[0] : size[1];
  const auto code = [all](uint64_t part, bool is_negative) {
    const auto rounded = static_cast<int16_t>((512 * part + all) / (2 * all));
    return static_cast<int16_t>(is_negative ? -rounded : rounded);
  };
  return {code(x, negative[0]), code(y, negative[1])};
}

/// Foretells normals of vertices one by one.
class NormalTeller {
 public:
  NormalTeller(const QuantizedMesh& mesh, const std::vector<Guess>& guesses, const std::vector<uint8_t>& is_wanted)
      : mesh_(mesh), guesses_(guesses) {
    if (mesh.on_grid) sums_ = normals_around(mesh, is_wanted);
  }
  /// Bits of floats have no crosses: there, the normal of the corner before.
  glm::i16vec2 foretold(uint32_t v) const {
    if (mesh_.on_grid) return octahedral_of_sum(sums_[v]);
    return guesses_[v].known == 0 ? glm::i16vec2(0) : mesh_.normals[guesses_[v].a];
  }

 private:
  const QuantizedMesh& mesh_;
  const std::vector<Guess>& guesses_;
  std::vector<std::array<uint64_t, 3>> sums_;
};

Error not_there(uint32_t vertex, uint32_t kind) {
  return Error{fmt::format("mesh: vertex {} is of kind {}, like none that is there", vertex, kind)};
}

}  // namespace

void put_positions(const std::vector<glm::u32vec3>& positions, const std::vector<Guess>& guesses,
                   const std::vector<uint32_t>& twins, bool wide, ByteWriter& writer) {
  std::vector<std::byte> kinds_of_all;
  kinds_of_all.reserve(positions.size());
  std::array<std::vector<uint32_t>, 3> told;
  for (uint32_t v = 0; v < positions.size(); ++v) {
    if (twins[v] != 0) continue;
    const std::array<uint32_t, 3> likely = likely_vertices(guesses[v], v);
    uint32_t kinds = 0;
    for (int i = 2; i >= 0; --i) {
      const uint32_t value = positions[v][i], guess = expected(positions, guesses[v], i) & mask_of(wide);
      uint32_t kind = value == guess ? kExpected : kTold;
      for (uint32_t k = 0; k < likely.size() && kind == kTold; ++k)
        if (likely[k] < v && positions[likely[k]][i] == value) kind = kLikely + k;
      if (kind == kTold) told[size_t(i)].push_back(folded(value - guess, wide));
      kinds = kinds * kComponentKinds + kind;
    }
    kinds_of_all.push_back(static_cast<std::byte>(kinds));
  }
  writer.put_bytes(kinds_of_all);
  for (const std::vector<uint32_t>& codes : told) put_planes(codes, wide ? 4 : 2, writer);
}

Status get_positions(ByteReader& reader, const std::vector<Guess>& guesses, const std::vector<uint32_t>& twins,
                     bool wide, std::vector<glm::u32vec3>& positions) {
  const auto twin_count = std::count_if(twins.begin(), twins.end(), [](uint32_t back) { return back != 0; });
  const std::span<const std::byte> kinds = reader.get_bytes(guesses.size() - static_cast<size_t>(twin_count));
  std::array<std::vector<uint32_t>, 3> told;
  std::array<size_t, 3> told_count{};
  for (const std::byte kind : kinds) {
    const auto byte = std::to_integer<uint32_t>(kind);
    if (byte >= kPositionKinds) return Error{fmt::format("mesh: a position of kind {}", byte)};
    for (size_t i = 0; i < 3; ++i) told_count[i] += kKindsOfByte[byte][i] == kTold ? 1U : 0U;
  }
  for (size_t i = 0; i < 3; ++i) {
    told[i].resize(told_count[i]);
    if (!get_planes(reader, wide ? 4 : 2, told[i])) return Error{"mesh: positions reach beyond the end"};
  }
  if (!reader.ok()) return Error{"mesh: positions reach beyond the end"};
  positions.resize(guesses.size());
  size_t at = 0;
  std::array<const uint32_t*, 3> next{told[0].data(), told[1].data(), told[2].data()};
  for (uint32_t v = 0; v < positions.size(); ++v) {
    if (twins[v] != 0) {
      positions[v] = positions[v - twins[v]];
      continue;
    }
    const auto byte = std::to_integer<uint32_t>(kinds[at++]);
    const std::array<uint32_t, 3> likely = likely_vertices(guesses[v], v);
    for (int i = 0; i < 3; ++i) {
      const uint32_t kind = kKindsOfByte[byte][size_t(i)];
      if (kind == kExpected || kind == kTold) {
        const uint32_t beside = kind == kTold ? unfolded(*next[size_t(i)]++) : 0;
        positions[v][i] = (expected(positions, guesses[v], i) + beside) & mask_of(wide);
        continue;
      }
      const uint32_t like = likely[kind - kLikely];
      if (like >= v) return not_there(v, kind);
      positions[v][i] = positions[like][i];
    }
  }
  return Done{};
}

void put_normals(const QuantizedMesh& mesh, const std::vector<Guess>& guesses, const std::vector<uint32_t>& twins,
                 ByteWriter& writer) {
  const std::vector<glm::i16vec2>& normals = mesh.normals;
  std::vector<uint8_t> is_wanted(normals.size());
  for (size_t v = 0; v < normals.size(); ++v) is_wanted[v] = normals[v] != kNoNormal ? 1 : 0;
  const NormalTeller teller(mesh, guesses, is_wanted);
  std::array<std::vector<uint32_t>, 2> told;
  for (uint32_t v = 0; v < normals.size(); ++v) {
    if (is_wanted[v] == 0) {
      writer.put(kNone);
      continue;
    }
    const glm::i16vec2 foretold = teller.foretold(v);
    const std::array<uint32_t, 3> likely = likely_vertices(guesses[v], v);
    uint8_t kind = kToldNormal;
    for (uint8_t k = 3; k-- > 0;)
      if (likely[k] < v && normals[likely[k]] == normals[v]) kind = static_cast<uint8_t>(kLikelyNormal + k);
    if (twins[v] != 0 && normals[v - twins[v]] == normals[v]) kind = kTwin;
    if (foretold == normals[v]) kind = kForetold;
    writer.put(kind);
    for (int i = 0; i < 2 && kind == kToldNormal; ++i)
      told[size_t(i)].push_back(
          folded(static_cast<uint32_t>(normals[v][i]) - static_cast<uint32_t>(foretold[i]), false));
  }
  for (const std::vector<uint32_t>& codes : told) put_planes(codes, 2, writer);
}

Status get_normals(ByteReader& reader, const std::vector<Guess>& guesses, const std::vector<uint32_t>& twins,
                   QuantizedMesh& mesh) {
  const std::span<const std::byte> kinds = reader.get_bytes(guesses.size());
  if (!reader.ok()) return Error{"mesh: normals reach beyond the end"};
  std::vector<uint8_t> is_wanted(guesses.size());
  size_t told_count = 0;
  for (size_t v = 0; v < kinds.size(); ++v) {
    const auto kind = std::to_integer<uint8_t>(kinds[v]);
    if (kind > kToldNormal) return Error{fmt::format("mesh: a normal of kind {}", kind)};
    is_wanted[v] = kind == kForetold || kind == kToldNormal ? 1 : 0;
    told_count += kind == kToldNormal ? 1U : 0U;
  }
  std::array<std::vector<uint32_t>, 2> told{std::vector<uint32_t>(told_count), std::vector<uint32_t>(told_count)};
  for (std::vector<uint32_t>& codes : told)
    if (!get_planes(reader, 2, codes)) return Error{"mesh: normals reach beyond the end"};
  const NormalTeller teller(mesh, guesses, is_wanted);
  mesh.normals.resize(guesses.size());
  size_t at = 0;
  for (uint32_t v = 0; v < mesh.normals.size(); ++v) {
    const auto kind = std::to_integer<uint8_t>(kinds[v]);
    glm::i16vec2& normal = mesh.normals[v];
    if (kind == kNone) {
      normal = kNoNormal;
    } else if (is_wanted[v] != 0) {
      normal = teller.foretold(v);
      if (kind != kToldNormal) continue;
      for (int i = 0; i < 2; ++i)
        normal[i] = static_cast<int16_t>((static_cast<uint32_t>(normal[i]) + unfolded(told[size_t(i)][at])) & 0xffffU);
      ++at;
    } else {
      const uint32_t like = kind == kTwin ? v - twins[v] : likely_vertices(guesses[v], v)[kind - kLikelyNormal];
      if (like >= v) return not_there(v, kind);
      normal = mesh.normals[like];
    }
  }
  return Done{};
}

}  // namespace promenade
