// Work of a picture on several threads.

#include <gtest/gtest.h>
#include <unistd.h>

#include <atomic>
#include <fstream>

#include "raster/visibility_state.h"

namespace promenade {
namespace {

/// Of the process, bytes that are in memory.
uint64_t resident_bytes() {
  std::ifstream file("/proc/self/statm");
  uint64_t all = 0, resident = 0;
  file >> all >> resident;
  return resident * static_cast<uint64_t>(sysconf(_SC_PAGESIZE));
}

TEST(RunParallel, does_each_piece_once) {
  for (const unsigned threads : {0U, 1U, 2U, 7U}) {
    std::vector<std::atomic<int>> done(100);
    run_parallel(threads, done.size(), [&](size_t i) { ++done[i]; });
    for (const std::atomic<int>& times : done) EXPECT_EQ(times, 1) << threads;
  }
}

/// An hour of frames calls this half a million times.
TEST(RunParallel, takes_no_memory_for_good) {
  const auto run = [](int times) {
    std::atomic<uint64_t> sum{0};
    for (int i = 0; i < times; ++i) run_parallel(2, 8, [&](size_t k) { sum += k; });
    return sum.load();
  };
  EXPECT_EQ(run(100), 2800U);
  const uint64_t before = resident_bytes();
  ASSERT_GT(before, 0U);
  run(5000);
  EXPECT_LT(resident_bytes(), before + (uint64_t(8) << 20)) << "of 35 MiB that an arena a call takes";
}

}  // namespace
}  // namespace promenade
