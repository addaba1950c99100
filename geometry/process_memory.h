#pragma once
// What this process takes.

#include <cstdint>

namespace promenade {

/// Most memory that the process held so far, bytes; 0 where the system does not tell. Any thread.
uint64_t peak_rss_bytes();

/// Gives back to the system what was freed and lies in whole pages: the C library keeps it, for whoever asks next.
/// Worth it after work that took much. Any thread.
void return_freed_memory();

}  // namespace promenade
