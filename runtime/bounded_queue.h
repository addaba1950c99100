#pragma once
// A queue between two stages that work at the same time.

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <mutex>
#include <optional>
#include <utility>

namespace promenade {

/// Any threads. Whoever puts something into a full queue waits, and so does whoever takes from an empty one.
/// Source: [funkhouser1993] section 6.1.
template <class T>
class BoundedQueue {
 public:
  /// capacity: >= 1.
  explicit BoundedQueue(size_t capacity) : capacity_(capacity) {}

  /// false: the queue is closed, and `value` is gone.
  bool put(T value) {
    {
      std::unique_lock lock(mutex_);
      changed_.wait(lock, [this] { return closed_ || values_.size() < capacity_; });
      if (closed_) return false;
      values_.push_back(std::move(value));
    }
    changed_.notify_all();
    return true;
  }

  /// nullopt: the queue is closed and empty.
  std::optional<T> take() {
    std::optional<T> value;
    {
      std::unique_lock lock(mutex_);
      changed_.wait(lock, [this] { return closed_ || !values_.empty(); });
      if (values_.empty()) return std::nullopt;
      value = std::move(values_.front());
      values_.pop_front();
    }
    changed_.notify_all();
    return value;
  }

  /// The same, but nullopt where there is nothing at the moment.
  std::optional<T> take_if_there() {
    std::optional<T> value;
    {
      const std::lock_guard lock(mutex_);
      if (values_.empty()) return std::nullopt;
      value = std::move(values_.front());
      values_.pop_front();
    }
    changed_.notify_all();
    return value;
  }

  /// Nothing more can be put in; what is in it can be taken. Whoever waits goes on.
  void close() {
    {
      const std::lock_guard lock(mutex_);
      closed_ = true;
    }
    changed_.notify_all();
  }

  size_t size() const {
    const std::lock_guard lock(mutex_);
    return values_.size();
  }

 private:
  const size_t capacity_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<T> values_;  ///< guarded by mutex_
  bool closed_ = false;   ///< guarded by mutex_
};

}  // namespace promenade
