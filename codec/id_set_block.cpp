// The decisions of encoder and decoder are one walk over the forest, written once for both: a Coder either tells which
// way it goes or is told. What decoding takes is mostly branches that nobody can predict, so that there is one a
// decision at most, and none where nothing but a value depends on it; and all that changes with every decision is in
// registers, which takes a loop instead of recursion, and everything inlined.
#include "codec/id_set_block.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cstring>
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
  /// In a subtree of which the reference holds some: is anything different there? By how large it is, by what became
  /// of the sibling before.
  std::array<std::array<BitModel, 4>, kSizeClasses> inside_changed;
  std::array<std::array<BitModel, 4>, 2> inside_to;  ///< to what: still inside? else: the root?
  /// Of which it holds the root (1), or nothing (0).
  std::array<std::array<BitModel, 4>, 2> plain_changed;
  std::array<std::array<BitModel, 4>, 2> leaf_changed;
  std::array<std::array<BitModel, 4>, 2> plain_to_inside;
  /// Below a node that has just given way to its descendants: by what was there, the sibling before.
  std::array<std::array<BitModel, 4>, 2> fresh_root;
  std::array<std::array<BitModel, 4>, 2> fresh_leaf;
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
  Telling(const IdForest& forest, RangeEncoder& encoder) : forest_(&forest), encoder_(&encoder) {}
  void begin(std::span<const uint32_t> set) { at_ = set.data(), last_ = at_ + set.size(); }

  State state_of(uint32_t node) const {
    if (at_ == last_ || *at_ >= forest_->subtree_end[node]) return kNothing;
    return *at_ == node ? kRoot : kInside;
  }
  /// Whether the set is unlike the reference's ids below end.
  uint32_t differs(const uint32_t* ref, const uint32_t* ref_last, uint32_t end) const {
    return std::equal(at_, skip_below(at_, last_, end), ref, skip_below(ref, ref_last, end)) ? 0 : 1;
  }
  uint32_t decide(BitModel& model, uint32_t bit) {
    encoder_->put(model, bit);
    return bit;
  }
  uint32_t decide_value(BitModel& model, uint32_t bit) { return decide(model, bit); }
  bool copy_below(const uint32_t*& ref, const uint32_t* ref_last, uint32_t end) {
    const uint32_t* begin = ref;
    ref = skip_below(ref, ref_last, end);
    at_ += ref - begin;
    return true;
  }
  bool copy_all(std::span<const uint32_t> reference) {
    at_ += reference.size();
    return true;
  }
  bool add(uint32_t) { return add_if(1, 0); }
  bool add_if(uint32_t held, uint32_t) {
    at_ += held;
    return true;
  }

 private:
  const IdForest* forest_;
  RangeEncoder* encoder_;
  const uint32_t* at_ = nullptr;
  const uint32_t* last_ = nullptr;
};

/// Reads the decisions and makes the set.
class Hearing {
 public:
  Hearing(std::span<const std::byte> bytes, std::span<uint32_t> ids)
      : decoder_(bytes), at_(ids.data()), last_(at_ + ids.size()) {}

  [[gnu::always_inline]] State state_of(uint32_t) const { return kNothing; }
  [[gnu::always_inline]] uint32_t differs(const uint32_t*, const uint32_t*, uint32_t) const { return 0; }
  [[gnu::always_inline]] uint32_t decide(BitModel& model, uint32_t) { return decoder_.get(model); }
  [[gnu::always_inline]] uint32_t decide_value(BitModel& model, uint32_t) { return decoder_.get_value(model); }
  /// Several ids at a time, with what may stand behind them and is overwritten later.
  [[gnu::always_inline]] bool copy_below(const uint32_t*& ref, const uint32_t* ref_last, uint32_t end) {
    constexpr int kAtOnce = 8;
    while (ref_last - ref >= kAtOnce && last_ - at_ >= kAtOnce) {
      int below = 0;
      for (int i = 0; i < kAtOnce; ++i) below += ref[i] < end ? 1 : 0;
      std::memcpy(at_, ref, kAtOnce * sizeof(uint32_t));
      at_ += below, ref += below;
      if (below != kAtOnce) return true;
    }
    for (; ref != ref_last && *ref < end; ++ref)
      if (!add(*ref)) return false;
    return true;
  }
  [[gnu::always_inline]] bool copy_all(std::span<const uint32_t> reference) {
    if (reference.size() > static_cast<size_t>(last_ - at_)) return false;
    at_ = std::copy(reference.begin(), reference.end(), at_);
    return true;
  }
  [[gnu::always_inline]] bool add(uint32_t id) { return add_if(1, id); }
  /// held: 1 or 0. Without a branch that nobody can predict.
  [[gnu::always_inline]] bool add_if(uint32_t held, uint32_t id) {
    if (at_ == last_) return held == 0;
    *at_ = id;
    at_ += held;
    return true;
  }
  const uint32_t* at() const { return at_; }
  bool broken() const { return decoder_.overrun(); }

 private:
  RangeDecoder decoder_;
  uint32_t* at_;
  uint32_t* last_;
};

/// Families whose siblings are not all done: the way from a root down.
struct OpenFamily {
  uint32_t end;     ///< of the siblings
  uint32_t before;  ///< what the next of them sees of the one that is under way
};

/// The walk that tells a set from its reference.
template <class Coder>
class Walk {
 public:
  Walk(const IdForest& forest, Models& models)
      : end_(forest.subtree_end.data()), size_(forest.size()), models_(models) {}

  /// False: there is no room for the set.
  bool set_from(std::span<const uint32_t> reference, bool same, Coder& shared) {
    Coder coder = shared;  // a local one, whose address nobody has: it stays in registers
    const uint32_t *ref = reference.data(), *const ref_last = ref + reference.size();
    bool room = true;
    if (coder.decide(models_.equal, same ? 0 : 1) == 0)
      room = coder.copy_all(reference);
    else
      room = changed_families(ref, ref_last, coder);
    shared = coder;
    return room;
  }

