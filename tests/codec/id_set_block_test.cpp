#include "codec/id_set_block.h"

#include <gtest/gtest.h>

#include <algorithm>
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
    uint64_t digit = 1;
    for (size_t i = bytes.size() % 4; i > 0; --i, digit *= 256) state_ += digit * next_byte();
    fill();
  }

  std::vector<Ids> decode(size_t count) {
    std::vector<Ids> sets;
    for (size_t i = 0; i < count; ++i) {
      std::string prefix = "back ";
      size_t back = 0;
      for (int bit = 0; bit < 7; ++bit) {
        const uint64_t digit = of_two(prefix);
        back = 2 * back + digit;
        prefix += digit != 0 ? '1' : '0';
      }
      reference_.clear();
      if (back > 0) reference_.insert(sets.at(i - back).begin(), sets.at(i - back).end());
      set_.clear();
      if (of_two("equal") == 0)
        set_ = reference_;
      else
        changed_family(0, forest_.size());
      sets.emplace_back(set_.begin(), set_.end());
    }
    return sets;
  }

 private:
  /// start: of the shares, one more than there are.
  struct Model {
    std::vector<int64_t> start;
    size_t asked = 0;
  };

  uint64_t next_byte() { return at_ < bytes_.size() ? std::to_integer<uint64_t>(bytes_[at_++]) : 0; }

  void fill() {
    if (state_ >= uint64_t(1) << 24) return;
    uint64_t word = 0;
    for (uint64_t digit = 1; digit < uint64_t(1) << 32; digit *= 256) word += digit * next_byte();
    state_ = (state_ << 32) + word;
  }

  /// Of shares that start at these places of 16384.
  size_t choose(const std::vector<int64_t>& start) {
    const auto place = static_cast<int64_t>(state_ % 16384);
    size_t choice = 0;
    while (start[choice + 1] <= place) ++choice;
    state_ = static_cast<uint64_t>(start[choice + 1] - start[choice]) * (state_ / 16384) +
             static_cast<uint64_t>(place - start[choice]);
    fill();
    return choice;
  }

  /// By which power of two the way is divided.
  static int64_t part(Model& model) {
    static const std::vector<int64_t> parts = {2, 4, 4, 8, 8, 8, 16, 16, 16, 16, 16, 16, 16, 16, 16};
    return model.asked < parts.size() ? parts[model.asked++] : 32;
  }

  uint64_t of_two(const std::string& name) {
    Model& model = models_[name];
    if (model.start.empty()) model.start = {32768};
    int64_t& p = model.start[0];
    const size_t choice = choose({0, p / 4, 16384});
    if (choice == 0)
      p += (65536 - p) / part(model);
    else
      p -= p / part(model);
    return choice;
  }

  uint64_t of_sixteen(const std::string& name, int64_t likely) {
    Model& model = models_[name];
    if (model.start.empty())
      for (int64_t i = 0; i <= 16; ++i)
        model.start.push_back(i < likely ? i * ((16384 - 2 * (16 - likely)) / likely) : 16384 - 2 * (16 - i));
    const size_t choice = choose(model.start);
    const int64_t parts = part(model);
    for (int64_t i = 0; i < 16; ++i) {
      int64_t& start = model.start[static_cast<size_t>(i)];
      const int64_t goal = i <= static_cast<int64_t>(choice) ? 2 * i : 16384 - 2 * (16 - i), way = goal - start;
      start += way >= 0 ? way / parts : -((-way + parts - 1) / parts);
    }
    return choice;
  }

  bool is_leaf(uint32_t node) const { return forest_.subtree_end[node] == node + 1; }

  Ids held(uint32_t node) const {
    Ids ids;
    for (uint32_t id = node; id < forest_.subtree_end[node]; ++id)
      if (reference_.contains(id)) ids.push_back(id);
    return ids;
  }

  std::vector<Ids> groups_of(uint32_t begin, uint32_t end) const {
    std::vector<Ids> groups;
    for (uint32_t node = begin; node < end; node = forest_.subtree_end[node]) {
      if (groups.empty() || groups.back().size() == 4) groups.emplace_back();
      groups.back().push_back(node);
    }
    return groups;
  }

  bool all_leaves(const Ids& group) const {
    return std::all_of(group.begin(), group.end(), [&](uint32_t node) { return is_leaf(node); });
  }

  static size_t bits_of(size_t n) {
    size_t bits = 0;
    for (; n > 0; n /= 2) ++bits;
    return bits;
  }

  void hold(const Ids& group, uint64_t bits) {
    for (size_t i = 0; i < group.size(); ++i)
      if ((bits >> i & 1U) != 0) set_.insert(group[i]);
  }

  void changed_family(uint32_t begin, uint32_t end) {
    for (const Ids& group : groups_of(begin, end)) {
      if (all_leaves(group)) {
        std::string name = "leaves " + std::to_string(group.size()) + " ";
        for (const uint32_t node : group) name += reference_.contains(node) ? '1' : '0';
        hold(group, of_sixteen(name, int64_t(1) << group.size()));
        continue;
      }
      const size_t nodes = end - group[0], size = nodes < 16 ? nodes : 16 + std::min<size_t>(bits_of(nodes) - 4, 11);
      const uint64_t unlike = of_sixteen("unlike " + std::to_string(size), 16);
      for (size_t i = 0; i < group.size(); ++i) {
        const Ids there = held(group[i]);
        if ((unlike >> i & 1U) == 0)
          set_.insert(there.begin(), there.end());
        else
          changed(group[i], there);
      }
    }
  }

  void changed(uint32_t node, const Ids& there) {
    const uint32_t end = forest_.subtree_end[node];
    if (!there.empty() && there[0] != node) {
      if (of_two("not inside " + std::to_string(std::min<size_t>(bits_of(end - node), 12))) == 0)
        changed_family(node + 1, end);
      else if (of_two("root") != 0)
        set_.insert(node);
      return;
    }
    const std::string h = there.empty() ? " new" : " held";
    if (!is_leaf(node) && of_two("inside" + h) != 0)
      fresh_family(node + 1, end, h);
    else if (there.empty())
      set_.insert(node);
  }

  void fresh_family(uint32_t begin, uint32_t end, const std::string& h) {
    for (const Ids& group : groups_of(begin, end)) {
      const std::string name = std::to_string(group.size()) + h;
      if (all_leaves(group)) {
        hold(group, of_sixteen("fresh leaves " + name, int64_t(1) << group.size()));
        continue;
      }
      const uint64_t there = of_sixteen("fresh " + name, int64_t(1) << group.size());
      for (size_t i = 0; i < group.size(); ++i) {
        if ((there >> i & 1U) == 0) continue;
        if (!is_leaf(group[i]) && of_two("fresh inside" + h) != 0)
          fresh_family(group[i] + 1, forest_.subtree_end[group[i]], h);
        else
          set_.insert(group[i]);
      }
    }
  }

  const IdForest& forest_;
  std::span<const std::byte> bytes_;
  size_t at_ = 0;
  uint64_t state_ = 0;
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
  EXPECT_LE(encode_block(forest, block_of(same)).size(), 13U) << "of these 3 for the number that the coder begins with";
  EXPECT_LE(encode_block(forest, block_of({Ids{}})).size(), 5U) << "8 choices, 1 bit each at first";
}

TEST(IdSetBlock, comes_back_from_a_forest_without_nodes_and_from_broken_bytes_for_one) {
  const IdForest none;
  expect_round_trip(none, block_of({Ids{}, Ids{}}));
  Ids ids(8), ends(2);
  for (int byte = 0; byte < 256; ++byte) {
    const std::vector<std::byte> bytes(8, static_cast<std::byte>(byte));
    if (decode_block(none, bytes, ids, ends)) {
      EXPECT_EQ(ends, (Ids{0, 0}));
    }
  }
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
  expect_golden("id_set_block_v3.bin", encode_block(forest, random_block(forest, random, 24)));
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
