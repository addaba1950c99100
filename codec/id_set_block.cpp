// The choices of encoder and decoder are one walk over the forest, written once for both: a Coder either tells which
// way it goes or is told. What decoding takes is mostly branches that nobody can predict, and one choice waiting for
// the one before it. So a choice is about up to four siblings at once and by what is known without looking at them;
// where nothing but values depend on it there is no branch; and what changes with every choice is in registers, which
// takes a loop instead of recursion, and everything inlined.
#include "codec/id_set_block.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cstring>
#include <iterator>

#include "codec/rans_coder.h"

namespace promenade {
namespace {

/// What a set holds of a subtree: nothing; its root alone; some of its root's descendants.
using State = uint32_t;
constexpr State kNothing = 0, kRoot = 1, kInside = 2;

constexpr uint32_t kGroup = 4;  // siblings that one choice is about
constexpr size_t kSizeClasses = 12, kFineSizeClasses = 28;
constexpr size_t kReferenceBits = 7;

/// Of so many nodes, at least one: powers of two.
size_t size_class(uint32_t count) {
  return std::min<size_t>(static_cast<size_t>(std::bit_width(count)), kSizeClasses) - 1;
}

/// The same, where small numbers are told apart.
size_t fine_size_class(uint32_t count) {
  constexpr uint32_t kSmall = 16, kSmallBits = 4;
  const auto bits = static_cast<uint32_t>(std::bit_width(count));
  return count < kSmall ? count : kSmall + std::min(bits - kSmallBits, uint32_t{kFineSizeClasses - kSmall - 1});
}

/// Choices among the subsets of a group of 1 to 4 siblings, by the size of the group: all as likely at first.
template <size_t Others>
using GroupModels = std::array<std::array<NibbleModel, Others>, kGroup>;
template <size_t Others>
constexpr GroupModels<Others> group_models() {
  GroupModels<Others> models;
  for (uint32_t size = 1; size <= kGroup; ++size) models[size - 1].fill(NibbleModel(1U << size));
  return models;
}

/// Chances of all choices, by what is known when they are made.
struct Models {
  BitModel equal;                                               ///< a set to its reference
  std::array<BitModel, size_t(1) << kReferenceBits> reference;  ///< how far back it is, a binary tree
  /// Siblings among which the set and the reference differ. By how many nodes there are in the subtrees of these and of
  /// those behind them: which differ?
  std::array<NibbleModel, kFineSizeClasses> changed;
  /// Of leaves, by which the reference holds: which does the set hold?
  GroupModels<size_t(1) << kGroup> leaves = group_models<size_t(1) << kGroup>();
  /// Where the reference holds some descendants, and not the same: by how large the subtree is, does the set, too? If
  /// not, does it hold the root?
  std::array<BitModel, kSizeClasses> still_inside;
  BitModel inside_to_root;
  /// Where it holds the root (1), or nothing (0): does the set hold descendants?
  std::array<BitModel, 2> to_inside;
  /// Siblings below a node that has just given way to its descendants: by what was there, in which is something?
  GroupModels<2> fresh = group_models<2>();
  GroupModels<2> fresh_leaves = group_models<2>();
  std::array<BitModel, 2> fresh_inside;
};

/// Siblings that are chosen among together.
struct Group {
  std::array<uint32_t, kGroup + 1> starts;  ///< of their subtrees; of the last one the end, too
  uint32_t size;
  uint32_t all() const { return (1U << size) - 1; }
  bool leaves() const { return starts[kGroup] - starts[0] == size; }
};

/// The first place at or after `from` whose id is not below `end`.
const uint32_t* skip_below(const uint32_t* from, const uint32_t* last, uint32_t end) {
  size_t step = 1;
  while (static_cast<size_t>(last - from) > step && from[step] < end) from += step, step *= 2;
  return std::lower_bound(from, from + std::min<size_t>(step + 1, static_cast<size_t>(last - from)), end);
}

/// Writes the choices that turn the reference into the set.
class Telling {
 public:
  explicit Telling(RansEncoder& encoder) : encoder_(&encoder) {}
  void begin(std::span<const uint32_t> set) { at_ = set.data(), last_ = at_ + set.size(); }

