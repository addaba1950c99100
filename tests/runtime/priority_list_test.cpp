#include "runtime/priority_list.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace promenade {
namespace {

/// The same by brute force: a vector, searched and sorted.
class SortedVector {
 public:
  struct Entry {
    uint32_t id;
    float priority;
    bool loaded;
  };
  void update(uint32_t id, float priority) {
    const auto it = find(id);
    Entry entry{id, priority, false};
    if (it != entries_.end()) {
      if (it->priority == priority) return;
      entry.loaded = it->loaded;
      entries_.erase(it);
    }
    const auto place =
        std::find_if(entries_.begin(), entries_.end(), [&](const Entry& e) { return e.priority < priority; });
    entries_.insert(place, entry);
  }
  void erase(uint32_t id) {
    const auto it = find(id);
    if (it != entries_.end()) entries_.erase(it);
  }
  void set_loaded(uint32_t id, bool loaded) { find(id)->loaded = loaded; }
  bool contains(uint32_t id) { return find(id) != entries_.end(); }
  uint32_t next_unloaded() const {
    const auto it = std::find_if(entries_.begin(), entries_.end(), [](const Entry& e) { return !e.loaded; });
    return it == entries_.end() ? index_of(kNoNode) : it->id;
  }
  const std::vector<Entry>& entries() const { return entries_; }

 private:
  std::vector<Entry>::iterator find(uint32_t id) {
    return std::find_if(entries_.begin(), entries_.end(), [id](const Entry& e) { return e.id == id; });
  }
  std::vector<Entry> entries_;
};

std::vector<uint32_t> ids_of(const PriorityList& list) {
  std::vector<uint32_t> ids;
  for (NodeId id = list.front(); id != kNoNode; id = list.after(id)) ids.push_back(index_of(id));
  return ids;
}

std::vector<uint32_t> ids_backwards(const PriorityList& list) {
  std::vector<uint32_t> ids;
  for (NodeId id = list.back(); id != kNoNode; id = list.before(id)) ids.push_back(index_of(id));
  std::reverse(ids.begin(), ids.end());
  return ids;
}

std::vector<uint32_t> ids_of(const SortedVector& oracle) {
  std::vector<uint32_t> ids;
  for (const SortedVector::Entry& e : oracle.entries()) ids.push_back(e.id);
  return ids;
}

TEST(PriorityList, agrees_with_a_sorted_vector_under_random_operations) {
  constexpr uint32_t kNodes = 60;
  std::mt19937 random(7);
  PriorityList list(kNodes);
  SortedVector oracle;
  for (int step = 0; step < 20000; ++step) {
    const uint32_t id = static_cast<uint32_t>(random()) % kNodes;
    switch (random() % 4) {
      case 0:
      case 1: {
        // Few values, so that equals abound.
        const float priority = float(random() % 12);
        list.update(NodeId{id}, priority);
        oracle.update(id, priority);
        break;
      }
      case 2:
        if (oracle.contains(id)) {
          const bool loaded = random() % 3 != 0;
          list.set_loaded(NodeId{id}, loaded);
          oracle.set_loaded(id, loaded);
        }
        break;
      default:
        list.erase(NodeId{id});
        oracle.erase(id);
    }
    ASSERT_EQ(index_of(list.next_unloaded()), oracle.next_unloaded()) << "after operation " << step;
    ASSERT_EQ(list.size(), oracle.entries().size());
    if (step % 16 == 0) {
      ASSERT_EQ(ids_of(list), ids_of(oracle)) << "after operation " << step;
      ASSERT_EQ(ids_backwards(list), ids_of(oracle)) << "after operation " << step;
    }
  }
}

TEST(PriorityList, bulk_update_sorts_whether_it_steps_or_not) {
  constexpr uint32_t kNodes = 3000;
  std::mt19937 random(11);
  PriorityList list(kNodes);
  std::vector<float> wanted(kNodes);
  for (int round = 0; round < 6; ++round) {
    std::vector<PriorityUpdate> updates;
    for (uint32_t id = 0; id < kNodes; ++id) {
      if (round == 0 && id % 3 == 0) continue;  // comes in later
      wanted[id] = float(random() % 100000);
      updates.push_back({NodeId{id}, wanted[id]});
    }
    list.update(updates);
    for (uint32_t id = 0; id < kNodes; ++id)
      if (list.contains(NodeId{id}) && random() % 2 == 0) list.set_loaded(NodeId{id}, random() % 2 == 0);
    ASSERT_EQ(list.size(), round == 0 ? kNodes - kNodes / 3 : kNodes);
    NodeId first_unloaded = kNoNode;
    for (NodeId id = list.front(); id != kNoNode; id = list.after(id)) {
      ASSERT_EQ(list.priority(id), wanted[index_of(id)]);
      if (list.after(id) != kNoNode) {
        ASSERT_GE(list.priority(id), list.priority(list.after(id)));
      }
      if (first_unloaded == kNoNode && !list.loaded(id)) first_unloaded = id;
    }
    ASSERT_EQ(list.next_unloaded(), first_unloaded);
  }
}

TEST(PriorityList, coherent_updates_and_queries_cost_a_few_steps_each) {
  constexpr uint32_t kNodes = 5000;
  PriorityList list(kNodes);
  std::vector<PriorityUpdate> updates;
  for (uint32_t id = 0; id < kNodes; ++id) updates.push_back({NodeId{id}, float(id)});
  list.update(updates);
  const uint64_t before = list.steps();
  std::mt19937 random(3);
  uint64_t operations = 0;
  for (int frame = 0; frame < 50; ++frame) {
    // Priorities drift by a couple of places; the loader takes a few of the most important.
    for (PriorityUpdate& u : updates) u.priority += float(random() % 5) - 2.0F;
    list.update(updates);
    operations += updates.size();
    for (int i = 0; i < 20; ++i, ++operations) list.set_loaded(list.next_unloaded(), true);
  }
  EXPECT_LT(list.steps() - before, 5 * operations);
}

TEST(PriorityList, equal_priorities_keep_their_turn) {
  PriorityList list(3);
  list.update(NodeId{2}, 1);
  list.update(NodeId{0}, 1);
  list.update(NodeId{1}, 1);
  EXPECT_EQ(ids_of(list), (std::vector<uint32_t>{2, 0, 1}));
  list.update(NodeId{2}, 1);
  EXPECT_EQ(ids_of(list), (std::vector<uint32_t>{2, 0, 1})) << "an unchanged priority moves nothing";
}

}  // namespace
}  // namespace promenade
