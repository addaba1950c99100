#pragma once
// Blocks of sets that are much alike, as those of neighbouring view cells are: each set is told by its difference from
// one before it in the block, along the forest whose fronts the sets are parts of. A node that gives way to its
// children is told once, not by each of them. FORMAT.md has the bytes.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "codec/id_forest.h"
#include "geometry/result.h"

namespace promenade {

/// Most sets in a block. More save bytes, and make the last of them slower to get at.
constexpr size_t kMaxSetsInBlock = 64;

/// Sets one behind the other.
struct IdSetBlock {
  std::vector<uint32_t> ids;
  std::vector<uint32_t> ends;  ///< by set: where its ids end
  std::span<const uint32_t> set(size_t i) const {
    const size_t begin = i == 0 ? 0 : ends[i - 1];
    return std::span(ids).subspan(begin, ends[i] - begin);
  }
};

/// The bytes of 1 to kMaxSetsInBlock sets. Each is an antichain of the forest; together fewer than 2^32 ids.
/// Deterministic. Any thread.
std::vector<std::byte> encode_block(const IdForest& forest, const IdSetBlock& sets);

/// The first ends.size() sets of a block (at most kMaxSetsInBlock): their ids one behind the other at the front of
/// `ids`, where each ends in `ends`. Each set comes out an antichain, ascending. Allocates nothing. Safe on any bytes:
/// an Error when there is no room for a set or the bytes end too early. Any thread.
Status decode_block(const IdForest& forest, std::span<const std::byte> bytes, std::span<uint32_t> ids,
                    std::span<uint32_t> ends);

}  // namespace promenade