  State state_of(uint32_t node, uint32_t end) const {
    if (at_ == last_ || *at_ >= end) return kNothing;
    return *at_ == node ? kRoot : kInside;
  }
  /// Of which siblings the set holds something.
  uint32_t present(const Group& group) const {
    uint32_t present = 0;
    const uint32_t* at = at_;
    for (uint32_t i = 0; i < group.size; ++i) {
      const uint32_t* const next = skip_below(at, last_, group.starts[i + 1]);
      present |= (next != at ? 1U : 0U) << i;
      at = next;
    }
    return present;
  }
  /// In which of them it is unlike the reference.
  uint32_t changed(const Group& group, const uint32_t* ref, const uint32_t* ref_last) const {
    uint32_t changed = 0;
    const uint32_t* at = skip_below(at_, last_, group.starts[0]);
    ref = skip_below(ref, ref_last, group.starts[0]);
    for (uint32_t i = 0; i < group.size; ++i) {
      const uint32_t *const next = skip_below(at, last_, group.starts[i + 1]), *const ref_next = skip_below(
                                                                                   ref, ref_last, group.starts[i + 1]);
      changed |= (std::equal(at, next, ref, ref_next) ? 0U : 1U) << i;
      at = next, ref = ref_next;
    }
    return changed;
  }
  template <class Model>
  uint32_t choose(Model& model, uint32_t choice) {
    encoder_->put(model, choice);
    return choice;
  }
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
  bool add_if(uint32_t held, uint32_t) {
    at_ += held;
    return true;
  }
  bool add_group(uint32_t held, uint32_t) {
    at_ += std::popcount(held);
    return true;
  }

 private:
  RansEncoder* encoder_;
  const uint32_t* at_ = nullptr;
  const uint32_t* last_ = nullptr;
};

/// Reads the choices and makes the set.
class Hearing {
 public:
  Hearing(std::span<const std::byte> bytes, std::span<uint32_t> ids)
      : decoder_(bytes), at_(ids.data()), last_(at_ + ids.size()) {}

  [[gnu::always_inline]] State state_of(uint32_t, uint32_t) const { return kNothing; }
  [[gnu::always_inline]] uint32_t present(const Group&) const { return 0; }
  [[gnu::always_inline]] uint32_t changed(const Group&, const uint32_t*, const uint32_t*) const { return 0; }
  template <class Model>
  [[gnu::always_inline]] uint32_t choose(Model& model, uint32_t) {
    return decoder_.get(model);
  }
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
      if (!add_if(1, *ref)) return false;
    return true;
  }
  [[gnu::always_inline]] bool copy_all(std::span<const uint32_t> reference) {
    if (reference.size() > static_cast<size_t>(last_ - at_)) return false;
    at_ = std::copy(reference.begin(), reference.end(), at_);
    return true;
  }
  /// held: 1 or 0. Without a branch that nobody can predict.
  [[gnu::always_inline]] bool add_if(uint32_t held, uint32_t id) {
    if (at_ == last_) return held == 0;
    *at_ = id;
    at_ += held;
    return true;
  }
  [[gnu::always_inline]] bool add_group(uint32_t held, uint32_t node) {
    if (last_ - at_ < static_cast<std::ptrdiff_t>(kGroup)) {
      for (uint32_t i = 0; i < kGroup; ++i)
        if (!add_if(held >> i & 1U, node + i)) return false;
      return true;
    }
    for (uint32_t i = 0; i < kGroup; ++i) {
      *at_ = node + i;
      at_ += held >> i & 1U;
    }
    return true;
  }
  const uint32_t* at() const { return at_; }
  bool broken() const { return decoder_.overrun(); }

 private:
  RansDecoder decoder_;
  uint32_t* at_;
  uint32_t* last_;
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
    if (coder.choose(models_.equal, same ? 0 : 1) == 0)
      room = coder.copy_all(reference);
    else
      room = changed_families(ref, ref_last, coder);
    shared = coder;
    return room;
  }

 private:
  /// Siblings that are not all done: the way from a root down.
  struct Family {
    uint32_t next, end;  ///< of those in no group yet
    uint32_t left;       ///< which of the group are still to do
    Group group;
  };

  [[gnu::always_inline]] void next_group(Family& family) const {
    Group& group = family.group;
    uint32_t at = family.next, size = 0;
    group.starts[0] = at;
    for (uint32_t i = 1; i <= kGroup; ++i) {  // without a branch: nobody can predict how many there are
      const bool more = at < family.end;
      const uint32_t end = end_[more ? at : 0];
      at = more ? end : at;
      size += more ? 1 : 0;
      group.starts[i] = at;
    }
    group.size = size;
    family.next = at;
  }

  /// Which of `size` leaves from a node on the reference holds, and steps over these.
  [[gnu::always_inline]] static uint32_t take_group(const uint32_t*& ref, const uint32_t* ref_last, uint32_t node,
                                                    uint32_t size) {
    uint32_t held = 0;
    if (ref_last - ref >= static_cast<std::ptrdiff_t>(kGroup)) {
      uint32_t count = 0;
      for (uint32_t i = 0; i < kGroup; ++i) {
        const uint32_t leaf = ref[i] - node, in = leaf < size ? 1 : 0;
        held |= in << (leaf & 31U);
        count += in;
      }
      ref += count;
    } else {
      for (; ref != ref_last && *ref - node < size; ++ref) held |= 1U << (*ref - node);
    }
    return held;
  }

