#include "codec/id_set.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "codec/varint.h"

namespace promenade {

std::vector<std::byte> encode_ids(std::span<const uint32_t> ids) {
  std::vector<std::byte> bytes;
  uint64_t free = 0;  // the least id that the next run may begin with
  for (size_t i = 0; i < ids.size();) {
    size_t end = i + 1;
    while (end < ids.size() && ids[end] == ids[end - 1] + 1) ++end;
    put_varint(bytes, static_cast<uint32_t>(ids[i] - free));
    put_varint(bytes, static_cast<uint32_t>(end - i - 1));
    free = uint64_t(ids[end - 1]) + 2;  // the id after a run is not in the set, or the run would be longer
    i = end;
  }
  return bytes;
}

Result<std::vector<uint32_t>> decode_ids(std::span<const std::byte> bytes, uint32_t limit) {
  std::vector<uint32_t> ids;
  VarintReader reader(bytes);
  uint64_t free = 0;
  while (!reader.at_end()) {
    const size_t at = reader.offset();
    uint32_t gap = 0, more = 0;
    if (!reader.get(gap) || !reader.get(more)) return Error{fmt::format("byte {}: a broken number", at)};
    const uint64_t first = free + gap, end = first + more + 1;
    if (end > limit) return Error{fmt::format("byte {}: ids {} to {}, the limit is {}", at, first, end - 1, limit)};
    for (uint64_t id = first; id < end; ++id) ids.push_back(static_cast<uint32_t>(id));
    free = end + 1;
  }
  return ids;
}

std::vector<uint32_t> symmetric_difference(std::span<const uint32_t> a, std::span<const uint32_t> b) {
  std::vector<uint32_t> difference;
  std::set_symmetric_difference(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(difference));
  return difference;
}

}  // namespace promenade
