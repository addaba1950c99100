#pragma once
// Places of a grown mesh, each by those known near it: most coordinates of what people build equal one of theirs, or
// lie as far from where they are expected as others did, and whole parts repeat. FORMAT.md says how.

#include <emmintrin.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <span>
#include <vector>

#include "codec/grown_axis.h"
#include "codec/grown_kin.h"
#include "codec/told_number.h"

namespace promenade {

/// A place's numbers: x, y, z, and whether it lies beside the grid.
struct alignas(16) Place {
  std::array<uint32_t, 4> at{};
};

template <class Side>
class PlaceTeller {
 public:
  /// most: how many there will be. fine_bits: places that are not told to lie beside the grid have none of these.
  PlaceTeller(Side& side, bool on_grid, uint32_t fine_bits, size_t most)
      : side_(side),
        continues_(on_grid),
        fine_bits_(fine_bits),
        table_bits_(static_cast<unsigned>(std::clamp(int(std::bit_width(most)), kLeastTableBits, kMostTableBits))) {
    for (auto& table : tables_) table.assign(size_t(1) << table_bits_, kNone);
    places_.resize(most + kFirstPlace);
    traces_.resize(most);
  }
  /// All places. wanted: where they are; a PutSide's.
  void tell_all(std::span<const PlaceKin> kin, const std::vector<Place>& wanted);
  /// With kFirstPlace more before the first.
  const std::vector<Place>& places() const { return places_; }

 private:
  static constexpr uint32_t kNone = 0xffffffffU;
  static constexpr uint32_t kAllSame = 7;
  static constexpr int kLeastTableBits = 6, kMostTableBits = 16;

  /// How a place was found: for each component how far it is from a slot, and which.
  struct alignas(16) Trace {
    std::array<uint32_t, 3> offsets{};
    uint32_t slots = 0;  ///< eight bits each, the first component's the lowest
  };
  /// The same, taken apart.
  struct Found {
    std::array<uint32_t, 3> offsets{}, slots{};
  };
  struct Site {
    LikelyValues likely;
    uint32_t family = 0, is_fine = 0, shift = 0;
  };

  void tell(Side& side, const PlaceKin& kin, const Place& wanted);
  Site site_of(Side& side, const PlaceKin& kin, const Place& wanted);
  uint32_t find_twin(const Site& site, size_t& order);
  /// As one: it is soon read so.
  template <class Four>
  static void store(Four* to, uint32_t a, uint32_t b, uint32_t c, uint32_t d) {
    _mm_store_si128(reinterpret_cast<__m128i*>(to), _mm_setr_epi32(int(a), int(b), int(c), int(d)));
  }
  void tell_kinds(Side& side, const Site& site, uint32_t same, const Place& wanted, Found& found,
                  std::array<uint32_t, 3>& kinds);
  void remember(const Found& found);