 private:
  /// From the roots on: siblings of whose subtrees the set and the reference hold different ids.
  [[gnu::always_inline]] bool changed_families(const uint32_t* ref, const uint32_t* const ref_last, Coder& coder) {
    uint32_t node = 0, family_end = size_, before = kNoSibling;
    size_t depth = 0;
    while (true) {
      while (node == family_end) {
        if (depth == 0) return true;
        family_end = open_[--depth].end, before = open_[depth].before;
      }
      const uint32_t end = end_[node], next = ref == ref_last ? size_ : *ref;
      const uint32_t has = next == node ? 1 : 0;
      if (end == node + 1) {  // a leaf
        ref += has;
        before = coder.decide_value(models_.leaf_changed[has][before], (coder.state_of(node) == kRoot ? 1 : 0) ^ has);
        if (!coder.add_if(has ^ before, node)) return false;
        node = end;
        continue;
      }
      if (next > node && next < end) {  // the reference holds descendants of the node
        BitModel& model = models_.inside_changed[size_class(end - node)][before];
        if (coder.decide(model, coder.differs(ref, ref_last, end)) == 0) {
          before = 0;
          if (!coder.copy_below(ref, ref_last, end)) return false;
          node = end;
          continue;
        }
        const State to = coder.state_of(node);
        if (coder.decide(models_.inside_to[0][before], to == kInside ? 0 : 1) == 0) {
          open_[depth++] = {family_end, 1};
          family_end = end, before = kNoSibling;
          ++node;
          continue;
        }
        ref = skip_below(ref, ref_last, end);
        const bool root = coder.decide(models_.inside_to[1][before], to == kRoot ? 0 : 1) == 0;
        before = 2;
        if (root && !coder.add(node)) return false;
        node = end;
        continue;
      }
      // It holds the node itself, or nothing of its subtree.
      ref += has;
      const State to = coder.state_of(node), from = has != 0 ? kRoot : kNothing;
      if (coder.decide(models_.plain_changed[has][before], to == from ? 0 : 1) == 0) {
        before = 0;
        if (has != 0 && !coder.add(node)) return false;
      } else if (coder.decide(models_.plain_to_inside[has][before], to == kInside ? 1 : 0) != 0) {
        before = 2;
        if (!fresh_families(node + 1, end, has, depth, coder)) return false;
      } else {
        before = 1;
        if (has == 0 && !coder.add(node)) return false;
      }
      node = end;
    }
  }

  /// Below a node of which the reference held the node (has 1) or nothing.
  [[gnu::always_inline]] bool fresh_families(uint32_t node, uint32_t family_end, uint32_t has, const size_t from_depth,
                                             Coder& coder) {
    uint32_t before = kNoSibling;
    size_t depth = from_depth;
    while (true) {
      while (node == family_end) {
        if (depth == from_depth) return true;
        family_end = open_[--depth].end, before = open_[depth].before;
      }
      const uint32_t end = end_[node];
      const State to = coder.state_of(node);
      if (end == node + 1) {
        before = coder.decide_value(models_.fresh_leaf[has][before], to == kRoot ? 1 : 0);
        if (!coder.add_if(before, node)) return false;
        node = end;
        continue;
      }
      if (coder.decide(models_.fresh_root[has][before], to == kRoot ? 0 : 1) == 0) {
        before = kRoot;
        if (!coder.add(node)) return false;
        node = end;
      } else if (coder.decide(models_.fresh_inside[has][before], to == kInside ? 1 : 0) != 0) {
        open_[depth++] = {family_end, kInside};
        family_end = end, before = kNoSibling;
        ++node;
      } else {
        before = kNothing;
        node = end;
      }
    }
  }

  const uint32_t* end_;
  uint32_t size_;
  Models& models_;
  std::array<OpenFamily, kMaxForestDepth> open_{};  // a forest is no deeper
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
  Walk<Telling> walk(forest, models);
  for (size_t i = 0; i < sets.ends.size(); ++i) {
    const std::span<const uint32_t> set = sets.set(i);
    assert(is_antichain(forest, set));
    const uint32_t back = choose_reference(sets, i);
    const std::span<const uint32_t> reference = back == 0 ? std::span<const uint32_t>() : sets.set(i - back);
    code_reference(models, teller, back);
    teller.begin(set);
    walk.set_from(reference, std::equal(set.begin(), set.end(), reference.begin(), reference.end()), teller);
  }
  encoder.finish();
  return bytes;
}

Status decode_block(const IdForest& forest, std::span<const std::byte> bytes, std::span<uint32_t> ids,
                    std::span<uint32_t> ends) {
  assert(ends.size() <= kMaxSetsInBlock);
  Models models;
  Hearing hearer(bytes, ids);
  Walk<Hearing> walk(forest, models);
  for (size_t i = 0; i < ends.size(); ++i) {
    const uint32_t back = code_reference(models, hearer, 0);
    if (back > i) return Error{fmt::format("set {}: differs from the set {} before it", i, back)};
    std::span<const uint32_t> reference;
    if (back != 0) {
      const size_t begin = back == i ? 0 : ends[i - back - 1];
      reference = ids.subspan(begin, ends[i - back] - begin);
    }
    if (!walk.set_from(reference, false, hearer))
      return Error{fmt::format("set {}: more than {} ids in all", i, ids.size())};
    if (hearer.broken()) return Error{fmt::format("set {}: is cut off", i)};
    ends[i] = static_cast<uint32_t>(hearer.at() - ids.data());
  }
  return Done{};
}

}  // namespace promenade
