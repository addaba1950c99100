#pragma once
// Where the processor time of making nodes goes.

#include <time.h>

#include <array>
#include <atomic>
#include <cstdint>
#include <map>
#include <string>

namespace promenade {

/// Processor time of all threads, by part of the work. Any thread may add.
class NodeProfile {
 public:
  enum class Part : uint8_t { merge, simplify, measure, bake, code };

  /// Adds the calling thread's processor time until it goes. Not nested; nothing within may wait for other tasks,
  /// whose time it would count.
  class Clock {
   public:
    Clock(NodeProfile& profile, Part part) : profile_(profile), part_(part), start_ns_(thread_ns()) {}
    ~Clock() { profile_.spent_ns_[static_cast<size_t>(part_)] += thread_ns() - start_ns_; }
    Clock(const Clock&) = delete;
    Clock& operator=(const Clock&) = delete;

   private:
    static int64_t thread_ns() {
      timespec now{};
      clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
      return int64_t(now.tv_sec) * 1'000'000'000 + now.tv_nsec;
    }
    NodeProfile& profile_;
    Part part_;
    int64_t start_ns_;
  };

  /// By name.
  std::map<std::string, double> seconds() const {
    constexpr std::array<const char*, kParts> kNames = {"merge", "simplify", "measure", "bake", "code"};
    std::map<std::string, double> out;
    for (size_t i = 0; i < kParts; ++i) out[kNames[i]] = double(spent_ns_[i]) * 1e-9;
    return out;
  }

 private:
  static constexpr size_t kParts = 5;
  std::array<std::atomic<int64_t>, kParts> spent_ns_{};
};

}  // namespace promenade
