#pragma once
// A row of plain values on pages of its own: it grows without a copy (a vector that grows holds everything twice for a
// while), and gives all of its memory back to the system at once, whatever else lies in the heap.

#include <sys/mman.h>

#include <algorithm>
#include <cstddef>
#include <memory>
#include <new>
#include <span>
#include <type_traits>
#include <utility>

namespace promenade {

/// As std::vector, for values that may be moved byte by byte. Memory that was never written to is none. Throws
/// std::bad_alloc. Not thread-safe.
template <class T>
class PagedArray {
  static_assert(std::is_trivially_copyable_v<T> && std::is_trivially_destructible_v<T>);

 public:
  PagedArray() = default;
  PagedArray(PagedArray&& other) noexcept
      : data_(std::exchange(other.data_, nullptr)),
        size_(std::exchange(other.size_, 0)),
        capacity_(std::exchange(other.capacity_, 0)) {}
  PagedArray& operator=(PagedArray&& other) noexcept {
    std::swap(data_, other.data_), std::swap(size_, other.size_), std::swap(capacity_, other.capacity_);
    return *this;
  }
  PagedArray(const PagedArray&) = delete;
  PagedArray& operator=(const PagedArray&) = delete;
  ~PagedArray() { release(); }

  void push_back(const T& value) {
    const T copy = value;  // it may lie in what moves
    if (size_ == capacity_) reserve(size_ + 1);
    ::new (data_ + size_++) T(copy);
  }
  void append(std::span<const T> values) {
    reserve(size_ + values.size());
    std::uninitialized_copy(values.begin(), values.end(), data_ + size_);
    size_ += values.size();
  }
  void pop_back() { --size_; }
  /// Forgets all but the first so many, or adds some of whatever value.
  void resize(size_t count) {
    reserve(count);
    size_ = count;
  }
  /// Forgets the values and keeps the memory.
  void clear() { size_ = 0; }
  void release() {
    if (data_ != nullptr) munmap(data_, capacity_ * sizeof(T));
    data_ = nullptr, size_ = capacity_ = 0;
  }
  /// By a quarter at least, in place or moved page by page.
  void reserve(size_t count) {
    if (count <= capacity_) return;
    const size_t least = std::max({count, capacity_ + capacity_ / 4, kLeastBytes / sizeof(T) + 1});
    const size_t bytes = (least * sizeof(T) + kLeastBytes - 1) / kLeastBytes * kLeastBytes;
    void* moved = data_ == nullptr ? mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0)
                                   : mremap(data_, capacity_ * sizeof(T), bytes, MREMAP_MAYMOVE);
    if (moved == MAP_FAILED) throw std::bad_alloc();
    data_ = static_cast<T*>(moved), capacity_ = bytes / sizeof(T);
  }

  size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  T* data() { return data_; }
  const T* data() const { return data_; }
  T* begin() { return data_; }
  const T* begin() const { return data_; }
  T* end() { return data_ + size_; }
  const T* end() const { return data_ + size_; }
  T& operator[](size_t i) { return data_[i]; }
  const T& operator[](size_t i) const { return data_[i]; }
  T& back() { return data_[size_ - 1]; }
  const T& back() const { return data_[size_ - 1]; }
  friend bool operator==(const PagedArray& a, const PagedArray& b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end());
  }

 private:
  static constexpr size_t kLeastBytes = size_t(1) << 16;  // whole pages, of whatever size
  T* data_ = nullptr;
  size_t size_ = 0, capacity_ = 0;
};

}  // namespace promenade
