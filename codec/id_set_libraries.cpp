// Rivals that libraries bring: CRoaring and zstd.
#include <fmt/format.h>
#include <roaring/roaring.h>
#include <zstd.h>

#include <memory>

#include "codec/frame.h"
#include "codec/id_runs.h"
#include "codec/id_set_rivals.h"
#include "codec/varint.h"

namespace promenade {
namespace {

constexpr int kZstdLevel = 19;

struct FreeRoaring {
  void operator()(roaring_bitmap_t* bitmap) const { roaring_bitmap_free(bitmap); }
};
using Roaring = std::unique_ptr<roaring_bitmap_t, FreeRoaring>;

/// Where the ids of a bitmap go. Broken bytes make containers that hold other ids than they say: nothing is believed.
struct RoaringSink {
  std::span<uint32_t> into;
  uint64_t universe = 0;
  uint64_t free = 0;
  size_t count = 0;
};
bool take(uint32_t id, void* sink) {
  auto& s = *static_cast<RoaringSink*>(sink);
  if (id < s.free || id >= s.universe || s.count == s.into.size()) return false;
  s.into[s.count++] = id;
  s.free = uint64_t(id) + 1;
  return true;
}

struct FreeContext {
  void operator()(ZSTD_DCtx* context) const { ZSTD_freeDCtx(context); }
};

/// The content of a frame that holds at most `most` bytes. The span lives until the thread's next call.
Result<std::span<const std::byte>> decompressed(std::span<const std::byte> bytes, size_t most) {
  thread_local const std::unique_ptr<ZSTD_DCtx, FreeContext> context(ZSTD_createDCtx());
  thread_local std::vector<std::byte> content;
  const uint64_t claimed = ZSTD_getFrameContentSize(bytes.data(), bytes.size());
  if (claimed > most) return Error{fmt::format("zstd frame: no content of at most {} bytes", most)};
  if (content.size() < claimed) content.resize(claimed);
  const size_t made = ZSTD_decompressDCtx(context.get(), content.data(), content.size(), bytes.data(), bytes.size());
  if (ZSTD_isError(made) || made != claimed) return Error{"zstd frame: broken"};
  return std::span<const std::byte>(content).first(made);
}

size_t most_varint_bytes(size_t ids, size_t sets) { return 10 * ids + 5 * sets; }

}  // namespace

void encode_roaring(std::span<const uint32_t> ids, uint32_t, std::vector<std::byte>& bytes) {
  const Roaring bitmap(roaring_bitmap_of_ptr(ids.size(), ids.data()));
  roaring_bitmap_run_optimize(bitmap.get());
  const size_t begin = bytes.size();
  bytes.resize(begin + roaring_bitmap_portable_size_in_bytes(bitmap.get()));
  roaring_bitmap_portable_serialize(bitmap.get(), reinterpret_cast<char*>(bytes.data() + begin));
}

Result<size_t> decode_roaring(std::span<const std::byte> bytes, uint32_t universe, std::span<uint32_t> into) {
  const auto* raw = reinterpret_cast<const char*>(bytes.data());
  const size_t used = roaring_bitmap_portable_deserialize_size(raw, bytes.size());
  if (used == 0 || used != bytes.size()) return Error{fmt::format("{} bytes are no Roaring bitmap", bytes.size())};
  const Roaring bitmap(roaring_bitmap_portable_deserialize_safe(raw, bytes.size()));
  if (!bitmap) return Error{"broken Roaring bitmap"};
  RoaringSink sink{into, universe};
  if (!roaring_iterate(bitmap.get(), take, &sink)) return Error{fmt::format("broken code after {} ids", sink.count)};
  return sink.count;
}

void encode_zstd(std::span<const uint32_t> ids, uint32_t universe, std::vector<std::byte>& bytes) {
  std::vector<std::byte> plain;
  encode_varint(ids, universe, plain);
  const std::vector<std::byte> frame = compress_frame(plain, kZstdLevel);
  bytes.insert(bytes.end(), frame.begin(), frame.end());
}

Result<size_t> decode_zstd(std::span<const std::byte> bytes, uint32_t universe, std::span<uint32_t> into) {
  const Result<std::span<const std::byte>> plain = decompressed(bytes, most_varint_bytes(into.size(), 1));
  if (!plain) return plain.error();
  return decode_varint(*plain, universe, into);
}

std::vector<std::byte> encode_zstd_frame(std::span<const std::vector<uint32_t>> sets) {
  std::vector<std::byte> plain;
  for (const std::vector<uint32_t>& set : sets) {
    uint32_t runs = 0;
    for_each_run(set, [&](uint32_t, uint32_t) { ++runs; });
    put_varint(plain, runs);
    encode_varint(set, 0, plain);
  }
  return compress_frame(plain, kZstdLevel);
}

Status decode_zstd_frame(std::span<const std::byte> bytes, uint32_t universe, std::span<uint32_t> ids,
                         std::span<uint32_t> ends) {
  const Result<std::span<const std::byte>> plain = decompressed(bytes, most_varint_bytes(ids.size(), ends.size()));
  if (!plain) return plain.error();
  VarintReader reader(*plain);
  size_t total = 0;
  for (size_t i = 0; i < ends.size(); ++i) {
    const auto broken = [i] { return Error{fmt::format("set {}: broken code", i)}; };
    uint32_t runs = 0;
    if (!reader.get(runs)) return broken();
    RunSink sink(ids.subspan(total), universe);
    for (; runs > 0; --runs) {
      uint32_t gap = 0, more = 0;
      if (!reader.get(gap) || !reader.get(more) || !sink.add(gap, more)) return broken();
    }
    total += sink.count();
    ends[i] = static_cast<uint32_t>(total);
  }
  if (!reader.at_end()) return Error{fmt::format("bytes follow the last of {} sets", ends.size())};
  return Done{};
}

}  // namespace promenade
