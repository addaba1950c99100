#pragma once
// Places of a growing mesh, each by those known near it: most coordinates of what people build equal one of theirs, or
// lie as far from where they are expected as others did, and whole parts repeat. FORMAT.md says how.

#include <emmintrin.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <glm/vec3.hpp>
#include <utility>
#include <vector>

#include "codec/told_number.h"
#include "codec/vertex_guesses.h"

namespace promenade {

/// The latest different numbers, the last one first. What is asked for again moves to the front.
class Recent {
 public:
  static constexpr uint32_t kMost = NibbleModel::kSymbols, kNone = 0xffffffffU;
  uint32_t rank_of(uint32_t number) const {
    const __m128i wanted = _mm_set1_epi32(static_cast<int>(number));
    const auto like = [&](size_t i) {
      return _mm_cmpeq_epi32(_mm_load_si128(reinterpret_cast<const __m128i*>(numbers_.data()) + i), wanted);
    };
    const __m128i all = _mm_packs_epi16(_mm_packs_epi32(like(0), like(1)), _mm_packs_epi32(like(2), like(3)));
    const auto rank =
        static_cast<uint32_t>(std::countr_zero(static_cast<uint32_t>(_mm_movemask_epi8(all)) | 1U << kMost));
    return rank < count_ ? rank : kNone;
  }
  uint32_t count() const { return count_; }
  /// rank: below kMost; 0 beyond count().
  uint32_t at(uint32_t rank) const { return numbers_[rank]; }
  void use(uint32_t rank) {
    const uint32_t number = numbers_[rank];
    for (; rank > 0; --rank) numbers_[rank] = numbers_[rank - 1];
    numbers_[0] = number;
  }
  void add(uint32_t number) {
    if (count_ < kMost) ++count_;
    numbers_[count_ - 1] = number;
    use(count_ - 1);
  }

 private:
  alignas(16) std::array<uint32_t, kMost> numbers_{};
  uint32_t count_ = 0;
};

/// What a new place is next to.
struct PlaceKin {
  uint8_t known = 0;  ///< 0: nothing but the places before; 1: a; 3: the triangle beyond whose edge a b it lies
  uint32_t a = 0, b = 0, c = 0;  ///< places
};

template <class Side>
class PlaceCoder {
 public:
  /// most: about how many there will be. fine_bits: places not told to be finer have none of these set.
  PlaceCoder(Side& side, bool on_grid, uint32_t fine_bits, size_t most)
      : side_(side),
        on_grid_(on_grid),
        fine_bits_(fine_bits),
        table_bits_(static_cast<unsigned>(std::clamp(int(std::bit_width(most)), kLeastTableBits, kMostTableBits))) {
    for (auto& table : tables_) table.assign(size_t(1) << table_bits_, kNone);
  }
  /// The next place. wanted: where, for a PutSide. False: it is like one that is not there.
  bool add(PlaceKin kin, const glm::u32vec3& wanted);
  const std::vector<glm::u32vec3>& places() const { return places_; }
  size_t count() const { return places_.size(); }

 private:
  static constexpr uint32_t kNone = 0xffffffffU;
  static constexpr int kLeastTableBits = 6, kMostTableBits = 16;
  // Of a component: as expected; as one of three likely places; as far off as another was; as another; told.
  static constexpr uint32_t kExpected = 0, kLikelies = 3, kSameOffset = 1 + kLikelies, kSameValue = 5, kTold = 6;
  // What a kind is told by: the kinds of the components before it, offsets and values alike.
  static constexpr uint32_t kKinds = kSameOffset + 1, kKindContexts = 1 + kKinds + kKinds * kKinds;
  static constexpr uint32_t kWidthContexts = 9;

  /// How a component was found: what a twin elsewhere has in common.
  struct Trace {
    uint32_t kind = 0, offset = 0;
    bool operator==(const Trace&) const = default;
  };
  using Traces = std::array<Trace, 3>;
  struct Site {
    uint32_t family = 0;  ///< 0: nothing known, 1: one, 2: a triangle
    bool is_fine = false;
    uint32_t shift = 0;
    /// For each axis what is expected, and what the likely places have there.
    std::array<std::array<uint32_t, 1 + kLikelies>, 3> values{};
    uint32_t likelies = 0;  ///< how many of these there are
  };
  struct AxisModels {
    std::array<std::array<NibbleModel, kKindContexts>, 3> kinds;  ///< by family
    NibbleModel offset_rank, value_rank;
    BitModel sign;
    std::array<NibbleModel, kWidthContexts> widths;  ///< of numbers
    Recent offsets, values;
  };

  Site site_of(const PlaceKin& kin, const glm::u32vec3& wanted);
  Trace trace_of(const Site& site, int axis, uint32_t value) const;
  std::pair<uint32_t, size_t> find_twin(const Site& site);
  static uint32_t size_of(uint32_t offset) { return std::min(offset, 0 - offset); }
  static uint32_t kind_of(const AxisModels& models, const Trace& trace, uint32_t value);
  bool tell_component(const Site& site, int axis, const Trace* same, uint32_t& value, Trace& trace);
  bool tell_off(AxisModels& models, uint32_t kind, uint32_t expected, uint32_t& value);
  void note_off(AxisModels& models, uint32_t kind, uint32_t offset, uint32_t value);
  void remember(const Traces& traces);

