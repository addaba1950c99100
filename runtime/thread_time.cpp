#include "runtime/thread_time.h"

#include <pthread.h>
#include <time.h>

namespace promenade {
namespace {

double ms_of(clockid_t clock) {
  timespec taken{};
  if (clock_gettime(clock, &taken) != 0) return 0;
  return double(taken.tv_sec) * 1e3 + double(taken.tv_nsec) * 1e-6;
}

}  // namespace

double own_cpu_ms() { return ms_of(CLOCK_THREAD_CPUTIME_ID); }

double cpu_ms_of(const std::thread& thread) {
  clockid_t clock{};
  // std::thread's handle is a pthread_t here; asking is no change of the thread.
  const pthread_t handle = const_cast<std::thread&>(thread).native_handle();
  return pthread_getcpuclockid(handle, &clock) == 0 ? ms_of(clock) : 0;
}

double process_cpu_ms() { return ms_of(CLOCK_PROCESS_CPUTIME_ID); }

}  // namespace promenade