  /// From the roots on: siblings among whose subtrees the set and the reference differ. What is between two differences
  /// is copied when the second one is reached.
  [[gnu::always_inline]] bool changed_families(const uint32_t* ref, const uint32_t* const ref_last, Coder& coder) {
    if (size_ == 0) return true;
    Family* family = open_.data();
    family->next = 0, family->end = size_;
    while (true) {
      const uint32_t nodes = family->end - family->next;  // known at once: a decoder need not wait for the siblings
      next_group(*family);
      const Group& group = family->group;
      if (group.leaves()) {
        const uint32_t node = group.starts[0];
        if (!coder.copy_below(ref, ref_last, node)) return false;
        const uint32_t held = take_group(ref, ref_last, node, group.size);
        const uint32_t holds = coder.choose(models_.leaves[group.size - 1][held], coder.present(group));
        if (!coder.add_group(holds & group.all(), node)) return false;
        family->left = 0;
      } else {
        family->left =
            coder.choose(models_.changed[fine_size_class(nodes)], coder.changed(group, ref, ref_last)) & group.all();
      }
      // On to the next group: of this family, of one below a sibling, or of one above.
      while (true) {
        if (family->left == 0) {
          if (family->next != family->end) break;
          if (family == open_.data()) return coder.copy_below(ref, ref_last, size_);
          --family;
          continue;
        }
        const auto i = static_cast<uint32_t>(std::countr_zero(family->left));
        const uint32_t node = family->group.starts[i], end = family->group.starts[i + 1];
        family->left &= family->left - 1;
        if (!coder.copy_below(ref, ref_last, node)) return false;
        const uint32_t has = ref != ref_last && *ref == node ? 1 : 0;
        if (has == 0 && ref != ref_last && *ref < end) {  // the reference holds descendants of the node
          if (coder.choose(models_.still_inside[size_class(end - node)],
                           coder.state_of(node, end) == kInside ? 0 : 1) == 0) {
            family +=
                (family->left | (family->next ^ family->end)) != 0 ? 1 : 0;  // one that is done is not come back to
            family->next = node + 1, family->end = end;
            break;
          }
          ref = skip_below(ref, ref_last, end);
          if (!coder.add_if(coder.choose(models_.inside_to_root, coder.state_of(node, end) == kRoot ? 1 : 0), node))
            return false;
          continue;
        }
        // It holds the node itself, or nothing of its subtree.
        ref += has;
        if (end != node + 1 &&
            coder.choose(models_.to_inside[has], coder.state_of(node, end) == kInside ? 1 : 0) != 0) {
          if (!fresh_families(family + 1, node + 1, end, has, coder)) return false;
        } else if (!coder.add_if(1 - has, node)) {
          return false;
        }
      }
    }
  }

  /// Below a node of which the reference held the node (has 1) or nothing.
  [[gnu::always_inline]] bool fresh_families(Family* const first, uint32_t begin, uint32_t end, uint32_t has,
                                             Coder& coder) {
    Family* family = first;
    family->next = begin, family->end = end;
    while (true) {
      next_group(*family);
      const Group& group = family->group;
      if (group.leaves()) {
        const uint32_t holds = coder.choose(models_.fresh_leaves[group.size - 1][has], coder.present(group));
        if (!coder.add_group(holds & group.all(), group.starts[0])) return false;
        family->left = 0;
      } else {
        family->left = coder.choose(models_.fresh[group.size - 1][has], coder.present(group)) & group.all();
      }
      while (true) {
        if (family->left == 0) {
          if (family->next != family->end) break;
          if (family == first) return true;
          --family;
          continue;
        }
        const auto i = static_cast<uint32_t>(std::countr_zero(family->left));
        const uint32_t node = family->group.starts[i], node_end = family->group.starts[i + 1];
        family->left &= family->left - 1;
        if (node_end != node + 1 &&
            coder.choose(models_.fresh_inside[has], coder.state_of(node, node_end) == kInside ? 1 : 0) != 0) {
          family += (family->left | (family->next ^ family->end)) != 0 ? 1 : 0;
          family->next = node + 1, family->end = node_end;
          break;
        }
        if (!coder.add_if(1, node)) return false;
      }
    }
  }

  const uint32_t* end_;
  uint32_t size_;
  Models& models_;
  std::array<Family, kMaxForestDepth + 1> open_;  // a forest is no deeper; each is set before it is read
};

/// How far back the reference of a set is: 1 the set before it; 0: it has none.
template <class Coder>
uint32_t code_reference(Models& models, Coder& coder, uint32_t back) {
  uint32_t node = 1;
  for (size_t i = kReferenceBits; i-- > 0;) node = node * 2 + coder.choose(models.reference[node], back >> i & 1U);
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
  RansEncoder encoder;
  Models models;
  Telling teller(encoder);
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
  return encoder.finish();
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
