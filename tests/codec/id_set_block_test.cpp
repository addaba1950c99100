#include "codec/id_set_block.h"

#include <gtest/gtest.h>

#include <map>
#include <set>
#include <string>

#include "tests/codec/id_set_fixtures.h"
#include "tests/golden.h"

namespace promenade {
namespace {

using Ids = std::vector<uint32_t>;

/// The slow decoder: FORMAT.md word by word, with named models in a map and sets as std::set.
class SlowDecoder {
 public:
  SlowDecoder(const IdForest& forest, std::span<const std::byte> bytes) : forest_(forest), bytes_(bytes) {
    for (int i = 0; i < 8; ++i) code_ = code_ * 256 + next_byte();
  }

  std::vector<Ids> decode(size_t count) {
    std::vector<Ids> sets;
    for (size_t i = 0; i < count; ++i) {
      std::string prefix = "back ";
      size_t back = 0;
      for (int bit = 0; bit < 7; ++bit) {
        const uint32_t digit = decide(prefix);
        back = 2 * back + digit;
        prefix += digit != 0 ? '1' : '0';
      }
      reference_.clear();
      if (back > 0) reference_.insert(sets.at(i - back).begin(), sets.at(i - back).end());
      set_.clear();
      if (decide("equal") == 0)
        set_ = reference_;
      else
        changed_family(0, forest_.size());
      sets.emplace_back(set_.begin(), set_.end());
    }
    return sets;
  }

 private:
  struct Model {
    uint64_t p = 32768;
    size_t count = 0;
  };

  uint64_t next_byte() { return at_ < bytes_.size() ? std::to_integer<uint64_t>(bytes_[at_++]) : 0; }

  uint32_t decide(const std::string& name) {
    Model& model = models_[name];
    static const std::vector<uint64_t> parts = {2, 4, 4, 8, 8, 8, 16, 16, 16, 16, 16, 16, 16, 16, 16};
    const uint64_t part = model.count < parts.size() ? parts[model.count] : 32;
    ++model.count;
    const uint64_t bound = range_ / 4096 * (model.p / 16);
    const uint32_t decision = code_ < bound ? 0 : 1;
    if (decision == 0) {
      range_ = bound;
      model.p += (65536 - model.p) / part;
    } else {
      code_ -= bound, range_ -= bound;
      model.p -= model.p / part;
    }
    if (range_ < uint64_t(1) << 32)
      for (int i = 0; i < 4; ++i) range_ *= 256, code_ = code_ * 256 + next_byte();
    return decision;
  }

  bool is_leaf(uint32_t node) const { return forest_.subtree_end[node] == node + 1; }

  std::vector<uint32_t> held(uint32_t node) const {
    Ids ids;
    for (uint32_t id = node; id < forest_.subtree_end[node]; ++id)
      if (reference_.contains(id)) ids.push_back(id);
    return ids;
  }

  void changed_family(uint32_t begin, uint32_t end) {
    int before = 3;
    for (uint32_t node = begin; node < end; node = forest_.subtree_end[node]) {
      const std::string of_before = " before " + std::to_string(before);
      const Ids there = held(node);
      if (!there.empty() && there[0] != node) {
        int bits = 0;
        for (uint32_t n = forest_.subtree_end[node] - node; n > 0; n /= 2) ++bits;
        if (decide("inside changed " + std::to_string(std::min(bits, 8)) + of_before) == 0) {
          set_.insert(there.begin(), there.end());
          before = 0;
        } else if (decide("inside leaves" + of_before) == 0) {
          changed_family(node + 1, forest_.subtree_end[node]);
          before = 1;
        } else {
          if (decide("inside nothing" + of_before) == 0) set_.insert(node);
          before = 2;
        }
        continue;
      }
      const std::string h = there.empty() ? " new" : " held";
      if (is_leaf(node)) {
        before = static_cast<int>(decide("leaf changed" + h + of_before));
        if (there.empty() == (before == 1)) set_.insert(node);
      } else if (decide("plain changed" + h + of_before) == 0) {
        if (!there.empty()) set_.insert(node);
        before = 0;
      } else if (decide("plain inside" + h + of_before) == 1) {
        fresh_family(node + 1, forest_.subtree_end[node], h);
        before = 2;
      } else {
        if (there.empty()) set_.insert(node);
        before = 1;
      }
    }
  }

