#pragma once
// Numbers in as few bytes as they need: seven bits a byte, the lowest first; the top bit says that more follow.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace promenade {

inline void put_varint(std::vector<std::byte>& bytes, uint32_t value) {
  constexpr unsigned kGroupBits = 7;
  constexpr uint32_t kGroupMask = 0x7f, kMore = 0x80;
  for (; value > kGroupMask; value >>= kGroupBits)
    bytes.push_back(static_cast<std::byte>((value & kGroupMask) | kMore));
  bytes.push_back(static_cast<std::byte>(value));
}

class VarintReader {
 public:
  explicit VarintReader(std::span<const std::byte> bytes) : bytes_(bytes) {}
  bool at_end() const { return at_ == bytes_.size(); }
  size_t offset() const { return at_; }
  /// False: the number is cut off, has more than 32 bits or more bytes than it needs.
  bool get(uint32_t& value) {
    constexpr unsigned kGroupBits = 7, kMaxGroups = 5;  // of 7 bits each hold 32 bits
    constexpr uint32_t kGroupMask = 0x7f, kMore = 0x80;
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

}  // namespace promenade
