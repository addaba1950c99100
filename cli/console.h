#pragma once
// What a person sees while a command works: progress on standard error, results on standard output.

#include <chrono>
#include <ctime>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include "geometry/job_monitor.h"

namespace promenade {

/// Draws a bar on a terminal once a stage has taken more than a second; elsewhere writes a plain line when such a stage
/// ends and every ten seconds within it. Warnings: the first few in full, then a count. Thread-safe.
class ConsoleMonitor : public JobMonitor {
 public:
  ConsoleMonitor();
  ~ConsoleMonitor() override;
  void progress(std::string_view stage, uint64_t done, uint64_t total) override;
  void warning(std::string_view message) override;
  bool cancelled() const override;

 private:
  using Clock = std::chrono::steady_clock;
  void draw(Clock::time_point now);
  void end_stage(Clock::time_point now);

  std::mutex mutex_;  // guards everything below
  bool terminal_ = false;
  bool bar_shown_ = false;
  bool line_shown_ = false;
  std::string stage_;
  uint64_t done_ = 0, total_ = 0;
  Clock::time_point stage_start_, last_drawn_;
  uint64_t warnings_ = 0;
};

/// From now on Ctrl-C and SIGTERM ask the running job to stop (ConsoleMonitor::cancelled); a second Ctrl-C ends the
/// process at once.
void catch_interrupts();

/// Seconds since construction.
class WallClock {
 public:
  double seconds() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

/// Processor time of the thread that makes it and asks it: what others do on the machine counts little.
class ThreadClock {
 public:
  double seconds() const { return now_s() - start_s_; }

 private:
  static double now_s() {
    timespec now{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return double(now.tv_sec) + double(now.tv_nsec) * 1e-9;
  }
  double start_s_ = now_s();
};

/// "12.3 MiB", "1.2 million": for people.
std::string human_bytes(uint64_t bytes);
std::string human_count(uint64_t count);

}  // namespace promenade
