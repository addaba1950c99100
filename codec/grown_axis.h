#pragma once
// One component of a new place, or of a texture coordinate: mostly it equals that of one near by, or lies as far from
// where it is expected as others did. FORMAT.md says how it is told.

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "codec/recent.h"
#include "codec/told_number.h"
#include "codec/vertex_guesses.h"

namespace promenade {

/// What a component is likely to be: by slot (expected; as one of three near by), by component.
struct alignas(16) LikelyValues {
  static constexpr uint32_t kSlots = 4;
  std::array<std::array<uint32_t, 4>, kSlots> values;
  /// The first slot that holds a value; kSlots: none.
  uint32_t slot_of(size_t component, uint32_t value) const {
    uint32_t slot = 0;
    while (slot < kSlots && values[slot][component] != value) ++slot;
    return slot;
  }
};

/// A component as it is told. One thread.
class AxisTeller {
 public:
  // The kinds: a slot's; as far off as another was; as another was; told, with the number's width from kLeastWidth on
  // among the kinds, or in full.
  static constexpr uint32_t kSameOffset = LikelyValues::kSlots, kSameValue = 5, kTold = 6, kToldInFull = 15;
  /// What a kind is told by: the kinds of up to two components before it, all that are off alike.
  static constexpr uint32_t kContexts = 31;
  static uint32_t context_after(uint32_t context, uint32_t kind) {
    return context * (kSameOffset + 1) + 1 + std::min(kind, kSameOffset);
  }
  static bool is_off(uint32_t kind) { return kind >= kSameOffset; }

  /// family: 0 to 2, for what the component is likely to be. shift: it and the likely ones have none of these bits.
  /// wanted: a PutSide's.
  template <class Side>
  [[gnu::always_inline]] uint32_t tell_kind(Side& side, uint32_t family, uint32_t context, const LikelyValues& likely,
                                            size_t component, uint32_t shift, uint32_t wanted) {
    uint32_t kind = 0;
    if constexpr (Side::kPuts) kind = kind_of(likely, component, shift, wanted);
    return side.tell(kinds_[family][context], kind);
  }
  /// How far off a component is that no slot holds, whose kind was told.
  template <class Side>
  [[gnu::always_inline]] uint32_t tell_offset(Side& side, uint32_t kind, uint32_t expected, uint32_t shift,
                                              uint32_t wanted);

 private:
  static constexpr uint32_t kLeastWidth = 5;  // measured: nine widths from there are seven eighths of all

  static uint32_t size_of(uint32_t offset) { return std::min(offset, 0 - offset); }
  /// An offset is no 0, and a whole number of steps.
  static uint32_t told_of_offset(uint32_t offset, uint32_t shift) {
    return folded(static_cast<uint32_t>(static_cast<int32_t>(offset) >> shift), true) - 1;
  }
  static uint32_t offset_of_told(uint32_t told, uint32_t shift) { return unfolded(told + 1) << shift; }
  uint32_t kind_of(const LikelyValues& likely, size_t component, uint32_t shift, uint32_t value) const;

  std::array<std::array<NibbleModel, kContexts>, 3> kinds_;
  NibbleModel offset_rank_, value_rank_, width_;
  BitModel sign_;
  Recent offsets_, values_;  ///< of what was off: how far, either way, and what it was
};

inline uint32_t AxisTeller::kind_of(const LikelyValues& likely, size_t component, uint32_t shift,
                                    uint32_t value) const {
  if (const uint32_t slot = likely.slot_of(component, value); slot < LikelyValues::kSlots) return slot;
  const uint32_t offset = value - likely.values[0][component];
  const uint32_t offset_rank = offsets_.rank_of(size_of(offset)), value_rank = values_.rank_of(value);
  if (offset_rank < Recent::kMost && offset_rank <= value_rank + 1) return kSameOffset;
  if (value_rank < Recent::kMost) return kSameValue;
  const auto width = static_cast<uint32_t>(std::bit_width(told_of_offset(offset, shift)));
  return width < kLeastWidth || width >= kLeastWidth + kToldInFull - kTold ? kToldInFull : kTold + width - kLeastWidth;
}

template <class Side>
[[gnu::always_inline]] inline uint32_t AxisTeller::tell_offset(Side& side, uint32_t kind, uint32_t expected,
                                                               uint32_t shift, uint32_t wanted) {
  uint32_t offset = wanted - expected;
  if (kind == kSameValue) {
    const uint32_t rank = side.tell(value_rank_, values_.rank_of(wanted) % Recent::kMost);
    offset = values_.at(rank) - expected;
    values_.use(rank);
    return offset;
  }
  if (kind == kSameOffset) {
    const uint32_t rank = side.tell(offset_rank_, offsets_.rank_of(size_of(offset)) % Recent::kMost);
    const uint32_t size = offsets_.at(rank);
    offsets_.use(rank);
    offset = side.tell(sign_, offset == size ? 0 : 1) == 0 ? size : 0 - size;
    const uint32_t value_rank = values_.rank_of(expected + offset);
    value_rank < Recent::kMost ? values_.use(value_rank) : values_.add(expected + offset);
    return offset;
  }
  const uint32_t number = told_of_offset(offset, shift);
  offset = offset_of_told(
      kind == kToldInFull ? tell_number(side, width_, number) : tell_low_bits(side, kind - kTold + kLeastWidth, number),
      shift);
  offsets_.add(size_of(offset));
  values_.add(expected + offset);
  return offset;
}

}  // namespace promenade
