#pragma once
// Little-endian numbers to bytes and back, field by field.

#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>
#include <vector>

namespace promenade {

/// Appends numbers to a run of bytes.
class ByteWriter {
 public:
  template <std::integral T>
  void put(T value) {
    using Bits = std::make_unsigned_t<T>;
    const auto bits = static_cast<Bits>(value);
    for (size_t i = 0; i < sizeof(T); ++i) bytes_.push_back(static_cast<std::byte>((bits >> (8 * i)) & 0xffU));
  }
  void put(float value) { put(std::bit_cast<uint32_t>(value)); }
  void put(double value) { put(std::bit_cast<uint64_t>(value)); }
  void put_bytes(std::span<const std::byte> bytes) { bytes_.insert(bytes_.end(), bytes.begin(), bytes.end()); }

  size_t size() const { return bytes_.size(); }
  std::span<const std::byte> bytes() const { return bytes_; }
  std::vector<std::byte> take() { return std::move(bytes_); }

 private:
  std::vector<std::byte> bytes_;
};

/// Reads numbers from a run of bytes. Reading past the end gives zeros and is remembered: check counts against
/// remaining() before allocating, and ok() before using what was read.
class ByteReader {
 public:
  explicit ByteReader(std::span<const std::byte> bytes) : bytes_(bytes) {}

  template <std::integral T>
  T get() {
    using Bits = std::make_unsigned_t<T>;
    const std::span<const std::byte> raw = get_bytes(sizeof(T));
    Bits bits = 0;
    for (size_t i = 0; i < raw.size(); ++i)
      bits = static_cast<Bits>(bits | static_cast<Bits>(std::to_integer<Bits>(raw[i]) << (8 * i)));
    return static_cast<T>(bits);
  }
  template <std::floating_point T>
  T get() {
    if constexpr (sizeof(T) == sizeof(uint32_t))
      return std::bit_cast<T>(get<uint32_t>());
    else
      return std::bit_cast<T>(get<uint64_t>());
  }
  /// Empty, and ok() false, when there are fewer.
  std::span<const std::byte> get_bytes(uint64_t count) {
    if (count > remaining()) {
      ok_ = false;
      at_ = bytes_.size();
      return {};
    }
    const std::span<const std::byte> run = bytes_.subspan(at_, static_cast<size_t>(count));
    at_ += run.size();
    return run;
  }

  bool ok() const { return ok_; }
  size_t offset() const { return at_; }
  size_t remaining() const { return bytes_.size() - at_; }

 private:
  std::span<const std::byte> bytes_;
  size_t at_ = 0;
  bool ok_ = true;
};

}  // namespace promenade
