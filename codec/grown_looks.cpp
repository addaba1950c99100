#include "codec/grown_looks.h"

#include <algorithm>
#include <bit>

#include "codec/angle_normals.h"
#include "codec/grown_axis.h"

namespace promenade {
namespace {

constexpr uint32_t kNone = VertexKin::kNone;

// Of a normal: what the triangles around let expect; as the twin's; as the likely vertex'; as the vertex' before; told;
// none.
constexpr uint8_t kForetold = 0, kTwin = 1, kLikely = 2, kBefore = 3, kTold = 4, kNoNormalKind = 5;

/// The vertex that one is likely to look like; kNone: there is none.
uint32_t like_of(const VertexKin& kin) { return kin.guess.known == 0 ? kNone : kin.guess.a; }

/// The vertex that a normal of this kind is taken from; kNone: none.
uint32_t normal_source(const VertexKin& kin, uint32_t vertex, uint8_t kind) {
  if (kind == kTwin) return kin.twin;
  if (kind == kLikely) return like_of(kin);
  return kind == kBefore && vertex > 0 ? vertex - 1 : kNone;
}

uint8_t normal_kind(const std::vector<glm::i16vec2>& normals, const VertexKin& kin, uint32_t v,
                    const glm::i16vec2& foretold) {
  if (normals[v] == kNoNormal) return kNoNormalKind;
  if (normals[v] == foretold) return kForetold;
  for (uint8_t kind = kTwin; kind < kTold; ++kind)
    if (const uint32_t source = normal_source(kin, v, kind); source != kNone && normals[source] == normals[v])
      return kind;
  return kTold;
}

uint32_t difference(int16_t a, int16_t b) { return static_cast<uint32_t>(a) - static_cast<uint32_t>(b); }

/// Two numbers told as differences, the second's width by the first's.
struct PairModels {
  static constexpr size_t kContexts = 8;
  NibbleModel first;
  std::array<NibbleModel, kContexts> second;
};

template <class Side>
[[gnu::always_inline]] inline std::array<uint32_t, 2> tell_pair(Side& side, PairModels& models,
                                                                const std::array<uint32_t, 2>& folded_numbers) {
  const uint32_t first = tell_number(side, models.first, folded_numbers[0]);
  const size_t width = std::min<size_t>(static_cast<size_t>(std::bit_width(first)), PairModels::kContexts - 1);
  return {first, tell_number(side, models.second[width], folded_numbers[1])};
}

/// Red above all, so that colours in order have small steps of red.
uint32_t packed(const glm::u8vec4& c) {
  return uint32_t(c.r) << 24U | uint32_t(c.g) << 16U | uint32_t(c.b) << 8U | uint32_t(c.a);
}
glm::u8vec4 unpacked(uint32_t c) { return {c >> 24U, (c >> 16U) & 0xffU, (c >> 8U) & 0xffU, c & 0xffU}; }

std::vector<uint32_t> palette_of(const std::vector<glm::u8vec4>& colors) {
  std::vector<uint32_t> palette;
  palette.reserve(colors.size());
  for (const glm::u8vec4& c : colors) palette.push_back(packed(c));
  std::sort(palette.begin(), palette.end());
  palette.erase(std::unique(palette.begin(), palette.end()), palette.end());
  return palette;
}

/// The different colours, in order, each as its components' differences from the one before.
template <class Side>
[[gnu::always_inline]] inline bool tell_palette(Side& side, size_t vertices, std::vector<uint32_t>& palette) {
  const uint32_t count = side.tell_bits(32, static_cast<uint32_t>(palette.size()));
  if (count > vertices) return false;
  palette.resize(count);
  std::array<NibbleModel, 4> models;
  uint32_t before = 0;
  for (uint32_t& color : palette) {
    uint32_t told = 0;
    for (unsigned i = 0; i < 4; ++i) {
      const unsigned low = 24 - 8 * i;
      const auto step = static_cast<int8_t>((color >> low) - (before >> low));
      const uint32_t number = tell_number(
          side, models[i], i == 0 ? static_cast<uint8_t>(step) : folded(static_cast<uint32_t>(int(step)), true));
      told |= (((before >> low) + (i == 0 ? number : unfolded(number))) & 0xffU) << low;
    }
    before = color = told;
    if (side.is_broken()) return false;
  }
  return true;
}

/// Which of four vertices, the first the lowest bit, have twins.
uint32_t twins_from(uint32_t first, const std::vector<VertexKin>& kin) {
  uint32_t twins = 0;
  for (uint32_t i = 0; i < 4 && first + i < kin.size(); ++i) twins |= kin[first + i].twin != kNone ? 1U << i : 0U;
  return twins;
}

/// Which of four vertices, the first the lowest bit, are not coloured like their likely vertex.
uint32_t others_from(uint32_t first, const std::vector<VertexKin>& kin, const std::vector<glm::u8vec4>& colors) {
  uint32_t others = 0;
  for (uint32_t i = 0; i < 4 && first + i < kin.size(); ++i) {
    const uint32_t like = like_of(kin[first + i]);
    others |= like == kNone || colors[first + i] != colors[like] ? 1U << i : 0U;
  }
  return others;
}

/// Of all vertices, in order; a PutSide's are given. False: there is none like that.
template <class Side>
bool tell_normal_kinds(Side& given, const std::vector<VertexKin>& kin, std::vector<uint8_t>& kinds) {
  AtHand<Side> hand(given);
  Side& side = hand.get();
  std::array<NibbleModel, 16> none_models;                // which of four vertices have none, by which of the last four
  std::array<std::array<NibbleModel, 3>, 2> kind_models;  // by whether there is a twin, and what the likely vertex has
  const auto count = static_cast<uint32_t>(kin.size());
  uint32_t without = 0;
  for (uint32_t first = 0; first < count; first += 4) {
    const uint32_t last = std::min(first + 4, count);
    uint32_t wanted = 0;
    if constexpr (Side::kPuts)
      for (uint32_t v = first; v < last; ++v) wanted |= kinds[v] == kNoNormalKind ? 1U << (v - first) : 0U;
    without = side.tell(none_models[without], wanted);
    for (uint32_t v = first; v < last; ++v) {
      if ((without >> (v - first) & 1U) != 0) {
        kinds[v] = kNoNormalKind;
        continue;
      }
      const uint32_t like = like_of(kin[v]);
      const size_t likely = like == kNone ? 0 : kinds[like] == kNoNormalKind ? 1 : 2;
      kinds[v] = static_cast<uint8_t>(side.tell(kind_models[kin[v].twin != kNone ? 1 : 0][likely], kinds[v]));
      if (kinds[v] > kTold) return false;
    }
    if (side.is_broken()) return false;
  }
  return true;
}

/// What the triangles around let expect of those vertices whose normal is of that kind, or told.
std::vector<glm::i16vec2> foretold_normals(const QuantizedMesh& mesh, const std::vector<uint8_t>& kinds) {
  if (!mesh.on_grid) return std::vector<glm::i16vec2>(kinds.size());  // bits of floats have no crosses
  std::vector<uint8_t> is_wanted(kinds.size());
  for (size_t v = 0; v < kinds.size(); ++v) is_wanted[v] = kinds[v] == kForetold || kinds[v] == kTold ? 1 : 0;
  return normals_by_angle(mesh, is_wanted);
}

}  // namespace

template <class Side>
bool tell_normals(Side& given, const std::vector<VertexKin>& kin, QuantizedMesh& mesh) {
  std::vector<uint8_t> kinds(kin.size(), kTold);
  std::vector<glm::i16vec2> foretold;
  if constexpr (Side::kPuts) {
    for (uint32_t v = 0; v < kinds.size(); ++v)
      if (mesh.normals[v] == kNoNormal) kinds[v] = kNoNormalKind;
    foretold = foretold_normals(mesh, kinds);
    for (uint32_t v = 0; v < kinds.size(); ++v) kinds[v] = normal_kind(mesh.normals, kin[v], v, foretold[v]);
  }
  if (!tell_normal_kinds(given, kin, kinds)) return false;
  if constexpr (!Side::kPuts) foretold = foretold_normals(mesh, kinds);
  AtHand<Side> hand(given);
  Side& side = hand.get();
  PairModels models;
  mesh.normals.resize(kinds.size());
  for (uint32_t v = 0; v < kinds.size(); ++v) {
    glm::i16vec2& normal = mesh.normals[v];
    if (kinds[v] == kNoNormalKind) {
      normal = kNoNormal;
    } else if (kinds[v] == kForetold) {
      normal = foretold[v];
    } else if (kinds[v] == kTold) {
      const glm::i16vec2 from = foretold[v];
      const auto told = tell_pair(
          side, models, {folded(difference(normal.x, from.x), false), folded(difference(normal.y, from.y), false)});
      for (int i = 0; i < 2; ++i)
        normal[i] = static_cast<int16_t>((static_cast<uint32_t>(from[i]) + unfolded(told[size_t(i)])) & 0xffffU);
      if (side.is_broken()) return false;
    } else {
      const uint32_t source = normal_source(kin[v], v, kinds[v]);
      if (source == kNone) return false;
      normal = mesh.normals[source];
    }
  }
  return true;
}

template <class Side>
bool tell_texcoords(Side& given, const std::vector<VertexKin>& kin, QuantizedMesh& mesh) {
  AtHand<Side> hand(given);
  Side& side = hand.get();
  std::vector<glm::u32vec2>& values = mesh.texcoords;
  values.resize(kin.size());
  std::array<AxisTeller, 2> axes;
  for (uint32_t v = 0; v < kin.size() && !side.is_broken(); ++v) {
    const Guess& guess = kin[v].guess;
    const uint32_t family = std::min<uint32_t>(guess.known, 2);
    const auto at = [&](uint32_t vertex) { return vertex < v ? values[vertex] : glm::u32vec2(0); };
    const glm::u32vec2 a = at(guess.known == 0 ? v - 1 : guess.a), b = at(family == 2 ? guess.b : v - 1),
                       c = at(family == 2 ? guess.c : v - 2), expected = family == 2 ? a + b - c : a;
    const LikelyValues likely{{{{expected.x, expected.y}, {a.x, a.y}, {b.x, b.y}, {c.x, c.y}}}};
    uint32_t context = 0;
    glm::u32vec2 told{};
    for (int i = 0; i < 2; ++i) {
      AxisTeller& axis = axes[size_t(i)];
      const uint32_t wanted = Side::kPuts ? values[v][i] : 0;
      const uint32_t kind = axis.tell_kind(side, family, context, likely, size_t(i), 0, wanted);
      told[i] = AxisTeller::is_off(kind) ? expected[i] + axis.tell_offset(side, kind, expected[i], 0, wanted)
                                         : likely.values[kind][size_t(i)];
      context = AxisTeller::context_after(context, kind);
    }
    values[v] = told;
  }
  return true;
}

template <class Side>
bool tell_colors(Side& given, const std::vector<VertexKin>& kin, QuantizedMesh& mesh) {
  AtHand<Side> hand(given);
  Side& side = hand.get();
  constexpr uint32_t kFarther = NibbleModel::kSymbols - 1;
  std::vector<uint32_t> palette;
  if constexpr (Side::kPuts) palette = palette_of(mesh.colors);
  if (!tell_palette(side, kin.size(), palette)) return false;
  const auto colors = static_cast<uint32_t>(palette.size());
  mesh.colors.resize(kin.size());
  std::array<NibbleModel, 16> other_models;  // of four vertices, by which of them have twins
  std::array<NibbleModel, 2> rank_models;    // by whether there is a twin
  Recent recent;                             // places in the palette
  uint32_t others = 0;                       // which of four vertices do not look like their likely one
  for (uint32_t v = 0; v < kin.size() && !side.is_broken(); ++v) {
    if (v % 4 == 0)
      others = side.tell(other_models[twins_from(v, kin)], Side::kPuts ? others_from(v, kin, mesh.colors) : 0);
    if ((others >> (v % 4) & 1U) == 0) {
      const uint32_t like = like_of(kin[v]);
      if (like == kNone) return false;
      mesh.colors[v] = mesh.colors[like];
      continue;
    }
    const size_t has_twin = kin[v].twin != kNone ? 1 : 0;
    uint32_t place = 0, rank = 0;
    if constexpr (Side::kPuts) {
      place = static_cast<uint32_t>(std::lower_bound(palette.begin(), palette.end(), packed(mesh.colors[v])) -
                                    palette.begin());
      rank = std::min(recent.rank_of(place), kFarther);
    }
    rank = side.tell(rank_models[has_twin], rank);
    if (rank == kFarther) {
      if (colors == 0) return false;
      place = tell_one_of(side, colors, place);
      if (place >= colors) return false;
      const uint32_t known = recent.rank_of(place);
      known == Recent::kMost ? recent.add(place) : recent.use(known);
    } else {
      place = recent.at(rank);
      recent.use(rank);
      if (place >= colors) return false;
    }
    mesh.colors[v] = unpacked(palette[place]);
  }
  return true;
}

template bool tell_normals(PutSide&, const std::vector<VertexKin>&, QuantizedMesh&);
template bool tell_normals(GetSide&, const std::vector<VertexKin>&, QuantizedMesh&);
template bool tell_texcoords(PutSide&, const std::vector<VertexKin>&, QuantizedMesh&);
template bool tell_texcoords(GetSide&, const std::vector<VertexKin>&, QuantizedMesh&);
template bool tell_colors(PutSide&, const std::vector<VertexKin>&, QuantizedMesh&);
template bool tell_colors(GetSide&, const std::vector<VertexKin>&, QuantizedMesh&);

}  // namespace promenade
