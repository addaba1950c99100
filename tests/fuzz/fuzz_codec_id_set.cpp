// Any bytes as sets of ids: the first byte says by which codec; the last one stands for blocks. Must end in an error or
// in ascending ids (of a block: antichains of its forest), within the room that there is.

#include <cstdint>
#include <cstdlib>
#include <span>
#include <vector>

#include "codec/id_set_block.h"
#include "codec/id_set_codec.h"
#include "codec/id_set_rivals.h"

namespace {

using namespace promenade;
constexpr uint32_t kUniverse = 4096;
constexpr size_t kRoom = 1024;

void expect(bool holds) {
  if (!holds) std::abort();
}

/// Four children a node, but the last.
IdForest some_forest() {
  IdForest forest;
  const auto grow = [&forest](const auto& self, uint32_t levels) -> void {
    const size_t node = forest.subtree_end.size();
    forest.subtree_end.push_back(0);
    for (uint32_t i = 0; levels > 0 && i < 4; ++i) self(self, levels - 1);
    forest.subtree_end[node] = forest.size();
  };
  grow(grow, 4);
  return forest;
}

void decode_as_block(std::span<const std::byte> bytes) {
  static const IdForest forest = some_forest();
  std::vector<uint32_t> ids(kRoom), ends(kMaxSetsInBlock);
  if (!decode_block(forest, bytes, ids, ends)) return;
  size_t begin = 0;
  for (const uint32_t end : ends) {
    expect(end >= begin && end <= ids.size());
    expect(is_antichain(forest, std::span(ids).subspan(begin, end - begin)));
    begin = end;
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  if (size == 0) return 0;
  const std::span<const std::byte> bytes = std::as_bytes(std::span(data, size)).subspan(1);
  const std::span<const IdSetCodec> codecs = id_set_codecs();
  const size_t choice = data[0] % (codecs.size() + 2);
  std::vector<uint32_t> ids(kRoom), ends(40);
  if (choice == codecs.size()) {
    static_cast<void>(decode_zstd_frame(bytes, kUniverse, ids, ends).ok());
  } else if (choice > codecs.size()) {
    decode_as_block(bytes);
  } else {
    const Result<size_t> count = codecs[choice].decode(bytes, kUniverse, ids);
    for (size_t i = 0; count && i < *count; ++i) expect(ids[i] < kUniverse && (i == 0 || ids[i - 1] < ids[i]));
  }
  return 0;
}