  Side& side_;
  bool continues_;  ///< whether places continue linearly: bits of floats do not
  uint32_t fine_bits_;
  unsigned table_bits_;
  uint32_t count_ = 0;  ///< of places that were told
  std::vector<Place> places_;
  std::array<std::array<AxisTeller, 3>, 2> axes_;  ///< by fineness
  std::array<BitModel, 12> fine_models_;
  // Places with the same ones before them, by hash: the latest after the same three, after the same one.
  std::array<std::vector<uint32_t>, 2> tables_;
  std::array<size_t, 2> slots_{};
  std::vector<Trace> traces_;
  std::array<uint64_t, 3> before_{};  ///< hashes of the last three places' traces
  std::array<std::array<NibbleModel, 8>, 2> same_models_;
  uint32_t same_before_ = 0;  ///< which components the last place had in common with its twin
};

template <class Side>
[[gnu::always_inline]] inline typename PlaceTeller<Side>::Site PlaceTeller<Side>::site_of(Side& side,
                                                                                          const PlaceKin& kin,
                                                                                          const Place& wanted) {
  const auto at = [this](uint32_t place) {
    return _mm_load_si128(reinterpret_cast<const __m128i*>(places_[place].at.data()));
  };
  const __m128i a = at(kin.a), b = at(kin.b), c = at(kin.c);
  Site site;
  site.family = continues_ ? kin.family : std::min(kin.family, 1U);
  uint32_t mask = ~0U;
  if (fine_bits_ > 0) {
    const uint32_t beside = places_[kin.a].at[3] * 2U + places_[kin.b].at[3];
    const uint32_t fine = (wanted.at[0] | wanted.at[1] | wanted.at[2]) & ((1U << fine_bits_) - 1);
    site.is_fine = side.tell(fine_models_[site.family * 4 + beside], fine != 0 ? 1 : 0);
    site.shift = site.is_fine != 0 ? 0 : fine_bits_;
    mask <<= site.shift;
  }
  const __m128i masks = _mm_set1_epi32(static_cast<int>(mask));
  const __m128i continues = _mm_cmpeq_epi32(_mm_set1_epi32(static_cast<int>(site.family)), _mm_set1_epi32(2));
  const __m128i expected = _mm_add_epi32(a, _mm_and_si128(continues, _mm_sub_epi32(b, c)));
  const auto keep = [&](size_t slot, __m128i values) {
    _mm_store_si128(reinterpret_cast<__m128i*>(site.likely.values[slot].data()), _mm_and_si128(values, masks));
  };
  keep(0, expected), keep(1, a), keep(2, b), keep(3, c);
  return site;
}

/// The latest place that came after the same ones as this (kNone: none is known), and by which table.
template <class Side>
[[gnu::always_inline]] inline uint32_t PlaceTeller<Side>::find_twin(const Site& site, size_t& order) {
  constexpr uint64_t kMix = 0x9e3779b97f4a7c15ULL;
  const uint64_t after_one = (site.family * 2 + site.is_fine + 1 + before_[0]) * kMix;
  const uint64_t after_three = ((after_one ^ before_[1]) * kMix ^ before_[2]) * kMix;
  slots_ = {after_three >> (64 - table_bits_), after_one >> (64 - table_bits_)};
  const uint32_t twin = tables_[0][slots_[0]];
  order = twin != kNone ? 0 : 1;
  return twin != kNone ? twin : tables_[1][slots_[1]];
}

template <class Side>
[[gnu::always_inline]] inline void PlaceTeller<Side>::remember(const Found& found) {
  constexpr uint64_t kMix = 0xbf58476d1ce4e5b9ULL;
  for (size_t i = 0; i < 2; ++i) tables_[i][slots_[i]] = count_;
  const std::array<uint32_t, 3>&offsets = found.offsets, &slots = found.slots;
  store(&traces_[count_], offsets[0], offsets[1], offsets[2], slots[0] | slots[1] << 8U | slots[2] << 16U);
  uint64_t hash = 1;
  for (size_t i = 0; i < 3; ++i) hash = (hash ^ (uint64_t(slots[i]) << 32U | offsets[i])) * kMix;
  before_ = {hash ^ hash >> 32U, before_[0], before_[1]};
}

/// Of the components that are not the same as a twin's.
template <class Side>
[[gnu::always_inline]] inline void PlaceTeller<Side>::tell_kinds(Side& side, const Site& site, uint32_t same,
                                                                 const Place& wanted, Found& found,
                                                                 std::array<uint32_t, 3>& kinds) {
  uint32_t context = 0;
#pragma GCC unroll 3
  for (size_t i = 0; i < 3; ++i) {
    uint32_t kind = found.slots[i] | (found.offsets[i] != 0 ? AxisTeller::kSameOffset : 0U);
    if ((same >> i & 1U) == 0) {
      kinds[i] = kind =
          axes_[site.is_fine][i].tell_kind(side, site.family, context, site.likely, i, site.shift, wanted.at[i]);
      found.slots[i] = AxisTeller::is_off(kind) ? 0 : kind;
      found.offsets[i] = 0;
    }
    context = AxisTeller::context_after(context, kind);
  }
}

template <class Side>
[[gnu::always_inline]] inline void PlaceTeller<Side>::tell(Side& side, const PlaceKin& kin, const Place& wanted) {
  const Site site = site_of(side, kin, wanted);
  size_t order = 0;
  const uint32_t twin = find_twin(site, order);
  Found found;
  uint32_t same = 0;
  if (twin != kNone) {
    const Trace& trace = traces_[twin];
    found = {trace.offsets, {trace.slots & 0xffU, trace.slots >> 8U & 0xffU, trace.slots >> 16U}};
    if constexpr (Side::kPuts)
      for (size_t i = 0; i < 3; ++i) {
        const uint32_t slot = site.likely.slot_of(i, wanted.at[i]) % LikelyValues::kSlots,
                       offset = wanted.at[i] - site.likely.values[slot][i];
        same |= slot == found.slots[i] && offset == found.offsets[i] ? 1U << i : 0U;
      }
    same = side.tell(same_models_[order][same_before_], same) & kAllSame;
  }
  same_before_ = same;
  std::array<uint32_t, 3> kinds{};
  if (same != kAllSame) tell_kinds(side, site, same, wanted, found, kinds);
  std::array<uint32_t, 3> at{};
#pragma GCC unroll 3
  for (size_t i = 0; i < 3; ++i) {
    if (AxisTeller::is_off(kinds[i]))
      found.offsets[i] =
          axes_[site.is_fine][i].tell_offset(side, kinds[i], site.likely.values[0][i], site.shift, wanted.at[i]);
    at[i] = site.likely.values[found.slots[i]][i] + found.offsets[i];
  }
  store(&places_[kFirstPlace + count_], at[0], at[1], at[2], site.is_fine);
  remember(found);
  ++count_;
}

template <class Side>
void PlaceTeller<Side>::tell_all(std::span<const PlaceKin> kin, const std::vector<Place>& wanted) {
  AtHand<Side> hand(side_);
  for (size_t i = 0; i < kin.size(); ++i) tell(hand.get(), kin[i], Side::kPuts ? wanted[i] : Place());
}

}  // namespace promenade
