#pragma once
// What ThreadSanitizer must be told: TBB is built without it, so that it does not see that what one thread did before a
// task, or in it, has happened for those that run it, or wait for it.

#ifdef __SANITIZE_THREAD__
#include <sanitizer/tsan_interface.h>
#endif

namespace promenade {

/// What happened before give() has happened for who takes. Costs nothing in other builds. Any thread.
class HandOver {
 public:
#ifdef __SANITIZE_THREAD__
  void give() { __tsan_release(this); }
  void take() { __tsan_acquire(this); }

 private:
  char address_ = 0;
#else
  void give() {}
  void take() {}
#endif
};

}  // namespace promenade
