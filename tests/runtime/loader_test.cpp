#include "runtime/loader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>
#include <tuple>

#include "tests/runtime/forest.h"
#include "tests/runtime/null_renderer.h"

namespace promenade {
namespace {

using forest::Forest;
using testing::ElementsAre;

const Box somewhere_pose{{10, -8, -1}, {10.5F, 8, 1}};
constexpr uint64_t kPlenty = uint64_t(1) << 30;

/// A resident set with its loader, stepped by hand.
struct Bench {
  Bench(const Forest& f, uint64_t memory_bytes, uint64_t piece_bytes = 400, double margin = 0, double along_share = 0)
      : source(f) {
    options.memory_bytes = memory_bytes;
    options.piece_bytes = piece_bytes;
    set = std::make_unique<ResidentSet>(source, renderer, memory_bytes, 0, margin, along_share);
    loader = std::make_unique<Loader>(source, renderer, *set, nullptr, options);
  }
  ~Bench() {
    set->clear(renderer);
    EXPECT_EQ(renderer.bytes(), 0U) << "a handle was forgotten";
  }
  Bench(const Bench&) = delete;
  Bench& operator=(const Bench&) = delete;

  void want(const std::vector<PriorityUpdate>& updates) {
    set->update(updates, [](NodeId) { return 0.0F; });
  }
  void begin_frame() { set->let_go(set->refresh(), renderer); }
  /// Of what arrived, the flags are up to date.
  uint32_t upload(double budget_ms) {
    const uint32_t arrived = set->upload(renderer, budget_ms);
    begin_frame();
    return arrived;
  }
  /// Loads and uploads until there is nothing to do.
  void run() {
    for (int idle = 0; idle < 3; ++idle) {
      while (loader->step().outcome == Loader::Outcome::worked) {
        idle = 0;
        check_memory();
      }
      begin_frame();
      if (upload(1e9) > 0) idle = 0;
      check_memory();
    }
  }
  void check_memory() {
    const MemoryUse use = set->memory();
    ASSERT_LE(use.total(), options.memory_bytes);
    ASSERT_LE(renderer.bytes(), use.uploaded) << "the renderer holds more than is counted";
  }
  bool resident(NodeId id) const { return set->resident()[index_of(id)] != 0; }
  size_t resident_count() const {
    const std::span<const uint8_t> flags = set->resident();
    return static_cast<size_t>(std::count(flags.begin(), flags.end(), 1));
  }