  Side& side_;
  bool on_grid_;
  uint32_t fine_bits_;
  unsigned table_bits_;
  std::vector<glm::u32vec3> places_;
  std::vector<uint8_t> is_fine_;
  std::array<std::array<AxisModels, 3>, 2> axes_;  ///< by fineness
  std::array<BitModel, 12> fine_models_;
  // Places with the same ones before them, by hash: the latest after the same three, after the same one.
  std::array<std::vector<uint32_t>, 2> tables_;
  std::array<size_t, 2> slots_{};
  std::vector<Traces> traces_;
  std::array<uint64_t, 3> before_{};  ///< hashes of the last three places' traces
  std::array<std::array<NibbleModel, 8>, 2> same_models_;
  uint32_t same_before_ = 0;                      ///< which components the last place had in common with its twin
  uint32_t kind_context_ = 0, width_before_ = 0;  ///< of the components before this one
};

template <class Side>
typename PlaceCoder<Side>::Site PlaceCoder<Side>::site_of(const PlaceKin& kin, const glm::u32vec3& wanted) {
  Site site;
  const auto count = static_cast<uint32_t>(places_.size());
  site.family = kin.known == 3 && on_grid_ ? 2 : std::min<uint32_t>(kin.known, 1);  // floats do not continue linearly
  if (fine_bits_ > 0) {
    const uint32_t mask = (1U << fine_bits_) - 1;
    const uint32_t beside = site.family == 0 ? (count > 0 ? is_fine_[count - 1] : 0U)
                                             : is_fine_[kin.a] * 2U + (site.family == 2 ? is_fine_[kin.b] : 0U);
    const bool fine = ((wanted.x | wanted.y | wanted.z) & mask) != 0;
    site.is_fine = side_.tell(fine_models_[site.family * 4 + beside], fine ? 1 : 0) != 0;
    site.shift = site.is_fine ? 0 : fine_bits_;
  }
  std::array<uint32_t, kLikelies> likely{count - 1, count - 2, count - 3};
  if (site.family == 1 && kin.a != likely[0]) likely = {kin.a, likely[0], likely[1]};
  if (site.family == 2) likely = {kin.a, kin.b, kin.c};
  while (site.likelies < kLikelies && likely[site.likelies] < count) ++site.likelies;
  for (uint32_t k = 0; k < site.likelies; ++k)
    for (int i = 0; i < 3; ++i) site.values[size_t(i)][1 + k] = places_[likely[k]][i] >> site.shift;
  for (int i = 0; i < 3; ++i) {
    uint32_t expected = site.likelies > 0 ? places_[likely[0]][i] : 0;
    if (site.family == 2) expected = places_[kin.a][i] + places_[kin.b][i] - places_[kin.c][i];
    site.values[size_t(i)][kExpected] = static_cast<uint32_t>(static_cast<int32_t>(expected) >> site.shift);
  }
  return site;
}

template <class Side>
typename PlaceCoder<Side>::Trace PlaceCoder<Side>::trace_of(const Site& site, int axis, uint32_t value) const {
  const auto& values = site.values[size_t(axis)];
  const uint32_t offset = value - values[kExpected];
  for (uint32_t kind = kExpected; kind <= site.likelies; ++kind)
    if (values[kind] == value) return {kind, 0};
  return {kTold, offset};
}

/// The latest place that came after the same ones as this (kNone: none is known), and by which table.
template <class Side>
std::pair<uint32_t, size_t> PlaceCoder<Side>::find_twin(const Site& site) {
  constexpr uint64_t kMix = 0x9e3779b97f4a7c15ULL;
  uint64_t hash = (site.family * 2 + (site.is_fine ? 1U : 0U) + 1 + before_[0]) * kMix;
  slots_[1] = hash >> (64 - table_bits_);
  hash = ((hash ^ before_[1]) * kMix ^ before_[2]) * kMix;
  slots_[0] = hash >> (64 - table_bits_);
  const uint32_t after_three = tables_[0][slots_[0]];
  if (after_three != kNone) return {after_three, 0};
  return {tables_[1][slots_[1]], 1};
}

template <class Side>
void PlaceCoder<Side>::remember(const Traces& traces) {
  constexpr uint64_t kMix = 0xbf58476d1ce4e5b9ULL;
  const auto index = static_cast<uint32_t>(traces_.size());
  for (size_t i = 0; i < 2; ++i) tables_[i][slots_[i]] = index;
  traces_.push_back(traces);
  uint64_t hash = 1;
  for (const Trace& trace : traces) hash = (hash ^ (uint64_t(trace.kind) << 32U | trace.offset)) * kMix;
  before_ = {hash ^ hash >> 32U, before_[0], before_[1]};
}

/// What a PutSide tells of a component, and both keep of one that a twin tells.
template <class Side>
uint32_t PlaceCoder<Side>::kind_of(const AxisModels& models, const Trace& trace, uint32_t value) {
  if (trace.kind != kTold) return trace.kind;
  const uint32_t offset_rank = models.offsets.rank_of(size_of(trace.offset)), value_rank = models.values.rank_of(value);
  if (offset_rank != Recent::kNone && (value_rank == Recent::kNone || offset_rank <= value_rank + 1))
    return kSameOffset;
  return value_rank != Recent::kNone ? kSameValue : kTold;
}

/// How far a component is off, which is like none near it.
template <class Side>
bool PlaceCoder<Side>::tell_off(AxisModels& models, uint32_t kind, uint32_t expected, uint32_t& value) {
  const uint32_t offset = value - expected;
  if (kind == kSameOffset) {
    const uint32_t rank = side_.tell(models.offset_rank, models.offsets.rank_of(size_of(offset)));
    if (rank >= models.offsets.count()) return false;
    const uint32_t size = models.offsets.at(rank);
    value = side_.tell(models.sign, offset == size ? 0 : 1) == 0 ? expected + size : expected - size;
  } else if (kind == kSameValue) {
    const uint32_t rank = side_.tell(models.value_rank, models.values.rank_of(value));
    if (rank >= models.values.count()) return false;
    value = models.values.at(rank);
  } else {
    const size_t context = width_before_ == 0 ? 0 : std::min<size_t>(1 + width_before_ / 2, kWidthContexts - 1);
    value = expected + unfolded(tell_number(side_, models.widths[context], folded(offset, true) - 1) + 1);
  }
  return true;
}

template <class Side>
void PlaceCoder<Side>::note_off(AxisModels& models, uint32_t kind, uint32_t offset, uint32_t value) {
  const uint32_t size = size_of(offset), value_rank = models.values.rank_of(value);
  if (kind == kSameOffset) models.offsets.use(models.offsets.rank_of(size));
  if (kind == kTold) models.offsets.add(size);
  if (value_rank == Recent::kNone)
    models.values.add(value);
  else
    models.values.use(value_rank);
  width_before_ = std::max(width_before_, static_cast<uint32_t>(std::bit_width(size)));
}

/// same: a twin's, where the component is found as its; else null.
template <class Side>
bool PlaceCoder<Side>::tell_component(const Site& site, int axis, const Trace* same, uint32_t& value, Trace& trace) {
  AxisModels& models = axes_[site.is_fine ? 1 : 0][size_t(axis)];
  const uint32_t expected = site.values[size_t(axis)][kExpected];
  uint32_t kind = kExpected;
  if (same != nullptr) {
    trace = *same;
    kind = trace.kind;
    if (kind == kTold) value = expected + trace.offset, kind = kind_of(models, trace, value);
  } else {
    if constexpr (Side::kPuts) kind = kind_of(models, trace_of(site, axis, value), value);
    kind = side_.tell(models.kinds[site.family][kind_context_], kind);
    if (kind > kTold || (kind >= kSameOffset && !tell_off(models, kind, expected, value))) return false;
    trace = {kind, 0};
    if (kind >= kSameOffset) trace = {kTold, value - expected};
  }
  if (kind >= kSameOffset) {
    note_off(models, kind, trace.offset, value);
  } else {
    if (kind > site.likelies) return false;
    value = site.values[size_t(axis)][kind];
  }
  const uint32_t kept = std::min(kind, kSameOffset);
  kind_context_ = axis == 0 ? 1 + kept : 1 + kKinds + (kind_context_ - 1) * kKinds + kept;
  return true;
}

template <class Side>
bool PlaceCoder<Side>::add(PlaceKin kin, const glm::u32vec3& wanted) {
  const Site site = site_of(kin, wanted);
  const auto [twin, order] = find_twin(site);
  uint32_t same = 0;
  if (twin != kNone) {
    if constexpr (Side::kPuts)
      for (int i = 0; i < 3; ++i)
        same |= trace_of(site, i, wanted[i] >> site.shift) == traces_[twin][size_t(i)] ? 1U << unsigned(i) : 0U;
    same = side_.tell(same_models_[order][same_before_], same) & 7U;
  }
  same_before_ = same;
  kind_context_ = width_before_ = 0;
  Traces traces;
  glm::u32vec3 place{};
  for (int i = 0; i < 3; ++i) {
    uint32_t value = wanted[i] >> site.shift;
    const Trace* like = (same >> unsigned(i) & 1U) != 0 ? &traces_[twin][size_t(i)] : nullptr;
    if (!tell_component(site, i, like, value, traces[size_t(i)])) return false;
    place[i] = value << site.shift;
  }
  places_.push_back(place);
  is_fine_.push_back(site.is_fine ? 1 : 0);
  remember(traces);
  return true;
}

}  // namespace promenade