  void fresh_family(uint32_t begin, uint32_t end, const std::string& h) {
    int before = 3;
    for (uint32_t node = begin; node < end; node = forest_.subtree_end[node]) {
      const std::string of_before = " before " + std::to_string(before);
      if (is_leaf(node)) {
        before = static_cast<int>(decide("fresh leaf held" + h + of_before));
        if (before == 1) set_.insert(node);
      } else if (decide("fresh not held" + h + of_before) == 0) {
        set_.insert(node);
        before = 1;
      } else if (decide("fresh inside" + h + of_before) == 1) {
        fresh_family(node + 1, forest_.subtree_end[node], h);
        before = 2;
      } else {
        before = 0;
      }
    }
  }

  const IdForest& forest_;
  std::span<const std::byte> bytes_;
  size_t at_ = 0;
  uint64_t range_ = ~uint64_t(0), code_ = 0;
  std::map<std::string, Model> models_;
  std::set<uint32_t> reference_, set_;
};

void expect_round_trip(const IdForest& forest, const IdSetBlock& block) {
  const std::vector<std::byte> bytes = encode_block(forest, block);
  Ids ids(block.ids.size()), ends(block.ends.size());
  const Status status = decode_block(forest, bytes, ids, ends);
  ASSERT_TRUE(status.ok()) << status.error().message;
  ASSERT_EQ(ends, block.ends);
  ASSERT_EQ(ids, block.ids);
}

IdSetBlock block_of(const std::vector<Ids>& sets) {
  IdSetBlock block;
  for (const Ids& set : sets) {
    block.ids.insert(block.ids.end(), set.begin(), set.end());
    block.ends.push_back(static_cast<uint32_t>(block.ids.size()));
  }
  return block;
}

/// Two roots: 0 with children 1 (with 2, 3), 4 and 5 (with 6); and 7.
IdForest small_forest() { return {{7, 4, 3, 4, 5, 7, 7, 8}}; }

std::vector<Ids> antichains_of(const IdForest& forest) {
  std::vector<Ids> sets;
  for (uint32_t bits = 0; bits < 1U << forest.size(); ++bits) {
    Ids ids;
    for (uint32_t i = 0; i < forest.size(); ++i)
      if ((bits >> i & 1U) != 0) ids.push_back(i);
    if (is_antichain(forest, ids)) sets.push_back(ids);
  }
  return sets;
}

TEST(IdSetBlock, brings_back_every_pair_of_sets_of_a_small_forest) {
  const IdForest forest = small_forest();
  ASSERT_TRUE(check(forest).ok());
  const std::vector<Ids> sets = antichains_of(forest);
  ASSERT_EQ(sets.size(), 62U);
  for (const Ids& a : sets)
    for (const Ids& b : sets) ASSERT_NO_FATAL_FAILURE(expect_round_trip(forest, block_of({a, b})));
}

TEST(IdSetBlock, brings_back_random_blocks) {
  Random random(1);
  for (int i = 0; i < 200; ++i) {
    const IdForest forest = random_forest(random, 1 + random() % 3000);
    ASSERT_TRUE(check(forest).ok());
    ASSERT_NO_FATAL_FAILURE(expect_round_trip(forest, random_block(forest, random, 1 + random() % kMaxSetsInBlock)));
  }
}

TEST(IdSetBlock, brings_back_sets_without_a_tree) {
  Random random(2);
  IdForest forest;
  for (uint32_t i = 0; i < 2000; ++i) forest.subtree_end.push_back(i + 1);
  std::vector<Ids> sets(kMaxSetsInBlock);
  for (Ids& set : sets) set = random_ids(random, 2000, 1 + random() % 300, 5);
  expect_round_trip(forest, block_of(sets));
}

TEST(IdSetBlock, is_read_by_the_slow_decoder) {
  Random random(3);
  for (int i = 0; i < 40; ++i) {
    const IdForest forest = random_forest(random, 1 + random() % 600);
    const IdSetBlock block = random_block(forest, random, 1 + random() % kMaxSetsInBlock);
    const std::vector<std::byte> bytes = encode_block(forest, block);
    const std::vector<Ids> sets = SlowDecoder(forest, bytes).decode(block.ends.size());
    for (size_t k = 0; k < sets.size(); ++k)
      ASSERT_EQ(sets[k], Ids(block.set(k).begin(), block.set(k).end())) << "set " << k;
  }
}

TEST(IdSetBlock, gives_its_first_sets_without_the_rest) {
  Random random(4);
  const IdForest forest = random_forest(random, 500);
  const IdSetBlock block = random_block(forest, random, 30);
  const std::vector<std::byte> bytes = encode_block(forest, block);
  for (size_t count = 0; count <= 30; ++count) {
    Ids ids(count == 0 ? 0 : block.ends[count - 1]), ends(count);
    ASSERT_TRUE(decode_block(forest, bytes, ids, ends).ok());
    EXPECT_TRUE(std::equal(ids.begin(), ids.end(), block.ids.begin()));
  }
}

TEST(IdSetBlock, tells_nothing_twice) {
  const IdForest forest = small_forest();
  const std::vector<Ids> same(kMaxSetsInBlock, Ids{1, 4, 6, 7});
  EXPECT_LE(encode_block(forest, block_of(same)).size(), 10U);
  EXPECT_TRUE(encode_block(forest, block_of({Ids{}})).empty()) << "an empty set is the number zero";
}

TEST(IdSetBlock, refuses_sets_without_room) {
  Random random(5);
  const IdForest forest = random_forest(random, 500);
  const IdSetBlock block = random_block(forest, random, 30);
  const std::vector<std::byte> bytes = encode_block(forest, block);
  Ids ends(block.ends.size());
  for (const size_t room : {size_t(0), block.ids.size() / 2, block.ids.size() - 1}) {
    Ids ids(room);
    EXPECT_FALSE(decode_block(forest, bytes, ids, ends).ok());
  }
}

TEST(IdSetBlock, gives_antichains_or_an_error_for_any_bytes) {
  Random random(6);
  const IdForest forest = random_forest(random, 400);
  const IdSetBlock block = random_block(forest, random, 20);
  const std::vector<std::byte> good = encode_block(forest, block);
  Ids ids(block.ids.size() + 500), ends(block.ends.size());
  for (int i = 0; i < 5000; ++i) {
    std::vector<std::byte> bytes = good;
    if (i % 3 == 0) bytes.resize(random() % (good.size() + 1));
    for (uint32_t k = random() % 4; k > 0 && !bytes.empty(); --k)
      bytes[random() % bytes.size()] = static_cast<std::byte>(random());
    if (!decode_block(forest, bytes, ids, ends)) continue;
    for (size_t k = 0; k < ends.size(); ++k) {
      const size_t begin = k == 0 ? 0 : ends[k - 1];
      ASSERT_LE(begin, ends[k]);
      ASSERT_TRUE(is_antichain(forest, std::span(ids).subspan(begin, ends[k] - begin)));
    }
  }
}

TEST(IdSetBlock, keeps_its_bytes) {
  Random random(7);
  const IdForest forest = random_forest(random, 300);
  expect_golden("id_set_block_v2.bin", encode_block(forest, random_block(forest, random, 24)));
}

TEST(IdForest, refuses_subtrees_that_overlap_or_leave) {
  EXPECT_TRUE(check(IdForest{}).ok());
  EXPECT_TRUE(check(IdForest{{3, 2, 3}}).ok());
  EXPECT_FALSE(check(IdForest{{0}}).ok());
  EXPECT_FALSE(check(IdForest{{2}}).ok());
  EXPECT_FALSE(check(IdForest{{2, 3, 3}}).ok());
  EXPECT_FALSE(check(IdForest{{3, 1, 3}}).ok());
  IdForest chain;
  for (uint32_t i = 0; i < kMaxForestDepth + 1; ++i) chain.subtree_end.push_back(kMaxForestDepth + 1);
  EXPECT_FALSE(check(chain).ok());
}

TEST(IdForest, knows_sets_without_ancestors) {
  const IdForest forest = small_forest();
  EXPECT_TRUE(is_antichain(forest, Ids{}));
  EXPECT_TRUE(is_antichain(forest, Ids{1, 4, 6, 7}));
  EXPECT_FALSE(is_antichain(forest, Ids{1, 2}));
  EXPECT_FALSE(is_antichain(forest, Ids{4, 4}));
  EXPECT_FALSE(is_antichain(forest, Ids{4, 1}));
  EXPECT_FALSE(is_antichain(forest, Ids{8}));
}

}  // namespace
}  // namespace promenade
