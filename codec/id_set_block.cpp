// The decisions of encoder and decoder are one walk over the forest, written once for both: a Coder either tells which
// way it goes or is told.
#include "codec/id_set_block.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <iterator>

#include "codec/range_coder.h"

namespace promenade {
namespace {

/// What a set holds of a subtree: nothing; its root alone; some of its root's descendants.
using State = uint32_t;
constexpr State kNothing = 0, kRoot = 1, kInside = 2;

constexpr uint32_t kNoSibling = 3;  // the state of the sibling before the first
constexpr size_t kSizeClasses = 8;
constexpr size_t kReferenceBits = 7;

/// Probabilities of all decisions, by what is known when they are taken.
struct Models {
  BitModel equal;                                               ///< a set to its reference
  std::array<BitModel, size_t(1) << kReferenceBits> reference;  ///< how far back it is, a binary tree
  /// In a subtree of which the reference holds some: is anything different there? By how much it holds, by whether
  /// the siblings before were different.
  std::array<std::array<BitModel, 4>, kSizeClasses> inside_changed;
  std::array<std::array<BitModel, 4>, 2> inside_to;  ///< to what: still inside? else: the root?
  /// Of which it holds the root, or nothing.
  std::array<std::array<std::array<BitModel, 2>, 4>, 2> plain_changed;
  std::array<std::array<BitModel, 4>, 2> plain_to_inside;
  /// Below a node that has just given way to its descendants: by what was there, the sibling before, being a leaf.
  std::array<std::array<std::array<BitModel, 2>, 4>, 2> fresh_root;
  std::array<std::array<BitModel, 4>, 2> fresh_inside;
};

size_t size_class(size_t count) { return std::min<size_t>(std::bit_width(count), kSizeClasses) - 1; }

/// The first place at or after `from` whose id is not below `end`.
const uint32_t* skip_below(const uint32_t* from, const uint32_t* last, uint32_t end) {
  size_t step = 1;
  while (static_cast<size_t>(last - from) > step && from[step] < end) from += step, step *= 2;
  return std::lower_bound(from, from + std::min<size_t>(step + 1, static_cast<size_t>(last - from)), end);
}

/// Writes the decisions that turn the reference into the set.
class Telling {
 public:
  Telling(const IdForest& forest, RangeEncoder& encoder) : forest_(forest), encoder_(encoder) {}
  void begin(std::span<const uint32_t> set) { at_ = set.data(), last_ = at_ + set.size(); }

  State state_of(uint32_t node) {
    if (at_ == last_ || *at_ >= forest_.subtree_end[node]) return kNothing;
    return *at_ == node ? kRoot : kInside;
  }
  /// Whether the set is unlike the reference's ids in the node's subtree.
  uint32_t differs(uint32_t node, const uint32_t* ref, const uint32_t* ref_end) {
    const uint32_t* end = skip_below(at_, last_, forest_.subtree_end[node]);
    return std::equal(at_, end, ref, ref_end) ? 0 : 1;
  }
  uint32_t decide(BitModel& model, uint32_t bit) {
    encoder_.put(model, bit);
    return bit;
  }
  bool copy(const uint32_t* first, const uint32_t* last) {
    at_ += last - first;
    return true;
  }
  bool add(uint32_t) {
    ++at_;
    return true;
  }

 private:
  const IdForest& forest_;
  RangeEncoder& encoder_;
  const uint32_t* at_ = nullptr;
  const uint32_t* last_ = nullptr;
};

/// Reads the decisions and makes the set.
class Hearing {
 public:
  Hearing(RangeDecoder& decoder, std::span<uint32_t> ids)
      : decoder_(decoder), at_(ids.data()), last_(at_ + ids.size()) {}

