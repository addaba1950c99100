#pragma once
// One description of what is told, for both sides: a PutSide tells it, a GetSide is told. FORMAT.md says how.

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "codec/bit_io.h"
#include "codec/rans_coder.h"
#include "codec/varint.h"

namespace promenade {

/// Every `tell` returns what was told: on this side what it was given, on the other what is read. What is no choice
/// among likely and unlikely ones lies apart, as bits.
class PutSide {
 public:
  static constexpr bool kPuts = true;
  PutSide() : bits_(bit_bytes_) {}
  PutSide(const PutSide&) = delete;
  PutSide& operator=(const PutSide&) = delete;
  template <class Model>
  uint32_t tell(Model& model, uint32_t symbol) {
    choices_.put(model, symbol);
    return symbol;
  }
  /// count: at most 32.
  uint32_t tell_bits(unsigned count, uint32_t value) {
    bits_.put(value, count);
    return value;
  }
  bool is_broken() const { return false; }
  /// How many bytes the bits take, a varint; the bits; the choices.
  std::vector<std::byte> finish() const {
    std::vector<std::byte> bytes;
    put_varint(bytes, static_cast<uint32_t>(bit_bytes_.size()));
    bytes.insert(bytes.end(), bit_bytes_.begin(), bit_bytes_.end());
    const std::vector<std::byte> choices = choices_.finish();
    bytes.insert(bytes.end(), choices.begin(), choices.end());
    return bytes;
  }

 private:
  RansEncoder choices_;
  std::vector<std::byte> bit_bytes_;
  BitWriter bits_;
};

/// What is given to `tell` does not count.
class GetSide {
 public:
  static constexpr bool kPuts = false;
  explicit GetSide(std::span<const std::byte> bytes) : GetSide(bytes, parts_of(bytes)) {}
  template <class Model>
  [[gnu::always_inline]] uint32_t tell(Model& model, uint32_t /*symbol*/) {
    return choices_.get(model);
  }
  [[gnu::always_inline]] uint32_t tell_bits(unsigned count, uint32_t /*value*/) { return bits_.get(count); }
  /// Whether more choices were asked for than there are: a loop need not go on. at_end() knows of bits.
  bool is_broken() const { return choices_.overrun(); }
  bool at_end() const { return choices_.at_end() && bits_.at_padding(); }

 private:
  struct Parts {
    size_t begin = 0, end = 0;  ///< of the bits
  };
  /// No bits, and choices that are no whole ones, where the bytes cannot be divided.
  static Parts parts_of(std::span<const std::byte> bytes) {
    VarintReader reader(bytes);
    uint32_t count = 0;
    if (!reader.get(count) || count > bytes.size() - reader.offset()) return {bytes.size(), bytes.size()};
    return {reader.offset(), reader.offset() + count};
  }
  GetSide(std::span<const std::byte> bytes, Parts parts)
      : choices_(bytes.subspan(parts.end)), bits_(bytes.subspan(parts.begin, parts.end - parts.begin)) {}

  RansDecoderOf<RansWay::without_branches> choices_;
  BitReader bits_;
};

/// A side at hand for a loop: a GetSide's numbers stay in registers meanwhile, as long as its address goes nowhere, and
/// are given back at the end.
template <class Side>
class AtHand {
 public:
  explicit AtHand(Side& side) : side_(side) {}
  Side& get() { return side_; }
  void lay_back() {}
  void take_up() {}

 private:
  Side& side_;
};
template <>
class AtHand<GetSide> {
 public:
  explicit AtHand(GetSide& side) : from_(side), side_(side) {}
  AtHand(const AtHand&) = delete;
  AtHand& operator=(const AtHand&) = delete;
  [[gnu::always_inline]] ~AtHand() { from_ = side_; }
  [[gnu::always_inline]] GetSide& get() { return side_; }
  /// Before and after others use the side itself.
  [[gnu::always_inline]] void lay_back() { from_ = side_; }
  [[gnu::always_inline]] void take_up() { side_ = from_; }

 private:
  GetSide& from_;
  GetSide side_;
};

/// One of many, all as likely. count: at least 1.
template <class Side>
[[gnu::always_inline]] inline uint32_t tell_one_of(Side& side, uint32_t count, uint32_t value) {
  const auto width = static_cast<unsigned>(std::bit_width(count - 1));
  if (width == 0) return 0;
  const auto few = static_cast<uint32_t>((uint64_t(1) << width) - count);  // so many are told by a bit less
  const uint32_t high = side.tell_bits(width - 1, value < few ? value : (value + few) >> 1U);
  if (high < few) return high;
  return (high << 1U | side.tell_bits(1, (value + few) & 1U)) - few;
}

/// A number's bits below its highest, which is known. width: of the number, at most 32.
template <class Side>
[[gnu::always_inline]] inline uint32_t tell_low_bits(Side& side, uint32_t width, uint32_t value) {
  if (width < 2) return width;
  const uint32_t highest = 1U << (width - 1);
  return highest | side.tell_bits(width - 1, value & (highest - 1));
}

/// A number of up to 32 bits: how many it takes, by the model; those below the highest as they are.
template <class Side>
[[gnu::always_inline]] inline uint32_t tell_number(Side& side, NibbleModel& model, uint32_t value) {
  constexpr uint32_t kMore = NibbleModel::kSymbols - 1;
  constexpr unsigned kMoreBits = 5;
  const auto wanted = static_cast<uint32_t>(std::bit_width(value));
  uint32_t width = side.tell(model, std::min(wanted, kMore));
  if (width == kMore) width = std::min(kMore + side.tell_bits(kMoreBits, wanted - std::min(wanted, kMore)), 32U);
  return tell_low_bits(side, width, value);
}

}  // namespace promenade
