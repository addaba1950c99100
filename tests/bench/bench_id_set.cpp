// Speed and size of the id set codecs: sets by themselves, and blocks of sets as a model stores them. Fronts that move
// a little from set to set, as those of neighbouring cells do; the second number of a block's name is how many 256ths
// of the nodes hiding changes.

#include <benchmark/benchmark.h>

#include "codec/id_set_block.h"
#include "codec/id_set_codec.h"
#include "tests/codec/id_set_fixtures.h"

namespace promenade {
namespace {

constexpr uint32_t kUniverse = 1U << 20;

void BM_decode_set(benchmark::State& state) {
  const IdSetCodec& codec = id_set_codecs()[static_cast<size_t>(state.range(0))];
  Random random(1);
  std::vector<std::vector<std::byte>> coded(64);
  size_t ids = 0, bytes = 0;
  for (std::vector<std::byte>& set : coded) {
    const std::vector<uint32_t> some = random_ids(random, kUniverse, static_cast<uint32_t>(state.range(1)), 6);
    codec.encode(some, kUniverse, set);
    ids += some.size(), bytes += set.size();
  }
  std::vector<uint32_t> into(4 * static_cast<size_t>(state.range(1)) + 64);
  for (auto unused : state)
    for (const std::vector<std::byte>& set : coded) benchmark::DoNotOptimize(codec.decode(set, kUniverse, into).ok());
  state.SetLabel(std::string(codec.name));
  state.counters["bytes_per_set"] = static_cast<double>(bytes) / static_cast<double>(coded.size());
  state.counters["ids_per_s"] = benchmark::Counter(static_cast<double>(ids * static_cast<size_t>(state.iterations())),
                                                   benchmark::Counter::kIsRate);
}
BENCHMARK(BM_decode_set)
    ->ArgsProduct({benchmark::CreateDenseRange(0, static_cast<int>(id_set_codecs().size()) - 1, 1), {100, 1000}});

/// Sets whose thresholds of refinement and hiding move by a step each.
IdSetBlock walk_block(const IdForest& forest, uint32_t hide_step) {
  IdSetBlock block;
  for (uint32_t i = 0; i < kMaxSetsInBlock; ++i) {
    const std::vector<uint32_t> set = front_part(forest, 160 + i, 64 + i * hide_step);
    block.ids.insert(block.ids.end(), set.begin(), set.end());
    block.ends.push_back(static_cast<uint32_t>(block.ids.size()));
  }
  return block;
}

void BM_decode_block(benchmark::State& state) {
  Random random(2);
  const IdForest forest = random_forest(random, static_cast<uint32_t>(state.range(0)));
  const IdSetBlock block = walk_block(forest, static_cast<uint32_t>(state.range(1)));
  const std::vector<std::byte> bytes = encode_block(forest, block);
  std::vector<uint32_t> ids(block.ids.size()), ends(block.ends.size());
  for (auto unused : state) benchmark::DoNotOptimize(decode_block(forest, bytes, ids, ends).ok());
  state.counters["bytes_per_set"] = static_cast<double>(bytes.size()) / static_cast<double>(ends.size());
  state.counters["ids_per_s"] = benchmark::Counter(
      static_cast<double>(ids.size() * static_cast<size_t>(state.iterations())), benchmark::Counter::kIsRate);
}
BENCHMARK(BM_decode_block)->ArgsProduct({{10000, 100000}, {0, 1, 2}});

void BM_encode_block(benchmark::State& state) {
  Random random(2);
  const IdForest forest = random_forest(random, static_cast<uint32_t>(state.range(0)));
  const IdSetBlock block = walk_block(forest, 1);
  for (auto unused : state) benchmark::DoNotOptimize(encode_block(forest, block).size());
  state.counters["ids_per_s"] = benchmark::Counter(
      static_cast<double>(block.ids.size() * static_cast<size_t>(state.iterations())), benchmark::Counter::kIsRate);
}
BENCHMARK(BM_encode_block)->Arg(10000)->Arg(100000);

}  // namespace
}  // namespace promenade