  State state_of(uint32_t) { return kNothing; }
  uint32_t differs(uint32_t, const uint32_t*, const uint32_t*) { return 0; }
  uint32_t decide(BitModel& model, uint32_t) { return decoder_.get(model); }
  bool copy(const uint32_t* first, const uint32_t* last) {
    if (last - first > last_ - at_) return false;
    at_ = std::copy(first, last, at_);
    return true;
  }
  bool add(uint32_t id) {
    if (at_ == last_) return false;
    *at_++ = id;
    return true;
  }
  const uint32_t* at() const { return at_; }
  bool broken() const { return decoder_.overrun(); }

 private:
  RangeDecoder& decoder_;
  uint32_t* at_;
  uint32_t* last_;
};

/// The walk that tells a set from its reference. False from any step: there is no room for the set.
template <class Coder>
class Walk {
 public:
  Walk(const IdForest& forest, Models& models, Coder& coder)
      : end_(forest.subtree_end.data()), size_(forest.size()), models_(models), coder_(coder) {}

  bool set_from(std::span<const uint32_t> reference, bool same) {
    ref_ = reference.data(), ref_last_ = ref_ + reference.size();
    if (coder_.decide(models_.equal, same ? 0 : 1) == 0) return coder_.copy(ref_, ref_last_);
    return changed_family(0, size_);
  }

 private:
  /// Siblings from `node` on, of whose subtrees the set and the reference hold different ids.
  bool changed_family(uint32_t node, uint32_t family_end) {
    uint32_t before = kNoSibling;
    for (; node < family_end; node = end_[node]) {
      const bool inside = ref_ != ref_last_ && *ref_ < end_[node] && *ref_ != node;
      if (!(inside ? inside_child(node, before) : plain_child(node, before))) return false;
    }
    return true;
  }

  /// The reference holds descendants of the node.
  bool inside_child(uint32_t node, uint32_t& before) {
    const uint32_t* ref_end = skip_below(ref_, ref_last_, end_[node]);
    BitModel& model = models_.inside_changed[size_class(static_cast<size_t>(ref_end - ref_))][before];
    if (coder_.decide(model, coder_.differs(node, ref_, ref_end)) == 0) {
      before = 0;
      const uint32_t* begin = ref_;
      ref_ = ref_end;
      return coder_.copy(begin, ref_end);
    }
    const State to = coder_.state_of(node);
    if (coder_.decide(models_.inside_to[0][before], to == kInside ? 0 : 1) == 0) {
      before = 1;
      return changed_family(node + 1, end_[node]);
    }
    ref_ = ref_end;
    const bool root = coder_.decide(models_.inside_to[1][before], to == kRoot ? 0 : 1) == 0;
    before = 2;
    return !root || coder_.add(node);
  }

  /// The reference holds the node itself, or nothing of its subtree.
  bool plain_child(uint32_t node, uint32_t& before) {
    const uint32_t has = ref_ != ref_last_ && *ref_ == node ? 1 : 0;
    ref_ += has;
    const uint32_t leaf = end_[node] == node + 1 ? 1 : 0;
    const State to = coder_.state_of(node), from = has != 0 ? kRoot : kNothing;
    if (coder_.decide(models_.plain_changed[has][before][leaf], to == from ? 0 : 1) == 0) {
      before = 0;
      return has == 0 || coder_.add(node);
    }
    if (leaf == 0 && coder_.decide(models_.plain_to_inside[has][before], to == kInside ? 1 : 0) != 0) {
      before = 2;
      return fresh_family(node + 1, end_[node], has);
    }
    before = 1;
    return has != 0 || coder_.add(node);
  }

  /// Siblings below a node of which the reference held the node (has 1) or nothing.
  bool fresh_family(uint32_t node, uint32_t family_end, uint32_t has) {
    uint32_t before = kNoSibling;
    for (; node < family_end; node = end_[node]) {
      const uint32_t leaf = end_[node] == node + 1 ? 1 : 0;
      const State to = coder_.state_of(node);
      if (coder_.decide(models_.fresh_root[has][before][leaf], to == kRoot ? 0 : 1) == 0) {
        before = kRoot;
        if (!coder_.add(node)) return false;
      } else if (leaf == 0 && coder_.decide(models_.fresh_inside[has][before], to == kInside ? 1 : 0) != 0) {
        before = kInside;
        if (!fresh_family(node + 1, end_[node], has)) return false;
      } else {
        before = kNothing;
      }
    }
    return true;
  }