  const Forest& source;
  NullRenderer renderer;
  LoaderOptions options;
  std::unique_ptr<ResidentSet> set;
  std::unique_ptr<Loader> loader;
};

/// A root with four leaves; 1000 stored bytes each.
struct RootWithFour : Forest {
  RootWithFour() {
    top = root(somewhere_pose, 1);
    leaves = split(top, 4, 0);
  }
  NodeId top{};
  std::vector<NodeId> leaves;
};

TEST(Loader, loads_the_most_important_first) {
  RootWithFour model;
  Bench bench(model, kPlenty);
  ASSERT_TRUE(bench.set->load_roots(bench.renderer));
  EXPECT_TRUE(bench.resident(model.top));
  bench.want({{model.leaves[0], 1}, {model.leaves[1], 3}, {model.leaves[2], 2}});
  std::vector<NodeId> order;
  for (int i = 0; i < 12; ++i) {
    bench.loader->step();
    bench.begin_frame();
    if (bench.upload(0) == 0) continue;
    for (const NodeId id : model.leaves)
      if (bench.resident(id) && std::find(order.begin(), order.end(), id) == order.end()) order.push_back(id);
  }
  EXPECT_THAT(order, ElementsAre(model.leaves[1], model.leaves[2], model.leaves[0]));
  EXPECT_FALSE(bench.resident(model.leaves[3])) << "nobody asked for it";
}

/// Nodes in the order in which they became resident, one upload a step.
std::vector<NodeId> loading_order(Bench& bench, const std::vector<NodeId>& nodes) {
  std::vector<NodeId> order;
  for (int i = 0; i < 20; ++i) {
    bench.loader->step();
    bench.begin_frame();
    bench.upload(1e9);
    for (const NodeId id : nodes)
      if (bench.resident(id) && std::find(order.begin(), order.end(), id) == order.end()) order.push_back(id);
  }
  return order;
}

TEST(Loader, reads_on_where_the_disk_is_what_matters_nearly_as_much) {
  RootWithFour model;
  const std::vector<PriorityUpdate> wanted = {{model.leaves[2], 10}, {model.leaves[0], 9}, {model.leaves[3], 5}};
  const auto order_with = [&](double along_share, uint64_t& reads, uint64_t piece_bytes) {
    Bench bench(model, kPlenty, piece_bytes, 0, along_share);
    EXPECT_TRUE(bench.set->load_roots(bench.renderer));
    bench.want(wanted);
    std::vector<NodeId> order = loading_order(bench, model.leaves);
    reads = bench.set->counts().reads - 1;  // the root's
    return order;
  };
  const auto [a, b, c] = std::tuple(model.leaves[2], model.leaves[0], model.leaves[3]);
  uint64_t reads = 0;
  EXPECT_THAT(order_with(0, reads, 4096), ElementsAre(a, b, c));
  EXPECT_EQ(reads, 3U);
  // Behind the first lies the last, of half the other's priority: it is read in one go with the first.
  order_with(0.5, reads, 4096);
  EXPECT_EQ(reads, 2U);
  order_with(0.6, reads, 4096);
  EXPECT_EQ(reads, 3U) << "it matters too little";
  order_with(0.5, reads, 400);
  EXPECT_EQ(reads, 3U) << "more than a piece: something else may come up meanwhile";
}

TEST(Loader, what_lies_along_pushes_nothing_out) {
  RootWithFour model;
  Bench roomy(model, kPlenty, 4096, 0, 0.1);
  ASSERT_TRUE(roomy.set->load_roots(roomy.renderer));
  roomy.want({{model.leaves[2], 10}, {model.leaves[0], 9}, {model.leaves[3], 5}});
  roomy.run();
  const uint64_t all = roomy.set->memory_peak_bytes();
  for (uint64_t bytes = all / 4; bytes < all; bytes += all / 16) {
    Bench bench(model, bytes, 4096, 0, 0.1);
    if (!bench.set->load_roots(bench.renderer)) continue;
    bench.want({{model.leaves[2], 10}, {model.leaves[0], 9}, {model.leaves[3], 5}});
    bench.run();  // checks the bound at every step
    if (bench.resident(model.leaves[3])) {
      EXPECT_TRUE(bench.resident(model.leaves[0])) << bytes;
    }
    if (bench.resident(model.leaves[0])) {
      EXPECT_TRUE(bench.resident(model.leaves[2])) << bytes;
    }
  }
}

TEST(Loader, turns_to_what_became_more_important_and_resumes_later) {
  RootWithFour model;
  Bench bench(model, kPlenty, 400);  // three pieces a segment
  ASSERT_TRUE(bench.set->load_roots(bench.renderer));
  bench.want({{model.leaves[0], 2}, {model.leaves[1], 1}});
  bench.loader->step();
  bench.loader->step();
  bench.want({{model.leaves[0], 2}, {model.leaves[1], 3}});
  for (int i = 0; i < 4; ++i) bench.loader->step();
  bench.upload(1e9);
  EXPECT_TRUE(bench.resident(model.leaves[1]));
  EXPECT_FALSE(bench.resident(model.leaves[0]));
  EXPECT_EQ(bench.set->counts().loads_suspended, 1U);
  bench.run();
  EXPECT_TRUE(bench.resident(model.leaves[0]));
  EXPECT_EQ(bench.set->counts().loads_resumed, 1U);
  EXPECT_EQ(bench.set->counts().bytes_read, 3000U) << "nothing was read twice";
}

TEST(Loader, shared_texture_is_read_once_and_leaves_with_its_last_node) {
  RootWithFour model;
  model.texture(16, {model.leaves[0], model.leaves[1]});
  Bench bench(model, 60000);
  ASSERT_TRUE(bench.set->load_roots(bench.renderer));
  bench.want({{model.leaves[0], 2}, {model.leaves[1], 1}});
  bench.run();
  EXPECT_TRUE(bench.resident(model.leaves[0]) && bench.resident(model.leaves[1]));
  EXPECT_EQ(bench.set->counts().textures_loaded, 1U);
  EXPECT_EQ(bench.renderer.textures.size(), 1U);
}

TEST(Loader, node_is_resident_only_with_all_its_textures) {
  RootWithFour model;
  model.texture(16, {model.leaves[0]});
  Bench bench(model, kPlenty, 1000);
  ASSERT_TRUE(bench.set->load_roots(bench.renderer));
  bench.want({{model.leaves[0], 1}});
  for (int i = 0; i < 4; ++i) bench.loader->step();  // texture: read, decode; mesh: read, decode
  EXPECT_EQ(bench.upload(0), 0U) << "the texture";
  EXPECT_FALSE(bench.resident(model.leaves[0]));
  EXPECT_EQ(bench.upload(0), 1U) << "the mesh";
  EXPECT_TRUE(bench.resident(model.leaves[0]));
}

TEST(Loader, evicts_the_least_important_for_a_more_important_one) {
  RootWithFour model;
  // Room for the root, two leaves, and loading one.
  const uint64_t leaf = NullRenderer().mesh_bytes_bound(4, 1000);
  Bench probe(model, kPlenty);
  ASSERT_TRUE(probe.set->load_roots(probe.renderer));
  const uint64_t base = probe.set->memory().total();
  Bench bench(model, base + 2 * leaf + 31000, 1000);
  ASSERT_TRUE(bench.set->load_roots(bench.renderer));
  bench.want({{model.top, 9}, {model.leaves[0], 2}, {model.leaves[1], 3}});
  bench.run();
  ASSERT_TRUE(bench.resident(model.leaves[0]) && bench.resident(model.leaves[1]));
  bench.want({{model.top, 0}, {model.leaves[0], 2}, {model.leaves[1], 3}, {model.leaves[2], 1}});
  bench.run();
  EXPECT_FALSE(bench.resident(model.leaves[2])) << "everything in memory matters more";
  EXPECT_GT(bench.set->counts().refused_memory, 0U);
  bench.want({{model.top, 0}, {model.leaves[0], 2}, {model.leaves[1], 3}, {model.leaves[2], 4}});
  bench.run();
  EXPECT_TRUE(bench.resident(model.leaves[2]));
  EXPECT_FALSE(bench.resident(model.leaves[0]));
  EXPECT_TRUE(bench.resident(model.leaves[1]));
  EXPECT_TRUE(bench.resident(model.top)) << "roots stay, whatever their priority";
  EXPECT_EQ(bench.set->counts().nodes_evicted, 1U);
}

TEST(Loader, waits_for_the_render_thread_to_let_go) {
  RootWithFour model;
  Bench probe(model, kPlenty);
  ASSERT_TRUE(probe.set->load_roots(probe.renderer));
  Bench bench(model, probe.set->memory().total() + 40000, 1000);
  ASSERT_TRUE(bench.set->load_roots(bench.renderer));
  bench.want({{model.leaves[0], 1}, {model.leaves[1], 1}});
  bench.run();
  bench.want({{model.leaves[0], 1}, {model.leaves[1], 1}, {model.leaves[2], 5}, {model.leaves[3], 5}});
  Loader::Outcome outcome = Loader::Outcome::worked;
  while (outcome == Loader::Outcome::worked) outcome = bench.loader->step().outcome;
  EXPECT_EQ(outcome, Loader::Outcome::waiting);
  EXPECT_GT(bench.renderer.bytes_of(bench.set->mesh_of(model.leaves[0])), 0U) << "still drawable in this frame";
  bench.begin_frame();
  EXPECT_EQ(bench.loader->step().outcome, Loader::Outcome::worked);
}

TEST(Loader, never_exceeds_the_bound_never_evicts_roots_and_always_progresses) {
  for (const uint32_t seed : {1U, 2U, 3U}) {
    Forest model;
    model.grow(model.root(somewhere_pose, 1), 3, 4);
    model.grow(model.root(somewhere_pose, 1), 2, 5);
    std::mt19937 random(seed);
    const uint32_t nodes = static_cast<uint32_t>(model.model().tables.nodes.size());
    for (uint32_t i = 0; i < 12; ++i) {
      std::vector<NodeId> users;
      for (int k = 0; k < 6; ++k) {
        const NodeId id{static_cast<uint32_t>(random()) % nodes};
        if (model.node(id).texture_count == 0 && std::find(users.begin(), users.end(), id) == users.end())
          users.push_back(id);
      }
      model.texture(8 + static_cast<uint32_t>(random()) % 40, users);
    }
    Bench bench(model, 400000, 300);
    const Status roots = bench.set->load_roots(bench.renderer);
    ASSERT_TRUE(roots) << roots.error().message;
    for (int round = 0; round < 400; ++round) {
      std::vector<PriorityUpdate> updates;
      NodeId best{};
      float most = -1;
      for (uint32_t i = 0; i < nodes; ++i) {
        if (random() % 3 == 0) continue;
        updates.push_back({NodeId{i}, float(random() % 1000)});
        if (updates.back().priority > most) most = updates.back().priority, best = NodeId{i};
      }
      bench.want(updates);
      if (round % 8 == 0) {
        bench.run();
        ASSERT_TRUE(bench.resident(best)) << "round " << round;
      }
      for (uint32_t steps = static_cast<uint32_t>(random()) % 30; steps > 0; --steps) {
        bench.loader->step();
        bench.check_memory();
      }
      bench.begin_frame();
      bench.upload(0);
      bench.check_memory();
      for (const NodeId root : model.model().tables.roots) ASSERT_TRUE(bench.resident(root));
    }
    EXPECT_LE(bench.set->memory_peak_bytes(), 400000U);
    EXPECT_GT(bench.set->counts().nodes_evicted, 100U) << "the bound was no bound";
    EXPECT_GT(bench.set->counts().loads_suspended, 10U);
  }
}

TEST(Loader, memory_too_small_for_the_roots_says_what_is_needed) {
  RootWithFour model;
  Bench bench(model, 10000);
  const Status status = bench.set->load_roots(bench.renderer);
  ASSERT_FALSE(status);
  EXPECT_NE(status.error().message.find("10000"), std::string::npos) << status.error().message;
  EXPECT_NE(status.error().message.find("give more"), std::string::npos) << status.error().message;
}

TEST(Loader, node_that_never_fits_is_counted_and_left) {
  RootWithFour model;
  model.node(model.leaves[0]).triangles = 1000000;
  Bench bench(model, 200000);
  ASSERT_TRUE(bench.set->load_roots(bench.renderer));
  bench.want({{model.leaves[0], 2}, {model.leaves[1], 1}});
  bench.run();
  EXPECT_FALSE(bench.resident(model.leaves[0]));
  EXPECT_TRUE(bench.resident(model.leaves[1]));
  EXPECT_EQ(bench.set->counts().refused_too_large, 1U);
}

TEST(Loader, unreadable_or_wrong_segment_is_counted_once_and_never_asked_for_again) {
  RootWithFour model;
  model.unreadable.insert(model.node(model.leaves[0]).segment);
  model.undecodable.insert(model.node(model.leaves[1]).segment);
  Bench bench(model, kPlenty);
  ASSERT_TRUE(bench.set->load_roots(bench.renderer));
  for (int i = 0; i < 3; ++i) {
    bench.want({{model.leaves[0], 3}, {model.leaves[1], 2}, {model.leaves[2], 1}});
    bench.run();
  }
  EXPECT_EQ(bench.set->counts().failed_reads, 1U);
  EXPECT_EQ(bench.set->counts().failed_decodes, 1U);
  EXPECT_THAT(bench.set->failures(), ElementsAre("forest: unreadable", "forest: wrong bytes"));
  EXPECT_TRUE(bench.resident(model.leaves[2]));
}

TEST(Loader, mesh_larger_than_its_tables_say_is_refused) {
  struct Liar : RootWithFour {
    Result<Mesh> decode_mesh(NodeId id, std::span<const std::byte> stored) const override {
      Result<Mesh> mesh = RootWithFour::decode_mesh(id, stored);
      if (id == leaves[0]) mesh->positions.emplace_back(0);
      return mesh;
    }
  } model;
  Bench bench(model, kPlenty);
  ASSERT_TRUE(bench.set->load_roots(bench.renderer));
  bench.want({{model.leaves[0], 1}});
  bench.run();
  EXPECT_EQ(bench.set->counts().failed_decodes, 1U);
  EXPECT_FALSE(bench.resident(model.leaves[0]));
}

TEST(Loader, failed_upload_is_counted) {
  RootWithFour model;
  Bench bench(model, kPlenty);
  ASSERT_TRUE(bench.set->load_roots(bench.renderer));
  bench.renderer.fail_uploads = true;
  bench.want({{model.leaves[0], 1}});
  bench.run();
  EXPECT_EQ(bench.set->counts().failed_uploads, 1U);
  EXPECT_FALSE(bench.resident(model.leaves[0]));
}

TEST(Loader, useful_bytes_are_those_of_drawn_nodes) {
  RootWithFour model;
  Bench bench(model, kPlenty);
  ASSERT_TRUE(bench.set->load_roots(bench.renderer));
  bench.want({{model.leaves[0], 2}, {model.leaves[1], 1}});
  bench.run();
  bench.set->mark_drawn(std::vector<NodeId>{model.leaves[0]});
  bench.set->mark_drawn(std::vector<NodeId>{model.leaves[0]});
  EXPECT_EQ(bench.set->counts().bytes_read_useful, 1000U);
}

TEST(Loader, emulated_disk_takes_its_time_and_counts_runs) {
  RootWithFour model;
  Bench bench(model, kPlenty, 500);
  ASSERT_TRUE(bench.set->load_roots(bench.renderer));
  const uint64_t reads = bench.set->counts().reads;
  LoaderOptions options = bench.options;
  options.disk_mbps = 0.5;  // 500 bytes: 1 ms
  options.disk_seek_ms = 7;
  Loader loader(model, bench.renderer, *bench.set, nullptr, options);
  // Leaves 1 and 2 lie one behind the other; leaf 0 before them.
  bench.want({{model.leaves[1], 3}, {model.leaves[2], 2}, {model.leaves[0], 1}});
  std::vector<int> read_ms;
  for (int i = 0; i < 9; ++i) {
    const double busy_ms = loader.step().busy_ms;
    if (i % 3 != 2) read_ms.push_back(int(busy_ms + 0.01));
  }
  EXPECT_THAT(read_ms, ElementsAre(8, 1, 1, 1, 8, 1));
  EXPECT_EQ(bench.set->counts().reads - reads, 2U);
}

TEST(LoaderThread, feeds_a_render_loop_within_the_bound) {
  Forest model;
  model.grow(model.root(somewhere_pose, 1), 3, 4);
  const uint32_t nodes = static_cast<uint32_t>(model.model().tables.nodes.size());
  Bench bench(model, 500000, 300);
  ASSERT_TRUE(bench.set->load_roots(bench.renderer));
  {
    LoaderThread thread(*bench.loader);
    std::mt19937 random(4);
    for (int frame = 0; frame < 300; ++frame) {
      bench.begin_frame();
      bench.upload(0.2);
      std::vector<PriorityUpdate> updates;
      for (uint32_t i = 0; i < nodes; ++i)
        if (random() % 4 != 0) updates.push_back({NodeId{i}, float(random() % 1000)});
      bench.want(updates);
      thread.wake();
      bench.check_memory();
      if (frame % 3 == 0) thread.wait();
    }
  }
  EXPECT_GT(bench.set->counts().nodes_loaded, 20U);
  EXPECT_LE(bench.set->memory_peak_bytes(), 500000U);
}

TEST(LoaderThread, stops_when_its_grant_is_spent) {
  RootWithFour model;
  Bench bench(model, kPlenty, 100);
  ASSERT_TRUE(bench.set->load_roots(bench.renderer));
  LoaderOptions options = bench.options;
  options.disk_mbps = 0.1;  // 100 bytes: 1 ms
  Loader loader(model, bench.renderer, *bench.set, nullptr, options);
  LoaderThread thread(loader);
  thread.grant(0);
  bench.want({{model.leaves[0], 1}});
  const uint64_t before = bench.set->counts().bytes_read;
  thread.grant(2.5);
  thread.wait();
  EXPECT_GE(bench.set->counts().bytes_read - before, 100U);
  EXPECT_LE(bench.set->counts().bytes_read - before, 300U) << "a piece that was begun within the grant is finished";
}

}  // namespace
}  // namespace promenade
