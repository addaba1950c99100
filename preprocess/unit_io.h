#pragma once
// Values to bytes and back for the files that a build keeps to itself (spilled triangles, work units): little-endian as
// the machine has it, read by the same program that wrote them, guarded by a checksum outside.

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "geometry/mesh.h"

namespace promenade {

/// Appends values. One thread.
class UnitWriter {
 public:
  template <class T>
  void value(const T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    append(&value, sizeof(T));
  }
  /// A count, then the elements.
  template <class T>
  void array(const std::vector<T>& values) {
    static_assert(std::is_trivially_copyable_v<T>);
    value(static_cast<uint64_t>(values.size()));
    append(values.data(), values.size() * sizeof(T));
  }
  void text(const std::string& text) {
    value(static_cast<uint64_t>(text.size()));
    append(text.data(), text.size());
  }
  void mesh(const Mesh& mesh) {
    array(mesh.positions), array(mesh.normals), array(mesh.texcoords), array(mesh.colors);
    array(mesh.indices), array(mesh.materials);
  }
  std::vector<std::byte>& bytes() { return bytes_; }

 private:
  void append(const void* from, size_t count) {
    if (count == 0) return;
    const size_t at = bytes_.size();
    bytes_.resize(at + count);
    std::memcpy(bytes_.data() + at, from, count);
  }
  std::vector<std::byte> bytes_;
};

/// Reads what UnitWriter wrote. After the first value that does not fit everything reads as zero and ok() is false.
class UnitReader {
 public:
  explicit UnitReader(std::span<const std::byte> bytes) : bytes_(bytes) {}

  template <class T>
  T value() {
    static_assert(std::is_trivially_copyable_v<T>);
    T result{};
    take(&result, 1, sizeof(T));
    return result;
  }
  template <class T>
  std::vector<T> array() {
    const auto count = value<uint64_t>();
    if (!ok_ || count > left() / sizeof(T)) {
      ok_ = false;
      return {};
    }
    std::vector<T> result(static_cast<size_t>(count));
    take(result.data(), result.size(), sizeof(T));
    return result;
  }
  std::string text() {
    const std::vector<char> chars = array<char>();
    return {chars.begin(), chars.end()};
  }
  Mesh mesh() {
    Mesh mesh;
    mesh.positions = array<glm::vec3>(), mesh.normals = array<glm::vec3>(), mesh.texcoords = array<glm::vec2>();
    mesh.colors = array<glm::u8vec4>(), mesh.indices = array<uint32_t>(), mesh.materials = array<uint32_t>();
    return mesh;
  }
  bool ok() const { return ok_; }
  uint64_t left() const { return bytes_.size() - at_; }

 private:
  void take(void* into, size_t count, size_t size) {
    if (count > left() / size) ok_ = false;
    if (!ok_ || count == 0) return;
    std::memcpy(into, bytes_.data() + at_, count * size);
    at_ += count * size;
  }
  std::span<const std::byte> bytes_;
  size_t at_ = 0;
  bool ok_ = true;
};

}  // namespace promenade
