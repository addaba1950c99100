#include "codec/id_set.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

namespace promenade {
namespace {

constexpr unsigned kGroupBits = 7;
constexpr uint32_t kGroupMask = 0x7f, kMore = 0x80;
constexpr unsigned kMaxGroups = 5;  // of 7 bits each hold 32 bits

/// Seven bits a byte, the lowest first; the top bit says that more follow.
void put_number(std::vector<std::byte>& bytes, uint32_t value) {
  for (; value > kGroupMask; value >>= kGroupBits)
    bytes.push_back(static_cast<std::byte>((value & kGroupMask) | kMore));
  bytes.push_back(static_cast<std::byte>(value));
}

class NumberReader {
 public:
  explicit NumberReader(std::span<const std::byte> bytes) : bytes_(bytes) {}
  bool at_end() const { return at_ == bytes_.size(); }
  size_t offset() const { return at_; }
  /// False: the number is cut off, has more than 32 bits or more bytes than it needs.
  bool get(uint32_t& value) {
    uint64_t sum = 0;
    for (unsigned group = 0; group < kMaxGroups && at_ < bytes_.size(); ++group) {
      const auto byte = std::to_integer<uint32_t>(bytes_[at_++]);
      sum |= uint64_t(byte & kGroupMask) << (kGroupBits * group);
      if ((byte & kMore) != 0) continue;
      value = static_cast<uint32_t>(sum);
      return sum == value && (byte != 0 || group == 0);
    }
    return false;
  }

 private:
  std::span<const std::byte> bytes_;
  size_t at_ = 0;
};

}  // namespace

std::vector<std::byte> encode_ids(std::span<const uint32_t> ids) {
  std::vector<std::byte> bytes;
  uint64_t free = 0;  // the least id that the next run may begin with
  for (size_t i = 0; i < ids.size();) {
    size_t end = i + 1;
    while (end < ids.size() && ids[end] == ids[end - 1] + 1) ++end;
    put_number(bytes, static_cast<uint32_t>(ids[i] - free));
    put_number(bytes, static_cast<uint32_t>(end - i - 1));
    free = uint64_t(ids[end - 1]) + 2;  // the id after a run is not in the set, or the run would be longer
    i = end;
  }
  return bytes;
}

Result<std::vector<uint32_t>> decode_ids(std::span<const std::byte> bytes, uint32_t limit) {
  std::vector<uint32_t> ids;
  NumberReader reader(bytes);
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