  const uint32_t* end_;
  uint32_t size_;
  Models& models_;
  Coder& coder_;
  const uint32_t* ref_ = nullptr;
  const uint32_t* ref_last_ = nullptr;
};

/// How far back the reference of a set is: 1 the set before it; 0: it has none.
template <class Coder>
uint32_t code_reference(Models& models, Coder& coder, uint32_t back) {
  uint32_t node = 1;
  for (size_t i = kReferenceBits; i-- > 0;) node = node * 2 + coder.decide(models.reference[node], back >> i & 1U);
  return node - (1U << kReferenceBits);
}

size_t difference_size(std::span<const uint32_t> a, std::span<const uint32_t> b) {
  size_t both = 0;
  for (size_t i = 0, j = 0; i < a.size() && j < b.size();) {
    const uint32_t x = a[i], y = b[j];
    both += x == y ? 1 : 0;
    i += x <= y ? 1 : 0;
    j += y <= x ? 1 : 0;
  }
  return a.size() + b.size() - 2 * both;
}

/// The set before i that differs from it least; the nearest of these. 0: none is nearer than the empty set.
uint32_t choose_reference(const IdSetBlock& sets, size_t i) {
  uint32_t best = 0;
  size_t least = sets.set(i).size();
  for (uint32_t back = 1; back <= i; ++back) {
    const size_t size = difference_size(sets.set(i - back), sets.set(i));
    if (size < least) best = back, least = size;
  }
  return best;
}

}  // namespace

std::vector<std::byte> encode_block(const IdForest& forest, const IdSetBlock& sets) {
  assert(sets.ends.size() <= kMaxSetsInBlock);
  std::vector<std::byte> bytes;
  RangeEncoder encoder(bytes);
  Models models;
  Telling teller(forest, encoder);
  Walk<Telling> walk(forest, models, teller);
  for (size_t i = 0; i < sets.ends.size(); ++i) {
    const std::span<const uint32_t> set = sets.set(i);
    assert(is_antichain(forest, set));
    const uint32_t back = choose_reference(sets, i);
    const std::span<const uint32_t> reference = back == 0 ? std::span<const uint32_t>() : sets.set(i - back);
    code_reference(models, teller, back);
    teller.begin(set);
    walk.set_from(reference, std::equal(set.begin(), set.end(), reference.begin(), reference.end()));
  }
  encoder.finish();
  return bytes;
}

Status decode_block(const IdForest& forest, std::span<const std::byte> bytes, std::span<uint32_t> ids,
                    std::span<uint32_t> ends) {
  assert(ends.size() <= kMaxSetsInBlock);
  RangeDecoder decoder(bytes);
  Models models;
  Hearing hearer(decoder, ids);
  Walk<Hearing> walk(forest, models, hearer);
  for (size_t i = 0; i < ends.size(); ++i) {
    const uint32_t back = code_reference(models, hearer, 0);
    if (back > i) return Error{fmt::format("set {}: differs from the set {} before it", i, back)};
    std::span<const uint32_t> reference;
    if (back != 0) {
      const size_t begin = back == i ? 0 : ends[i - back - 1];
      reference = ids.subspan(begin, ends[i - back] - begin);
    }
    if (!walk.set_from(reference, false)) return Error{fmt::format("set {}: more than {} ids in all", i, ids.size())};
    if (hearer.broken()) return Error{fmt::format("set {}: is cut off", i)};
    ends[i] = static_cast<uint32_t>(hearer.at() - ids.data());
  }
  return Done{};
}

}  // namespace promenade
